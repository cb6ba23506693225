"""Types of the package; `tests/python/stubs_test.py` holds them against what it is."""

from collections.abc import Iterator, Mapping, Sequence
import os
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_Path = str | os.PathLike[str]
_Value = float | tuple[float, float] | Estimate
_Source = _Path | Recording | Sequence[Mapping[str, Any] | Channel]
_Sources = _Source | Sequence[_Source]
_SceneLike = Scene | _Path | Mapping[str, Any]

def inspect(recordings: _Sources, *, sample_rate: float | None = None) -> InspectResult: ...

def resample(
    recording: _Source, rate: float | None = None, *, out: _Path | None = None, sample_rate: float | None = None
) -> ResampleResult: ...

def decay(
    recording: _Source, channel: str | None = None, *, start: float | None = None, end: float | None = None,
    band: tuple[float, float] | None = None, each: bool = False, max_modes: int | None = None,
    sample_rate: float | None = None, threads: int | None = None, seed: int | None = None
) -> DecayResult: ...

def frf(
    recordings: _Sources, force: str, response: str | Sequence[str] | None = None, *,
    band: tuple[float, float] | None = None, out: _Path | None = None, csv: _Path | None = None,
    encoding: Literal["binary", "ascii"] = 'binary', threads: int | None = None, seed: int | None = None,
    **hits: Any
) -> FrfResult: ...

def modal(
    frfs: FrfResult | FrfSet | _Sources, *, force: str | None = None, response: str | Sequence[str] | None = None,
    band: tuple[float, float] | None = None, order: int | None = None, max_damping: float | None = None,
    averages: int | None = None, out: _Path | None = None, synthesis: _Path | None = None, threads: int | None = None,
    seed: int | None = None, **hits: Any
) -> ModalResult: ...

def bending(
    recordings: _Sources | Mapping[str, ArrayLike] | Sequence[Mapping[str, ArrayLike]], *, span: float | None = None,
    span_std: float | None = None, tension: str | Literal[0] | None = None,
    ends: Literal["clamped", "pinned", "cantilever"] | None = None, rectangle: tuple[float, float] | None = None,
    diameter: float | None = None, second_moment: float | None = None, section_std: float | None = None,
    load: str | None = None, deflection: str | None = None, load_calibration: float | None = None,
    deflection_calibration: float | None = None, tension_zero_std: float | None = None,
    tension_calibration: float | None = None, strand: Sequence[float] | None = None,
    relative_std: float | None = None, EA: float | None = None, mass_per_length: float | None = None
) -> BendingResult: ...

def axial(
    recordings: _Sources, *, mass: float, length: float | Sequence[float], channel: str | None = None,
    mass_per_length: float | None = None, mass_std: float | None = None, length_std: float | None = None,
    mass_per_length_std: float | None = None, adapter_stiffness: float | None = None,
    adapter_stiffness_std: float | None = None, adapter_bar: Sequence[float] | None = None,
    compliance_std: float | None = None, catalogue_EA: float | None = None, band: tuple[float, float] | None = None,
    sample_rate: float | None = None, draws: int | None = None, threads: int | None = None, seed: int | None = None,
    frame_stiffness: float | Literal["rigid"] | None = None, frame_stiffness_std: float | None = None
) -> AxialResult: ...

def tension(
    recordings: _Sources | None = None, *, length: _Value, mass_per_length: _Value,
    frequencies: ArrayLike | None = None, frequency_std: float | None = None,
    measured: _Path | ModalResult | Sequence[Mapping[str, Any]] | None = None, column: str | None = None,
    channel: str | Sequence[str] | None = None, band: tuple[float, float] | None = None,
    max_peaks: int | None = None, sample_rate: float | None = None, plane: Literal["any", "in", "out"] = 'any',
    mass_of: Literal["installed", "unstretched"] | None = None, EI: _Value | None = None, EA: _Value | None = None,
    inclination: float | None = None, ends: Literal["compare", "pinned", "clamped", "springs"] = 'compare',
    missed: float | None = None, false_mode: float | None = None, threads: int | None = None,
    seed: int | None = None
) -> TensionResult: ...

