"""The scripts of apps/python/examples run, and print what a reader is told."""

import os
import pathlib
import re
import subprocess
import sys
import unittest

SOURCE = pathlib.Path(os.environ["RIGFIT_SOURCE"])


def run(name):
    done = subprocess.run([sys.executable, "-W", "ignore", SOURCE / "apps/python/examples" / name],
                          capture_output=True, text=True)
    if done.returncode:
        raise AssertionError(done.stderr)
    return done.stdout


class Examples(unittest.TestCase):
    def test_known_modes(self):
        out = run("known_modes.py")
        # pyFRF's H1 of the same five blocks has 0.644 %: the noise of the record, which no average of five takes away.
        self.assertLess(float(re.search(r"rms error (\S+) %", out)[1]), 1.05 * 0.644)
        found = re.findall(r"off by +(\S+) mHz \(std (\S+)\), damping (\S+) % \(std (\S+), true (\S+) %\)", out)
        self.assertEqual(len(found), 3)
        self.assertIn("3 modes in the band", out)
        # Six errors in standard uncertainties: their squares exceed 16.8 once in a hundred records (chi-square).
        squares = [(off / std) ** 2 + ((damping - true) / damping_std) ** 2
                   for off, std, damping, damping_std, true in (map(float, one) for one in found)]
        self.assertLess(sum(squares), 16.8)

    def test_updating(self):
        out = run("updating.py")
        for value, std, true in re.findall(r"-> +(\S+) \+- (\S+) +\(truth (\S+)\)", out):
            self.assertLess(abs(float(value) - float(true)), 3 * float(std))
        self.assertEqual(out.count("truth"), 2)


if __name__ == "__main__":
    unittest.main()
