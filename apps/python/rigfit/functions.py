"""The verbs of the program as functions. Their options are described in C++ (`described.verb`); here stands what takes objects of
Python in place of files."""

from collections.abc import Mapping
import functools
import json
import pathlib
import re
import tempfile

import numpy as np

from . import _core, checks
from .described import call, is_path, parted, verb
from .model import Scene, scene_or_path
from .recordings import Recording, sources, warn
from .results import (AxialResult, BendingResult, DecayResult, Estimate, FrfResult, InspectResult, ModalResult, ModesResult,
                      PredictResult, ReportResult, ResampleResult, RespondResult, SynthesizeResult, TensionResult,
                      UpdateResult)


def _run(name, options, inputs=None):
    """Document, exit code, text, and what else the result has. ``inputs``: what stands first in the call."""
    return call(_core.run, name, options, inputs)


def _one(argument, given):
    found = sources(argument, given)
    if len(found) != 1:
        checks.fail(argument, f"must be one recording, not {len(found)}")
    return found[0]


def _with_folder(function):
    """Gives objects a temporary folder to be written to; the document then does not list them as inputs."""
    @functools.wraps(function)
    def called(**arguments):
        with tempfile.TemporaryDirectory(prefix="rigfit-") as folder:
            answer = function(**arguments, folder=folder)
        inputs = answer[0].get("inputs", [])
        answer[0]["inputs"] = [one for one in inputs if not one["path"].startswith(folder)]
        return answer
    return called


@verb("read", Recording, raw={"file": "_Path"})
def read(file, sample_rate=None, *, options):
    """Reads a recording: every format that ``rigfit inspect`` reads. A TOML file of its name beside it describes its channels, which
    are views of what was read; nothing is copied."""
    core, found = call(_core.read, checks.path("file", file), options)
    warn(found)
    return Recording._of(core)


@verb("inspect", InspectResult)
def inspect(recordings, options):
    """What recordings hold and whether they are fit for use."""
    return _run("inspect", options, sources("recordings", recordings))


@verb("resample", ResampleResult)
def resample(recording, rate=None, *, out=None, options):
    """A recording at another rate (with a filter), or uneven times made even."""
    *answer, more = _run("resample", options, _one("recording", recording))
    return *answer, {"recording": Recording._of(more["recording"])}


@verb("decay", DecayResult)
def decay(recording, channel=None, *, options):
    """Frequency and damping of a free decay."""
    return _run("decay", options, _one("recording", recording))


@verb("frf", FrfResult)
def frf(recordings, force, response=None, *, options):
    """Hammer hits found and judged, averaged FRFs with coherence and error bars."""
    return _run("frf", options, sources("recordings", recordings))


@verb("modal", ModalResult)
def modal(frfs, *, options):
    """Natural frequencies, damping and shapes with error bars from FRFs (an FrfResult, a FrfSet, files), with ``force`` from hits,
    with ``ambient`` from motion under unknown forces."""
    at_hand = frfs._arrays() if isinstance(frfs, FrfResult) else frfs if isinstance(frfs, _core.FrfSet) else None
    given = [] if at_hand is not None else sources("frfs", frfs)
    if at_hand is not None and "force" in options:
        checks.fail("force", "is for recordings of hits; these are FRFs already")
    ambient = options.get("ambient", False)
    if ambient and at_hand is not None:
        checks.fail("ambient", "is for recordings; these are FRFs already")
    if not ambient and "force" not in options and not all(isinstance(one, str) for one in given):
        checks.fail("force", "is needed for recordings of hits")
    return _run("modal", options, given if at_hand is None else at_hand)


_UNITS = {"tension": "N", "tension_N": "N", "load": "N", "load_N": "N", "deflection": "m", "deflection_m": "m",
          "EI_Nm2": "N m2", "EI": "N m2", "std": "N m2", "low": "N m2", "high": "N m2"}


