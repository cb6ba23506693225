"""Scenes and what is done with them: `Scene`, `modes`, `frf_of`, `respond`, `synthesize`; and `report`."""

from collections.abc import Mapping
import html
import math
import pathlib

import numpy as np

from . import _core, checks
from .laboratory import is_path, not_negative, positives
from .results import ModesResult, ReportResult, RespondResult, SceneFrfs, SynthesizeResult
from .spectra import call, finish


def _toml(argument, value):
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, str):
        escapes = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}
        for c in value:
            if ord(c) < 32 and c not in escapes or ord(c) == 127:
                checks.fail(argument, "holds a control character")
        return '"' + "".join(escapes.get(c, c) for c in value) + '"'
    if isinstance(value, (int, np.integer)):
        if not -2**63 <= value < 2**63:
            checks.fail(argument, "is too large for a whole number")
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        if math.isnan(value):
            checks.fail(argument, "is not a number")
        return repr(float(value))
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(f"{argument}[{i}]", one) for i, one in enumerate(value)) + "]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_toml(argument, _key(argument, key))} = {_toml(f'{argument}.{key}', one)}"
                               for key, one in value.items()) + "}"
    checks.fail(argument, f"cannot be written in a scene: {checks.kind(value)}")


def _key(argument, key):
    if not isinstance(key, str):
        checks.fail(argument, f"has a key that is no string: {checks.kind(key)}")
    return key


def _document(scene):
    """A dict of the keys of a scene file as TOML."""
    lines, tables = [], []
    for key, value in scene.items():
        _key("scene", key)
        if isinstance(value, (list, tuple)) and value and all(isinstance(one, Mapping) for one in value):
            for i, one in enumerate(value):
                tables.append(f"[[{_toml(key, key)}]]")
                tables += [f"{_toml(key, _key(key, name))} = {_toml(f'{key}[{i}].{name}', entry)}"
                           for name, entry in one.items()]
        else:
            lines.append(f"{_toml(key, key)} = {_toml(key, value)}")
    return "\n".join(lines + tables) + "\n"


class Scene:
    """A rig as a person describes it: nodes, members, loads, sensors. It does not change.

    Parameters
    ----------
    scene : str, path or dict
        TOML text (with a line end), a scene file, or a dict of the same keys
        (``{"node": [{"name": "left", ...}, ...], "member": [...]}``).

    Raises
    ------
    InputError
        With file, line, key and remedy.
    """

    def __init__(self, scene):
        if isinstance(scene, Mapping):
            self._core = call(_core.parse_scene, _document(scene), "scene")
        elif isinstance(scene, str) and "\n" in scene:
            self._core = call(_core.parse_scene, checks.text("scene", scene), "scene")
        elif is_path(scene):
            self._core = call(_core.read_scene, checks.path("scene", scene))
        else:
            checks.fail("scene", f"must be TOML text, a path or a dict, not {checks.kind(scene)}")

    @classmethod
    def _of(cls, core):
        scene = cls.__new__(cls)
        scene._core = core
        return scene

    @property
    def title(self):
        """As in the file."""
        return self._core.title

    @property
    def nodes(self):
        """Names."""
        return self._core.nodes()

    @property
    def members(self):
        """Names."""
        return self._core.members()

    @property
    def loads(self):
        """Names."""
        return self._core.loads()

    @property
    def sensors(self):
        """Names."""
        return self._core.sensors()

    @property
    def parameters(self):
        """Every number that can be fitted or set, such as ``"cable.EI"``: name to value."""
        return self._core.parameters()

    def with_parameters(self, values):
        """The scene with other values of some parameters, ``{"cable.tension": 210.0}``."""
        if not isinstance(values, Mapping):
            checks.fail("values", f"must be a dict of parameter to value, not {checks.kind(values)}")
        core = self._core
        for name, value in values.items():
            core = call(core.with_parameter, checks.text("values", name), checks.number(f"values[{name!r}]", value))
        return Scene._of(core)

    def to_toml(self):
        """A scene file that reads back to the same scene."""
        return self._core.text()

    def to_dict(self):
        """The keys of the scene file."""
        import tomllib
        return tomllib.loads(self.to_toml())

    def write(self, file):
        """Writes the scene file."""
        pathlib.Path(checks.new_file("file", file)).write_text(self.to_toml())

    def __repr__(self):
        return f"Scene({self.title!r}, members {self.members}, loads {self.loads}, sensors {self.sensors})"

    def _repr_html_(self):
        return f"<p><b>{html.escape(self.title)}</b></p><pre>{html.escape(self.to_toml())}</pre>"


