"""Results: the program's JSON documents as objects, with values that carry their uncertainty."""

from collections.abc import Mapping
import copy
import html
import importlib
import pathlib
import tempfile

import numpy as np

from .errors import Error


def _package(name, use):
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise Error(f"{use} needs the package {name} (Debian: python3-{name})", code="not_installed") from error


def pandas():
    """The package, where it is installed."""
    return _package("pandas", "to_frame()")


class Numbers(np.ndarray):
    """Values of a field over a list, with the ``std`` of each where the field is an estimate."""

    std = None


class Records(list):
    """A list of records; a field of all of them is an attribute: ``modes.frequency_hz``, ``modes.frequency_hz.std``."""

    def __getattr__(self, name):
        found = [one.get(name) for one in self if isinstance(one, Record)]
        if name.startswith("_") or not any(name in one for one in self if isinstance(one, Record)):
            raise AttributeError(f"no entry has {name!r}")
        if not all(one is None or isinstance(one, (int, float, Estimate)) for one in found):
            return found

        def numbers(values):
            return np.array([np.nan if one is None else one for one in values], dtype=float).view(Numbers)
        if any(isinstance(one, Estimate) for one in found):
            values = numbers([one and one.value for one in found])
            values.std = numbers([one and one.std for one in found])
            return values
        return numbers(found)

    def to_dict(self):
        """As in the JSON document."""
        return [one.to_dict() if isinstance(one, Record) else one for one in self]

    def to_frame(self, all=False):
        """A pandas.DataFrame, a row a record; an estimate is two columns, ``x`` and ``x_std``. ``all``: also ``x_low`` and what is nested."""
        rows = pandas().json_normalize(self.to_dict(), sep=".")
        kept = [name for name in rows if (all or "." not in name or name.endswith((".value", ".std"))) and
                not rows[name].map(lambda cell: isinstance(cell, list)).any()]
        return rows[kept].rename(columns=lambda name: name.removesuffix(".value").replace(".", "_"))

    def _repr_html_(self):
        """Twenty rows of five columns; further columns stand behind a fold."""
        keys = dict.fromkeys(key for one in self for key in one if not isinstance(one[key], (list, Record)) or
                             isinstance(one[key], Estimate))

        def table(names):
            rows = [names] + [[_shown(one.get(name)) for name in names] for one in self[:20]]
            return "<table>" + "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>"
                                       for row in rows) + "</table>"
        first, rest = list(keys)[:5], list(keys)[5:]
        more = f"<p>{len(self) - 20} more</p>" if len(self) > 20 else ""
        return table(first) + more + (f"<details><summary>more columns</summary>{table(rest)}</details>" if rest else "")


def _shown(value):
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


NAMED = {"name", "source", "key"}  # a row of parameters, of a budget or of answers, not an estimate


def wrapped(value):
    """What an attribute gives: Estimate, Record, Records or the plain value."""
    if isinstance(value, dict):
        return Estimate(value) if {"value", "std"} <= set(value) and not NAMED & set(value) else Record(value)
    if isinstance(value, list) and all(isinstance(one, dict) for one in value):
        return Records(wrapped(one) for one in value)
    return value


class Record(Mapping):
    """Named entries of a document: as attributes and by ``[name]``."""

    def __init__(self, fields):
        self.__dict__["_fields"] = fields

    def __getattr__(self, name):
        fields = self.__dict__.get("_fields", {})
        if name in fields:
            return wrapped(fields[name])
        raise AttributeError(f"{type(self).__name__} has no {name!r}; there are: {', '.join(fields)}")

    def __setattr__(self, name, value):
        raise AttributeError(f"{type(self).__name__} cannot be changed")

    def __getitem__(self, name):
        return wrapped(self._fields[name])

    def __iter__(self):
        return iter(self._fields)

    def __len__(self):
        return len(self._fields)

    def __dir__(self):
        return sorted({*super().__dir__(), *self._fields})

    def to_dict(self):
        """As in the JSON document."""
        return copy.deepcopy(self._fields)

    def __repr__(self):
        shown = ", ".join(f"{key}={_shown(value)}" if not isinstance(value, (dict, list)) else
                          f"{key}={wrapped(value)!s}" if isinstance(wrapped(value), Estimate) else key
                          for key, value in self._fields.items())
        return f"{type(self).__name__}({shown})"


