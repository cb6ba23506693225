"""Recordings: channels sampled together, read from files or made of arrays."""

from collections.abc import Mapping, Sequence
import os
import warnings as _warnings

import numpy as np

from . import _core, checks
from .errors import DataWarning, Error
from .results import Record, Records, pandas


class Channel:
    """One channel of a recording, in SI units.

    Attributes
    ----------
    name, unit, source_unit, quantity : str
        ``unit`` is the SI symbol, empty where none is known; ``source_unit`` as it was given.
    data : numpy.ndarray
        Samples, float64, NaN where missing. A view that cannot be written to.
    fs : float
        Sample rate, Hz; 0: not known.
    missing_samples : int
    direction : tuple of float
        Of positive values, in scene axes; zeros: not known.
    """

    def __init__(self, fields, fs):
        self.__dict__.update(fields, fs=fs)

    def to_sep005(self):
        """The channel as a dict ``{name, data, fs, unit_str}`` (SDyPy proposal SEP005), data not copied."""
        return {"name": self.name, "data": self.data, "fs": self.fs, "unit_str": self.unit}

    def __len__(self):
        return len(self.data)

    def __repr__(self):
        return f"Channel({self.name!r}, {len(self.data)} samples, unit {self.unit!r}, fs {self.fs:g} Hz)"


