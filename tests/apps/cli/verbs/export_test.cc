#include "tests/apps/apps_test.h"

namespace rigfit::apps::export_test {

TEST(ExportVerb, WritesADeckAndRefusesWhatItCannotSay) {
  const TemporaryFolder folder;
  const auto run =
      run_line("export $/jalali2021/scenes/cable.toml --calculix {}", {folder.path() / "ccx"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(folder.read("ccx/cable.inp"), HasSubstr("*FREQUENCY"));
  EXPECT_EQ(run_line("export $/jalali2021/scenes/cable.toml").exit_code, 2);
  EXPECT_EQ(run_line("export none.toml --calculix {}", {folder.path() / "x"}).exit_code, 3);
}

/// Read again: the line's type, its ends and its length are the scene's; with a fit its values, and
/// their interval before the first section. What lines cannot say is refused.
TEST(ExportVerb, WritesCablesForMoorDyn) {
  const TemporaryFolder folder;
  const std::string scenes = RIGFIT_TESTDATA "/jalali2021/scenes/";
  const std::string fit = folder.write("fit.json", R"({"parameters": [{"name": "cable.EA",
      "value": 200000.0, "std": 500.0, "low": 199000.0, "high": 201000.0}]})");
  const auto run = run_line("export $/jalali2021/scenes/cable.toml --moordyn {} --from {}",
                            {folder.path() / "md", fit});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::istringstream text(folder.read("md/cable.txt"));
  std::string line, section;
  std::map<std::string, std::vector<std::vector<std::string>>> rows;
  while (std::getline(text, line)) {
    if (line.starts_with("---")) {
      section = line;
      continue;
    }
    std::istringstream words(line);
    rows[section].emplace_back(std::istream_iterator<std::string>(words),
                               std::istream_iterator<std::string>());
  }
  EXPECT_THAT(folder.read("md/cable.txt"),
              HasSubstr("! cable.EA = 200000, 95 %: 199000 to 201000"));
  bool found = false;
  for (const auto& [name, all] : rows) {
    if (name.find(" LINES ") != std::string::npos) {
      ASSERT_EQ(all.size(), 3U);
      const double length = std::stod(all[2][4]);
      // 200 N stretch it by 200 / EA of its length; sag adds 2e-5.
      EXPECT_NEAR(length, 2.4 / (1 + 200.0 / 200000), 1e-4);
      found = true;
    }
    if (name.find("LINE TYPES") != std::string::npos) {
      ASSERT_EQ(all.size(), 3U);
      EXPECT_EQ(all[2][3], "200000");
      EXPECT_EQ(all[2][2], "0.16667");
    }
  }
  EXPECT_TRUE(found);
  const auto beam =
      run_line("export $/jalali2021/scenes/rig.toml --moordyn {}", {folder.path() / "md"});
  EXPECT_EQ(beam.exit_code, 3);
  EXPECT_THAT(beam.err, HasSubstr("is a beam"));
}

TEST(SynthesizeVerb, WritesRecordingsThatTheOtherVerbsReadBack) {
  const TemporaryFolder folder;
  const std::string out = folder.path() / "lab";
  EXPECT_EQ(document_of("synthesize $/jalali2021/scenes/cable.toml --out {} --seed 7 --hits 3 "
                        "--record 4 --finer 1 --bending-span 1 --axial-length 1.0 --taps 1",
                        {out})["data"],
            "synthetic");
  const Document truth = parsed(folder.read("lab/truth.json"));
  EXPECT_EQ(truth["seed"], 7);
  ASSERT_EQ(truth["rig"][0]["records"].size(), 3u);
  EXPECT_THAT(folder.read("lab/rig/hammer-hit1.csv"), HasSubstr("synthetic"));

  // The tap's frequency comes back: 1 s of decay at 30 dB and more gives it to well under 0.1 %.
  const double damped = truth["axial"][0]["frequency_hz"];
  const double ratio = truth["axial"][0]["damping_ratio"];
  const double natural = damped / std::sqrt(1 - ratio * ratio);
  const Document mode =
      document_of("decay {}/axial/L1m-1.csv --channel tension --band 20 100", {out})["modes"][0];
  EXPECT_NEAR(mode["frequency_hz"]["value"], natural, 1e-3 * natural);
  EXPECT_NEAR(mode["damping_ratio"]["value"], ratio, 0.05 * ratio);
}

TEST(SynthesizeVerb, SeveralTensionsInUffAndTheirTruth) {
  const TemporaryFolder folder;
  const std::string out = folder.path() / "lab";
  const auto made = run_line(
      "synthesize $/jalali2021/scenes/cable.toml --out {} --tension 100 200 --tension-std 0.01 "
      "--hits 1 --double-hits 0 --record 1 --finer 1 --format uff --bending-span 0.5 --stiffness "
      "$/jalali2021/table1_bending_stiffness.csv",
      {out});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const Document truth = parsed(folder.read("lab/truth.json"));
  ASSERT_EQ(truth["rig"].size(), 2u);
  ASSERT_EQ(truth["bending"].size(), 2u);
  EXPECT_EQ(truth["rig"][1]["tension_meant_N"], 200);
  const double tension = truth["rig"][1]["parameters"]["cable.tension"];
  EXPECT_NE(tension, 200);
  EXPECT_NEAR(tension, 200, 5 * 2);
  EXPECT_NEAR(truth["bending"][0]["EI_Nm2"], 0.4948, 1e-12);
  EXPECT_THAT(folder.read("lab/rig/T200N-hammer-hit1.uff"), HasSubstr("synthetic"));
}

}  // namespace rigfit::apps::export_test
