// Two campaigns side by side: virtual laboratories of one beam, recorded twice, and of a beam that
// is 5 % stiffer. What was changed is named, what was not is not.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/run_program.h"

namespace rigfit::apps::compare_campaigns_test {
namespace {

/// A beam's recordings and the campaign that fits EI, tip mass and damping ratio to them.
std::string laboratory(const TemporaryFolder& folder, double EI_Nm2, int seed) {
  const auto scene = [&](double stiffness, double tip_kg) {
    return fmt::format(R"(title = "Beam"
[[node]]
name = "foot"
position = [0.0, -0.75, 0.0]
support = "clamped"
[[node]]
name = "tip"
position = [0.0, 0.0, 0.0]
mass = {}
[[member]]
name = "beam"
kind = "beam"
nodes = ["foot", "tip"]
segments = 30
mass_per_length = 0.301
EA = 7.5e6
EI = [{}, 260.0]
GJ = 3.2
damping_ratio = 0.01
[[load]]
name = "hammer"
kind = "impact"
member = "beam"
position = 0.8
direction = [1.0, 0.0, 0.0]
peak = 2.0
duration = 0.003
[[sensor]]
name = "acceleration"
member = "beam"
position = 0.87
direction = [1.0, 0.0, 0.0]
)",
                       tip_kg, stiffness);
  };
  folder.write("scene.toml", scene(1.8, 0.01));
  const auto made = run_line(
      "synthesize {} --out {} --seed {} --hits 3 --record 4 --rate 2048 --format uff --quiet",
      {folder.write("truth.toml", scene(EI_Nm2, 0.023)), folder.at("lab"), std::to_string(seed)});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  return folder.write("campaign.toml", fmt::format(R"(title = "Synthetic beam, laboratory {}"
[[scene]]
name = "beam"
file = "scene.toml"
[[test]]
name = "beam"
kind = "modal"
scene = "beam"
planes = ["in"]
force = "force"
responses = ["acceleration"]
band = [1.0, 160.0]
force_window = 0.012
exponential_window = 0.05
[[test.recording]]
files = ["lab/rig/hammer-*.uff"]
synthetic = true
[[fit]]
name = "fit"
title = "Beam fitted"
tests = ["beam"]
model_std = 0.001
[[fit.parameter]]
name = "beam.EI_z"
[[fit.parameter]]
name = "tip.mass"
[[fit.parameter]]
name = "beam.damping_ratio"
)",
                                                   seed));
}

/// Verdicts of the values that both have, by key; of several modes the worst one.
std::map<std::string, bool> changed(const std::string& before, const std::string& after) {
  const TemporaryFolder out;
  const auto run =
      run_line("report {} {} --out {} --quiet --seed 1", {before, after, out.path().string()});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  std::map<std::string, bool> verdicts;
  // All of the comparison is in the short report: no empty section in the appendix, no link to one.
  const std::string page = out.read("report.html");
  EXPECT_THAT(page, ::testing::HasSubstr("id=\"comparison\""));
  EXPECT_THAT(page, ::testing::Not(::testing::HasSubstr("comparison-details")));
  const auto document = parsed(out.read("report.json"));
  for (const auto& one : document["comparison"]) {
    if (one["before"].is_null() || one["after"].is_null()) continue;
    auto& worst = verdicts[one["key"].get<std::string>()];
    worst = worst || one["changed"].get<bool>();
  }
  return verdicts;
}

const auto kKeys = {"fit/beam.EI_z", "fit/tip.mass", "fit/beam.damping_ratio",
                    "beam/as built/frequency", "beam/as built/damping"};

TEST(TwoCampaigns, OfOneBeamDoNotDiffer) {
  const TemporaryFolder first, again;
  const auto repeated = changed(laboratory(first, 2.17, 1), laboratory(again, 2.17, 2));
  for (const char* key : kKeys) {
    ASSERT_TRUE(repeated.contains(key)) << key;
    EXPECT_FALSE(repeated.at(key)) << key;
  }
}

TEST(TwoCampaigns, NameWhatWasChangedAndNothingElse) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the test above runs the same code, and takes minutes";
#endif
  const TemporaryFolder first, stiffer;
  const auto changes = changed(laboratory(first, 2.17, 1), laboratory(stiffer, 1.2 * 2.17, 3));
  for (const char* key : kKeys) ASSERT_TRUE(changes.contains(key)) << key;
  // 20 % are six standard uncertainties of the difference or more, even where a doubtful mode
  // widens the interval of EI to 0.05 N m2.
  EXPECT_TRUE(changes.at("fit/beam.EI_z"));
  EXPECT_TRUE(changes.at("beam/as built/frequency"));
  EXPECT_FALSE(changes.at("fit/tip.mass"));
  EXPECT_FALSE(changes.at("fit/beam.damping_ratio"));
  EXPECT_FALSE(changes.at("beam/as built/damping"));
}

}  // namespace
}  // namespace rigfit::apps::compare_campaigns_test
