#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/apps/run_program.h"

namespace rigfit::apps::new_test {
namespace {

using ::testing::HasSubstr;

TEST(New, WritesACampaignThatRunsAndNeverOverwrites) {
  const TemporaryFolder folder;
  const std::string rig = (folder.path() / "rig").string();
  const auto made = run_program({"new", rig, "--json", "-"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(parsed(made.out)["files"].size(), 4u);
  const auto report = run_program({"report", rig + "/campaign.toml"});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  EXPECT_THAT(folder.read("rig/report/report.html"), HasSubstr("Example: a cable in a test rig"));
  const auto again = run_program({"new", rig});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("exists already"));
  EXPECT_EQ(run_program({"new"}).exit_code, 2);
}

// A folder as it comes: a static table of two forces, a swing in volts, a picture. Nothing is
// written there; what is not used is said; the campaign runs.
TEST(New, AFolderOfMixedFiles) {
  const TemporaryFolder folder;
  std::string table = "Nr;Vorspannkraft [N];Querkraft [N];Weg [mm]\n";
  for (int k = 1; k <= 12; ++k) {
    std::string line = fmt::format("{};{:.2f};{:.3f};{:.5f}\n", k, 100 + 0.03 * (k % 3), 0.5 * k,
                                   0.5 * k / 3.0 + 1e-5 * (k % 2));
    std::replace(line.begin(), line.end(), '.', ',');
    table += line;
  }
  const std::string file = folder.write("data/table.csv", table);
  std::string swing = "Einheit;V\nZeit;CH1;CH2\n";
  for (int k = 0; k < 2000; ++k) {
    const double t = 1e-3 * k, x = std::exp(-3 * t) * std::sin(2 * std::numbers::pi * 25 * t);
    swing += fmt::format("{:.3f};{:.6f};{:.6f}\n", t, 0.1 * x + 1e-4 * std::sin(97.0 * k * k), x);
  }
  folder.write("data/swing.csv", swing);
  folder.write("data/photo.jpg", "\xFF\xD8\xFF...");
  const std::string data = (folder.path() / "data").string();
  const std::string rig = (folder.path() / "rig").string();
  const auto run = run_program(
      {"new", rig, "--from", data, "--span", "1", "--sensitivity", "CH1=100 mV/g", "--json", "-"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(parsed(run.out)["files"], ::testing::ElementsAre(rig + "/campaign.toml"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(data), {}), 3);
  EXPECT_THAT(run.err, HasSubstr("photo.jpg"));
  const std::string text = folder.read("rig/campaign.toml");
  EXPECT_THAT(text, HasSubstr("tension = \"Vorspannkraft\", load = \"Querkraft\""));
  EXPECT_THAT(text, HasSubstr("sensitivity_unit = \"mV/g\""));
  const auto report = run_program({"report", rig + "/campaign.toml", "--json", "-"});
  EXPECT_THAT(report.exit_code, ::testing::AnyOf(0, 4)) << report.err;
  EXPECT_TRUE(std::filesystem::exists(rig + "/report/report.html"));
  const auto test = parsed(report.out)["bending"][0]["tests"][0];
  EXPECT_NEAR(test["tension_N"].get<double>(), 100, 0.1);
  // The same table by the verb, whose columns it finds.
  const auto bending = run_program({"bending", file, "--span", "1", "--json", "-"});
  EXPECT_EQ(parsed(bending.out)["tests"][0]["EI_Nm2"], test["EI_Nm2"]) << bending.err;
  const auto inspected = run_program({"inspect", file});
  EXPECT_THAT(inspected.err, HasSubstr("rigfit bending"));

  for (const auto& [options, message] :
       std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--from", data + "/swing.csv", "--span", "1"},
            "--span belongs to none of these tests"},
           {{"--example", "--mass", "2"}, "--mass: is given without --from"},
           {{"--from", data + "/swing.csv", "--kind", "tension"}, "give the length"},
           {{"--from", data + "/swing.csv", "--kind", "axial", "--length", "1", "2"},
            "2 lengths"}}) {
    std::vector<std::string> command{"new", rig + "2"};
    command.insert(command.end(), options.begin(), options.end());
    const auto refused = run_program(command);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr(message));
  }
  EXPECT_FALSE(std::filesystem::exists(rig + "2"));
  const auto tension = run_program({"new", rig + "3", "--from", data + "/swing.csv", "--kind",
                                    "tension", "--length", "2.4", "--mass-per-length", "0.167"});
  EXPECT_EQ(tension.exit_code, 0) << tension.err;
  EXPECT_THAT(folder.read("rig3/campaign.toml"), HasSubstr("length = 2.4"));
  const auto only = run_program({"new", rig + "4", "--from", data + "/photo.jpg"});
  EXPECT_EQ(only.exit_code, 3);
  // Load over extension may be of a beam that was bent or of a cable that was pulled: it is asked.
  const std::string pull = folder.write(
      "pull.csv", "Load (N);Extension (mm)\n0,0;0,000\n100,0;1,333\n200,0;2,667\n300,0;4,000\n");
  const auto asked = run_program({"new", rig + "5", "--from", pull});
  EXPECT_EQ(asked.exit_code, 3);
  EXPECT_THAT(asked.err, HasSubstr("EA is its length times the slope"));
  const auto bent =
      run_program({"new", rig + "6", "--from", pull, "--kind", "bending", "--span", "2"});
  EXPECT_EQ(bent.exit_code, 0) << bent.err;
}

}  // namespace
}  // namespace rigfit::apps::new_test