def scene_or_path(scene):
    """As the module takes it: a path, read in the call, or a scene at hand."""
    if isinstance(scene, Scene):
        return scene._core
    if is_path(scene) and "\n" not in str(scene):
        return checks.path("scene", scene)
    return Scene(scene)._core


def modes(scene, *, count=None, band=None, segments=None, rotary_inertia="accurate", torsion="auto", shapes=False):
    """Static equilibrium of a scene, then its natural modes.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict
    count : int, optional
        The first N modes (1 to 10000; default 6).
    band : (float, float), optional
        All modes between two frequencies, Hz.

        Instead of a count.
    segments : int, optional
        Segments of every member, instead of the scene's (2 to 100000).
    rotary_inertia : {"accurate", "rigid_rod"}
        Of a segment, and its joints: accurate, or a rigid rod's as in the paper (default accurate).
    torsion : {"auto", "on", "off"}
        Model torsion: where needed, always or never (default auto).
    shapes : bool
        Mode shapes at every node in the JSON result.

        They are ``modes[].shape``.

    Returns
    -------
    ModesResult
        ``modes[]``, ``equilibrium``, ``relative_error_estimate``, ``modelled``.
    """
    options = {"shapes": checks.flag("shapes", shapes)}
    if count is not None and band is not None:
        checks.fail("count", "cannot be given with band")
    if count is not None:
        options["count"] = checks.integer("count", count, 1, 10000)
    if band is not None:
        options["band"] = checks.band("band", band)
    if segments is not None:
        options["segments"] = checks.integer("segments", segments, 2, 100000)
    options["rotary_inertia"] = checks.choice("rotary_inertia", rotary_inertia, ("accurate", "rigid_rod"))
    options["torsion"] = checks.choice("torsion", torsion, ("auto", "on", "off"))
    return finish(ModesResult, *call(_core.modes, scene_or_path(scene), options))


def frf_of(scene, frequency_hz, *, segments=None, exponential_window=None):
    """FRFs of a scene from its loads to its sensors, no mode left out.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict
    frequency_hz : array, shape (lines,)
        Not negative, Hz.
    segments : int, optional
        Of every member, instead of the scene's.
    exponential_window : float, optional
        Decay rate of a window that measured FRFs were averaged under, 1/s.

    Returns
    -------
    SceneFrfs
        ``frequency_hz`` and ``H``, complex, shape (lines, sensors, loads), in ``units``; ``sensors``, ``loads``.
    """
    options = {}
    lines = checks.array("frequency_hz", frequency_hz, 1)
    if lines.min() < 0:
        checks.fail("frequency_hz", f"must not be negative, not {lines.min():g}")
    if segments is not None:
        options["segments"] = checks.integer("segments", segments, 2, 100000)
    if exponential_window is not None:
        options["exponential_window"] = checks.number("exponential_window", exponential_window, 0, 1e6)
    document, exit_code, H = call(_core.frf_of, scene_or_path(scene), lines, options)
    return finish(SceneFrfs, document, exit_code, frequency_hz=lines, H=H)


_SOLVERS = ("auto", "modal", "large-motion", "explicit", "implicit", "cvode-adams", "cvode-banded")


