"""FRFs of other programs, for `modal`: `frfs_of_arrays`."""

import numpy as np

from . import _core, checks


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
    options["averages"] = 0 if averages is None else checks.integer("averages", averages, 1, 1000000)
    options["exponential_window"] = checks.number("exponential_window", 0 if exponential_window is None else exponential_window, 0, 1e6)
    return _core.frfs_of_arrays(lines, H, coherence, options)
