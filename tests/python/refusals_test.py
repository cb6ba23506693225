"""What goes wrong ends alike by the program and by the package: exit code, code, message, place, and what can be had.

Where the program leaves a JSON document (exit codes 4 and 5), its `error` is the exception; where it leaves none (2 and 3),
its line on standard error is. Options of the command line are arguments in Python's messages.
"""

import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest
import warnings

import numpy as np

import rigfit

PROGRAM = os.environ["RIGFIT_PROGRAM"]
DATA = pathlib.Path(os.environ["RIGFIT_SOURCE"]) / "testdata"
CABLE = str(DATA / "jalali2021/scenes/cable.toml")
BEAM = str(DATA / "jalali2021/scenes/beam.toml")
RELEASE = str(DATA / "scenes/cable-release.toml")
CODES = {2: {"wrong_usage", "argument"}, 3: {"bad_input"}}


def in_python(text):
    """A message with arguments in place of options."""
    return re.sub(r"`[^`]*`|--([a-z][a-z-]*)", lambda m: f"`{m[1].replace('-', '_')}`" if m[1] else m[0], text)


def without_times(value):
    if isinstance(value, dict):
        return {k: without_times(v) for k, v in value.items() if k != "wall_s"}
    return [without_times(v) for v in value] if isinstance(value, list) else value


