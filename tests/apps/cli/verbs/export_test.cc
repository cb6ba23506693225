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

}  // namespace rigfit::apps::export_test
