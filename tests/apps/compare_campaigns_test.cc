// Two campaigns side by side: virtual laboratories of one beam, and of a beam that is 20 % stiffer.
// What was changed is named, what was not is not.
#include "model/scene/read_scene.h"
#include "tests/apps/apps_test.h"
#include "tests/scenes.h"

namespace rigfit::apps::compare_campaigns_test {

/// A beam's recordings and the campaign that fits EI, tip mass and damping ratio to them.
std::string laboratory(const TemporaryFolder& folder, double EI_Nm2, int seed) {
  const auto scene = [](double EI, double tip_kg) {
    auto beam = model::testing::vertical_beam(0.75, EI, 0.301);
    beam.nodes[1].mass = tip_kg;
    beam.members[0].EI[1] = 260;
    beam.members[0].damping_ratio = 0.01;
    beam.loads = {model::testing::impact({"", "beam", 0.8}, {1, 0, 0}, 2, 0.003)};
    beam.sensors = {
        model::testing::sensor("beam", 0.87, model::Sensor::Quantity::acceleration, {1, 0, 0})};
    return model::scene_text(beam);
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
band = [1.0, 160.0]
force_window = 0.012
exponential_window = 0.05
[[test.recording]]
files = ["lab/rig/hammer-*.uff"]
synthetic = true
[[fit]]
name = "fit"
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

TEST(TwoCampaigns, NameWhatWasChangedAndNothingElse) {
  const TemporaryFolder first, stiffer, out;
  const auto run = run_line(
      "report {} {} --out {} --quiet --seed 1",
      {laboratory(first, 2.17, 1), laboratory(stiffer, 1.2 * 2.17, 3), out.path().string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  // All of the comparison is in the short report: no empty section in the appendix, no link to one.
  const std::string page = out.read("report.html");
  EXPECT_THAT(page, HasSubstr("id=\"comparison\""));
  EXPECT_THAT(page, Not(HasSubstr("comparison-details")));
  // Verdicts of the values that both have, by key; of several modes the worst one.
  std::map<std::string, bool> changes;
  const auto document = parsed(out.read("report.json"));
  for (const auto& one : document["comparison"]) {
    if (one["before"].is_null() || one["after"].is_null()) continue;
    auto& worst = changes[one["key"].get<std::string>()];
    worst = worst || one["changed"].get<bool>();
  }
  // 20 % are six standard uncertainties of the difference or more, even where a doubtful mode
  // widens the interval of EI to 0.05 N m2.
  for (const auto& [key, changed] : {std::pair{"fit/beam.EI_z", true},
                                     {"beam/as built/frequency", true},
                                     {"fit/tip.mass", false},
                                     {"fit/beam.damping_ratio", false},
                                     {"beam/as built/damping", false}}) {
    ASSERT_TRUE(changes.contains(key)) << key;
    EXPECT_EQ(changes.at(key), changed) << key;
  }
}

}  // namespace rigfit::apps::compare_campaigns_test
