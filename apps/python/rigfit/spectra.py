"""Recordings to decays, FRFs and modes: `inspect`, `resample`, `decay`, `frf`, `modal`."""

import re

import numpy as np

from . import _core, checks, errors
from .recordings import Recording, sources, warn
from .results import DecayResult, FrfResult, InspectResult, ModalResult, ResampleResult


def finish(kind, document, exit_code, **extra):
    """The result of a call; a refusal or a failure to converge raises, with what can be had as its ``result``."""
    result = kind(document, **extra)
    if exit_code == 0:
        warn(document["warnings"])
        return result
    found = document["error"]
    where, problem = f"{found['where']}: " if found["where"] else "", _in_arguments(found["message"])
    error = (errors.Refused if exit_code == 4 else errors.NotConverged)(
        f"{where}{problem}", code=found["code"], where=found["where"], problem=problem, result=result)
    if hasattr(error, "add_note"):  # from Python 3.11 on
        error.add_note(f"What can be had all the same is the exception's `result` ({kind.__name__}).")
    raise error


def _in_arguments(text):
    """A message with arguments in place of options of the command line, but for commands in backticks."""
    return re.sub(r"`[^`]*`|--([a-z][a-z-]*)", lambda m: f"`{m[1].replace('-', '_')}`" if m[1] else m[0], text)


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
        Sample rate in Hz of files that give none.

    Returns
    -------
    InspectResult
        ``recordings[]`` with ``channels[]``: min, max, mean, rms, clipped_samples, missing_samples, findings.
    """
    options = {}
    if sample_rate is not None:
        options["sample_rate"] = checks.number("sample_rate", sample_rate, positive=True)
    return finish(InspectResult, *call(_core.inspect, sources("recordings", recordings), options))


def resample(recording, rate=None, *, out=None, sample_rate=None):
    """A recording at another rate (with a filter), or uneven times made even.

    Parameters
    ----------
    recording : path, Recording or list of channels
    rate : float, optional
        New rate, Hz [of uneven times that of their usual step].
    out : path, optional
        Recording to write.
    sample_rate : float, optional
        Where the file gives none, Hz.

    Returns
    -------
    ResampleResult
        ``recording`` (Recording); ``channels[]`` with ``error_rms``, each in its unit.
    """
    options, given = {}, sources("recording", recording)
    if len(given) != 1:
        checks.fail("recording", f"must be one recording, not {len(given)}")
    for name, value in (("rate", rate), ("sample_rate", sample_rate)):
        if value is not None:
            options[name] = checks.number(name, value, positive=True)
    if out is not None:
        options["out"] = checks.new_file("out", out)
    document, exit_code, even = call(_core.resample, given, options)
    return finish(ResampleResult, document, exit_code, recording=Recording._of(even))


def decay(recording, channel=None, *, start=None, end=None, band=None, each=False, max_modes=None, sample_rate=None,
          threads=None, seed=None):
    """Frequency and damping of a free decay.

    Parameters
    ----------
    recording : path, Recording or list of channels
    channel : str, optional
        Name or #number; may be left out where there is one.
    start : float, optional
        Fit from this time on, s (default: found).
    end : float, optional
        Use nothing after this time, s.
    band : (float, float), optional
        Report modes between these, Hz.
    each : bool
        Fit every decay of the record and pool their modes: mean, and scatter between decays.
    max_modes : int, optional
        At most so many modes (1 to 12; default 6).
    sample_rate : float, optional
        Where the file gives none, Hz.
    threads : int, optional
        Threads to use (all processors); the numbers do not depend on it (1 to 1024).
    seed : int, optional
        Seed of every random number (default 1).

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
        Force channel: name or #k.
    response : str or list of str, optional
        Response channels [every other].
    band : (float, float), optional
        Band in which the force spectrum is asked for, Hz.
    out : path, optional
        FRFs with coherence and error bars as UFF 58.
    csv : path, optional
        FRFs with standard deviations and coherence as CSV.
    encoding : {"binary", "ascii"}
        Of the UFF file (default binary).
    threads : int, optional
        Threads to use (all processors); the numbers do not depend on it (1 to 1024).
    seed : int, optional
        Seed of every random number (default 1).
    **hits
        How hits are found, judged and windowed: below.

    Other Parameters
    ----------------
    driving_point : str, optional
        The response at the point struck.
    struck : list of str, optional
        Point struck in each file, one a file (roving hammer): a response's name where it was struck, else any name.
    estimator : {"h1", "h2", "hv"}
        h1: noise on responses, h2: on force, hv: both (default h1).
    force_window : float or {"by-noise", "auto", "off"}, optional
        Seconds of force kept from the pulse's start, auto (three pulse lengths), off, or by-noise: auto where the
        noise on the force matters, else off (default by-noise).
    exponential_window : float, optional
        Decay rate of a window on force and responses, 1/s; its damping is carried along and taken off the poles again
        (0 to 1e+06; default 0).
    exponential_end_level : float, optional
        The same, given as its level at the end of the block (1e-12 to 1).
    sample_rate : float, optional
        Hz, for files that do not say.
    block : float, optional
        Seconds analysed a hit [what uses most of the recordings].
    pre_trigger : float, optional
        Seconds before the peak [1 % of the block].
    pulse_sign : {"auto", "positive", "negative"}
        Side to which the force goes when hit (default auto).
    trigger : float, optional
        A hit exceeds this much of the largest force, % (0.1 to 100; default 10).
    double_hit : float, optional
        Smallest second contact that is reported, % of the hit (0.1 to 100; default 3).
    min_pulse_samples : int, optional
        Samples a pulse needs above 10 % of its peak (1 to 10000; default 4).
    max_spectrum_drop : float, optional
        Drop of the force spectrum within the band, dB (ISO 7626-5) (default 20).
    ring_down_level : float, optional
        A ring-down may be cut once it has fallen to this, % of its largest value (1e-06 to 100; default 1).
    keep_outliers : bool
        No leave-one-out test.
    frequencies_only : bool
        Keep hits whose pulse is not resolved; the FRFs then have no scale.
    error_smoothing : int, optional
        Lines on either side over which the noise under error bars is averaged (0 to 1000000; default 10).

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
        options["out"] = checks.new_file("out", out)
    if csv is not None:
        options["csv"] = checks.new_file("csv", csv)
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
    force : str, optional
        Force channel: name or #k.

        For recordings of hits.
    response : str or list of str, optional
        Response channels [every other].
    band : (float, float), optional
        Band to look for modes in (and for the force spectrum of hits), Hz.
    order : int, optional
        Highest model order of the stabilisation diagram (2 to 400; default 60).
    max_damping : float, optional
        Largest damping ratio that is taken for a mode (1e-06 to 0.99; default 0.2).
    averages : int, optional
        Averages behind the coherence of FRFs from a file [as the file says] (1 to 1000000).
    out : path, optional
        Modes as UFF 55.
    synthesis : path, optional
        FRFs rebuilt from the modes and what else was fitted, at the measured lines, as UFF 58.
    threads : int, optional
        Threads to use (all processors); the numbers do not depend on it (1 to 1024).
    seed : int, optional
        Seed of every random number (default 1).
    **hits
        For recordings of hits, as of `frf`: below.

    Other Parameters
    ----------------
    driving_point : str, optional
        The response at the point struck.
    struck : list of str, optional
        Point struck in each file, one a file (roving hammer): a response's name where it was struck, else any name.
    estimator : {"h1", "h2", "hv"}
        h1: noise on responses, h2: on force, hv: both (default h1).
    force_window : float or {"by-noise", "auto", "off"}, optional
        Seconds of force kept from the pulse's start, auto (three pulse lengths), off, or by-noise: auto where the
        noise on the force matters, else off (default by-noise).
    exponential_window : float, optional
        Decay rate of a window on force and responses, 1/s: used on hits, or stated of FRFs from a file that were
        measured with one; it is taken off the poles (0 to 1e+06; default 0).
    exponential_end_level : float, optional
        The same, given as its level at the end of the block (1e-12 to 1).
    sample_rate : float, optional
        Hz, for files that do not say.
    block : float, optional
        Seconds analysed a hit [what uses most of the recordings].
    pre_trigger : float, optional
        Seconds before the peak [1 % of the block].
    pulse_sign : {"auto", "positive", "negative"}
        Side to which the force goes when hit (default auto).
    trigger : float, optional
        A hit exceeds this much of the largest force, % (0.1 to 100; default 10).
    double_hit : float, optional
        Smallest second contact that is reported, % of the hit (0.1 to 100; default 3).
    min_pulse_samples : int, optional
        Samples a pulse needs above 10 % of its peak (1 to 10000; default 4).
    max_spectrum_drop : float, optional
        Drop of the force spectrum within the band, dB (ISO 7626-5) (default 20).
    ring_down_level : float, optional
        A ring-down may be cut once it has fallen to this, % of its largest value (1e-06 to 100; default 1).
    keep_outliers : bool
        No leave-one-out test.
    frequencies_only : bool
        Keep hits whose pulse is not resolved; the FRFs then have no scale.
    error_smoothing : int, optional
        Lines on either side over which the noise under error bars is averaged (0 to 1000000; default 10).

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
        options["out"] = checks.new_file("out", out)
    if synthesis is not None:
        options["synthesis"] = checks.new_file("synthesis", synthesis)
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
        Behind the coherence.
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
