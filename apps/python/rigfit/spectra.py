"""Recordings to decays, FRFs and modes: `inspect`, `decay`, `frf`, `modal`."""

import re

import numpy as np

from . import _core, checks, errors
from .recordings import sources, warn
from .results import DecayResult, FrfResult, InspectResult, ModalResult


def finish(kind, document, exit_code, **extra):
    """The result of a call; a refusal or a failure to converge raises, with what can be had as its ``result``."""
    result = kind(document, **extra)
    if exit_code == 0:
        warn(document["warnings"])
        return result
    found = document["error"]
    where, problem = f"{found['where']}: " if found["where"] else "", _in_arguments(found["message"])
    raise (errors.Refused if exit_code == 4 else errors.NotConverged)(
        f"{where}{problem}", code=found["code"], where=found["where"], problem=problem, result=result)


def _in_arguments(text):
    """A message with arguments in place of options of the command line."""
    return re.sub(r"--([a-z][a-z-]*)", lambda m: m[1].replace("-", "_"), text)


def call(function, *arguments):
    """Calls the module; options of the command line in what it raises become names of arguments."""
    try:
        return function(*arguments)
    except errors.Error as error:
        error.message = _in_arguments(error.message)
        error.args = (error.message,)
        error.problem, error.remedy = _in_arguments(error.problem), _in_arguments(error.remedy)
        raise


def inspect(recordings, *, sample_rate=None):
    """What recordings hold and whether they are fit for use.

    Parameters
    ----------
    recordings : path, Recording, list of channels, or list of these
    sample_rate : float, optional
        Hz, of files that give none.

    Returns
    -------
    InspectResult
        ``recordings[]`` with ``channels[]``: min, max, mean, rms, clipped_samples, missing_samples, findings.
    """
    options = {}
    if sample_rate is not None:
        options["sample_rate"] = checks.number("sample_rate", sample_rate, positive=True)
    return finish(InspectResult, *call(_core.inspect, sources("recordings", recordings), options))


def decay(recording, channel=None, *, start=None, end=None, band=None, each=False, max_modes=None, sample_rate=None,
          threads=None, seed=None):
    """Frequency and damping of a free decay.

    Parameters
    ----------
    recording : path, Recording or list of channels
    channel : str, optional
        Name or ``"#number"``; may be left out where there is one.
    start, end : float, optional
        s; without a start the decay is looked for.
    band : (float, float), optional
        Hz; modes between these are reported.
    each : bool
        Every decay of the record is fitted, and their modes pooled.
    max_modes : int, optional
    sample_rate : float, optional
        Hz, where the recording gives none.
    threads, seed : int, optional

    Returns
    -------
    DecayResult
        ``modes[]`` strongest first, each with ``frequency_hz``, ``damping_ratio`` (Estimate), ``cycles`` ...

    Raises
    ------
    Refused
        No decay stands out; ``result`` is what can be had.
    """
    options = checks.common(threads, seed)
    given = sources("recording", recording)
    if len(given) != 1:
        checks.fail("recording", f"must be one recording, not {len(given)}")
    if channel is not None:
        options["channel"] = checks.text("channel", channel)
    if start is not None:
        options["start"] = checks.number("start", start)
    if end is not None:
        options["end"] = checks.number("end", end)
    if band is not None:
        options["band"] = checks.band("band", band)
    options["each"] = checks.flag("each", each)
    if max_modes is not None:
        options["max_modes"] = checks.integer("max_modes", max_modes, 1, 12)
    if sample_rate is not None:
        options["sample_rate"] = checks.number("sample_rate", sample_rate, positive=True)
    return finish(DecayResult, *call(_core.decay, given, options))