@verb("bending", BendingResult, raw={"tension": "str | Literal[0]"})
def bending(recordings, options):
    """EI at each tension from load-deflection records or tables, and laws for EI over tension. A dict of arrays in SI is a table:
    ``tension``, ``load``, ``deflection``, or ``tension_N``, ``EI_Nm2`` (with ``std``, or ``low`` and ``high``)."""
    if isinstance(recordings, (Mapping, Recording)):
        recordings = [recordings]
    if isinstance(recordings, (list, tuple)):
        recordings = [Recording(one, units=_UNITS, name=f"recordings[{i}]")
                      if isinstance(one, Mapping) and "data" not in one else one for i, one in enumerate(recordings)]
    if "tension" in options:
        tension = options["tension"]
        zero = isinstance(tension, (int, np.integer)) and not isinstance(tension, bool) and tension == 0
        options["tension"] = "0" if zero else checks.text("tension", tension)
    return _run("bending", options, sources("recordings", recordings))


@verb("axial", AxialResult)
def axial(recordings, options):
    """EA, damping ratio and damper of a cable from hanging-mass records."""
    return _run("axial", options, sources("recordings", recordings))


_MODES = "_Path | ModalResult | ArrayLike | Sequence[Any]"


def write_modes(argument, given, folder):
    """Measured modes as a table that the program reads: its path. ``given``: path, ModalResult, frequencies, or dicts."""
    if is_path(given):
        return checks.path(argument, given)
    if isinstance(given, ModalResult):
        rows = [{"frequency_hz": mode.frequency_hz.value, "std": mode.frequency_hz.std,
                 "damping_ratio": mode.damping_ratio.value, "damping_std": mode.damping_ratio.std} for mode in given.modes]
    elif isinstance(given, np.ndarray) or (isinstance(given, (list, tuple)) and
                                           not any(isinstance(one, Mapping) for one in given)):
        rows = [{"frequency_hz": f} for f in checks.numbers(argument, given, positive=True)]
    elif isinstance(given, (list, tuple)):
        rows = list(given)
    else:
        checks.fail(argument, f"must be a path, a ModalResult, frequencies or a list of dicts, not {checks.kind(given)}")
    known = ("frequency_hz", "std", "damping_ratio", "damping_std", "plane", "tension_N")
    columns = []
    for i, row in enumerate(rows):
        if not isinstance(row, Mapping):
            checks.fail(f"{argument}[{i}]", f"must be a dict, not {checks.kind(row)}")
        for key in row:
            if not isinstance(key, str) or not (key in known or re.fullmatch('(?s)shape:[^,"\n\r]*', key)):
                checks.fail(f"{argument}[{i}]", f"has an unknown entry {key!r}; known are {', '.join(known)}")
        if "frequency_hz" not in row:
            checks.fail(f"{argument}[{i}]", "has no frequency_hz")
        columns += [key for key in row if key not in columns]
    if not rows:
        checks.fail(argument, "holds no mode")

    def cell(entry, column, value):
        value = value.value if isinstance(value, Estimate) else value
        if value is None:
            return ""
        if column != "plane":
            return repr(checks.number(entry, value))
        if value not in ("in", "out", "any"):
            checks.fail(entry, f"must be one of in, out, any, not {checks.kind(value)}")
        return value
    lines = [",".join(columns)] + [",".join(cell(f"{argument}[{i}].{key}", key, row.get(key)) for key in columns)
                                   for i, row in enumerate(rows)]
    file = pathlib.Path(folder) / f"{argument.replace('[', '_').replace(']', '')}.csv"
    file.write_text("\n".join(lines) + "\n")
    return str(file)


@verb("tension", TensionResult, raw={"measured": _MODES})
@_with_folder
def tension(recordings=None, options=None, folder=None):
    """Tension of a cable, hanger or stay from its natural frequencies: of recordings of its motion, ``frequencies`` or ``measured``."""
    if "measured" in options:
        options["measured"] = write_modes("measured", options["measured"], folder)
    return _run("tension", options, None if recordings is None else sources("recordings", recordings))


@verb("modes", ModesResult)
def modes(scene, options):
    """Static equilibrium of a scene, then its natural modes."""
    return _run("modes", options, scene_or_path(scene))


@verb("respond", RespondResult)
def respond(scene, *, duration, rate, out=None, options):
    """Time response of a scene at its sensors: linear or geometrically exact by need."""
    *answer, more = _run("respond", options, scene_or_path(scene))
    samples = more["samples"]
    samples.setflags(write=False)
    return *answer, {"response": samples, "time_s": np.arange(len(samples)) / options["rate"]}


