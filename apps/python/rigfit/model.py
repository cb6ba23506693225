"""Scenes and what is done with them: `Scene`, `modes`, `frf_of`, `respond`, `update`, `predict`, `synthesize`; and
`report`."""

from collections.abc import Mapping
import html
import math
import pathlib
import tempfile

import numpy as np

from . import _core, checks
from .laboratory import at_hand, estimate_text, is_path, not_negative, positives, write_modes
from .results import (AxialResult, BendingResult, ModesResult, PredictResult, ReportResult, RespondResult, SceneFrfs,
                      SynthesizeResult, UpdateResult)
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
        pathlib.Path(checks.path("file", file)).write_text(self.to_toml())

    def __repr__(self):
        return f"Scene({self.title!r}, members {self.members}, loads {self.loads}, sensors {self.sensors})"

    def _repr_html_(self):
        return f"<p><b>{html.escape(self.title)}</b></p><pre>{html.escape(self.to_toml())}</pre>"


def _scene(scene):
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
        The first so many modes (6).
    band : (float, float), optional
        All modes between two frequencies, Hz, instead of a count.
    segments : int, optional
        Of every member, instead of the scene's.
    rotary_inertia : {"accurate", "rigid_rod"}
    torsion : {"auto", "on", "off"}
    shapes : bool
        Mode shapes at every node in ``modes[].shape``.

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
    return finish(ModesResult, *call(_core.modes, _scene(scene), options))


def frf_of(scene, frequency_hz, *, segments=None, exponential_window=None):
    """FRFs of a scene from its loads to its sensors, no mode left out.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict
    frequency_hz : array, shape (lines,)
        Not negative, Hz.
    segments : int, optional
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
    document, exit_code, H = call(_core.frf_of, _scene(scene), lines, options)
    return finish(SceneFrfs, document, exit_code, frequency_hz=lines, H=H)


_SOLVERS = ("auto", "modal", "large-motion", "explicit", "implicit", "cvode-adams", "cvode-banded")


def respond(scene, *, duration, rate, out=None, energy=None, solver="auto", plane="auto", torsion="auto", axial="auto",
            segments=None, step=None, tolerance=None):
    """Time response of a scene at its sensors: linear or geometrically exact by need.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict
    duration, rate : float
        s, samples a second.
    out, energy : path, optional
        CSV files to write.
    solver : {"auto", "modal", "large-motion", "explicit", "implicit", "cvode-adams", "cvode-banded"}
    plane, torsion, axial : {"auto", "on", "off"}
    segments : int, optional
    step : float, optional
        Largest step of the explicit and implicit solvers, s.
    tolerance : float, optional
        Relative, of the CVODE solvers.

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
        options["out"] = checks.path("out", out)
    if energy is not None:
        options["energy"] = checks.path("energy", energy)
    if segments is not None:
        options["segments"] = checks.integer("segments", segments, 2, 10000)
    positives(options, step=step)
    if tolerance is not None:
        options["tolerance"] = checks.number("tolerance", tolerance, 1e-13, 1e-1)
    document, exit_code, samples = call(_core.respond, _scene(scene), options)
    samples.setflags(write=False)
    return finish(RespondResult, document, exit_code, response=samples,
                  time_s=np.arange(len(samples)) / options["rate"])


def _files(argument, value, folder, write):
    """Paths of what may be one or several, files or objects."""
    several = list(value) if isinstance(value, (list, tuple)) and value and \
        all(is_path(one) or not isinstance(one, (Mapping, int, float, np.number)) for one in value) else [value]
    named = [argument] if len(several) == 1 else [f"{argument}[{i}]" for i in range(len(several))]
    return [checks.path(name, one) if is_path(one) else write(name, one, folder) for name, one in zip(named, several)]


def _no_object(argument, value, folder):
    checks.fail(argument, f"must be a path, not {checks.kind(value)}")


def _write_document(argument, result, folder):
    import json
    file = pathlib.Path(folder) / f"{argument.partition('[')[0]}.json"
    file.write_text(json.dumps(result.to_dict()))
    return str(file)