def _number(key, doc):
    def get(self) -> "float | None":
        return self._fields.get(key)
    return property(get, doc=doc)


class Estimate(Record):
    """A value with its standard uncertainty, and the ends of its 95 % interval where they are known.

    Attributes
    ----------
    value, std : float or None
        None: there is no such number.
    low, high : float or None
    """

    value, std = _number("value", "Best value."), _number("std", "Its standard uncertainty.")
    low, high = _number("low", "Lower end of the interval."), _number("high", "Upper end of the interval.")

    def __float__(self):
        if self.value is None:
            raise Error("there is no value", code="no_value")
        return float(self.value)

    def to_ufloat(self):
        """``uncertainties.ufloat(value, std)``, where that package is installed."""
        uncertainties = _package("uncertainties", "to_ufloat()")
        if self.std is None:
            raise Error("there is no standard uncertainty", code="no_value")
        return uncertainties.ufloat(float(self), self.std)

    def __repr__(self):
        return f"Estimate({self})"

    def __str__(self):
        value = "-" if self.value is None else f"{self.value:.7g}"
        return value if self.std is None else f"{value} +- {self.std:.2g}"


class Picture(str):
    """An SVG, which a notebook shows."""

    def _repr_svg_(self):
        return str(self)


class Result(Record):
    """What a function found: the JSON document of the verb of that name.

    Every key of the document is an attribute. ``warnings`` ask for something or cast doubt on an answer, ``notes`` say what was
    done. Printed, it is the text of the program.
    """

    main = ""  #: the list that `to_frame` makes a table of
    rigfit: str
    command: str
    inputs: "Records"
    warnings: "Records"
    notes: "Records"

    def __init__(self, fields, printed="", **extra):
        super().__init__(fields)
        self.__dict__.update(extra, _printed=printed)

    def __repr__(self):
        return self._printed.rstrip("\n") or super().__repr__()

    def to_frame(self, all=False):
        """A pandas.DataFrame of the main list of the result; ``all``: every column."""
        rows = wrapped(self._fields.get(self.main, []))
        return rows.to_frame(all) if isinstance(rows, Records) else pandas().DataFrame()

    def __getstate__(self):
        return {key: one for key, one in self.__dict__.items() if key != "_work"}  # copies do no work

    def plot(self):
        """The picture that ``plot=F.svg`` writes, for a notebook; the work is done again for it."""
        if "_work" not in self.__dict__:
            raise Error("there is no picture of this result", code="no_plot")
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "plot.svg")
            self.__dict__["_work"](plot=str(file))
            return Picture(file.read_text(encoding="utf-8"))

    def _repr_html_(self):
        rows = wrapped(self._fields.get(self.main, []))
        lines = repr(self).splitlines()
        rest = [f"... {len(lines) - 80} lines more: print(result)"] if len(lines) > 80 else []
        printed = f"<pre>{html.escape(chr(10).join(lines[:80] + rest))}</pre>"
        return rows._repr_html_() + f"<details><summary>as printed</summary>{printed}</details>" if isinstance(rows, Records) and rows else printed


def _result(name, main, doc, base=object, **kinds):
    """The class of a verb's results: the list that `to_frame` makes a table of, and types of keys for editors."""
    members = {key: one for key, one in vars(base).items() if base is not object and key not in ("__dict__", "__weakref__")}
    return type(name, (Result,), {**members, "__doc__": doc, "__annotations__": kinds, "__module__": __name__, "main": main})