def tension_table(
    table: _Path | Sequence[Mapping[str, Any]] | Any, *, out: _Path | None = None, missed: float | None = None,
    false_mode: float | None = None, threads: int | None = None, seed: int | None = None
) -> TensionTableResult: ...

def modes(
    scene: _SceneLike, *, count: int | None = None, band: tuple[float, float] | None = None,
    segments: int | None = None, rotary_inertia: Literal["accurate", "rigid_rod"] = 'accurate',
    torsion: Literal["auto", "on", "off"] = 'auto', shapes: bool = False
) -> ModesResult: ...

def frf_of(
    scene: _SceneLike, frequency_hz: ArrayLike, *, segments: int | None = None,
    exponential_window: float | None = None
) -> SceneFrfs: ...

def respond(
    scene: _SceneLike, *, duration: float, rate: float, out: _Path | None = None, energy: _Path | None = None,
    solver: str = 'auto', plane: Literal["auto", "on", "off"] = 'auto',
    torsion: Literal["auto", "on", "off"] = 'auto', axial: Literal["auto", "on", "off"] = 'auto',
    segments: int | None = None, step: float | None = None, tolerance: float | None = None
) -> RespondResult: ...

def update(
    scene: _SceneLike | Sequence[_SceneLike], *,
    measured: _Path | ModalResult | ArrayLike | Sequence[Any] | None = None, frf: _Path | Sequence[_Path] | None = None,
    decay: _Path | Sequence[_Path] | None = None, response: _Path | Sequence[_Path] | None = None,
    free: str | Sequence[str] | None = None, prior: Mapping[str, _Value] | None = None,
    tension: float | Sequence[float] | None = None, plane: str | Sequence[str] | None = None,
    column: str | None = None, compare: str | Sequence[str] | None = None, node: str | Sequence[str] | None = None,
    channel: str | None = None, band: tuple[float, float] | None = None,
    stiffness: _Path | BendingResult | None = None, stiffness_std: float | None = None,
    axial: _Path | AxialResult | None = None, axial_damping: bool = False, input: str | Sequence[str] | None = None,
    aim: str | Sequence[str] | None = None, candidates: _Path | None = None,
    ends: str | Sequence[str] | None = None, profile: bool = False, assumed_std: float | None = None,
    model_std: float | None = None, frf_model_std: float | None = None, shape_std: float | None = None,
    segments: int | None = None, starts: int | None = None, start_spread: float | None = None,
    hold_out: bool = False, monte_carlo: int | None = None, threads: int | None = None, seed: int | None = None
) -> UpdateResult: ...

def predict(
    scene: _SceneLike, fit: UpdateResult | _Path, *, map: Mapping[str, str] | None = None, count: int | None = None,
    segments: int | None = None, measured: _Path | ModalResult | ArrayLike | Sequence[Mapping[str, Any]] | None = None,
    column: str | None = None, plane: Literal["any", "in", "out"] = 'any',
    damage: str | Sequence[str] | None = None, frf: _Path | None = None, band: tuple[float, float] | None = None,
    lines: int | None = None, response: _Path | None = None, duration: float | None = None, rate: float | None = None,
    sample: bool = False, threads: int | None = None, seed: int | None = None,
    input: str | Sequence[str] | None = None
) -> PredictResult: ...

def synthesize(
    scene: _SceneLike, out: _Path, *, seed: int | None = None, hits: int | None = None, double_hits: int | None = None,
    record: float | None = None, rate: float | None = None, finer: int | None = None,
    tension: float | Sequence[float] | None = None, tension_std: float | None = None, stiffness: _Path | None = None,
    format: Literal["csv", "uff"] = 'csv', accelerometer_mass: float | None = None,
    bending_span: float | None = None, bending_load: float | None = None,
    axial_length: float | Sequence[float] | None = None, axial_length_std: float | None = None,
    axial_mass: float | None = None, axial_damping: float | None = None, taps: int | None = None,
    threads: int | None = None
) -> SynthesizeResult: ...