def _hit_options(options, files, *, response=None, driving_point=None, struck=None, estimator="h1", force_window=None,
                 exponential_window=None, exponential_end_level=None, sample_rate=None, block=None, pre_trigger=None,
                 pulse_sign="auto", trigger=None, double_hit=None, min_pulse_samples=None, max_spectrum_drop=None,
                 ring_down_level=None, keep_outliers=False, frequencies_only=False, error_smoothing=None):
    if response is not None:
        options["response"] = checks.texts("response", response)
    if driving_point is not None:
        options["driving_point"] = checks.text("driving_point", driving_point)
    if struck is not None:
        options["struck"] = checks.texts("struck", struck)
        if len(options["struck"]) != files:
            checks.fail("struck", f"names {len(options['struck'])} points for {files} recordings: one a recording")
        if driving_point is not None:
            checks.fail("driving_point", "is for one point; struck names every recording's point")
    options["estimator"] = checks.choice("estimator", estimator, ("h1", "h2", "hv"))
    if force_window is not None:
        if isinstance(force_window, str):
            checks.choice("force_window", force_window, ("by-noise", "auto", "off"))
            options["force_window"] = force_window
        else:
            options["force_window"] = repr(checks.number("force_window", force_window, positive=True))
    if exponential_window is not None and exponential_end_level is not None:
        checks.fail("exponential_end_level", "says the same as exponential_window: give one")
    for name, value, low, high in (("exponential_window", exponential_window, 0, 1e6),
                                   ("exponential_end_level", exponential_end_level, 1e-12, 1),
                                   ("pre_trigger", pre_trigger, 0, None), ("trigger", trigger, 0.1, 100),
                                   ("double_hit", double_hit, 0.1, 100), ("ring_down_level", ring_down_level, 1e-6, 100)):
        if value is not None:
            options[name] = checks.number(name, value, low, high)
    for name, value in (("sample_rate", sample_rate), ("block", block), ("max_spectrum_drop", max_spectrum_drop)):
        if value is not None:
            options[name] = checks.number(name, value, positive=True)
    options["pulse_sign"] = checks.choice("pulse_sign", pulse_sign, ("auto", "positive", "negative"))
    if min_pulse_samples is not None:
        options["min_pulse_samples"] = checks.integer("min_pulse_samples", min_pulse_samples, 1, 10000)
    options["keep_outliers"] = checks.flag("keep_outliers", keep_outliers)
    options["frequencies_only"] = checks.flag("frequencies_only", frequencies_only)
    if error_smoothing is not None:
        options["error_smoothing"] = checks.integer("error_smoothing", error_smoothing, 0, 1000000)


def frf(recordings, force, response=None, *, band=None, out=None, csv=None, encoding="binary", threads=None, seed=None,
        **hits):
    """Hammer hits found and judged, averaged FRFs with coherence and error bars.

    Parameters
    ----------
    recordings : path, Recording, list of channels, or list of these
        Continuous, or one a hit. Channels of Recording objects are used where they lie, without a copy.
    force : str
        Force channel: name or ``"#k"``.
    response : str or list of str, optional
        Response channels; every other one when left out.
    band : (float, float), optional
        Hz, in which the force spectrum is asked for.
    out, csv : path, optional
        Files to write: UFF 58, table.
    encoding : {"binary", "ascii"}
    threads, seed : int, optional
    **hits
        driving_point, struck (one a recording: roving hammer), estimator ("h1", "h2", "hv"), force_window ("by-noise",
        "auto", "off" or s), exponential_window (1/s), exponential_end_level, sample_rate (Hz), block, pre_trigger (s),
        pulse_sign, trigger, double_hit, ring_down_level (%), min_pulse_samples, max_spectrum_drop (dB), keep_outliers,
        frequencies_only, error_smoothing (lines).

    Returns
    -------
    FrfResult
        ``hits[]``, ``averages`` ..., and the arrays ``frequency_hz``, ``H``, ``H_std``, ``coherence``.

    Raises
    ------
    Refused
        No hit can be used; ``result.hits`` says why.
    """
    options = checks.common(threads, seed)
    given = sources("recordings", recordings)
    options["force"] = checks.text("force", force)
    _hits(options, given, response, hits)
    if band is not None:
        options["band"] = checks.band("band", band)
    if out is not None:
        options["out"] = checks.path("out", out)
    if csv is not None:
        options["csv"] = checks.path("csv", csv)
    options["encoding"] = checks.choice("encoding", encoding, ("binary", "ascii"))
    document, exit_code, frfs = call(_core.frf, given, options)
    return finish(FrfResult, document, exit_code, frfs=frfs)


def _hits(options, given, response, hits):
    try:
        _hit_options(options, len(given), response=response, **hits)
    except TypeError as error:
        if isinstance(error, errors.Error):
            raise
        unknown = str(error).rpartition(" ")[2].strip("'")
        checks.fail(unknown, "is no argument of this function")


