"""Arguments checked before they reach the libraries: each failure names the argument and the reason."""

import math
import numbers as _numbers
import os

import numpy as np

from .errors import ArgumentError


def fail(argument, reason):
    """Raises ArgumentError: ``argument: reason``."""
    raise ArgumentError(f"{argument}: {reason}", argument=argument, problem=reason)


def kind(value):
    """How a message names a value."""
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape} and type {value.dtype}"
    text = repr(value)
    return f"{text if len(text) <= 40 else text[:37] + '...'} ({type(value).__name__})"


def number(argument, value, low=None, positive=False):
    """A finite float, at least ``low``, above zero where ``positive``."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if isinstance(value, bool) or not isinstance(value, _numbers.Real):
        fail(argument, f"must be a number, not {kind(value)}")
    try:
        value = float(value)
    except (OverflowError, ValueError):
        fail(argument, "is too large for a number")
    if not math.isfinite(value):
        fail(argument, f"must be finite, not {value}")
    if positive and not value > 0:
        fail(argument, f"must be positive, not {value:g}")
    if low is not None and value < low:
        fail(argument, f"must be at least {low:g}, not {value:g}")
    return value


def text(argument, value):
    """A str that is not empty."""
    if not isinstance(value, str):
        fail(argument, f"must be a string, not {kind(value)}")
    if not value:
        fail(argument, "is empty")
    if "\0" in value:
        fail(argument, "holds a null character")
    try:
        value.encode()
    except UnicodeEncodeError:
        fail(argument, "is not valid Unicode")
    return value


def path(argument, value):
    """A file name as str."""
    if hasattr(value, "read"):
        fail(argument, "is a file object: give its path")
    if not isinstance(value, (str, os.PathLike)):
        fail(argument, f"must be a path, not {kind(value)}")
    value = os.fspath(value)
    if isinstance(value, bytes):
        value = os.fsdecode(value)
    return text(argument, value)


def document(argument, value):
    """The name of a JSON or TOML file, not of a folder."""
    value = path(argument, value)
    if os.path.isdir(value):
        fail(argument, f"is a folder, not a file: {value}")
    return value


def new_file(argument, value):
    """The name of a file to write, in a folder that is there."""
    value = path(argument, value)
    folder = os.path.dirname(value) or "."
    if os.path.isdir(value):
        fail(argument, f"is a folder: {value}")
    if not os.path.isdir(folder):
        fail(argument, f"cannot be written: there is no folder {folder}")
    return value


def numbers(argument, value, **limits):
    """One number or several as a list of floats."""
    if isinstance(value, np.ndarray):
        if value.ndim > 1:
            fail(argument, f"must have one dimension, not {value.ndim}")
        value = list(np.atleast_1d(value))
    if isinstance(value, (list, tuple)):
        if not value:
            fail(argument, "is empty")
        return [number(f"{argument}[{i}]", one, **limits) for i, one in enumerate(value)]
    return [number(argument, value, **limits)]


def array(argument, value, missing=False):
    """A contiguous, aligned array of one dimension; the very same where it is one already. ``missing``: NaN may
    stand in it, and masked values become NaN."""
    if isinstance(value, (str, bytes)) or hasattr(value, "read"):
        fail(argument, f"must be an array, not {kind(value)}")
    try:
        if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
            if not missing:
                fail(argument, f"masks {int(np.ma.count_masked(value))} of its values")
            value = np.ma.filled(value.astype(np.float64), np.nan)
        given = np.asarray(value)
    except (ValueError, TypeError) as error:
        fail(argument, f"is no array: {error}")
    if given.dtype.kind not in "biuf":
        fail(argument, f"must hold real numbers, not {given.dtype}")
    if given.ndim != 1:
        fail(argument, f"must have 1 dimension, not {given.ndim}")
    if given.size == 0:
        fail(argument, "has no elements")
    given = np.require(given, np.float64, ("C", "A"))
    if not missing and not np.isfinite(given).all():
        fail(argument, f"holds {int((~np.isfinite(given)).sum())} values that are not finite")
    return given
