"""Modes and cables at hand as tables that the program reads."""

from collections.abc import Mapping
import math
import pathlib
import re

import numpy as np

from . import checks
from .results import Estimate, ModalResult


def _write(argument, rows, name, known, pattern, cell):
    """Rows as a table: its path. ``cell(entry, column, value)``: a checked value as text."""
    columns = []
    for i, row in enumerate(rows):
        if not isinstance(row, Mapping):
            checks.fail(f"{argument}[{i}]", f"must be a dict, not {checks.kind(row)}")
        for key in row:
            if not isinstance(key, str) or not (key in known or re.fullmatch(pattern, key)):
                checks.fail(f"{argument}[{i}]", f"has an unknown entry {key!r}; known are {', '.join(known)}")
        columns += [key for key in row if key not in columns]
    lines = [",".join(columns)]
    for i, row in enumerate(rows):
        given = {key: value.value if isinstance(value, Estimate) else value for key, value in row.items()}
        lines.append(",".join("" if given.get(key) is None else cell(f"{argument}[{i}].{key}", key, given[key]) for key in columns))
    pathlib.Path(name).write_text("\n".join(lines) + "\n")
    return str(name)


def write_modes(argument, given, folder):
    """Measured modes as a table that the program reads: its path. ``given``: path, ModalResult, frequencies, or dicts."""
    if isinstance(given, ModalResult):
        rows = [{"frequency_hz": mode["frequency_hz"]["value"], "std": mode["frequency_hz"]["std"],
                 "damping_ratio": mode["damping_ratio"]["value"], "damping_std": mode["damping_ratio"]["std"]}
                for mode in given._fields["modes"]]
    elif isinstance(given, np.ndarray) or (isinstance(given, (list, tuple)) and
                                           not any(isinstance(one, Mapping) for one in given)):
        rows = [{"frequency_hz": f} for f in checks.numbers(argument, given, positive=True)]
    elif isinstance(given, (list, tuple)):
        rows = list(given)
    else:
        checks.fail(argument, f"must be a path, a ModalResult, frequencies or a list of dicts, not {checks.kind(given)}")
    for i, row in enumerate(rows):
        if isinstance(row, Mapping) and "frequency_hz" not in row:
            checks.fail(f"{argument}[{i}]", "has no frequency_hz")
    if not rows:
        checks.fail(argument, "holds no mode")

    def cell(entry, column, value):
        return checks.choice(entry, value, ("in", "out", "any")) if column == "plane" else repr(checks.number(entry, value))
    return _write(argument, rows, pathlib.Path(folder) / f"{argument.replace('[', '_').replace(']', '')}.csv",
                  ("frequency_hz", "std", "damping_ratio", "damping_std", "plane", "tension_N"), '(?s)shape:[^,"\n\r]*', cell)


_WORDS = ("name", "cable", "ends", "plane", "mass_of")


def write_cables(argument, given, folder):
    """Cables as a table that the program reads: its path. ``given``: list of dicts, or a DataFrame."""
    if hasattr(given, "to_dict") and hasattr(given, "columns"):
        given = given.to_dict("records")
    if not isinstance(given, (list, tuple)) or not given:
        checks.fail(argument, f"must be a path, a list of dicts or a DataFrame, not {checks.kind(given)}")

    def cell(entry, column, value):
        if column in _WORDS:
            if any(c in checks.text(entry, value) for c in '"\n\r'):
                checks.fail(entry, "holds a quote or a line end")
            return f'"{value}"'
        if column == "frequencies":
            return " ".join(repr(f) for f in checks.numbers(entry, value, positive=True))
        return repr(checks.number(entry, value))
    given = [{key: None if isinstance(value, float) and math.isnan(value) else value for key, value in row.items()}
             if isinstance(row, Mapping) else row for row in given]  # not known
    known = _WORDS + ("length", "length_std", "mass_per_length", "mass_per_length_std", "EI", "EI_std", "EA", "EA_std", "inclination",
                      "frequency_std", "frequencies")
    return _write(argument, given, pathlib.Path(folder) / "cables.csv", known, "f[0-9]+", cell)
