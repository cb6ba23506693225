"""Laboratory tests to parameters: `bending`, `axial`, `tension`, `tension_table`."""

from collections.abc import Mapping
import math
import pathlib
import re
import tempfile

import numpy as np

from . import _core, checks
from .recordings import Recording, sources
from .results import AxialResult, BendingResult, Estimate, ModalResult, TensionResult, TensionTableResult
from .spectra import call, finish


def positives(options, **values):
    """Optional numbers above zero."""
    for name, value in values.items():
        if value is not None:
            options[name] = checks.number(name, value, positive=True)


def not_negative(options, high=None, **values):
    """Optional numbers from zero on."""
    for name, value in values.items():
        if value is not None:
            options[name] = checks.number(name, value, 0, high)


_UNITS = {"tension": "N", "tension_N": "N", "load": "N", "load_N": "N", "deflection": "m", "deflection_m": "m",
          "EI_Nm2": "N m2", "EI": "N m2", "std": "N m2", "low": "N m2", "high": "N m2"}


def bending(recordings, *, span=None, span_std=None, tension=None, ends=None, rectangle=None, diameter=None,
            second_moment=None, section_std=None, load=None, deflection=None, load_calibration=None,
            deflection_calibration=None, tension_zero_std=None, tension_calibration=None, strand=None,
            relative_std=None, EA=None, mass_per_length=None):
    """EI at each tension from load-deflection records or tables, and laws for EI over tension.

    Parameters
    ----------
    recordings : path, Recording, dict of arrays, or list of these
        Records or tables of tension, load and deflection; or of ``tension_N`` and ``EI_Nm2`` (with ``std``, or ``low``
        and ``high``). A dict holds arrays in SI by these names.
    span : float, optional
        Clear length between the clamps or supports (cantilever: to the load), m.
    span_std : float, optional
        Standard uncertainty of the span, m.
    tension : str or 0, optional
        Name of the tension column; 0: there is no tension (a beam, by dead weights or a testing machine).
    ends : {"clamped", "pinned", "cantilever"}, optional
        Of a beam without tension: clamped (default) or pinned, loaded at mid-span; cantilever, loaded at its end.
    rectangle : (float, float), optional
        Its cross-section: width and height (along the load), m: gives the modulus.
    diameter : float, optional
        Its diameter when round and solid, m.
    second_moment : float, optional
        Its second moment of area about the axis of bending, m4.
    section_std : float, optional
        Relative standard uncertainty of the second moment (three times that of a height, four times that of a
        diameter) (0 to 1).
    load : str, optional
        Name of the load column.
    deflection : str, optional
        Name of the deflection column.
    load_calibration : float, optional
        Relative standard uncertainty of the load cell's calibration (0 to 1).
    deflection_calibration : float, optional
        Relative standard uncertainty of the deflection sensor's calibration (0 to 1).
    tension_zero_std : float, optional
        Standard uncertainty of the tension cell's zero, N (offset and drift).
    tension_calibration : float, optional
        Relative standard uncertainty of the tension cell's calibration (0 to 1).
    strand : (E, wires, wire_diameter, diameter), optional
        Young's modulus (Pa), number of wires, wire diameter (m), strand diameter (m): bounds on EI.
    relative_std : float, optional
        Relative standard uncertainty of EI values that come without one (0 to 1).
    EA : float, optional
        Axial rigidity, N: with `mass_per_length`, the equivalent solid cylinder at each tension.
    mass_per_length : float, optional
        Of the cable, kg/m.

    Returns
    -------
    BendingResult
        ``tests[]`` with ``tension_N`` and ``EI_Nm2`` (Estimate), ``laws[]``, ``curve``, ``bounds``.
    """
    options = {}
    if isinstance(recordings, (Mapping, Recording)):
        recordings = [recordings]
    if isinstance(recordings, (list, tuple)):
        recordings = [Recording(one, units=_UNITS, name=f"recordings[{i}]") if _table(one) else one
                      for i, one in enumerate(recordings)]
    given = sources("recordings", recordings)
    positives(options, span=span, EA=EA, mass_per_length=mass_per_length, diameter=diameter, second_moment=second_moment)
    not_negative(options, span_std=span_std, tension_zero_std=tension_zero_std)
    not_negative(options, 1, load_calibration=load_calibration, deflection_calibration=deflection_calibration,
                 tension_calibration=tension_calibration, relative_std=relative_std, section_std=section_std)
    if isinstance(tension, (int, np.integer)) and not isinstance(tension, bool) and tension == 0:
        tension = "0"
    if ends is not None:
        options["ends"] = checks.choice("ends", ends, ("clamped", "pinned", "cantilever"))
    if rectangle is not None:
        options["rectangle"] = checks.numbers("rectangle", rectangle, positive=True)
        if len(options["rectangle"]) != 2:
            checks.fail("rectangle", "must be two numbers: width and height")
    if sum(one is not None for one in (rectangle, diameter, second_moment)) > 1:
        checks.fail("rectangle", "diameter and second_moment say the same: give one of them")
    for name, value in (("tension", tension), ("load", load), ("deflection", deflection)):
        if value is not None:
            options[name] = checks.text(name, value)
    if strand is not None:
        options["strand"] = checks.numbers("strand", strand, positive=True)
        if len(options["strand"]) != 4:
            checks.fail("strand", "must be four numbers: Young's modulus, wires, wire diameter, strand diameter")
        checks.number("strand[1]", options["strand"][1], 1, 1e6)
    return finish(BendingResult, *call(_core.bending, given, options))