def report(
    campaign: _Path | Sequence[_Path], out: _Path, *, style: Literal["lab", "client"] = 'lab', pdf: bool = False,
    force: bool = False, figure_size: tuple[float, float] | None = None, figure_font: str | None = None,
    figure_font_size: float | None = None, threads: int | None = None, seed: int | None = None
) -> ReportResult: ...

def read(
    file: _Path, sample_rate: float | None = None, *,
    format: Literal["csv", "lvm", "uff", "wav", "npy", "mat"] | None = None, decimal: Literal[".", ","] | None = None,
    separator: Literal[",", ";", "\t", " "] | None = None, time_unit: Literal["s", "ms", "us", "min"] | None = None,
    variable: str | Sequence[str] | None = None
) -> Recording: ...

def read_frfs(file: _Path) -> FrfSet: ...

def frfs_of_arrays(
    frequency_hz: ArrayLike, H: ArrayLike, *, form: Literal["receptance", "mobility", "accelerance"],
    responses: Sequence[str] | None = None, inputs: Sequence[str] | None = None, coherence: ArrayLike | None = None,
    averages: int | None = None, exponential_window: float | None = None
) -> FrfSet: ...

class Error(Exception):
    def __init__(
        self, message: str, *, code: str | None = None, argument: str = '', file: str = '', line: int = 0,
        column: int = 0, channel: str = '', key: str = '', value: str = '', problem: str = '', remedy: str = '',
        where: str = '', result: Result | None = None
    ) -> None: ...
    code: str
    exit_code: int
    message: str
    argument: str
    file: str
    line: int
    column: int
    channel: str
    key: str
    value: str
    problem: str
    remedy: str
    where: str
    result: Result | None

class ArgumentError(Error, ValueError, TypeError): ...
class UsageError(Error, ValueError): ...
class InputError(Error): ...
class Refused(Error): ...
class NotConverged(Error): ...
class InternalError(Error): ...
class DataWarning(UserWarning): ...

class Channel:
    def __init__(self, fields: Mapping[str, Any], fs: float) -> None: ...
    name: str
    unit: str
    source_unit: str
    quantity: str
    data: NDArray[np.float64]
    fs: float
    missing_samples: int
    direction: tuple[float, float, float]
    def to_sep005(self) -> dict[str, Any]: ...
    def __len__(self) -> int: ...

class Recording(Sequence[Channel]):
    def __init__(
        self, channels: Sequence[Mapping[str, Any] | Channel] | Mapping[str, ArrayLike], fs: float | None = None,
        units: Mapping[str, str] | None = None, start_time_s: float = 0.0, name: str = 'recording'
    ) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def format(self) -> str: ...
    @property
    def fs(self) -> float: ...
    @property
    def start_time_s(self) -> float: ...
    @property
    def time_s(self) -> NDArray[np.float64]: ...
    @property
    def channels(self) -> list[Channel]: ...
    @property
    def notes(self) -> Records: ...
    def __len__(self) -> int: ...
    @overload
    def __getitem__(self, key: int) -> Channel: ...
    @overload
    def __getitem__(self, key: str) -> Channel: ...
    @overload
    def __getitem__(self, key: slice) -> list[Channel]: ...
    def to_sep005(self) -> list[dict[str, Any]]: ...
    def to_dict(self) -> dict[str, Any]: ...
    def to_frame(self) -> Any: ...
    def plot(self, axes: Any = None) -> Any: ...

