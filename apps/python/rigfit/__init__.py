"""rigfit: recordings of cables and beams into parameters of a model, with uncertainty.

The functions are those of the program ``rigfit`` and give the same numbers to the last digit. They take files or what is
at hand (recordings, FRFs, scenes, results), release the interpreter's lock while they work, and raise one family of
exceptions, `Error`.

>>> import rigfit
>>> result = rigfit.decay("tap.csv", "tension")        # doctest: +SKIP
>>> result.modes[0].frequency_hz.value                 # doctest: +SKIP
"""

import atexit as _atexit
import os as _os
import sys as _sys

from . import _core
from ._core import FrfSet
from .errors import (ArgumentError, DataWarning, Error, InputError, InternalError, NotConverged, Refused, UsageError)
from .functions import (axial, bending, decay, frf, inspect, modal, modes, predict, read, report, resample, respond, synthesize,
                        tension, update)
from .model import Scene, frf_of
from .recordings import Channel, Recording
from .results import (AxialResult, BendingResult, DecayResult, Estimate, FrfResult, InspectResult, ModalResult,
                      ModesResult, PredictResult, Record, Records, ReportResult, ResampleResult, RespondResult, Result, SceneFrfs,
                      SynthesizeResult, TensionResult, UpdateResult)

__version__ = _core.version

__all__ = sorted(name for name, one in globals().items()
                 if not name.startswith("_") and getattr(one, "__module__", "").startswith(__name__))


def __dir__():
    """What one calls."""
    return [*__all__, "__version__"]


def _leave():
    """An interrupted call may still work on a thread of its own: the process ends without waiting for it."""
    if _core.abandoned_calls():
        for stream in (_sys.stdout, _sys.stderr):
            try:
                stream.flush()
            except (OSError, ValueError, AttributeError):
                pass
        _os._exit(130)


_atexit.register(_leave)