def update(scene, *, measured=None, frf=None, decay=None, response=None, free=None, prior=None, tension=None, plane=None,
           column=None, compare=None, node=None, channel=None, band=None, stiffness=None, stiffness_std=None,
           axial=None, axial_damping=False, input=None, aim=None, profile=False, assumed_std=None, model_std=None,
           frf_model_std=None, shape_std=None, segments=None, starts=None, start_spread=None, hold_out=False,
           monte_carlo=None, threads=None, seed=None):
    """A scene's uncertain parameters fitted to what was measured.

    Objects go through files in a temporary folder, in the formats that the program reads, so that the same rules
    apply to them.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict, or a list: one for each of the data below
    measured : path, ModalResult, array of frequencies, or list of dict, or a list of these, optional
        Measured modes; dicts hold ``frequency_hz`` and where known ``std``, ``damping_ratio``, ``damping_std``,
        ``plane``, ``tension_N``, ``shape:<sensor>``.
    frf, decay, response : path or list of paths, optional
        FRFs (UFF 58), recordings of free decays, recordings of the response to the scene's loads.
    free : str or list of str, optional
        Parameters to fit: NAME, NAME=TARGET,-TARGET, NAME@each. Left out: every member's EI.
    prior : dict of NAME to (value, std), optional
        Of free parameters, from other tests.
    tension : float or list of float, optional
        Of each of frf, decay and response, N.
    plane : str or list of str, optional
        Of each of the data: "in", "out", "any".
    column, compare : str, list of str, optional
        Columns of tables: of the frequencies; of other models, shown beside.
    node : str or list of str, optional
        SENSOR=NODE of universal files of mode shapes.
    channel : str, optional
        Of the decays.
    band : (float, float), optional
        Hz, of FRFs, decays and UFF 55.
    stiffness : path or BendingResult, optional
        The cables' EI in each state; ``stiffness_std`` is the relative uncertainty that its tests share.
    axial : path or AxialResult, optional
        EA of all cables; with ``axial_damping`` their damping ratio too.
    input, aim : str or list of str, optional
        Uncertainty of what is not fitted: ``TARGET=STD``; ``LOAD=METRES,DEGREES``.
    profile, hold_out : bool
        95 % intervals by profile; each state left out and predicted.
    assumed_std, model_std, frf_model_std, shape_std : float, optional
        As the options of ``rigfit update``.
    segments, starts, start_spread, monte_carlo : optional
    threads, seed : int, optional

    Returns
    -------
    UpdateResult
        ``parameters[]``, ``pairs[]``, ``alternatives[]``, ``fit``; ``covariance``; ``fitted_scenes``.

    Raises
    ------
    Refused
        No alternative has 90 % of the weight; ``result`` is the heaviest.
    """
    options = checks.common(threads, seed)
    if measured is None and frf is None and decay is None and response is None:
        checks.fail("measured", "nothing to fit to: give measured, frf, decay or response")
    if free is not None:
        options["free"] = checks.texts("free", free)
    if prior is not None:
        if not isinstance(prior, Mapping):
            checks.fail("prior", f"must be a dict of parameter to (value, std), not {checks.kind(prior)}")
        options["prior"] = [f"{checks.text('prior', name)}={estimate_text(f'prior[{name!r}]', value, positive=False)}"
                            for name, value in prior.items()]
    if tension is not None:
        options["tension"] = checks.numbers("tension", tension, positive=True)
    if plane is not None:
        options["plane"] = [checks.choice("plane", one, ("in", "out", "any")) for one in checks.sequence("plane", plane)]
    for name, value in (("column", column), ("channel", channel)):
        if value is not None:
            options[name] = checks.text(name, value)
    for name, value in (("compare", compare), ("node", node), ("input", input), ("aim", aim)):
        if value is not None:
            options[name] = checks.texts(name, value)
    if band is not None:
        options["band"] = checks.band("band", band)
    not_negative(options, 1, stiffness_std=stiffness_std, model_std=model_std, shape_std=shape_std)
    not_negative(options, 10, frf_model_std=frf_model_std)
    if assumed_std is not None:
        options["assumed_std"] = checks.number("assumed_std", assumed_std, 1e-9, 1)
    if start_spread is not None:
        options["start_spread"] = checks.number("start_spread", start_spread, 1, 100)
    for name, value, low, high in (("segments", segments, 2, 10000), ("starts", starts, 1, 1000),
                                   ("monte_carlo", monte_carlo, 0, 1000000)):
        if value is not None:
            options[name] = checks.integer(name, value, low, high)
    for name, value in (("profile", profile), ("hold_out", hold_out), ("axial_damping", axial_damping)):
        options[name] = checks.flag(name, value)
    with tempfile.TemporaryDirectory(prefix="rigfit-") as folder:
        options["scenes"] = [_scene_file(one, i, folder) for i, one in
                             enumerate(scene if isinstance(scene, (list, tuple)) and scene else [scene])]
        if measured is not None:
            options["measured"] = _files("measured", measured, folder, write_modes)
        for name, value in (("frf", frf), ("decay", decay), ("response", response)):
            if value is not None:
                options[name] = _files(name, value, folder, _no_object)
        for name, value, kind in (("stiffness", stiffness, BendingResult), ("axial", axial, AxialResult)):
            if isinstance(value, kind):
                options[name] = _write_document(name, value, folder)
            elif value is not None:
                options[name] = checks.path(name, value)
        document, exit_code, covariance, scenes = call(_core.update, options)
    covariance.setflags(write=False)
    return finish(UpdateResult, at_hand(document, folder), exit_code,
                  covariance=covariance if covariance.size and np.isfinite(covariance).all() else None,
                  fitted_scenes=[Scene._of(one) for one in scenes])


