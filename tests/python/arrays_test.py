"""Arrays in and out: what is copied, what lives how long; calls side by side; Ctrl-C."""

import gc
import os
import pathlib
import signal
import subprocess
import pickle
import sys
import tempfile
import threading
import time
import unittest
import unittest.mock
import warnings
import weakref

import numpy as np

import rigfit

DATA = pathlib.Path(os.environ["RIGFIT_SOURCE"]) / "testdata"
CABLE = str(DATA / "jalali2021/scenes/cable.toml")


def hits(samples, channels, fs=2048.0, seed=1):
    """Hits on a mode of 60 Hz: force and responses, channels x samples in one array."""
    rng = np.random.default_rng(seed)
    every = int(2 * fs)
    force = np.zeros(samples)
    for first in range(int(0.3 * fs), samples - every // 2, every):
        force[first:first + 8] += np.sin(np.pi * np.arange(8) / 8) * 100
    t = np.arange(int(2 * fs)) / fs
    h = np.exp(-0.02 * 2 * np.pi * 60 * t) * np.sin(2 * np.pi * 60 * t)
    size = 1 << (samples + len(h) - 1).bit_length()
    response = np.fft.irfft(np.fft.rfft(force, size) * np.fft.rfft(h, size))[:samples]
    data = np.empty((channels, samples))
    data[0] = force + 1e-3 * rng.standard_normal(samples)
    for c in range(1, channels):
        data[c] = c * response + 1e-3 * rng.standard_normal(samples)
    return data


def recording(data, fs=2048.0):
    return rigfit.Recording([{"name": "force" if c == 0 else f"a{c}", "data": row, "fs": fs,
                              "unit_str": "N" if c == 0 else "m/s^2"} for c, row in enumerate(data)])


class Arrays(unittest.TestCase):
    def setUp(self):
        warnings.simplefilter("ignore", rigfit.DataWarning)

    def test_samples_are_copies(self):
        data = hits(1 << 14, 3)
        one = recording(data)
        for c, row in enumerate(data):
            self.assertFalse(np.shares_memory(one.channels[c].data, row))
            np.testing.assert_array_equal(one.channels[c].data, row)
            self.assertFalse(one.channels[c].data.flags.writeable)
        # Not float64, not SI, not contiguous: converted, and equal.
        other = rigfit.Recording([{"name": "a", "data": np.arange(8, dtype=np.int16), "unit_str": "mm"},
                                  {"name": "b", "data": np.arange(16.0)[::2], "unit_str": "m"},
                                  {"name": "c", "data": np.arange(8, dtype=np.float32)},
                                  {"name": "d", "data": list(range(8))}])
        np.testing.assert_allclose(other["a"].data, 1e-3 * np.arange(8), rtol=1e-15)
        np.testing.assert_array_equal(other["b"].data, np.arange(16.0)[::2])
        np.testing.assert_array_equal(other["c"].data, np.arange(8.0))
        self.assertEqual(other["a"].unit, "m")

    def test_views_keep_their_recording(self):
        owner = hits(1 << 12, 2)
        one = recording(owner)
        alive = weakref.ref(one)
        view = one["a1"].data
        copy = view.copy()
        del one, owner
        gc.collect()
        self.assertIsNone(alive())
        np.testing.assert_array_equal(view, copy)
        result = rigfit.frf(recording(hits(1 << 14, 2)), "force")
        H = result.H
        copy = H.copy()
        del result
        gc.collect()
        np.testing.assert_array_equal(H, copy)

    def test_calls_side_by_side(self):
        data = [recording(hits(1 << 15, 4, seed=s)) for s in range(4)]
        alone = [rigfit.frf(one, "force", threads=1).H.copy() for one in data]
        found = [None] * 4

        def work(i):
            for _ in range(3):
                found[i] = rigfit.frf(data[i], "force", threads=1).H.copy()
                rigfit.modes(CABLE, count=3)

        threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
        [t.start() for t in threads]
        [t.join() for t in threads]
        for a, b in zip(alone, found):
            np.testing.assert_array_equal(a, b)

    def test_lock_is_released(self):
        ticks, stop = [], threading.Event()

        def tick():
            while not stop.is_set():
                ticks.append(time.monotonic())
                time.sleep(0.002)

        thread = threading.Thread(target=tick)
        thread.start()
        started = time.monotonic()
        rigfit.respond(DATA / "scenes/cable-release.toml", duration=1, rate=2000, solver="stiff")
        ended = time.monotonic()
        stop.set()
        thread.join()
        within = sum(started < t < ended for t in ticks)
        self.assertGreater(within, 0.05 * (ended - started) / 0.002)

    def interrupted(self, call, stops=False):
        """Seconds from the signal to KeyboardInterrupt; a further call works, and the process ends at once, or after
        the work where that ``stops``."""
        code = ("import rigfit, warnings\n"
                "warnings.simplefilter('ignore')\n"
                "print('ready', flush=True)\n"
                "try:\n"
                f"    rigfit.{call}\n"
                "except KeyboardInterrupt:\n"
                "    print('interrupted', flush=True)\n"
                f"print(len(rigfit.modes({CABLE!r}, count=1).modes), flush=True)\n"
                "import time\n"
                "ends = time.monotonic() + 30\n"
                f"while {stops} and rigfit._core.abandoned_calls() and time.monotonic() < ends: time.sleep(0.01)\n")
        run = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertEqual(run.stdout.readline().strip(), "ready")
        time.sleep(0.5)
        sent = time.monotonic()
        run.send_signal(signal.SIGINT)
        self.assertEqual(run.stdout.readline().strip(), "interrupted")
        took = time.monotonic() - sent
        # By the same reader: communicate() would not see what readline() has read ahead.
        modes = run.stdout.readline().strip()
        _, err = run.communicate(timeout=60)
        self.assertEqual((modes, run.returncode), ("1", 0 if stops else 130), err)
        return took

    def test_interrupt(self):
        # Calls of minutes. Signals are looked for every 50 ms; the rest of the bound is for a busy machine.
        response = f"respond({str(DATA / 'scenes/cable-release.toml')!r}, duration=2000, rate=2000, solver='explicit')"
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        report = f"report({str(DATA / 'virtual_laboratory/campaign.toml')!r}, out={folder.name + '/report'!r})"
        for call, stops in ((response, False), (report, True)):
            self.assertLess(self.interrupted(call, stops), 2, call)

    def test_sep005(self):
        one = recording(hits(1 << 12, 2))
        dicts = one.to_sep005()
        self.assertEqual(set(dicts[0]), {"name", "data", "fs", "unit_str"})
        again = rigfit.Recording(dicts)
        np.testing.assert_array_equal(again["a1"].data, one["a1"].data)
        self.assertEqual((again.fs, again["force"].unit), (2048, "N"))
        self.assertEqual(rigfit.inspect(dicts).recordings[0].channels[0].name, "force")


class Results(unittest.TestCase):
    def setUp(self):
        warnings.simplefilter("ignore", rigfit.DataWarning)
        self.result = rigfit.tension(frequencies=[7.36, 14.59, 22.15, 29.9], frequency_std=0.01, length=(2.4, 0.001),
                                     mass_per_length=0.16667, ends="pinned", EA=221780)

    def test_values(self):
        tension = self.result.tension_N
        self.assertTrue(tension.low < tension.value < tension.high)
        self.assertEqual(float(tension), tension.value)
        self.assertEqual(self.result["tension_N"], tension)
        with self.assertRaises(AttributeError):
            self.result.no_such
        with self.assertRaises(AttributeError):
            self.result.tension_N = 3
        self.assertTrue(repr(self.result).startswith("tension at mid-span"))  # as the program prints it
        np.testing.assert_array_equal(self.result.modes.measured_hz, [7.36, 14.59, 22.15, 29.9])
        self.assertEqual(self.result.candidates.tension_N.std[0], self.result.candidates[0].tension_N.std)
        self.assertIn("tension_N", dir(self.result))

    def test_uncertainties(self):
        try:
            import uncertainties
        except ImportError:
            self.skipTest("uncertainties is not installed")
        value = self.result.tension_N.to_ufloat()
        self.assertIsInstance(value, uncertainties.core.Variable)
        self.assertEqual(value.std_dev, self.result.tension_N.std)
        again = rigfit.tension(frequencies=[7.36, 14.59, 22.15, 29.9], frequency_std=0.01, mass_per_length=0.16667,
                               length=uncertainties.ufloat(2.4, 0.001), EA=221780, ends="pinned")
        self.assertEqual(again.tension_N, self.result.tension_N)

    def test_frames(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("pandas is not installed")
        frame = self.result.to_frame()
        self.assertEqual(list(frame["measured_hz"]), [7.36, 14.59, 22.15, 29.9])
        found = rigfit.modes(CABLE, count=4)
        modes, every = found.to_frame(), found.to_frame(all=True)
        self.assertEqual(len(modes), 4)
        self.assertLess(set(modes), set(every))
        table = rigfit.read(DATA / "virtual_laboratory/bench/axial/L1m-1.csv").to_frame()
        self.assertIsInstance(table, pandas.DataFrame)

    def test_notebook(self):
        shown = self.result._repr_html_()
        self.assertIn("<td>14.59</td>", shown)
        self.assertIn("<details>", shown)
        self.assertLess(len(shown), 20000)
        modes = rigfit.modes(CABLE, count=2)
        self.assertIn("<svg", modes.plot()._repr_svg_())
        self.assertEqual(pickle.loads(pickle.dumps(modes)).to_dict(), modes.to_dict())

    def test_block(self):
        block = rigfit.Recording(np.arange(64.0).reshape(2, 32), fs=100, names=["force", "acc"])
        self.assertEqual(block["acc"].data[0], 32)
        with self.assertRaisesRegex(rigfit.Error, "names"):
            rigfit.Recording(np.zeros((2, 32)), fs=100, names=["force"])

    def test_packages_that_are_missing(self):
        frf = rigfit.frf(recording(hits(1 << 14, 2)), "force")
        calls = {"uncertainties": self.result.tension_N.to_ufloat, "pandas": frf.to_frame}
        for package, call in calls.items():
            # An entry of None says that the package cannot be imported.
            with unittest.mock.patch.dict(sys.modules, {package: None}), self.assertRaises(rigfit.Error) as caught:
                call()
            self.assertEqual(caught.exception.code, "not_installed")
            self.assertIn(package, str(caught.exception))


if __name__ == "__main__":
    unittest.main()
