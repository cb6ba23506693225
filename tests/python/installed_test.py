"""The package as installed: by cmake --install, and by pip from a build that is there.

usage: installed_test.py BUILD_FOLDER CMAKE
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

BUILD, CMAKE = sys.argv[1], sys.argv[2]
SOURCE = pathlib.Path(os.environ["RIGFIT_SOURCE"])
USE = ("import rigfit, pathlib, sys\n"
       "folder = pathlib.Path(rigfit.__file__).parent\n"
       "assert folder == pathlib.Path(sys.argv[1]), folder\n"
       "assert (folder / 'py.typed').exists() and (folder / '__init__.pyi').exists()\n"
       "print(len(rigfit.modes(sys.argv[2], count=2).modes))\n")


class Installed(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name).resolve()

    def used_from(self, site):
        done = subprocess.run([sys.executable, "-c", USE, site / "rigfit", SOURCE / "testdata/jalali2021/scenes/cable.toml"],
                              env={**os.environ, "PYTHONPATH": str(site)}, cwd=self.folder, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout.strip()), (0, "2"), done.stderr)

    def test_cmake_install(self):
        subprocess.run([CMAKE, "--install", BUILD, "--component", "python", "--prefix", self.folder], check=True,
                       stdout=subprocess.DEVNULL)
        self.used_from(next(self.folder.rglob("rigfit")).parent)

    def test_pip_install(self):
        if subprocess.run([sys.executable, "-m", "pip", "--version"], capture_output=True).returncode:
            self.skipTest("pip is not installed")
        done = subprocess.run([sys.executable, "-m", "pip", "install", "--no-index", "--no-deps", "--no-cache-dir",
                               "--disable-pip-version-check", "--target", self.folder, SOURCE / "apps/python"],
                              env={**os.environ, "RIGFIT_BUILD_DIR": BUILD,
                                   "PATH": f"{pathlib.Path(CMAKE).parent}:{os.environ['PATH']}"},
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.used_from(self.folder)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