def _scene_file(scene, index, folder):
    if is_path(scene) and "\n" not in str(scene):
        return checks.path("scene", scene)
    if not isinstance(scene, Scene):
        scene = Scene(scene)
    file = pathlib.Path(folder) / f"scene{index + 1}.toml"
    file.write_text(scene.to_toml())
    return str(file)


def predict(scene, fit, *, map=None, count=None, segments=None, measured=None, column=None, plane="any", damage=None,
            frf=None, band=None, lines=None, sample=False, threads=None, seed=None):
    """Modes of another scene with the parameters of a fit, with intervals from their covariance.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict
        Where the parameters are used, such as one part of the rig that was fitted.
    fit : UpdateResult or path
        Result of `update`, or the JSON document of ``rigfit update``.
    map : dict of str to str, optional
        What a parameter of the fit is called here: ``{"cable.EI": "left.EI,right.EI"}``.
    count, segments : int, optional
        Modes from the first; segments of every member, instead of the scene's.
    measured : path, ModalResult, array of frequencies or list of dict, optional
        Measured modes to compare with; ``column`` is that of the frequencies in a table.
    column : str, optional
    plane : {"any", "in", "out"}
        Of the measured modes.
    damage : str or list of str, optional
        Loss of EI of a zone against its sound part: ``ZONE=SOUND[,RATIO]``.
    frf : path, optional
        CSV file of the FRFs with their intervals to write; ``band`` (Hz) and ``lines`` are of these.
    band : (float, float), optional
    lines : int, optional
    sample : bool
        Intervals from samples, also where the model is linear.
    threads, seed : int, optional

    Returns
    -------
    PredictResult
        ``modes[]`` with ``frequency_hz`` (Estimate with low, high), ``damping_ratio``; ``measured[]``, ``damage[]``.
    """
    options = checks.common(threads, seed)
    if map is not None:
        if not isinstance(map, Mapping):
            checks.fail("map", f"must be a dict of name to name, not {checks.kind(map)}")
        options["map"] = [f"{checks.text('map', name)}={checks.text(f'map[{name!r}]', target)}"
                          for name, target in map.items()]
    for name, value, low, high in (("count", count, 1, 1000), ("segments", segments, 2, 100000),
                                   ("lines", lines, 2, 100000)):
        if value is not None:
            options[name] = checks.integer(name, value, low, high)
    if column is not None:
        options["column"] = checks.text("column", column)
    options["plane"] = checks.choice("plane", plane, ("any", "in", "out"))
    if damage is not None:
        options["damage"] = checks.texts("damage", damage)
    if frf is not None:
        options["frf"] = checks.path("frf", frf)
    if band is not None:
        options["band"] = checks.band("band", band)
    options["sample"] = checks.flag("sample", sample)
    with tempfile.TemporaryDirectory(prefix="rigfit-") as folder:
        options["fit"] = (_write_document("fit", fit, folder) if isinstance(fit, UpdateResult) else
                          checks.path("fit", fit))
        if measured is not None:
            options["measured"] = (checks.path("measured", measured) if is_path(measured) else
                                   write_modes("measured", measured, folder))
        document, exit_code = call(_core.predict, _scene(scene), options)
    return finish(PredictResult, at_hand(document, folder), exit_code)


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
        Folder to write to; ``truth.json`` says what is true.
    seed, threads : int, optional
    hits, double_hits : int, optional
        Of every impact, and how many of them are double.
    record, rate : float, optional
        Length of a record in s, sample rate in Hz.
    finer : int, optional
        Segments of the tested rig over the scene's.
    tension, tension_std, stiffness : optional
        Tensions that the cables are set to, N; relative error of that; table of EI over tension.
    format : {"csv", "uff"}
    accelerometer_mass : float, optional
        kg.
    bending_span, bending_load : float, optional
        Also the bending test of the first cable: m, N.
    axial_length, axial_length_std, axial_mass, axial_damping, taps : optional
        Also its hanging-mass test: m, m, kg, ratio, number at every length.

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
    return finish(SynthesizeResult, *call(_core.synthesize, _scene(scene), options))


def report(campaign, out, *, force=False, threads=None, seed=None):
    """Everything a campaign names, from recordings to model against test.

    Parameters
    ----------
    campaign : path
        TOML file.
    out : path
        Folder for report.html, report.json, data/ and figures/.
    force : bool
        Another campaign's report in the folder is replaced.
    threads, seed : int, optional

    Returns
    -------
    ReportResult
    """
    options = checks.common(threads, seed)
    options["force"] = checks.flag("force", force)
    return finish(ReportResult, *call(_core.report, checks.path("campaign", campaign), checks.path("out", out),
                                      options))
