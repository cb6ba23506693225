"""Misuse: every call either works or raises rigfit.Error (or what Python itself raises for unknown arguments) that names
the argument and the reason; a thousand random misuses without a crash."""

import inspect
import io
import os
import pathlib
import random
import shutil
import tempfile
import unittest
import warnings

import numpy as np

import rigfit

SOURCE = pathlib.Path(os.environ["RIGFIT_SOURCE"])
FOLDER = tempfile.TemporaryDirectory()
CABLE = shutil.copy(SOURCE / "testdata/jalali2021/scenes/cable.toml", FOLDER.name)  # what is written over it is lost
MISUSES = 1000
CLOSED = io.StringIO("1,2\n")
CLOSED.close()
READ_ONLY = np.arange(64.0)
READ_ONLY.setflags(write=False)
MISALIGNED = np.zeros(8 * 8 + 1, dtype=np.uint8)[1:].view(np.float64)
GOOD = rigfit.Recording({"force": np.sin(np.arange(64.0)), "a": np.cos(np.arange(64.0))}, fs=64.0)

# What a person passes by mistake.
ODD = [None, True, 0, -1, 1, 2, 7, 2**70, -2**70, 0.0, -0.5, 0.5, 1e-320, 1e308, float("nan"), float("inf"), 1 + 2j, "",
       "x", "#0", "#99", "force", "a\0b", "\ud800", "no/such/file.csv", b"bytes", [], [1], [1, 2], [2, 1], [1.0, float("nan")],
       ["a", 1], (), {}, {"a": 1}, {"name": "a"}, {"name": "a", "data": [1, 2]}, {"a": [1, 2]}, {"a": []}, object(), CLOSED,
       io.BytesIO(), np.zeros(0), np.zeros((2, 2)), np.zeros((2, 3, 4)), np.array(3.0), np.arange(8), np.arange(8.0)[::2],
       np.arange(8.0)[::-1], np.arange(8, dtype=np.float32), np.arange(8, dtype=np.complex64), np.array(["a", "b"]),
       np.array([1, None], dtype=object), np.full(8, np.nan), np.full(8, np.inf), np.zeros(8, dtype=bool), READ_ONLY, MISALIGNED,
       np.ma.masked_array([1.0, 2.0], [True, False]), np.asfortranarray(np.zeros((3, 3))),
       np.zeros(8, dtype=">f8"), np.float32(2), np.int8(3), range(4), lambda: 0, rigfit.Recording, GOOD, [GOOD, GOOD],
       pathlib.Path("/"), pathlib.Path(CABLE), CABLE, "title = 1\n", rigfit.Scene(CABLE), ...]

# Every argument of every function, and of these one that there is not.
FUNCTIONS = {function: [*inspect.signature(function).parameters, "no_such"] for function in (
    rigfit.read, rigfit.Recording, rigfit.inspect, rigfit.resample, rigfit.decay, rigfit.frf, rigfit.modal,
    rigfit.bending, rigfit.axial, rigfit.tension, rigfit.Scene, rigfit.modes, rigfit.frf_of,
    rigfit.respond, rigfit.update, rigfit.predict, rigfit.synthesize, rigfit.report)}
# Arguments that make a call whole, so that one wrong among them is met where it is used; small, that what works is quick.
WHOLE = {
    rigfit.decay: {"recording": GOOD, "channel": "a"},
    rigfit.resample: {"recording": GOOD, "rate": 32.0},
    rigfit.frf: {"recordings": GOOD, "force": "force"},
    rigfit.modal: {"frfs": GOOD, "force": "force"},
    rigfit.bending: {"recordings": {"tension_N": [25, 100], "EI_Nm2": [0.2, 0.4]}},
    rigfit.axial: {"recordings": GOOD, "mass": 1.0, "length": 1.0, "channel": "a"},
    rigfit.tension: {"frequencies": [7.4], "length": 2.4, "mass_per_length": 0.17, "ends": "pinned", "EI": 0.5},
    rigfit.predict: {"scene": CABLE, "fit": "fit.json", "count": 1, "segments": 8, "lines": 3, "duration": 0.01},
    rigfit.modes: {"scene": CABLE, "count": 1},
    rigfit.frf_of: {"scene": CABLE, "frequency_hz": [1.0]},
    rigfit.respond: {"scene": CABLE, "duration": 0.01, "rate": 100.0, "solver": "modal", "segments": 8},
    rigfit.update: {"scene": CABLE, "measured": [7.4], "starts": 1, "segments": 8},
    rigfit.synthesize: {"scene": CABLE, "out": "out", "hits": 1, "double_hits": 0, "record": 0.2, "rate": 200.0,
                        "finer": 1},
    rigfit.report: {"campaign": "campaign.toml", "out": "out"},
}
# Sizes that are right and only slow.
SLOW = {("count", 7), ("segments", 2**70), ("taps", 7)}


# Arguments that name files to write.
WRITTEN = {"out", "csv", "frf", "response", "synthesis", "plot"}