def modal(frfs, *, force=None, response=None, band=None, order=None, max_damping=None, averages=None, out=None,
          synthesis=None, threads=None, seed=None, **hits):
    """Natural frequencies, damping and shapes with error bars from FRFs or from hits.

    Parameters
    ----------
    frfs : FrfResult, path of a file of FRFs, or recordings of hits (then with ``force``)
        A UFF file, or one or several text tables of frequency, real and imaginary part. FRFs of other programs:
        `frfs_of_arrays`.
    force, response, **hits
        As of `frf`, for recordings of hits; exponential_window is also the window that FRFs were measured with.
    band : (float, float), optional
        Hz, where modes are looked for.
    order : int, optional
        Highest model order.
    max_damping : float, optional
        Largest damping ratio that is taken for a mode.
    averages : int, optional
        Behind the coherence of FRFs from elsewhere.
    out, synthesis : path, optional
        Files to write: modes as UFF 55, FRFs rebuilt from them as UFF 58.
    threads, seed : int, optional

    Returns
    -------
    ModalResult
        ``modes[]`` with ``frequency_hz``, ``damping_ratio`` (Estimate), ``shape[]``; ``auto_mac``, ``pole_covariance``.
    """
    options = checks.common(threads, seed)
    given, at_hand = [], None
    if isinstance(frfs, FrfResult):
        at_hand = frfs._arrays()
    elif isinstance(frfs, _core.FrfSet):
        at_hand = frfs
    else:
        given = sources("frfs", frfs)
    if force is not None:
        if at_hand is not None:
            checks.fail("force", "is for recordings of hits; these are FRFs already")
        options["force"] = checks.text("force", force)
        if averages is not None:
            checks.fail("averages", "is for FRFs from elsewhere, not for recordings of hits")
    elif at_hand is None and not all(isinstance(one, str) for one in given):
        checks.fail("force", "is needed for recordings of hits")
    if force is None:
        unused = {name for name in hits if name not in ("exponential_window", "exponential_end_level")}
        if response is not None or unused:
            checks.fail("response" if response is not None else sorted(unused)[0],
                        "is for recordings of hits, which need force")
    _hits(options, given, response, hits)
    if band is not None:
        options["band"] = checks.band("band", band)
    if order is not None:
        options["order"] = checks.integer("order", order, 2, 400)
    if max_damping is not None:
        options["max_damping"] = checks.number("max_damping", max_damping, 1e-6, 0.99)
    if averages is not None:
        options["averages"] = checks.integer("averages", averages, 1, 1000000)
    if out is not None:
        options["out"] = checks.path("out", out)
    if synthesis is not None:
        options["synthesis"] = checks.path("synthesis", synthesis)
    document, exit_code, used = call(_core.modal, at_hand, given, options)
    return finish(ModalResult, document, exit_code, frfs=used)


def frfs_of_arrays(frequency_hz, H, *, form, responses=None, inputs=None, coherence=None, averages=None,
                   exponential_window=None):
    """FRFs of another program, for `modal`.

    Parameters
    ----------
    frequency_hz : array, shape (lines,)
        Rising, Hz.
    H : array, complex, shape (lines, responses, inputs), (lines, responses) or (lines,)
        SI per N, sign exp(+i 2 pi f t).
    form : {"receptance", "mobility", "accelerance"}
    responses, inputs : list of str, optional
    coherence : array of the shape of H, optional
        With ``averages`` it gives the error bars.
    averages : int, optional
    exponential_window : float, optional
        Decay rate of a window shared by force and responses, 1/s.

    Returns
    -------
    FrfSet
        With ``frequency_hz``, ``H``, ``coherence``, ``responses``, ``inputs``.
    """
    lines = checks.array("frequency_hz", frequency_hz, 1)
    if not (lines[0] >= 0 and (np.diff(lines) > 0).all()):
        checks.fail("frequency_hz", "must rise from 0 or above")

    def layers(name, value, dtype):
        value = np.asarray(value) if not isinstance(value, (str, bytes)) else value
        if isinstance(value, np.ndarray) and value.ndim in (1, 2):
            value = value.reshape(value.shape + (1,) * (3 - value.ndim))
        value = checks.array(name, value, 3, dtype)
        if value.shape[0] != len(lines):
            checks.fail(name, f"has {value.shape[0]} lines, frequency_hz {len(lines)}")
        return value

    H = layers("H", H, np.complex128)
    options = {"form": checks.choice("form", form, ("receptance", "mobility", "accelerance"))}
    for name, given, axis in (("responses", responses, 1), ("inputs", inputs, 2)):
        names = [f"{name[:-1]} {i + 1}" for i in range(H.shape[axis])] if given is None else checks.texts(name, given)
        if len(names) != H.shape[axis]:
            checks.fail(name, f"names {len(names)}, H has {H.shape[axis]}")
        options[name] = names
    if coherence is not None:
        coherence = layers("coherence", coherence, np.float64)
        if coherence.shape != H.shape:
            checks.fail("coherence", f"has shape {coherence.shape}, H {H.shape}")
        if coherence.min() < 0 or coherence.max() > 1:
            checks.fail("coherence", "must be between 0 and 1")
    if averages is not None:
        options["averages"] = checks.integer("averages", averages, 1, 1000000)
    if exponential_window is not None:
        options["exponential_window"] = checks.number("exponential_window", exponential_window, 0, 1e6)
    return _core.frfs_of_arrays(lines, H, coherence, options)


def read_frfs(file):
    """FRFs of a UFF 58 file or of a text table of frequency, real and imaginary part.

    Parameters
    ----------
    file : path

    Returns
    -------
    FrfSet
        As `frfs_of_arrays` gives them.
    """
    return call(_core.read_frfs, checks.path("file", file))