class _WithFrfs:
    def _arrays(self):
        frfs = self.__dict__.get("frfs")
        if frfs is None:
            raise Error("no hit was accepted: there are no FRFs", code="no_frfs")
        return frfs

    frequency_hz = property(lambda self: self._arrays().frequency_hz, doc="Lines, Hz.")
    H = property(lambda self: self._arrays().H, doc="lines x responses x inputs, SI per N, sign exp(+i 2 pi f t).")
    H_std = property(lambda self: self._arrays().H_std, doc="Of the real and of the imaginary part, each; None: not known.")
    coherence = property(lambda self: self._arrays().coherence, doc="Layout of H; None: not known.")
    response_names = property(lambda self: self._arrays().responses, doc="Names along the second axis of H.")
    input_names = property(lambda self: self._arrays().inputs, doc="Names along the third axis of H.")


class _WithSamples:
    def to_frame(self):
        """A pandas.DataFrame, a column a sensor over time in s."""
        names = [sensor["name"] for sensor in self._fields["sensors"]]
        return pandas().DataFrame({name: self.__dict__["response"][:, i] for i, name in enumerate(names)}, self.time_s)


InspectResult = _result("InspectResult", "recordings", "Quality of recordings: ``recordings``.")
ResampleResult = _result("ResampleResult", "channels", "A recording at another rate: ``recording``; ``channels`` with ``error_rms``.")
DecayResult = _result(
    "DecayResult", "modes", "Free decay: ``modes``, strongest first, ``decays``, ``frequency_drift_hz``, ``amplitude_dependence``.")
FrfResult = _result("FrfResult", "hits", "Averaged FRFs of hits: ``hits``, ``averages`` and the arrays.", base=_WithFrfs,
                    averages="int", units="str")
ModalResult = _result(
    "ModalResult", "modes", "Modes of FRFs: ``modes`` with ``frequency_hz``, ``damping_ratio``, ``shape``; ``stabilisation`` ...",
    auto_mac="list[list[float]]")
BendingResult = _result("BendingResult", "tests", "EI at each tension: ``tests``, ``laws``, ``curve``, ``bounds``.")
AxialResult = _result(
    "AxialResult", "samples", "Hanging-mass test: ``EA_N``, ``damping_ratio``, ``damping_Ns_m``, ``samples``, ``budget``.")
ModesResult = _result("ModesResult", "modes", "Natural modes of a scene.", relative_error_estimate="float")
SceneFrfs = _result(
    "SceneFrfs", "", "FRFs of a scene: ``frequency_hz`` and ``H``, lines x sensors x loads; ``sensors``, ``loads``, ``units``.",
    sensors="list[str]", loads="list[str]", units="list[str]", H="NDArray[Any]", frequency_hz="NDArray[Any]")
RespondResult = _result("RespondResult", "sensors", "Time response: ``time_s``, ``response`` (rows x sensors).", base=_WithSamples,
                        sensors="Records", time_s="NDArray[Any]", response="NDArray[Any]")
UpdateResult = _result(
    "UpdateResult", "parameters", "A fit: ``parameters``, ``pairs``, ``alternatives``, ``fit``; ``covariance`` of the parameters in "
    "their order (None where one of them cannot be identified), ``fitted_scenes``.\n\nWhere models were compared, it is of the "
    "heaviest, with ``candidates`` and ``averaged``.",
    candidates="Records", averaged="Records", fitted_scenes="list[Scene]", covariance="NDArray[Any] | None")
TensionResult = _result(
    "TensionResult", "modes", "Tension of a cable: ``tension_N``, ``EI_Nm2``, ``candidates``, ``modes``, ``formulas``, ``budget``.",
    EI_Nm2="Estimate")
PredictResult = _result(
    "PredictResult", "modes", "Modes of another scene with a fit's parameters: ``modes`` (``frequency_hz`` with low, high), "
    "``interval``; ``measured`` where it was compared.",
    interval="str", parameters_used="list[str]", measured="Records")
SynthesizeResult = _result("SynthesizeResult", "", "Files that a virtual laboratory wrote: ``files``.")
ReportResult = _result(
    "ReportResult", "answers", "The document of a report: ``answers``, ``summary``, ``fits`` ...; the page is ``report.html``.")
