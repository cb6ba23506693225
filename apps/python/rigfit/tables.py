"""Modes and cables at hand as tables that the program reads."""

from collections.abc import Mapping
import math
import pathlib
import re

import numpy as np

from . import checks
from .results import Estimate, ModalResult


def write_modes(argument, given, folder):
    """Measured modes as a table that the program reads: its path. ``given``: path, ModalResult, frequencies, or dicts."""
    if isinstance(given, ModalResult):
        rows = []
        for mode in given._fields["modes"]:
            row = {"frequency_hz": mode["frequency_hz"]["value"], "std": mode["frequency_hz"]["std"]}
            if mode["damping_ratio"]["value"] is not None:
                row.update(damping_ratio=mode["damping_ratio"]["value"], damping_std=mode["damping_ratio"]["std"])
            rows.append(row)
    elif isinstance(given, np.ndarray) or (isinstance(given, (list, tuple)) and
                                           not any(isinstance(one, Mapping) for one in given)):
        rows = [{"frequency_hz": f} for f in checks.numbers(argument, given, positive=True)]
    elif isinstance(given, (list, tuple)):
        rows = list(given)
    else:
        checks.fail(argument, f"must be a path, a ModalResult, frequencies or a list of dicts, not {checks.kind(given)}")
    if not rows:
        checks.fail(argument, "holds no mode")
    columns = []
    for i, row in enumerate(rows):
        if not isinstance(row, Mapping):
            checks.fail(f"{argument}[{i}]", f"must be a dict with frequency_hz, not {checks.kind(row)}")
        if "frequency_hz" not in row:
            checks.fail(f"{argument}[{i}]", "has no frequency_hz")
        columns += [key for key in row if key not in columns]
    known = ("frequency_hz", "std", "damping_ratio", "damping_std", "plane", "tension_N")
    for column in columns:
        if not isinstance(column, str) or not (column in known or column.startswith("shape:")) or \
                any(c in column for c in ',"\n\r'):
            checks.fail(argument, f"has an unknown column {column!r}; known are {', '.join(known)}, shape:<sensor>")
    lines = [",".join(columns)]
    for i, row in enumerate(rows):
        cells = []
        for column in columns:
            value = row.get(column)
            if isinstance(value, Estimate):
                value = value.value
            if value is None:
                cells.append("")
            elif column == "plane":
                cells.append(checks.choice(f"{argument}[{i}].plane", value, ("in", "out", "any")))
            else:
                cells.append(repr(checks.number(f"{argument}[{i}].{column}", value)))
        lines.append(",".join(cells))
    file = pathlib.Path(folder) / f"{argument.replace('[', '_').replace(']', '')}.csv"
    file.write_text("\n".join(lines) + "\n")
    return str(file)


_CABLE_COLUMNS = ("name", "cable", "length", "length_std", "mass_per_length", "mass_per_length_std", "EI", "EI_std", "EA",
                  "EA_std", "inclination", "ends", "plane", "mass_of", "frequency_std", "frequencies")


def write_cables(argument, given, folder):
    """Cables as a table that the program reads: its path. ``given``: list of dicts, or a DataFrame."""
    if hasattr(given, "to_dict") and hasattr(given, "columns"):
        given = given.to_dict("records")
    if not isinstance(given, (list, tuple)) or not given:
        checks.fail(argument, f"must be a path, a list of dicts or a DataFrame, not {checks.kind(given)}")
    columns, rows = [], []
    for i, row in enumerate(given):
        if not isinstance(row, Mapping):
            checks.fail(f"{argument}[{i}]", f"must be a dict, not {checks.kind(row)}")
        cells = {}
        for key, value in row.items():
            if not isinstance(key, str) or not (key in _CABLE_COLUMNS or re.fullmatch("f[0-9]+", key)):
                checks.fail(f"{argument}[{i}]", f"has an unknown entry {key!r}; known are {', '.join(_CABLE_COLUMNS)}, "
                                                "f1, f2 ...")
            entry = f"{argument}[{i}].{key}"
            if value is None or isinstance(value, float) and math.isnan(value):
                continue  # not known
            if key in ("name", "cable", "ends", "plane", "mass_of"):
                word = checks.text(entry, value)
                if any(c in word for c in '"\n\r'):
                    checks.fail(entry, "holds a quote or a line end")
                cells[key] = f'"{word}"'
            elif key == "frequencies":
                cells[key] = " ".join(repr(f) for f in checks.numbers(entry, value, positive=True))
            else:
                cells[key] = repr(checks.number(entry, value))
        columns += [key for key in row if key not in columns]
        rows.append(cells)
    lines = [",".join(columns)] + [",".join(cells.get(column, "") for column in columns) for cells in rows]
    file = pathlib.Path(folder) / "cables.csv"
    file.write_text("\n".join(lines) + "\n")
    return str(file)
