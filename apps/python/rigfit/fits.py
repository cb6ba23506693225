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
    candidates : path, optional
        TOML file of models to compare by evidence: ``[[candidate]]`` with ``name``, ``supports``, ``set``, ``free``,
        ``prior``, ``scene``. The result is the heaviest's, with ``candidates[]`` and ``averaged[]``.
    ends : str or list of str, optional
        The usual candidates: "pinned", "clamped", "springs", "own springs" at all nodes that are held.
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
    if candidates is not None:
        options["candidates"] = checks.path("candidates", candidates)
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
        document, exit_code = call(_core.predict, scene_or_path(scene), options)
    return finish(PredictResult, at_hand(document, folder), exit_code)