def respond(scene, *, duration, rate, out=None, energy=None, solver="auto", plane="auto", torsion="auto", axial="auto",
            segments=None, step=None, tolerance=None):
    """Time response of a scene at its sensors: linear or geometrically exact by need.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict
    duration : float
        Seconds to simulate.
    rate : float
        Samples a second.
    out : path, optional
        CSV: time_s, then one column a sensor.
    energy : path, optional
        CSV of the energy by member and kind over time.
    solver : {"auto", "modal", "large-motion", "explicit", "implicit", "cvode-adams", "cvode-banded"}
        auto: modal when the estimated frequency shift is within the scene's accuracy (default auto).
    plane : {"auto", "on", "off"}
        Move in the plane of symmetry only (default auto).
    torsion : {"auto", "on", "off"}
        Model torsion (default auto).
    axial : {"auto", "on", "off"}
        Axial waves at their own speed; off: quasi-static (modal) or slowed (other solvers) (default auto).
    segments : int, optional
        Segments of every member, instead of the scene's (2 to 10000).
    step : float, optional
        Largest step of the explicit and implicit solvers, s.
    tolerance : float, optional
        Relative tolerance of the CVODE solvers (1e-13 to 0.1; default 1e-06).

    Returns
    -------
    RespondResult
        ``time_s``, ``response`` (samples x sensors), ``sensors[]``, ``solver``, ``energy_drift`` ...
    """
    options = {"duration": checks.number("duration", duration, positive=True),
               "rate": checks.number("rate", rate, positive=True)}
    options["solver"] = checks.choice("solver", solver, _SOLVERS)
    for name, value in (("plane", plane), ("torsion", torsion), ("axial", axial)):
        options[name] = checks.choice(name, value, ("auto", "on", "off"))
    if out is not None:
        options["out"] = checks.new_file("out", out)
    if energy is not None:
        options["energy"] = checks.new_file("energy", energy)
    if segments is not None:
        options["segments"] = checks.integer("segments", segments, 2, 10000)
    positives(options, step=step)
    if tolerance is not None:
        options["tolerance"] = checks.number("tolerance", tolerance, 1e-13, 1e-1)
    document, exit_code, samples = call(_core.respond, scene_or_path(scene), options)
    samples.setflags(write=False)
    return finish(RespondResult, document, exit_code, response=samples,
                  time_s=np.arange(len(samples)) / options["rate"])