class Refusals(unittest.TestCase):
    maxDiff = 3000

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        warnings.simplefilter("ignore", rigfit.DataWarning)
        t = np.arange(500) / 500
        ring = np.exp(-2 * t) * np.cos(40 * np.pi * t)
        self.table("ring.csv", "t (s),a (m/s2)", t, ring)
        self.table("two.csv", "t (s),F (N),a (m/s2)", t, 0 * t + 0.5, ring)
        self.table("norate.csv", "a (m/s2)", ring)
        self.table("still.csv", "t (s),a (m/s2)", t, 0 * t + 1)
        self.table("noise.csv", "t (s),a (m/s2)", t, np.random.default_rng(5).standard_normal(500))
        self.table("uneven.csv", "t (s),a (m/s2)", t[:100] + np.where(np.arange(100) > 50, 0.05, 0), ring[:100])
        self.table("gaps.csv", "tension_N,EI_Nm2", [100, -200], [0.4, 0.5])
        self.table("loads.csv", "tension_N,load_N,deflection_mm", [100] * 3, [10, 20, 30], [1, 2, 3])
        self.table("soft.csv", "tension_N,load_N,deflection_mm", [100] * 4, [1, 2, 3, 4], [100, 200, 300, 400])
        self.table("modes.csv", "frequency_hz", [7.36, 14.5, 21.8])
        self.table("cables.csv", "name,length,mass_per_length,EI,f1,f2", ["a", "b", "c"], [2.4, 2.4, 2.4],
                   [0.16667, "x", 0.16667], [0.5, 0.5, 0.5], [7.36, 7.36, 7.36], [14.81, 14.81, 14.81])
        self.table("unnamed.csv", "f1,f2", [7.36], [14.59])
        pathlib.Path("bad.csv").write_text("time (s),a (N)\n0,1\n0.1,x\n0.2,3\n")
        pathlib.Path("other.json").write_text('{"EA_N": 3}')
        fit = {"parameters": [{"name": "cable.EI", "value": 0.5, "std": 0.01}]}
        pathlib.Path("fit.json").write_text(json.dumps(fit))
        fit["parameters"][0]["std"] = None
        pathlib.Path("nothing.json").write_text(json.dumps(fit))
        cable = rigfit.Scene(CABLE).to_toml()
        pathlib.Path("unknown.toml").write_text(cable + "unknown = 1\n")
        rigfit.Scene(CABLE).with_parameters({"cable.tension": 1e-6}).write("slack.toml")
        pathlib.Path("bare.toml").write_text(re.sub(r"(?s)\[\[(load|sensor)\]\].*?(?=\n\[\[|\Z)", "", cable))
        pathlib.Path("campaign.toml").write_text('title = "rig"\n[[test]]\nname = "ring"\nkind = "decay"\nband = [300, 400]\n'
                                                 '[[test.recording]]\nfiles = "ring.csv"\n')

    @staticmethod
    def table(name, header, *columns):
        rows = "\n".join(",".join(str(cell) for cell in row) for row in zip(*columns))
        pathlib.Path(name).write_text(f"{header}\n{rows}\n")

    def both(self, exit_code, code, words, function, *args, **kwargs):
        """``code``: of the finding (exit codes 4 and 5)."""
        with self.subTest(command=words):
            run = subprocess.run([PROGRAM, *words.split(), "--json", "-"], capture_output=True, text=True)
            self.assertEqual(run.returncode, exit_code, run.stderr)
            with self.assertRaises(rigfit.Error) as caught:
                function(*args, **kwargs)
            error = caught.exception
            self.assertEqual(error.exit_code, exit_code, repr(error))
            if exit_code in CODES:
                self.assertEqual(run.stdout, "")
                self.assertIn(error.code, CODES[exit_code])
                if error.code != "argument":  # arguments are checked before: in words of Python
                    self.assertIn(error.message, in_python(run.stderr))
                return error
            document = json.loads(run.stdout)
            self.assertEqual(document["error"]["exit_code"], exit_code)
            self.assertEqual(error.code, document["error"]["code"])
            self.assertEqual(error.code, code)
            self.assertEqual(error.problem, in_python(document["error"]["message"]))
            self.assertEqual(error.where, document["error"]["where"])
            if error.result is not None:
                if document["command"] == "update":
                    document.pop("scenes")  # files written
                self.assertEqual(without_times(error.result.to_dict()), without_times(document))
            return error

    def test_recordings(self):
        self.both(3, None, "inspect none.csv", rigfit.inspect, "none.csv")
        error = self.both(3, None, "inspect bad.csv", rigfit.inspect, "bad.csv")
        self.assertEqual((error.file, error.line), ("bad.csv", 3))
        self.assertTrue(error.remedy)
        self.both(2, None, "decay norate.csv", rigfit.decay, "norate.csv")
        self.both(2, None, "decay two.csv", rigfit.decay, "two.csv")
        self.both(2, None, "decay ring.csv --start 5 --end 6", rigfit.decay, "ring.csv", start=5, end=6)
        self.both(2, None, "decay ring.csv --band 50 20", rigfit.decay, "ring.csv", band=(50, 20))
        self.both(2, None, "decay ring.csv --band 300 400", rigfit.decay, "ring.csv", band=(300, 400))
        self.both(4, "constant", "decay still.csv", rigfit.decay, "still.csv")
        self.both(4, "not_uniform", "decay uneven.csv", rigfit.decay, "uneven.csv")
        self.both(4, "too_few_samples", "decay ring.csv --start 0.5 --end 0.504", rigfit.decay, "ring.csv", start=0.5, end=0.504)

    def test_hits(self):
        self.both(3, None, "frf none.csv --force F", rigfit.frf, "none.csv", "F")
        self.both(2, None, "frf two.csv --force F --response F", rigfit.frf, "two.csv", "F", "F")
        self.both(2, None, "frf two.csv --force F --band 5 3", rigfit.frf, "two.csv", "F", band=(5, 3))
        self.both(2, None, "frf two.csv --force F --struck a b", rigfit.frf, "two.csv", "F", struck=["a", "b"])
        self.both(4, "no_hit", "frf two.csv --force F", rigfit.frf, "two.csv", "F")
        self.table("short.csv", "t (s),F (N),a (m/s2)", np.arange(3000) / 500, np.where(np.arange(3000) == 300, 50.0, 0.0),
                   np.where(np.arange(3000) > 300, np.exp(-0.02 * np.arange(3000)) * np.cos(0.5 * np.arange(3000)), 0))
        error = self.both(4, "pulse_not_resolved", "frf short.csv --force F", rigfit.frf, "short.csv", "F")
        self.assertIn("`frequencies_only` keeps", str(error))  # the program: --frequencies-only
        self.both(3, None, "modal ring.csv", rigfit.modal, "ring.csv")
        self.both(4, "no_hit", "modal two.csv --force F", rigfit.modal, "two.csv", force="F")
        hits = str(DATA / "virtual_laboratory/beam/rig/hammer-hit1.uff")
        self.both(4, "no_hit_accepted", f"modal {hits} --force force", rigfit.modal, hits, force="force")
        hits = sorted(str(file) for file in DATA.glob("virtual_laboratory/beam/rig/hammer-*.uff"))
        self.both(4, "no_modes", f"modal {' '.join(hits)} --force force --band 41 41.1", rigfit.modal, hits, force="force",
                  band=(41, 41.1))

    def test_laboratory(self):
        self.both(2, None, "bending loads.csv", rigfit.bending, "loads.csv")
        self.both(3, None, "bending loads.csv --span 1 --tension zz", rigfit.bending, "loads.csv", span=1, tension="zz")
        self.both(3, None, "bending gaps.csv", rigfit.bending, "gaps.csv")
        self.both(4, "string_like", "bending soft.csv --span 1", rigfit.bending, "soft.csv", span=1)
        self.both(2, None, "axial norate.csv --mass 2.2 --length 1", rigfit.axial, "norate.csv", mass=2.2, length=1.0)
        self.both(4, "not_uniform", "axial uneven.csv --mass 2 --length 1", rigfit.axial, "uneven.csv", mass=2, length=1)
        self.both(4, "no_decay", "axial still.csv --mass 2 --length 1", rigfit.axial, "still.csv", mass=2, length=1)
        self.both(4, "no_tension", "tension --frequencies 7.36 --length 2.4 --mass-per-length 0.17 --EI 500 --ends pinned",
                  rigfit.tension, frequencies=[7.36], length=2.4, mass_per_length=0.17, EI=500, ends="pinned")
        self.both(4, "no_modes", "tension noise.csv --length 2.4 --mass-per-length 0.17", rigfit.tension, "noise.csv",
                  length=2.4, mass_per_length=0.17)
        error = self.both(4, "bad_row", "tension --table cables.csv", rigfit.tension_table, "cables.csv")
        self.assertEqual([cable.name for cable in error.result.cables if "tension_N" in cable], ["a", "c"])
        self.both(3, None, "tension --table unnamed.csv", rigfit.tension_table, "unnamed.csv")

    def test_scenes(self):
        error = self.both(3, None, "modes unknown.toml", rigfit.modes, "unknown.toml")
        self.assertTrue(error.key and error.line)
        self.both(5, "not_converged", "modes slack.toml", rigfit.modes, "slack.toml")
        self.both(2, None, "modes slack.toml --band 50 5", rigfit.modes, "slack.toml", band=(50, 5))
        self.both(3, None, "respond bare.toml --duration 1 --rate 100 --out r.csv", rigfit.respond, "bare.toml", duration=1,
                  rate=100)
        self.both(2, None, f"respond {RELEASE} --duration 0.001 --rate 100 --out r.csv", rigfit.respond, RELEASE, duration=0.001,
                  rate=100)
        self.both(2, None, f"respond {RELEASE} --duration 1e6 --rate 1e6 --out r.csv", rigfit.respond, RELEASE, duration=1e6,
                  rate=1e6)
        self.both(2, None, "synthesize bare.toml --out out", rigfit.synthesize, "bare.toml", "out")
        self.both(2, None, f"synthesize {CABLE} --out ring.csv", rigfit.synthesize, CABLE, "ring.csv")
        self.both(3, None, "report none.toml --out out", rigfit.report, "none.toml", "out")
        self.both(4, "band_not_sampled", "report campaign.toml --out out", rigfit.report, "campaign.toml", "out")
        other = pathlib.Path("campaign.toml").read_text().replace('"rig"', '"other rig"')
        pathlib.Path("other.toml").write_text(other)
        self.both(2, None, "report other.toml --out out", rigfit.report, "other.toml", "out")
        self.both(4, "band_not_sampled", "report other.toml --out out --force", rigfit.report, "other.toml", "out", force=True)

    def test_fits(self):
        update = f"update {CABLE} --out fitted.toml"
        self.both(2, None, update, rigfit.update, CABLE)
        self.both(3, None, update + " --measured modes.csv --free cable.XX", rigfit.update, CABLE, measured="modes.csv",
                  free="cable.XX")
        self.both(2, None, update + " --measured modes.csv --hold-out", rigfit.update, CABLE, measured="modes.csv",
                  hold_out=True)
        self.both(3, None, update + " --measured modes.csv --axial other.json", rigfit.update, CABLE, measured="modes.csv",
                  axial="other.json")
        self.both(4, "refused", update + " --decay ring.csv --band 300 400", rigfit.update, CABLE, decay="ring.csv",
                  band=(300, 400))
        self.both(5, "not_converged", update + " --measured modes.csv --prior cable.EI=0.5,1e-300", rigfit.update, CABLE,
                  measured="modes.csv", prior={"cable.EI": (0.5, 1e-300)})
        self.both(3, None, f"predict {BEAM} --from none.json", rigfit.predict, BEAM, "none.json")
        self.both(3, None, f"predict {BEAM} --from other.json", rigfit.predict, BEAM, "other.json")
        self.both(4, "no_parameter", f"predict {CABLE} --from nothing.json", rigfit.predict, CABLE, "nothing.json")
        self.both(4, "parameter_not_in_scene", f"predict {BEAM} --from fit.json", rigfit.predict, BEAM, "fit.json")
        self.both(2, None, f"predict {CABLE} --from fit.json --map x=cable.EA", rigfit.predict, CABLE, "fit.json",
                  map={"x": "cable.EA"})
        self.both(5, "not_converged", "predict slack.toml --from fit.json", rigfit.predict, "slack.toml", "fit.json")


if __name__ == "__main__":
    unittest.main()