class Recording(Sequence):
    """Channels sampled together at a constant rate.

    Parameters
    ----------
    channels : list of dict, dict of name to array, or array
        An array is channels x samples, with ``names``.
        In SEP005 style: ``name`` and ``data`` (one dimension), and where known ``fs`` (Hz), ``unit_str``,
        ``direction``. NaN is a missing sample. The arrays are copied.
    fs : float, optional
        Sample rate in Hz, where the channels do not say it.
    units : dict of name to str, optional
        Where the channels do not say them.
    names : list of str, optional
        Of the rows of an array.
    start_time_s : float
    name : str
        For messages and results.
    """

    def __init__(self, channels, fs=None, units=None, start_time_s=0.0, name="recording", *, names=None):
        name = checks.text("name", name)
        start = checks.number("start_time_s", start_time_s)
        if isinstance(channels, np.ndarray):
            rows = np.atleast_2d(channels)
            names = [f"channel {i + 1}" for i in range(len(rows))] if names is None else list(names)
            if rows.ndim != 2 or not len(names) == len(set(names)) == len(rows):
                checks.fail("names", f"must be a name of its own for each row of channels x samples: {len(names)} for an array of shape {channels.shape}")
            channels, names = dict(zip(names, rows)), None
        if names is not None:
            checks.fail("names", "belong to an array of channels x samples; here the channels have names")
        if isinstance(channels, Mapping):
            channels = [{"name": key, "data": data} for key, data in channels.items()]
        channels = [channels] if isinstance(channels, Channel) else channels
        if not isinstance(channels, (list, tuple)) or not channels:
            checks.fail("channels", "is empty" if isinstance(channels, (list, tuple)) else
                        f"must be a dict or a list of channels, not {checks.kind(channels)}")
        if units is not None and not isinstance(units, Mapping):
            checks.fail("units", f"must be a dict of channel name to unit, not {checks.kind(units)}")
        rates, given = set(), []
        if fs is not None:
            rates.add(checks.number("fs", fs, positive=True))
        for i, channel in enumerate(channels):
            if isinstance(channel, Channel):
                channel = channel.to_sep005()
            if not isinstance(channel, Mapping):
                checks.fail(f"channels[{i}]", f"must be a dict with name and data, not {checks.kind(channel)}")
            if "data" not in channel:
                checks.fail(f"channels[{i}]", "has no data")
            title = checks.text(f"channels[{i}].name", channel.get("name", f"channel {i + 1}"))
            if channel.get("fs") not in (None, 0):
                rates.add(checks.number(f"channels[{i}].fs", channel["fs"], positive=True))
            unit = channel.get("unit_str", channel.get("unit"))
            if unit is None:
                unit = (units or {}).get(title, "")
            if not isinstance(unit, str):
                checks.fail(f"channels[{i}].unit_str", f"must be a string, not {checks.kind(unit)}")
            data = checks.array(f"channels[{i}].data", channel["data"], missing=True)
            if np.isinf(data).any():
                checks.fail(f"channels[{i}].data", f"holds {np.isinf(data).sum()} infinite values (missing samples are NaN)")
            one = {"name": title, "unit": unit.replace("\0", ""), "data": data}
            if channel.get("direction") is not None:
                direction = checks.numbers(f"channels[{i}].direction", channel["direction"])
                if len(direction) != 3:
                    checks.fail(f"channels[{i}].direction", "must be three numbers")
                one["direction"] = direction
            given.append(one)
        if len({len(one["data"]) for one in given}) > 1:
            checks.fail("channels", "must have the same number of samples: " +
                        ", ".join(f"{one['name']} {len(one['data'])}" for one in given[:8]))
        if len(rates) > 1:
            checks.fail("fs", f"must be the same of all channels, not {', '.join(f'{r:g}' for r in sorted(rates))} Hz")
        self._set(_core.from_channels(given, rates.pop() if rates else 0.0, start, name))

    def _set(self, core):
        self._core = core
        self._channels = [Channel(fields, core.fs) for fields in core.channels()]

    @classmethod
    def _of(cls, core):
        recording = cls.__new__(cls)
        recording._set(core)
        return recording

    name = property(lambda self: self._core.name, doc="File, or the name given.")
    format = property(lambda self: self._core.format, doc="""``"csv"``, ``"uff58-binary"``, ... or ``"memory"``.""")
    fs = property(lambda self: self._core.fs, doc="Sample rate, Hz; 0: not known.")
    start_time_s = property(lambda self: self._core.start_time_s, doc="Time of the first sample, s.")

    @property
    def time_s(self):
        """Times of the samples, s."""
        uneven = self._core.time_s
        if len(uneven):
            return uneven
        if not self.fs > 0:
            checks.fail("fs", f"{self.name} gives no sample rate")
        return self.start_time_s + np.arange(len(self._channels[0]) if self._channels else 0) / self.fs

    @property
    def channels(self):
        """The channels, in order."""
        return list(self._channels)

    @property
    def notes(self):
        """What the reader found worth knowing: code, message, where."""
        return Records(Record(note) for note in self._core.notes())

    def __len__(self):
        return len(self._channels)

    def __getitem__(self, key):
        if isinstance(key, str):
            for channel in self._channels:
                if channel.name == key:
                    return channel
            raise KeyError(f"{self.name} has no channel {key!r}; there are: " +
                           ", ".join(c.name for c in self._channels))
        return self._channels[key]

    def to_sep005(self):
        """The channels as list of dicts ``{name, data, fs, unit_str}``, data not copied."""
        return [channel.to_sep005() for channel in self._channels]

    def to_dict(self):
        """Name, format, rate and the channels as in `to_sep005`."""
        return {"name": self.name, "format": self.format, "fs": self.fs, "start_time_s": self.start_time_s,
                "channels": self.to_sep005()}

    def to_frame(self):
        """A pandas.DataFrame, a column a channel over time in s (or over the sample number)."""
        index = self.time_s if self.fs > 0 or len(self._core.time_s) else None
        return pandas().DataFrame({c.name: c.data for c in self._channels}, index)

    def __repr__(self):
        samples = len(self._channels[0]) if self._channels else 0
        return f"Recording({self.name!r}, {len(self)} channels, {samples} samples, fs {self.fs:g} Hz)"


def warn(found):
    """Python warnings of what a document lists."""
    for one in found:
        where = f"{one['where']}: " if one["where"] else ""
        _warnings.warn(f"{where}{one['message']} [{one['code']}]", DataWarning, stacklevel=4)


def sources(argument, given):
    """Files and recordings as the module takes them: str and core recordings."""
    if isinstance(given, Recording):
        return [given._core]
    if isinstance(given, Mapping):
        checks.fail(argument, "is a dict: make a rigfit.Recording of it, with fs=")
    if isinstance(given, (str, os.PathLike)):
        return [checks.path(argument, given)]
    if not isinstance(given, (list, tuple)):
        if hasattr(given, "read"):
            checks.fail(argument, "is a file object: give its path")
        checks.fail(argument, f"must be a path, a Recording, a list of channels, or a list of these, not "
                              f"{checks.kind(given)}")
    if not given:
        checks.fail(argument, "is empty")
    if all(isinstance(one, (Channel, Mapping)) for one in given):
        try:
            return [Recording(list(given), name=argument)._core]
        except Error as error:
            error.argument = f"{argument}: {error.argument}"
            raise
    return [one for i, item in enumerate(given) for one in sources(f"{argument}[{i}]", item)]
