"""README's examples by the program and by the package: the same documents to the last digit, and the same refusals.

usage: python3 -m unittest, with RIGFIT_PROGRAM, RIGFIT_SOURCE set and the package on the path.
"""

import glob
import json
import os
import pathlib
import subprocess
import tempfile
import unittest
import warnings

import numpy as np

import rigfit

PROGRAM = os.environ["RIGFIT_PROGRAM"]
DATA = pathlib.Path(os.environ["RIGFIT_SOURCE"]) / "testdata"
AXIAL = [f for length in ("0.7m", "1m", "1.3m") for f in sorted(glob.glob(str(DATA / f"virtual_laboratory/bench/axial/L{length}-*.csv")))]
HITS = sorted(glob.glob(str(DATA / "virtual_laboratory/beam/rig/hammer-*.uff")))
BENDING = sorted(glob.glob(str(DATA / "virtual_laboratory/bench/bending/T*N.csv")))
CABLE = str(DATA / "jalali2021/scenes/cable.toml")
TIMES = {"wall_s"}


def without_times(value):
    """The document without what a clock says."""
    if isinstance(value, dict):
        return {k: without_times(v) for k, v in value.items() if k not in TIMES}
    return [without_times(v) for v in value] if isinstance(value, list) else value


class SameNumbers(unittest.TestCase):
    maxDiff = 2000

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        warnings.simplefilter("ignore", rigfit.DataWarning)

    def program(self, *words, code=0):
        run = subprocess.run([PROGRAM, *map(str, words), "--json", "-"], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(run.returncode, code, run.stderr)
        return json.loads(run.stdout)

    def same(self, document, result, leave_out=()):
        expected, given = without_times(document), without_times(result.to_dict())
        for key in leave_out:
            expected.pop(key, None), given.pop(key, None)
        self.assertEqual(expected, given)

    def test_inspect(self):
        self.same(self.program("inspect", AXIAL[0], HITS[0]), rigfit.inspect([AXIAL[0], HITS[0]]))

    def test_decay(self):
        document = self.program("decay", AXIAL[5], "--channel", "tension", "--band", 20, 100, "--each")
        result = rigfit.decay(AXIAL[5], "tension", band=(20, 100), each=True)
        self.same(document, result)
        # A recording at hand gives the same but for the file's hash.
        self.same(document, rigfit.decay(rigfit.read(AXIAL[5]), "tension", band=(20, 100), each=True), ["inputs"])
        mode = result.modes[0]
        self.assertEqual(mode.frequency_hz.value, document["modes"][0]["frequency_hz"]["value"])
        self.assertEqual(float(mode.damping_ratio), document["modes"][0]["damping_ratio"]["value"])

    def test_frf_and_modal(self):
        words = ["--force", "force", "--force-window", 0.012, "--exponential-window", 0.05, "--band", 1, 160]
        document = self.program("frf", *HITS, *words, "--out", "frf.uff")
        result = rigfit.frf(HITS, "force", force_window=0.012, exponential_window=0.05, band=(1, 160))
        self.same(document, result, ["out"])
        at_hand = rigfit.frf([rigfit.read(f) for f in HITS], "force", force_window=0.012, exponential_window=0.05,
                             band=(1, 160))
        self.same(document, at_hand, ["out", "inputs"])
        np.testing.assert_array_equal(result.H, at_hand.H)
        self.assertEqual(result.H.shape, (len(result.frequency_hz), len(result.response_names), 1))

        modes = self.program("modal", "frf.uff", "--band", 1, 160, "--out", "modes.uff", "--synthesis", "again.uff")
        self.same(modes, rigfit.modal(self.folder / "frf.uff", band=(1, 160)), ["out", "synthesis", "inputs"])
        direct = self.program("modal", *HITS, *words)
        self.same(direct, rigfit.modal(HITS, force="force", force_window=0.012, exponential_window=0.05, band=(1, 160)))
        by_frfs = rigfit.modal(result, band=(1, 160))
        self.assertEqual([m.frequency_hz.value for m in by_frfs.modes][:3],
                         [m["frequency_hz"]["value"] for m in direct["modes"]][:3])

    def test_bending(self):
        document = self.program("bending", *BENDING, "--span", 0.5, "--tension-zero-std", 0.1)
        self.same(document, rigfit.bending(BENDING, span=0.5, tension_zero_std=0.1))
        (self.folder / "ei.csv").write_text("tension_N,EI_Nm2\n25,0.2549\n100,0.4948\n200,0.5972\n300,0.8283\n")
        document = self.program("bending", "ei.csv", "--strand", 195e9, 133, 0.397e-3, 6.35e-3)
        result = rigfit.bending({"tension_N": [25, 100, 200, 300], "EI_Nm2": [0.2549, 0.4948, 0.5972, 0.8283]},
                                strand=(195e9, 133, 0.397e-3, 6.35e-3))
        for key in ("laws", "law_choice", "bounds"):
            self.assertEqual(document[key], result.to_dict()[key])

    def test_axial(self):
        document = self.program("axial", *AXIAL, "--length", 0.7, 1.0, 1.3, "--length-std", 0.001, "--mass", 2.2,
                                "--mass-std", 0.002, "--mass-per-length", 0.16667, "--band", 20, 100)
        result = rigfit.axial(AXIAL, length=[0.7, 1.0, 1.3], length_std=0.001, mass=2.2, mass_std=0.002,
                              mass_per_length=0.16667, band=(20, 100))
        self.same(document, result)

    def test_modes(self):
        document = self.program("modes", CABLE, "--count", 6, "--shapes")
        self.same(document, rigfit.modes(CABLE, count=6, shapes=True))
        scene = rigfit.Scene(CABLE)
        self.same(document, rigfit.modes(scene, count=6, shapes=True), ["inputs"])
        again = rigfit.Scene(scene.to_toml())
        self.assertEqual(document["modes"], rigfit.modes(again, count=6, shapes=True).to_dict()["modes"])

    def test_respond(self):
        scene = DATA / "scenes/cable-release.toml"
        document = self.program("respond", scene, "--duration", 0.5, "--rate", 2000, "--out", "r.csv")
        result = rigfit.respond(scene, duration=0.5, rate=2000, out=self.folder / "again.csv")
        self.same(document, result, ["out"])
        self.assertEqual((self.folder / "r.csv").read_bytes(), (self.folder / "again.csv").read_bytes())
        table = np.loadtxt(self.folder / "r.csv", delimiter=",", skiprows=1)
        # The file has nine digits.
        np.testing.assert_allclose(result.response, table[:, 1:], rtol=1e-8, atol=1e-300)
        np.testing.assert_allclose(result.time_s, table[:, 0], rtol=1e-9, atol=1e-15)

    def test_frf_of(self):
        result = rigfit.frf_of(CABLE, [5.0, 7.0, 9.0])
        self.assertEqual(result.H.shape, (3, len(result.sensors), len(result.loads)))
        self.assertTrue(np.isfinite(result.H).all())
        modes = rigfit.modes(CABLE, count=1)
        at, off = modes.modes[0].frequency_hz, 0.9 * modes.modes[0].frequency_hz
        H = np.abs(rigfit.frf_of(CABLE, [off, at]).H[:, 0, 0])
        self.assertGreater(H[1], 5 * H[0])  # of one mode: 1 / (2 zeta) = 100 against 0.81 / 0.19 = 4; others add to both

    def test_update(self):
        scene, table = DATA / "jalali2021/scenes/beam.toml", DATA / "jalali2021/table2_beam_frequencies.csv"
        words = ["--column", "bond_graph_Hz", "--plane", "in", "--free", "beam.EI_z", "tip.mass"]
        document = self.program("update", scene, "--measured", table, *words, "--out", "updated.toml")
        result = rigfit.update(scene, measured=table, column="bond_graph_Hz", plane="in", free=["beam.EI_z", "tip.mass"])
        self.same(document, result, ["scenes"])
        self.assertEqual((self.folder / "updated.toml").read_text(), result.fitted_scenes[0].to_toml())
        self.assertEqual(result.covariance.shape, (2, 2))
        # The bond graph's beam has a tip mass of 9.6 % of its own; two decimals of 2.34 Hz are 0.2 %.
        self.assertLess(document["rms_relative_error"], 1e-3)
        self.assertAlmostEqual(result.parameters[1].value / (0.295 * 0.75), 0.096, delta=0.003)
        # Modes and scene at hand.
        pairs = [p["measured_hz"] for p in document["pairs"]]
        at_hand = rigfit.update(rigfit.Scene(scene), measured=sorted(pairs), plane="in", free=["beam.EI_z", "tip.mass"])
        self.assertAlmostEqual(at_hand.parameters[0].value / result.parameters[0].value, 1, delta=1e-6)
        self.assertEqual(at_hand.to_dict()["inputs"], [])

    def test_tension(self):
        words = ["--frequencies", 7.36, 14.59, 22.15, 29.9, "--frequency-std", 0.01, "--length", "2.4,0.001",
                 "--mass-per-length", 0.16667, "--ends", "pinned", "--EA", 221780]
        document = self.program("tension", *words)
        frequencies = np.array([7.36, 14.59, 22.15, 29.9])
        options = dict(length=(2.4, 0.001), mass_per_length=0.16667, ends="pinned", EA=221780)
        self.same(document, rigfit.tension(frequencies=frequencies, frequency_std=0.01, **options))
        table = [{"frequency_hz": f, "std": 0.01} for f in frequencies]
        self.assertEqual(document["tension_N"], rigfit.tension(measured=table, **options).tension_N.to_dict())

    def test_predict(self):
        scene, table = DATA / "jalali2021/scenes/beam.toml", DATA / "jalali2021/table2_beam_frequencies.csv"
        fit = rigfit.update(scene, measured=table, column="bond_graph_Hz", plane="in", free=["beam.EI_z", "tip.mass"])
        (self.folder / "fit.json").write_text(json.dumps(fit.to_dict()))
        words = ["--count", 5, "--measured", table, "--column", "test_Hz", "--plane", "in"]
        document = self.program("predict", scene, "--from", "fit.json", *words)
        options = dict(count=5, measured=table, column="test_Hz", plane="in")
        self.same(document, rigfit.predict(scene, self.folder / "fit.json", **options), ["inputs"])
        result = rigfit.predict(rigfit.Scene(scene), fit, **options)
        self.same(document, result, ["inputs"])
        mode = result.modes[0].frequency_hz
        self.assertTrue(mode.low < mode.value < mode.high)
        sampled = self.program("predict", scene, "--from", "fit.json", "--map", "beam.EI_z=beam.EI_y")
        self.same(sampled, rigfit.predict(scene, fit, map={"beam.EI_z": "beam.EI_y"}), ["inputs"])

    def test_update_candidates(self):
        # The cable's in-plane modes to 0.1 % tell its ends, and nothing of its torsional rigidity.
        modes = [m.frequency_hz for m in rigfit.modes(CABLE, band=(1, 80)).modes if m.plane == "in"]
        (self.folder / "measured.csv").write_text("frequency_hz,std,plane\n" +
                                                  "".join(f"{f!r},{1e-3 * f!r},in\n" for f in modes))
        words = ["--measured", "measured.csv", "--free", "cable.tension"]
        options = dict(measured=self.folder / "measured.csv", free="cable.tension")
        (self.folder / "clamped.toml").write_text(pathlib.Path(CABLE).read_text().replace('"pinned"', '"clamped"'))
        (self.folder / "ends.toml").write_text('[[candidate]]\nname = "pinned"\n[[candidate]]\nname = "clamped"\nscene = "clamped.toml"\n')
        document = self.program("update", CABLE, *words, "--candidates", "ends.toml")
        result = rigfit.update(CABLE, candidates=self.folder / "ends.toml", **options)
        self.same(document, result, ["inputs", "scenes"])
        self.assertEqual([c.name for c in result.candidates], [c["name"] for c in document["candidates"]])
        self.assertAlmostEqual(sum(c.weight for c in result.candidates), 1, delta=1e-9)
        self.assertEqual(len(result.candidates), 2)
        (self.folder / "stiffer.toml").write_text(pathlib.Path(CABLE).read_text().replace("GJ = 0.1", "GJ = 0.2"))
        (self.folder / "models.toml").write_text(
            '[[candidate]]\nname = "as drawn"\n[[candidate]]\nname = "stiffer in torsion"\nscene = "stiffer.toml"\n')
        document = self.program("update", CABLE, *words, "--candidates", "models.toml", code=4)
        with self.assertRaises(rigfit.Refused) as caught:
            rigfit.update(CABLE, candidates=self.folder / "models.toml", **options)
        self.same(document, caught.exception.result, ["inputs", "scenes"])
        averaged = caught.exception.result.averaged
        self.assertEqual(averaged[0].name, "cable.tension")
        self.assertEqual(averaged[0].to_dict(), document["averaged"][0])

    def test_resample(self):
        document = self.program("resample", AXIAL[0], "--rate", 300, "--out", "slow.csv")
        result = rigfit.resample(AXIAL[0], 300, out=self.folder / "again.csv")
        self.same(document, result, ["out"])
        self.assertEqual((self.folder / "slow.csv").read_bytes(), (self.folder / "again.csv").read_bytes())
        self.assertEqual(result.recording.fs, 300)
        self.assertEqual(document["sample_rate_hz"], 300)
        self.assertEqual(len(result.recording.channels[0]), result.samples)
        at_hand = rigfit.resample(rigfit.read(AXIAL[0]), 300)
        np.testing.assert_array_equal(at_hand.recording.channels[0].data, result.recording.channels[0].data)

    def test_read_as_said(self):
        file = self.folder / "odd.csv"
        file.write_text("t;a (N)\n" + "".join(f"{i};{i},5\n" for i in range(100)))
        document = self.program("inspect", file, "--decimal", "comma", "--separator", "semicolon", "--time-unit", "ms")
        one = rigfit.read(file, decimal=",", separator=";", time_unit="ms", format="csv")
        self.assertEqual(one.fs, document["recordings"][0]["sample_rate_hz"])
        self.assertEqual(one.fs, 1000)
        np.testing.assert_array_equal(one["a"].data, np.arange(100) + 0.5)

    def test_synthesize(self):
        scene = DATA / "virtual_laboratory/truth/bench.toml"
        words = ["--bending-span", 0.5, "--axial-length", 0.7, "--taps", 1]
        self.program("synthesize", scene, "--out", "lab", "--seed", 11, *words)
        result = rigfit.synthesize(scene, self.folder / "again", seed=11, bending_span=0.5, axial_length=0.7, taps=1)
        self.assertTrue(result.files)
        for file in (self.folder / "lab").rglob("*.csv"):
            self.assertEqual(file.read_bytes(), (self.folder / "again" / file.relative_to(self.folder / "lab")).read_bytes())

    def test_report(self):
        (self.folder / "ei.csv").write_text("tension_N,EI_Nm2\n25,0.2549\n100,0.4948\n200,0.5972\n300,0.8283\n")
        campaign = self.folder / "campaign.toml"
        campaign.write_text('title = "one test"\n[[test]]\nname = "bending"\nkind = "bending"\nspan = 1.0\n'
                            '[test.table]\nfile = "ei.csv"\ntension = "tension_N"\nEI = "EI_Nm2"\n')
        document = self.program("report", campaign, "--out", self.folder / "by-program")
        self.same(document, rigfit.report(campaign, self.folder / "by-package"))
        for file in ("report.html", "report.json"):
            self.assertTrue((self.folder / "by-package" / file).exists())
        # Two campaigns, before and after; the short style.
        after = self.folder / "after.toml"
        after.write_text(campaign.read_text())
        document = self.program("report", campaign, after, "--out", self.folder / "compared", "--style", "client")
        self.assertTrue(rigfit.report(campaign, self.folder / "by-package").answers[0].quantity)
        self.same(document, rigfit.report([campaign, after], self.folder / "compared-too", style="client"))

    def test_refusals(self):
        time = np.arange(1000) / 500
        quiet = rigfit.Recording({"force": np.zeros(1000), "acc": np.sin(time)}, fs=500)
        with self.assertRaises(rigfit.Refused) as caught:
            rigfit.frf(quiet, "force")
        self.assertEqual(caught.exception.exit_code, 4)
        # A refusal with a result: the finding that the program calls refused, with its code in the document.
        table = self.folder / "still.csv"
        table.write_text("time (s),a (N)\n" + "".join(f"{i / 500},1\n" for i in range(500)))
        run = subprocess.run([PROGRAM, "decay", table, "--json", "-"], capture_output=True, text=True)
        self.assertEqual(run.returncode, 4)
        with self.assertRaises(rigfit.Refused) as caught:
            rigfit.decay(table)
        self.assertIn(caught.exception.problem, run.stderr[run.stderr.index("refused:"):])
        self.assertIn(caught.exception.code, [w["code"] for w in json.loads(run.stdout)["warnings"]])
        self.same(json.loads(run.stdout), caught.exception.result)
        if hasattr(caught.exception, "add_note"):
            self.assertIn("DecayResult", caught.exception.__notes__[0])
        # Options of the command line are arguments in Python's messages.
        with self.assertRaises(rigfit.UsageError) as caught:
            rigfit.decay(quiet)
        self.assertEqual((caught.exception.code, caught.exception.exit_code), ("wrong_usage", 2))
        self.assertIn("`channel`", str(caught.exception))
        (self.folder / "bad.csv").write_text("time (s),a (N)\n0,1\n0.1,x\n0.2,3\n")
        with self.assertRaises(rigfit.InputError) as caught:
            rigfit.inspect(self.folder / "bad.csv")
        self.assertEqual((caught.exception.exit_code, caught.exception.line), (3, 3))
        self.assertTrue(caught.exception.remedy)
        with self.assertRaises(rigfit.InputError) as caught:
            rigfit.Scene(rigfit.Scene(CABLE).to_toml() + "unknown = 1\n")
        self.assertEqual(caught.exception.code, "bad_input")
        self.assertIn("unknown", caught.exception.key)
        self.assertGreater(caught.exception.line, 10)
        with self.assertRaises(rigfit.NotConverged) as caught:
            scene = rigfit.Scene(CABLE)
            values = {"cable.tension": 1e-6}
            rigfit.modes(scene.with_parameters(values))
        self.assertEqual(caught.exception.result.equilibrium.to_dict()["status"] == "converged", False)


if __name__ == "__main__":
    unittest.main()
