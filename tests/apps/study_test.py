"""The study of many campaigns: two jobs at a time, a job killed, the whole run killed, gone on with.

usage: study_test.py PROGRAM SOURCE_FOLDER        exit code 77: snakemake is not installed
"""

import csv
import json
import os
import pathlib
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM, SOURCE = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
STUDY = SOURCE / "apps" / "study"

# Stands for the program: notes every call, and at the first report of seed 2 is killed, at the first of seed 3 hangs.
WRAPPER = """#!/bin/sh
echo "$1 $2" >> '{folder}/calls'
if [ "$1" = report ]; then
  case "$2" in
    2/*) [ -e '{folder}/killed' ] || {{ touch '{folder}/killed'; kill -9 $$; }} ;;
    3/*) [ -e '{folder}/hung' ] || {{ touch '{folder}/hung'; sleep 600; }} ;;
  esac
fi
exec '{program}' "$@"
"""


class Study(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="rigfit-study-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.program = self.script("program", WRAPPER)

    def script(self, name, text):
        path = self.folder / "bin" / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text.format(folder=self.folder, program=PROGRAM))
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return path

    def command(self, out, campaigns, *more):
        return ["snakemake", "-s", str(STUDY / "Snakefile"), *more, "--config", f"program={self.program}",
                f"campaigns={campaigns}", f"out={self.folder / out}"]

    def start(self, *arguments):
        environment = dict(os.environ, PATH=f"{self.folder / 'bin'}:{os.environ['PATH']}", HOME=str(self.folder))
        return subprocess.Popen(self.command(*arguments), cwd=self.folder, env=environment, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True, start_new_session=True)

    def run_study(self, *arguments):
        process = self.start(*arguments)
        output, _ = process.communicate(timeout=300)
        return process.returncode, output

    def calls(self):
        """Calls of the program since the last look."""
        path = self.folder / "calls"
        lines = path.read_text().splitlines() if path.exists() else []
        path.unlink(missing_ok=True)
        return lines

    def rows(self, out):
        with (self.folder / out / "summary.csv").open() as file:
            return list(csv.DictReader(file))

    def test_goes_on_where_it_stopped_and_gathers_one_summary(self):
        (self.folder / "hung").touch()
        code, output = self.run_study("out", 4, "--cores", "2")
        self.assertNotEqual(code, 0, output)
        self.assertFalse((self.folder / "out" / "summary.json").exists())
        self.assertIn("report 2/campaign.toml", self.calls())
        (self.folder / "hung").unlink()

        # Again; this time all of it is killed while seed 3 is at work, if it was not done before the stop.
        shutil.rmtree(self.folder / "out" / "3" / "report", ignore_errors=True)
        process = self.start("out", 4, "--cores", "2", "--rerun-incomplete")
        deadline = time.monotonic() + 120
        while not (self.folder / "hung").exists() and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertTrue((self.folder / "hung").exists())
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        self.assertFalse((self.folder / "out" / "summary.json").exists())
        done = {seed for seed in range(1, 5) if (self.folder / "out" / str(seed) / "report" / "report.json").exists()}
        self.assertNotIn(3, done)
        self.calls()
        self.assertEqual(self.run_study("out", 4, "--unlock")[0], 0)

        code, output = self.run_study("out", 4, "--cores", "2", "--rerun-incomplete")
        self.assertEqual(code, 0, output)
        again = self.calls()
        self.assertIn("report 3/campaign.toml", again)
        # What snakemake saw finished is not done again; the one beside the killed job may have been cut off with it.
        self.assertLessEqual(len([call for call in again if call.startswith("report")]), 2 + 4 - len(done))
        self.assertLessEqual(len([call for call in again if call.startswith("synthesize")]), 1)

        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        self.assertEqual(summary["campaigns"], 4)
        self.assertEqual([q["quantity"] for q in summary["quantities"]],
                         ["EI at 100 N, N m2", "EI at 200 N, N m2", "EI at 300 N, N m2", "EA, N", "damping ratio"])
        for quantity in summary["quantities"]:
            self.assertEqual((quantity["campaigns"], quantity["refused"]), (4, 0), quantity)
            # Each in four honest 95 % intervals misses with 5 %: none of four held has a chance of 6e-6.
            self.assertGreater(quantity["covered_95"], 0)
            self.assertLess(abs(quantity["relative_bias"]), 0.02)
        rows = self.rows("out")
        self.assertEqual(len(rows), 20)
        self.assertEqual({row["status"] for row in rows}, {"identified"})


if __name__ == "__main__":
    if shutil.which("snakemake") is None:
        print("skipped: snakemake is not installed (sh apps/install_packages.sh study)")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
