"""Parameters of scenes from measurements, and what they give elsewhere: `update`, `predict`."""

from collections.abc import Mapping
import json
import pathlib
import tempfile

import numpy as np

from . import _core, checks
from .laboratory import at_hand, estimate_text, is_path, not_negative, write_modes
from .model import Scene, scene_or_path
from .results import AxialResult, BendingResult, PredictResult, UpdateResult
from .spectra import call, finish


def _files(argument, value, folder, write):
    """Paths of what may be one or several, files or objects."""
    several = list(value) if isinstance(value, (list, tuple)) and value and \
        all(is_path(one) or not isinstance(one, (Mapping, int, float, np.number)) for one in value) else [value]
    named = [argument] if len(several) == 1 else [f"{argument}[{i}]" for i in range(len(several))]
    return [checks.path(name, one) if is_path(one) else write(name, one, folder) for name, one in zip(named, several)]


def _no_object(argument, value, folder):
    checks.fail(argument, f"must be a path, not {checks.kind(value)}")


def _write_document(argument, result, folder):
    file = pathlib.Path(folder) / f"{argument.partition('[')[0]}.json"
    file.write_text(json.dumps(result.to_dict()))
    return str(file)


def update(scene, *, measured=None, frf=None, decay=None, response=None, free=None, prior=None, tension=None, plane=None,
           column=None, compare=None, node=None, channel=None, band=None, stiffness=None, stiffness_std=None,
           axial=None, axial_damping=False, input=None, aim=None, candidates=None, ends=None, profile=False,
           assumed_std=None, model_std=None, frf_model_std=None, shape_std=None, segments=None, starts=None,
           start_spread=None, hold_out=False, monte_carlo=None, threads=None, seed=None):
    """A scene's uncertain parameters fitted to what was measured.

    Objects go through files in a temporary folder, in the formats that the program reads, so that the same rules
    apply to them.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict, or a list of these
        Several: one for each of the data below.
    measured : path, ModalResult, array of frequencies, or list of dict, or a list of these, optional
        Tables of measured modes: frequency_hz, and where known std, damping_ratio, damping_std, plane, tension_N (a
        state each), shape:<sensor>; or universal files of mode shapes (UFF 55, with 15 or 2411 for where the nodes
        are).

        A dict holds the same keys: ``{"frequency_hz": 7.36, "std": 0.01, "plane": "in"}``.
    frf : path or list of paths, optional
        FRFs (UFF 58), fitted line by line; names of inputs and responses are those of the scene's loads and sensors.
        Their modes give its starting values. An exponential window in them is part of the model then, not of its
        damping.
    decay : path or list of paths, optional
        Recordings of free decays: their frequencies and damping ratios.
    response : path or list of paths, optional
        Recordings of the response to the scene's own loads from t = 0 on, fitted sample by sample; channels are
        called like the scene's sensors.
    free : str or list of str, optional
        Scene parameters to fit: NAME, NAME=TARGET,-TARGET (several that share a value), NAME@each (one value a
        state). Default: every member's EI.
    prior : dict of NAME to (value, std), optional
        NAME=VALUE,STD of a free parameter, from other tests.

        Here ``{"cable.EI": (0.6, 0.02)}``.
    tension : float or list of float, optional
        N, of each universal file of `measured` (or of none of them), then of each `frf`, `decay` and `response`: the
        cables' tension in that state.
    plane : str or list of str, optional
        Plane of each file: in, out or any.
    column : str, optional
        Name of the frequency column.
    compare : str or list of str, optional
        Further columns of the tables: frequencies of other models, shown beside.
    node : str or list of str, optional
        SENSOR=NODE of universal files of mode shapes (SENSOR=NODE-Y: along the file's -y); without it a sensor's node
        is the one at its place in the scene.
    channel : str, optional
        Channel of the decays.
    band : (float, float), optional
        Lines and modes of FRFs, decays and UFF 55 that count, Hz.
    stiffness : path or BendingResult, optional
        Table of tension_N, EI_Nm2 and, where known, std, or the JSON result of rigfit bending: the cables' EI in each
        state.

        Or the result of `bending` itself.
    stiffness_std : float, optional
        Relative uncertainty of that EI that all its tests share (0 to 1).
    axial : path or AxialResult, optional
        JSON result of rigfit axial: EA of all cables, with its uncertainty.

        Or the result of `axial` itself.
    axial_damping : bool
        With `axial`: its damping ratio too becomes that of all cables.
    input : str or list of str, optional
        Uncertainty of what is not fitted: TARGET=STD or TARGET=0.5%, several targets with commas (-TARGET: opposite),
        `tension` for the cables' reading, @each at the end: independent in each state. Carried into the parameters,
        the predictions and `monte_carlo`.
    aim : str or list of str, optional
        Where a load of the scene struck, LOAD=METRES,DEGREES (standard uncertainties of its place along the member
        and of its direction, of the mean of the hits): carried on like every `input`. With `frf` and `response`.
    candidates : path, optional
        TOML file of models to compare, [[candidate]] with name and, as needed, supports = { NODE =
        "pinned|clamped|free|springs|own springs" }, set = { "PARAMETER" = VALUE }, free = [...], prior = [...], scene
        = "FILE": weights by evidence, averaged parameters; exit code 4 when none has 90 % of the weight.

        The result is the heaviest's, with ``candidates[]`` and ``averaged[]``; `Refused` has it where none is decided.
    ends : str or list of str, optional
        The usual candidates: all nodes that are held "pinned", "clamped", with "springs" (one rotational stiffness,
        fitted), with "own springs" (one a node).
    profile : bool
        Also 95 % intervals by profile (of data and priors alone).
    assumed_std : float, optional
        Relative standard uncertainty of frequencies that come without one (1e-09 to 1; default 0.01).
    model_std : float, optional
        Relative error in frequency that the model itself is allowed (0 to 1; default 0).
    frf_model_std : float, optional
        Relative error in FRFs that the model itself is allowed (0 to 10; default 0).
    shape_std : float, optional
        Uncertainty of a component of a unit shape: shapes are fitted too (0: they only help to pair) (0 to 1; default
        0).
    segments : int, optional
        Of every member while fitting (default: the scene's); fewer are faster (2 to 10000).
    starts : int, optional
        Starts, the first at the scene's own values (1 to 1000; default 4).
    start_spread : float, optional
        Factor by which the other starts are off at most (1 to 100; default 3).
    hold_out : bool
        Also leave out each state in turn and predict it from the others.
    monte_carlo : int, optional
        Refits with measured frequencies, damping ratios, FRFs and time histories, priors, the stiffness table, EA,
        every `input` and `aim` drawn anew (0 to 1000000).
    threads : int, optional
        Threads to use (all processors); the numbers do not depend on it (1 to 1024).
    seed : int, optional
        Seed of every random number (default 1).

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
    if candidates is not None:
        options["candidates"] = checks.document("candidates", candidates)
    if ends is not None:
        options["ends"] = [checks.choice("ends", one, ("pinned", "clamped", "springs", "own springs"))
                           for one in checks.sequence("ends", ends)]
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
                options[name] = checks.document(name, value)
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
            frf=None, band=None, lines=None, response=None, duration=None, rate=None, sample=False, threads=None,
            seed=None, input=None):
    """Modes of another scene with the parameters of a fit, with intervals from their covariance.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict
        Where the parameters are used, such as one part of the rig that was fitted.
    fit : UpdateResult or path
        JSON result of `rigfit update`.

        Or the result of `update` itself.
    map : dict of str to str, optional
        What a parameter of the fit is called here: NAME=TARGET[,-TARGET...].

        Such as ``{"cable.EI": "left.EI,right.EI"}``.
    count : int, optional
        The first N modes (1 to 1000; default 6).
    segments : int, optional
        Segments of every member, instead of the scene's (2 to 100000).
    measured : path, ModalResult, array of frequencies or list of dict, optional
        Table of measured frequencies, or universal file of modes (UFF 55), to compare with.
    column : str, optional
        Column of the frequencies in the table.
    plane : {"any", "in", "out"}
        Plane of the measured modes (default any).
    damage : str or list of str, optional
        Loss of EI of a zone against its sound part: ZONE=SOUND[,RATIO], SOUND a parameter of the fit or N m2.
    frf : path, optional
        FRFs with their 95 % intervals as a table.
    band : (float, float), optional
        Band of the FRFs, Hz.
    lines : int, optional
        Frequency lines of the FRFs (2 to 100000; default 400).
    response : path, optional
        Response to the scene's loads with its 95 % interval as a table.
    duration : float, optional
        Length of the response, s (1e-06 to 3600; default 2).
    rate : float, optional
        Sample rate of the response, Hz (0.001 to 1e+06; default 500).
    sample : bool
        Intervals from samples, also where the model is linear.
    threads : int, optional
        Threads to use (all processors); the numbers do not depend on it (1 to 1024).
    seed : int, optional
        Seed of every random number (default 1).
    input : str or list of str, optional
        A number of this scene that is known to a standard uncertainty: NAME=STD, NAME=0.5% or NAME=VALUE,STD; one of
        the same name in the fit is the same quantity and counts once.

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
    if input is not None:
        options["input"] = checks.texts("input", input)
    for name, value in (("frf", frf), ("response", response)):
        if value is not None:
            options[name] = checks.new_file(name, value)
    for name, value, low, high in (("duration", duration, 1e-6, 3600), ("rate", rate, 1e-3, 1e6)):
        if value is not None:
            options[name] = checks.number(name, value, low, high)
    if band is not None:
        options["band"] = checks.band("band", band)
    options["sample"] = checks.flag("sample", sample)
    with tempfile.TemporaryDirectory(prefix="rigfit-") as folder:
        options["fit"] = (_write_document("fit", fit, folder) if isinstance(fit, UpdateResult) else
                          checks.document("fit", fit))
        if measured is not None:
            options["measured"] = (checks.path("measured", measured) if is_path(measured) else
                                   write_modes("measured", measured, folder))
        document, exit_code = call(_core.predict, scene_or_path(scene), options)
    return finish(PredictResult, at_hand(document, folder), exit_code)
