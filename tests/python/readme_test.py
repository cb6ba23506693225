"""The Python code of the READMEs, run as it stands in a folder that holds the files it names."""

import os
import pathlib
import re
import shutil
import tempfile
import unittest
import warnings

import numpy as np

import rigfit

SOURCE = pathlib.Path(os.environ["RIGFIT_SOURCE"])
DATA = SOURCE / "testdata"


def hits(scene, fs=512.0, block=1 << 13, count=3):
    """Hits on the scene's first load and the answer of its first sensor, as a table of a logger."""
    rng = np.random.default_rng(11)
    lines = np.fft.rfftfreq(2 * block, 1 / fs)
    H = np.zeros(len(lines), complex)
    H[1:] = rigfit.frf_of(scene, lines[1:]).H[:, 0, 0]
    pulse = np.zeros(2 * block)
    pulse[200:204] = 40 * np.sin(np.pi * np.arange(1, 5) / 5)
    answer = np.fft.irfft(H * np.fft.rfft(pulse), 2 * block)
    data = 1e-3 * rng.standard_normal((2, count * block))
    for first in range(0, count * block, block):
        length = min(2 * block, count * block - first)
        data[0, first:first + length] += pulse[:length]
        data[1, first:first + length] += answer[:length]
    time = np.arange(count * block) / fs
    np.savetxt("hits.csv", np.column_stack([time, *data]), delimiter=",", header="time (s),hammer (N),acc (m/s^2)", comments="",
               fmt="%.9g")


class Readme(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        warnings.simplefilter("ignore")
        shutil.copy(DATA / "jalali2021/scenes/cable.toml", "cable.toml")
        rigfit.Scene("cable.toml").with_parameters({"right.x": 3.0}).write("longer.toml")
        text = pathlib.Path("cable.toml").read_text()
        pathlib.Path("clamped.toml").write_text(text.replace('"pinned"', '"clamped"'))
        pathlib.Path("ends.toml").write_text(
            '[[candidate]]\nname = "pinned"\n[[candidate]]\nname = "clamped"\nscene = "clamped.toml"\n')
        shutil.copy(DATA / "virtual_laboratory/bench/axial/L0.7m-1.csv", "a.csv")
        shutil.copy(DATA / "virtual_laboratory/bench/axial/L1m-1.csv", "b.csv")
        hits("cable.toml")

    def code_of(self, file):
        blocks = re.findall(r"```python\n(.*?)```", (SOURCE / file).read_text(), re.S)
        self.assertTrue(blocks)
        return "\n".join(blocks)

    def test_python_readme(self):
        try:
            import pandas  # noqa: F401
            import uncertainties  # noqa: F401
        except ImportError as missing:
            self.skipTest(f"{missing.name} is not installed")
        names = {}
        exec(compile(self.code_of("apps/python/README.md"), "README.md", "exec"), names)
        # The scene's EI is the truth of hits.csv.
        found = names["fit"].parameters[0]
        true = rigfit.Scene("cable.toml").parameters["cable.EI"]
        self.assertLess(abs(found.value - true), 4 * found.std + 0.02 * true)

    def test_main_readme(self):
        code = self.code_of("README.md").replace("modes.to_frame()", "len(modes.modes)")
        names = {}
        exec(compile(code, "README.md", "exec"), names)
        self.assertTrue(names["modes"].modes)


if __name__ == "__main__":
    unittest.main()
