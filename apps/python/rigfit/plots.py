"""Plots of results by matplotlib, where it is installed."""

import numpy as np

from .errors import Error


def axes_or_new(axes, rows=1):
    """The axes given, or new ones."""
    if axes is not None:
        return axes
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise Error("plot() needs matplotlib (Debian: python3-matplotlib)", code="not_installed") from error
    return pyplot.subplots(rows, 1, sharex=True, squeeze=False)[1][:, 0] if rows > 1 else pyplot.subplots()[1]


def plot_recording(recording, axes=None):
    """Channels over time."""
    axes = axes_or_new(axes)
    x = recording.time_s if recording.fs > 0 else np.arange(len(recording.channels[0]))
    for channel in recording:
        axes.plot(x, channel.data, label=f"{channel.name} ({channel.unit or '-'})", linewidth=0.8)
    axes.set_xlabel("time, s" if recording.fs > 0 else "sample")
    axes.legend()
    return axes


def _frf(result, axes, responses, inputs, units=""):
    axes = axes_or_new(axes)
    for r, response in enumerate(responses):
        for i, source in enumerate(inputs):
            axes.semilogy(result.frequency_hz, np.abs(result.H[:, r, i]), label=f"{response} by {source}", linewidth=0.8)
    axes.set_xlabel("frequency, Hz")
    axes.set_ylabel(f"|H|{units}")
    axes.legend()
    return axes


def _errors(axes, x, estimates, **style):
    values = [np.nan if e.value is None else e.value for e in estimates]
    bars = [0 if e.std is None else 2 * e.std for e in estimates]
    axes.errorbar(x, values, yerr=bars, fmt="o", capsize=3, **style)


def _modal(result, axes):
    axes = axes_or_new(axes)
    modes = [m for m in result.modes if m.damping_ratio.value is not None]
    _errors(axes, [m.frequency_hz.value for m in modes], [m.damping_ratio for m in modes])
    axes.set_xlabel("frequency, Hz")
    axes.set_ylabel("damping ratio (bars: two standard uncertainties)")
    return axes


def _decay(result, axes):
    axes = axes_or_new(axes)
    points = result.amplitude_dependence.points
    axes.semilogy([p.time_s for p in points], [p.amplitude for p in points], "o-")
    axes.set_xlabel("time, s")
    axes.set_ylabel(f"amplitude, {result.unit}")
    return axes


def _bending(result, axes):
    axes = axes_or_new(axes)
    tests = [t for t in result.tests if t.EI_Nm2.value is not None]
    _errors(axes, [t.tension_N for t in tests], [t.EI_Nm2 for t in tests])
    axes.set_xlabel("tension, N")
    axes.set_ylabel("EI, N m2 (bars: two standard uncertainties)")
    return axes


def _budget(result, axes):
    axes = axes_or_new(axes)
    axes.barh([term.source for term in result.budget], [term.contribution_N for term in result.budget])
    axes.set_xlabel("contribution to the standard uncertainty of EA, N")
    return axes


def _modes(result, axes):
    axes = axes_or_new(axes)
    axes.stem([m.frequency_hz for m in result.modes], [1] * len(result.modes))
    for m in result.modes:
        axes.annotate(m.plane, (m.frequency_hz, 1))
    axes.set_xlabel("frequency, Hz")
    axes.set_yticks([])
    return axes


def _respond(result, axes):
    axes = axes_or_new(axes)
    for s, sensor in enumerate(result.sensors):
        axes.plot(result.time_s, result.response[:, s], label=f"{sensor.name} ({sensor.unit})", linewidth=0.8)
    axes.set_xlabel("time, s")
    axes.legend()
    return axes


def _pairs(pairs, axes):
    axes = axes_or_new(axes)
    shown = [p for p in pairs if p.to_dict().get("relative_error") is not None]
    axes.plot([p.measured_hz for p in shown], [100 * p.relative_error for p in shown], "o")
    axes.axhline(0, linewidth=0.8)
    axes.set_xlabel("measured, Hz")
    axes.set_ylabel("model against test, %")
    return axes


# By the name of the result's class: results.py calls plot(), so its classes are not imported here.
_PLOTS = {
    "FrfResult": lambda r, axes: _frf(r, axes, r.response_names, r.input_names, f", {r.units}"),
    "SceneFrfs": lambda r, axes: _frf(r, axes, r.sensors, r.loads), "ModalResult": _modal, "DecayResult": _decay,
    "BendingResult": _bending, "AxialResult": _budget, "ModesResult": _modes, "RespondResult": _respond,
    "UpdateResult": lambda r, axes: _pairs(r.pairs, axes), "TensionResult": lambda r, axes: _pairs(r.modes, axes),
}


def plot(result, axes=None):
    """The plot that belongs to a result."""
    name = type(result).__name__
    if name not in _PLOTS:
        raise Error(f"{name} has no plot", code="no_plot")
    return _PLOTS[name](result, axes)