def _table(one):
    return isinstance(one, Mapping) and "data" not in one


def axial(recordings, *, mass, length, channel=None, mass_per_length=None, mass_std=None, length_std=None,
          mass_per_length_std=None, adapter_stiffness=None, adapter_stiffness_std=None, adapter_bar=None,
          compliance_std=None, catalogue_EA=None, band=None, sample_rate=None, draws=None, threads=None, seed=None,
          frame_stiffness=None, frame_stiffness_std=None):
    """EA, damping ratio and damper of a cable from hanging-mass records.

    Parameters
    ----------
    recordings : path, Recording, list of channels, or list of these
        Tension or motion after an impulse; a record may hold several.
    mass : float
        Hung mass, adapter and clamp included, kg.
    length : float or list of float
        Cable length, m: for all, each file, or each group of files.
    channel : str, optional
        Name or #number.
    mass_per_length : float, optional
        Of the cable, kg/m.
    mass_std : float, optional
        Standard uncertainty, kg.
    length_std : float, optional
        Standard uncertainty of each length, m.
    mass_per_length_std : float, optional
        Standard uncertainty, kg/m.
    adapter_stiffness : float, optional
        In series with the cable, N/m (default: rigid).
    adapter_stiffness_std : float, optional
        Standard uncertainty, N/m.
    adapter_bar : (E, A, l), optional
        Adapter as a bar: modulus Pa, area m2, length m.
    compliance_std : float, optional
        Standard uncertainty of what else gives way in series, m/N; 0: known to be rigid (default: not known, told
        from several lengths).
    catalogue_EA : float, optional
        What EA should be, N (default: 80 GPa on the metal of the mass per length).
    band : (float, float), optional
        Where the axial frequency is, Hz.
    sample_rate : float, optional
        Where a file gives none, Hz.
    draws : int, optional
        Monte Carlo draws, 0 for none (0 to 10000000; default 20000).
    threads : int, optional
        Threads to use (all processors); the numbers do not depend on it (1 to 1024).
    seed : int, optional
        Seed of every random number (default 1).
    frame_stiffness : float or "rigid", optional
        What gives way above the cable, N/m, or rigid (default: not known; one length then gives a lower bound of EA).
    frame_stiffness_std : float, optional
        Standard uncertainty, N/m.

    Returns
    -------
    AxialResult
        ``EA_N``, ``damping_ratio``, ``damping_Ns_m`` (Estimate), ``samples[]``, ``budget[]``.
    """
    options = checks.common(threads, seed)
    given = sources("recordings", recordings)
    options["mass"] = checks.number("mass", mass, positive=True)
    options["length"] = checks.numbers("length", length, positive=True)
    if len(given) % len(options["length"]):
        checks.fail("length", f"has {len(options['length'])} values for {len(given)} recordings: give one, one for "
                              "each, or one for each group of equal size")
    if channel is not None:
        options["channel"] = checks.text("channel", channel)
    not_negative(options, mass_per_length=mass_per_length, mass_std=mass_std, length_std=length_std,
                 mass_per_length_std=mass_per_length_std, adapter_stiffness=adapter_stiffness,
                 adapter_stiffness_std=adapter_stiffness_std, compliance_std=compliance_std, catalogue_EA=catalogue_EA,
                 frame_stiffness_std=frame_stiffness_std)
    if frame_stiffness == "rigid":
        options["frame_stiffness"] = frame_stiffness
    elif frame_stiffness is not None:
        options["frame_stiffness"] = repr(float(checks.number("frame_stiffness", frame_stiffness, positive=True)))
    positives(options, sample_rate=sample_rate)
    if adapter_bar is not None:
        options["adapter_bar"] = checks.numbers("adapter_bar", adapter_bar, positive=True)
        if len(options["adapter_bar"]) != 3:
            checks.fail("adapter_bar", "must be three numbers: modulus, area, length")
    if band is not None:
        options["band"] = checks.band("band", band)
    if draws is not None:
        options["draws"] = checks.integer("draws", draws, 0, 10000000)
    return finish(AxialResult, *call(_core.axial, given, options))