class Scene:
    def __init__(self, scene: _Path | Mapping[str, Any]) -> None: ...
    @property
    def title(self) -> str: ...
    @property
    def nodes(self) -> list[str]: ...
    @property
    def members(self) -> list[str]: ...
    @property
    def loads(self) -> list[str]: ...
    @property
    def sensors(self) -> list[str]: ...
    @property
    def parameters(self) -> dict[str, float]: ...
    def with_parameters(self, values: Mapping[str, float]) -> Scene: ...
    def to_toml(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...
    def write(self, file: _Path) -> None: ...

class FrfSet:
    @property
    def frequency_hz(self) -> NDArray[np.float64]: ...
    @property
    def H(self) -> NDArray[np.complex128]: ...
    @property
    def H_std(self) -> NDArray[np.float64] | None: ...
    @property
    def coherence(self) -> NDArray[np.float64] | None: ...
    @property
    def responses(self) -> list[str]: ...
    @property
    def inputs(self) -> list[str]: ...
    @property
    def form(self) -> str: ...
    @property
    def unit(self) -> str: ...

class Estimate:
    def __init__(self, fields: Mapping[str, Any]) -> None: ...
    value: float | None
    std: float | None
    low: float | None
    high: float | None
    def __float__(self) -> float: ...
    def to_dict(self) -> dict[str, Any]: ...
    def to_ufloat(self) -> Any: ...

class Record(Mapping[str, Any]):
    def __init__(self, fields: Mapping[str, Any]) -> None: ...
    def __getattr__(self, name: str) -> Any: ...
    def __getitem__(self, name: str) -> Any: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...
    def to_dict(self) -> dict[str, Any]: ...

class Records(list[Any]):
    def to_dict(self) -> list[Any]: ...
    def table(self) -> dict[str, list[Any]]: ...
    def to_frame(self) -> Any: ...

class Result(Record):
    def __init__(self, fields: Mapping[str, Any], **extra: Any) -> None: ...
    main: str
    rigfit: str
    command: str
    inputs: Records
    warnings: Records
    def to_frame(self) -> Any: ...
    def plot(self, axes: Any = None) -> Any: ...

class InspectResult(Result):
    recordings: Records

class ResampleResult(Result):
    recording: Recording
    channels: Records
    from_hz: float
    sample_rate_hz: float

class DecayResult(Result):
    channel: str
    unit: str
    modes: Records
    decays: Records

class FrfResult(Result):
    hits: Records
    averages: int
    units: str
    @property
    def frequency_hz(self) -> NDArray[np.float64]: ...
    @property
    def H(self) -> NDArray[np.complex128]: ...
    @property
    def H_std(self) -> NDArray[np.float64] | None: ...
    @property
    def coherence(self) -> NDArray[np.float64] | None: ...
    @property
    def response_names(self) -> list[str]: ...
    @property
    def input_names(self) -> list[str]: ...

class ModalResult(Result):
    modes: Records
    frfs: FrfSet
    auto_mac: list[list[float]]

class BendingResult(Result):
    tests: Records
    laws: Records

class AxialResult(Result):
    EA_N: Estimate
    damping_ratio: Estimate
    damping_Ns_m: Estimate
    samples: Records
    budget: Records

class ModesResult(Result):
    modes: Records
    equilibrium: Record
    relative_error_estimate: float

class SceneFrfs(Result):
    frequency_hz: NDArray[np.float64]
    H: NDArray[np.complex128]
    sensors: list[str]
    loads: list[str]
    units: list[str]

class RespondResult(Result):
    time_s: NDArray[np.float64]
    response: NDArray[np.float64]
    sensors: Records
    solver: str
    nonlinear: bool

class UpdateResult(Result):
    parameters: Records
    pairs: Records
    alternatives: Records
    fit: Record
    covariance: NDArray[np.float64] | None
    fitted_scenes: list[Scene]
    candidates: Records
    averaged: Records

class TensionResult(Result):
    tension_N: Estimate
    EI_Nm2: Estimate
    ends: str
    candidates: Records
    modes: Records
    formulas: Record
    budget: Records

class TensionTableResult(Result):
    cables: Records

class PredictResult(Result):
    title: str
    modes: Records
    interval: str
    parameters_used: list[str]
    parameters_not_used: list[str]
    measured: Records
    damage: Records
    response: Record

class SynthesizeResult(Result):
    files: list[str]

class ReportResult(Result):
    title: str
    answers: Records
    summary: Records