def synthesize(scene, out, *, seed=None, hits=None, double_hits=None, record=None, rate=None, finer=None, tension=None,
               tension_std=None, stiffness=None, format="csv", accelerometer_mass=None, bending_span=None,
               bending_load=None, axial_length=None, axial_length_std=None, axial_mass=None, axial_damping=None,
               taps=None, threads=None):
    """A virtual laboratory: recordings that a rig like this would give, with their truth.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict
        Its loads are the tests.
    out : path
        Folder to write to.

        Its ``truth.json`` says what is true.
    seed : int, optional
        Seed of every random number (default 1).
    hits : int, optional
        Hits of every impact (1 to 1000; default 5).
    double_hits : int, optional
        Of these, how many are double (0 to 1000; default 1).
    record : float, optional
        Length of a record, s (default 8).
    rate : float, optional
        Sample rate, Hz (default 1024).
    finer : int, optional
        Segments of the tested rig over the scene's (1 to 100; default 4).
    tension : float or list of float, optional
        Tensions that the cables are set to, N, one row of tests each (default: the scene's).
    tension_std : float, optional
        Relative error with which a person sets them (0 to 0.5; default 0).
    stiffness : path, optional
        Table of tension_N, EI_Nm2: the cables' EI at each of them.
    format : {"csv", "uff"}
        Of hammer and release recordings: csv, or uff (58, binary, single precision) (default csv).
    accelerometer_mass : float, optional
        Mass of an accelerometer, kg, where the scene has none at its place (default 0.0048).
    bending_span : float, optional
        Also the bending test of the scene's first cable, span in m.
    bending_load : float, optional
        Its largest load, N (default 10).
    axial_length : float or list of float, optional
        Also the hanging-mass test of that cable, lengths in m.
    axial_length_std : float, optional
        Error with which they were cut, m (0 to 0.1; default 0).
    axial_mass : float, optional
        Mass hung there, kg (default 2.2).
    axial_damping : float, optional
        Damping ratio of its oscillation (0 to 0.99; default 0.017).
    taps : int, optional
        Taps at every length (1 to 1000; default 5).
    threads : int, optional
        Threads to use (all processors); the numbers do not depend on it (1 to 1024).

    Returns
    -------
    SynthesizeResult
        ``files``.
    """
    options = checks.common(threads, seed)
    options["out"] = checks.path("out", out)
    options["command_line"] = ["rigfit", "synthesize", "(from Python)"]
    for name, value, low, high in (("hits", hits, 1, 1000), ("double_hits", double_hits, 0, 1000),
                                   ("finer", finer, 1, 100), ("taps", taps, 1, 1000)):
        if value is not None:
            options[name] = checks.integer(name, value, low, high)
    positives(options, record=record, rate=rate, bending_span=bending_span, bending_load=bending_load,
              axial_mass=axial_mass)
    not_negative(options, accelerometer_mass=accelerometer_mass)
    not_negative(options, 0.5, tension_std=tension_std)
    not_negative(options, 0.1, axial_length_std=axial_length_std)
    not_negative(options, 0.99, axial_damping=axial_damping)
    for name, value in (("tension", tension), ("axial_length", axial_length)):
        if value is not None:
            options[name] = checks.numbers(name, value, positive=True)
    if stiffness is not None:
        options["stiffness"] = checks.path("stiffness", stiffness)
    options["format"] = checks.choice("format", format, ("csv", "uff"))
    return finish(SynthesizeResult, *call(_core.synthesize, scene_or_path(scene), options))


def report(campaign, out, *, style="lab", pdf=False, force=False, figure_size=None, figure_font=None,
           figure_font_size=None, threads=None, seed=None):
    """Everything a campaign names, from recordings to model against test.

    Parameters
    ----------
    campaign : path, or (path, path)
        TOML file; two: before and after, compared value by value.
    out : path
        Folder for report.html, report.json, data/ and figures/.
    style : {"lab", "client"}
        lab: one page of everything; client: a short report, the appendix beside it (default lab).
    pdf : bool
        Print to PDF as well, by a Chromium on PATH.
    force : bool
        Replace another campaign's report in the folder.
    figure_size : (float, float), optional
        Width and height of the figures for a paper, mm; with `pdf` also figures.pdf (20 to 1000).
    figure_font : str, optional
        Font of these figures (default sans-serif).
    figure_font_size : float, optional
        Its size, pt (4 to 24; default 8).
    threads : int, optional
        Threads to use (all processors); the numbers do not depend on it (1 to 1024).
    seed : int, optional
        Seed of every random number (default 1).

    Returns
    -------
    ReportResult
    """
    options = checks.common(threads, seed)
    options["style"] = checks.choice("style", style, ("lab", "client"))
    options["pdf"] = checks.flag("pdf", pdf)
    options["force"] = checks.flag("force", force)
    if figure_size is not None:
        options["figure_size"] = checks.numbers("figure_size", figure_size, low=20, high=1000)
        if len(options["figure_size"]) != 2:
            checks.fail("figure_size", "must be width and height in mm")
    if figure_font is not None:
        options["figure_font"] = checks.text("figure_font", figure_font)
    if figure_font_size is not None:
        options["figure_font_size"] = checks.number("figure_font_size", figure_font_size, 4, 24)
    campaigns = checks.paths("campaign", campaign)
    if len(campaigns) > 2:
        checks.fail("campaign", f"must be one or two, before and after, not {len(campaigns)}")
    return finish(ReportResult, *call(_core.report, campaigns, checks.path("out", out), options))