def estimate_text(argument, value, positive=True):
    """"V" or "V,STD" of a number, a pair, an Estimate or a ufloat."""
    if isinstance(value, Estimate):
        value = (value.value, value.std) if value.std is not None else value.value
    elif hasattr(value, "nominal_value") and hasattr(value, "std_dev"):
        value = (value.nominal_value, value.std_dev)
    if isinstance(value, (tuple, list)):
        if len(value) != 2:
            checks.fail(argument, "must be a number or (value, std)")
        return ",".join((repr(checks.number(argument, value[0], positive=positive)),
                         repr(checks.number(f"{argument} std", value[1], 0))))
    return repr(checks.number(argument, value, positive=positive))


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


def tension_table(table, *, out=None, missed=None, false_mode=None, threads=None, seed=None):
    """Tensions of many cables from their natural frequencies, a row each.

    Parameters
    ----------
    table : path, list of dict or DataFrame
        Many cables, a row each (columns: ident/tension/README.md).

        Columns: name, length (m), mass_per_length (kg/m), and where known EI (N m2), EA (N), each also with ``_std``, inclination
        (degrees), ends, plane, mass_of, frequency_std (Hz); and f1, f2 ... or frequencies (a list), Hz. A file may say
        other units in brackets.
    out : path, optional
        Table of the tensions of `table`.
    missed : float, optional
        Probability that a mode in the band was missed (0.001 to 0.9; default 0.1).
    false_mode : float, optional
        Probability that a measured mode is none of the cable's (0.001 to 0.9; default 0.05).
    threads : int, optional
        Threads to use (all processors); the numbers do not depend on it (1 to 1024).
    seed : int, optional
        Seed of every random number (default 1).

    Returns
    -------
    TensionTableResult
        ``cables[]``, each with ``name`` and what `tension` gives, or ``error``.

    Raises
    ------
    Refused
        A row could not be used; ``result`` has the others.
    """
    options = checks.common(threads, seed)
    _probabilities(options, missed, false_mode)
    if out is not None:
        options["out"] = checks.new_file("out", out)
    with tempfile.TemporaryDirectory(prefix="rigfit-") as folder:
        options["table"] = checks.path("table", table) if is_path(table) else write_cables("table", table, folder)
        document, exit_code = call(_core.tension_table, options)
    return finish(TensionTableResult, at_hand(document, folder), exit_code)


def _probabilities(options, missed, false_mode):
    for name, value in (("missed", missed), ("false_mode", false_mode)):
        if value is not None:
            options[name] = checks.number(name, value, 0.001, 0.9)