def _document(argument, value, kind, folder):
    """Path of a JSON document; that of a result at hand is written."""
    if not isinstance(value, kind):
        return checks.document(argument, value)
    file = pathlib.Path(folder) / f"{argument}.json"
    file.write_text(json.dumps(value.to_dict()))
    return str(file)


def _files(argument, value, take=checks.path):
    """Paths of what may be one or several, files or objects that ``take`` writes."""
    several = list(value) if isinstance(value, (list, tuple)) and value and \
        all(is_path(one) or not isinstance(one, (Mapping, int, float, np.number)) for one in value) else [value]
    named = [argument] if len(several) == 1 else [f"{argument}[{i}]" for i in range(len(several))]
    return [take(name, one) for name, one in zip(named, several)]


_PATHS = "_Path | Sequence[_Path]"


@verb("update", UpdateResult, without=("out",), raw={
    "measured": _MODES, "frf": _PATHS, "decay": _PATHS, "prior": "Mapping[str, _Value]",
    "stiffness": "_Path | BendingResult", "axial": "_Path | AxialResult", "candidates": "_Path"})
@_with_folder
def update(scene, options, folder=None):
    """A scene's uncertain parameters fitted to what was measured; several scenes: one for each of the data. Objects go through files
    in a temporary folder, in the formats that the program reads. Measured modes may be dicts: ``{"frequency_hz": 7.36, "std": 0.01,
    "plane": "in"}``; a prior is ``{"cable.EI": (0.6, 0.02)}``."""
    if "prior" in options:
        if not isinstance(options["prior"], Mapping):
            checks.fail("prior", f"must be a dict of parameter to (value, std), not {checks.kind(options['prior'])}")
        pairs = {checks.text("prior", name): parted(f"prior[{name!r}]", value) for name, value in options["prior"].items()}
        options["prior"] = [f"{name}=" + ",".join(repr(checks.number(f"prior[{name!r}]", one)) for one in pair)
                            for name, pair in pairs.items()]
    if "candidates" in options:
        options["candidates"] = checks.document("candidates", options["candidates"])
    several = scene if isinstance(scene, (list, tuple)) and scene else [scene]
    scenes = [scene_or_path(one) for one in several]
    if "measured" in options:
        options["measured"] = _files("measured", options["measured"], lambda name, one: write_modes(name, one, folder))
    for name in {"frf", "decay"} & set(options):
        options[name] = _files(name, options[name])
    for name, kind in (("stiffness", BendingResult), ("axial", AxialResult)):
        if name in options:
            options[name] = _document(name, options[name], kind, folder)
    *answer, more = _run("update", options, scenes)
    covariance = more["covariance"]
    covariance.setflags(write=False)
    known = covariance.size and np.isfinite(covariance).all()
    return *answer, {"covariance": covariance if known else None, "fitted_scenes": [Scene._of(one) for one in more["scenes"]]}


@verb("predict", PredictResult, raw={"fit": "UpdateResult | _Path", "map": "Mapping[str, str]", "measured": _MODES})
@_with_folder
def predict(scene, fit, options=None, folder=None):
    """Modes of another scene with the parameters of a fit, with intervals from their covariance. ``map`` is a dict of the fit's
    names to names here: ``{"cable.EI": "left.EI,right.EI"}``."""
    if "map" in options:
        if not isinstance(options["map"], Mapping):
            checks.fail("map", f"must be a dict of name to name, not {checks.kind(options['map'])}")
        options["map"] = [f"{checks.text('map', name)}={checks.text(f'map[{name!r}]', target)}"
                          for name, target in options["map"].items()]
    options["from"] = _document("fit", fit, UpdateResult, folder)
    if "measured" in options:
        options["measured"] = write_modes("measured", options["measured"], folder)
    return _run("predict", options, scene_or_path(scene))


@verb("synthesize", SynthesizeResult, raw={"out": "_Path"})
def synthesize(scene, out, *, options):
    """A virtual laboratory: recordings that a rig like this would give; its ``truth.json`` says what is true."""
    options["out"] = checks.path("out", options["out"])
    return _run("synthesize", options, scene_or_path(scene))


@verb("report", ReportResult, raw={"out": "_Path"})
def report(campaign, out, *, options):
    """Everything a campaign names, from recordings to model against test; two campaigns are compared value by value."""
    options["out"] = checks.path("out", options["out"])
    return _run("report", options, _files("campaign", campaign))