class Misuse(unittest.TestCase):
    def setUp(self):
        warnings.simplefilter("ignore")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        pathlib.Path("fit.json").write_text('{"parameters": [{"name": "cable.EI", "value": 0.5, "std": 0.01}]}')
        pathlib.Path("ei.csv").write_text("tension_N,EI_Nm2\n25,0.25\n100,0.49\n200,0.59\n")
        pathlib.Path("campaign.toml").write_text(
            'title = "one test"\n[[test]]\nname = "bending"\nkind = "bending"\nspan = 1.0\n'
            '[test.table]\nfile = "ei.csv"\ntension = "tension_N"\nEI = "EI_Nm2"\n')

    def wrong(self, argument, reason, function, *args, **kwargs):
        with self.assertRaises(rigfit.ArgumentError) as caught:
            function(*args, **kwargs)
        self.assertIn(argument, str(caught.exception))
        self.assertIn(argument.partition("[")[0], caught.exception.argument)
        self.assertRegex(str(caught.exception), reason)
        self.assertEqual(caught.exception.code, "argument")
        self.assertIsInstance(caught.exception, ValueError)

    def test_argument_and_reason(self):
        x = np.arange(8.0)
        self.wrong("channels[1].data", "2 dimensions|1 dimension", rigfit.Recording, {"a": x, "b": np.zeros((2, 4))})
        self.wrong("channels[0].data", "no elements", rigfit.Recording, {"a": []})
        self.wrong("channels[0].data", "infinite", rigfit.Recording, {"a": np.full(3, np.inf)})
        self.wrong("channels[0].data", "complex", rigfit.Recording, {"a": x + 1j})
        self.wrong("channels[0].data", "numbers", rigfit.Recording, {"a": ["1", "2"]})
        self.wrong("channels", "a 8, b 7", rigfit.Recording, {"a": x, "b": x[:7]})
        self.wrong("fs", "finite", rigfit.Recording, {"a": x}, fs=float("nan"))
        self.wrong("fs", "positive", rigfit.Recording, {"a": x}, fs=0)
        self.wrong("fs", "same of all", rigfit.Recording, [{"name": "a", "data": x, "fs": 1.0},
                                                           {"name": "b", "data": x, "fs": 2.0}])
        self.wrong("file", "file object", rigfit.read, CLOSED)
        self.wrong("recordings", "file object", rigfit.frf, CLOSED, "force")
        self.wrong("recordings", "is a dict", rigfit.frf, {"a": x}, "force")
        self.wrong("band", "rise", rigfit.frf, GOOD, "force", band=(5, 1))
        self.wrong("band[1]", "finite", rigfit.frf, GOOD, "force", band=(5, float("nan")))
        self.wrong("estimator", "h1, h2, hv", rigfit.frf, GOOD, "force", estimator="h3")
        self.wrong("no_such", "no argument", rigfit.frf, GOOD, "force", no_such=1)
        self.wrong("mas", "did you mean mass", rigfit.axial, GOOD, mas=1.0, length=1.0)
        self.wrong("mass", "number", rigfit.axial, GOOD, mass="1 kg", length=1.0)
        self.wrong("count", "whole number", rigfit.modes, CABLE, count=2.5)
        self.wrong("frequency_hz", "negative", rigfit.frf_of, CABLE, [-1.0])
        self.wrong("measured[0].plane", "in, out, any", rigfit.update, CABLE,
                   measured=[{"frequency_hz": 7.0, "plane": "up"}])
        self.wrong("plane", "in, out, any", rigfit.update, CABLE, measured=[7.4], plane=["in", "up"])
        self.wrong("out", "no folder no/such", rigfit.resample, GOOD, 32.0, out="no/such/file.csv")
        self.wrong("csv", "is a folder", rigfit.frf, GOOD, "force", csv="/")
        self.wrong("fit", "is a folder", rigfit.predict, CABLE, "/")
        self.wrong("axial", "is a folder", rigfit.update, CABLE, measured=[7.4], axial="/")
        self.wrong("decimal", "one of", rigfit.read, "ei.csv", decimal=";")
        self.wrong("map", "dict", rigfit.predict, CABLE, "fit.json", map="cable.EI")
        self.wrong("measured[0]", "unknown entry 'x'", rigfit.update, CABLE, measured=[{"frequency_hz": 7.0, "x": 1}])

    def test_missing_samples_are_said(self):
        data = np.sin(np.arange(256.0))
        data[100:110] = np.nan
        one = rigfit.Recording({"force": data, "a": data}, fs=64)
        self.assertEqual(one["a"].missing_samples, 10)
        self.assertEqual(rigfit.inspect(one).recordings[0].channels[0].missing_samples, 10)

    def test_random_misuse(self):
        rng = random.Random(7)
        calls = refused = 0
        met = dict.fromkeys(FUNCTIONS, 0)
        for _ in range(MISUSES):
            function = rng.choice(list(FUNCTIONS))
            met[function] += 1
            names = FUNCTIONS[function]
            arguments = dict(WHOLE.get(function, {})) if rng.random() < 0.8 else {}
            for name in rng.sample(names, min(len(names), rng.choice((1, 1, 1, 2, 3)))):
                value = rng.choice(ODD)
                if name in WRITTEN and isinstance(value, (str, pathlib.Path)) and str(value) == CABLE:
                    value = "written.csv"
                if (name, value if isinstance(value, (int, str)) else None) not in SLOW:
                    arguments[name] = value
            calls += 1
            try:
                function(**arguments)
            except rigfit.InternalError as error:
                self.fail(f"{function.__name__}({arguments}): {error!r}")
            except (rigfit.Error, MemoryError):
                refused += 1
            except TypeError as error:
                # A required argument is left out, or one that is not there: Python's own.
                self.assertRegex(str(error), "missing|unexpected keyword", f"{function.__name__}({arguments})")
                refused += 1
        self.assertEqual(calls, MISUSES)
        self.assertGreater(refused, MISUSES / 2)
        self.assertGreater(min(met.values()), MISUSES / 50)  # 18 functions: of each some fifty of a thousand


if __name__ == "__main__":
    unittest.main()