def tension(recordings=None, *, length, mass_per_length, frequencies=None, frequency_std=None, measured=None,
            column=None, channel=None, band=None, max_peaks=None, sample_rate=None, plane="any", mass_of=None, EI=None,
            EA=None, inclination=None, ends="compare", missed=None, false_mode=None, threads=None, seed=None):
    """Tension of a cable, hanger or stay from its natural frequencies.

    Parameters
    ----------
    recordings : path, Recording, list of channels, or list of these, optional
        Of the cable's motion; the peaks of their spectra are the frequencies.
    length : float or (value, std)
        Between the ends, along the chord, m.

        Here and below also an Estimate or a ufloat.
    mass_per_length : float or (value, std)
        Of the cable, kg/m.
    frequencies : array or list of float, optional
        Measured frequencies, Hz.
    frequency_std : float, optional
        Standard uncertainty of `frequencies`, Hz.
    measured : path, ModalResult or list of dict, optional
        Table of measured frequencies, or modes as UFF 55.

        A dict holds frequency_hz and where known std, plane.
    column : str, optional
        Column of the frequencies in the table.
    channel : str or list of str, optional
        Channels to use (default: all).
    band : (float, float), optional
        Where peaks are looked for, Hz.
    max_peaks : int, optional
        Peaks a channel at most (1 to 200; default 12).
    sample_rate : float, optional
        Where a file gives none, Hz.
    plane : {"any", "in", "out"}
        The motion that was measured (default any).
    mass_of : {"installed", "unstretched"}, optional
        State of the cable that the mass per length is of.
    EI : float or (value, std), optional
        Flexural rigidity, N m2 (default: fitted).
    EA : float or (value, std), optional
        Axial rigidity, N.
    inclination : float, optional
        Of the chord, degrees: 0 horizontal, 90 a hanger (-90 to 90; default 0).
    ends : {"compare", "pinned", "clamped", "springs"}
        Kinds of ends (default compare).
    missed : float, optional
        Probability that a mode in the band was missed (0.001 to 0.9; default 0.1).
    false_mode : float, optional
        Probability that a measured mode is none of the cable's (0.001 to 0.9; default 0.05).
    threads : int, optional
        Threads to use (all processors); the numbers do not depend on it (1 to 1024).
    seed : int, optional
        Seed of every random number (default 1).

    Returns
    -------
    TensionResult
        ``tension_N`` (Estimate with low, high), ``EI_Nm2``, ``candidates[]``, ``modes[]``, ``formulas``, ``budget[]``.

    Raises
    ------
    Refused
        No tension explains the frequencies.
    """
    options = checks.common(threads, seed)
    _probabilities(options, missed, false_mode)
    given = sources("recordings", recordings) if recordings is not None else []
    options["length"] = estimate_text("length", length)
    options["mass_per_length"] = estimate_text("mass_per_length", mass_per_length)
    if EI is not None:
        options["EI"] = estimate_text("EI", EI, positive=False)
    if EA is not None:
        options["EA"] = estimate_text("EA", EA)
    if frequencies is not None:
        options["frequencies"] = checks.numbers("frequencies", frequencies, positive=True)
    positives(options, frequency_std=frequency_std, sample_rate=sample_rate)
    if inclination is not None:
        options["inclination"] = checks.number("inclination", inclination, -90, 90)
    if channel is not None:
        options["channel"] = checks.texts("channel", channel)
    if band is not None:
        options["band"] = checks.band("band", band)
    if max_peaks is not None:
        options["max_peaks"] = checks.integer("max_peaks", max_peaks, 1, 200)
    if column is not None:
        options["column"] = checks.text("column", column)
    options["plane"] = checks.choice("plane", plane, ("any", "in", "out"))
    if mass_of is not None:
        options["mass_of"] = checks.choice("mass_of", mass_of, ("installed", "unstretched"))
    options["ends"] = checks.choice("ends", ends, ("compare", "pinned", "clamped", "springs"))
    if not given and frequencies is None and measured is None:
        checks.fail("frequencies", "give recordings, frequencies or measured")
    with tempfile.TemporaryDirectory(prefix="rigfit-") as folder:
        if measured is not None:
            options["measured"] = (checks.path("measured", measured) if is_path(measured) else
                                   write_modes("measured", measured, folder))
        document, exit_code = call(_core.tension, given, options)
    return finish(TensionResult, at_hand(document, folder), exit_code)


def is_path(value):
    """Whether a value names a file."""
    return isinstance(value, str) or hasattr(value, "__fspath__")


def at_hand(document, folder):
    """The document without inputs that were objects, not files."""
    document["inputs"] = [one for one in document["inputs"] if not one["path"].startswith(str(folder))]
    return document
