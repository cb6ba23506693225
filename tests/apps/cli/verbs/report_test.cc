#include "model/scene/read_scene.h"
#include "tests/apps/apps_test.h"
#include "tests/scenes.h"

namespace rigfit::apps::report_test {

struct PublishedTables : ReportOfACampaign<PublishedTables> {
  static constexpr const char* kCampaign = "jalali2021/campaign.toml";
};

TEST_F(PublishedTables, WritesPageDocumentDataAndFigures) {
  ASSERT_EQ(run_.exit_code, 0) << run_.err;
  ASSERT_TRUE(document_.is_object());
  EXPECT_EQ(document_["command"], "report");
  EXPECT_EQ(document_["inputs"].size(), 9u);  // campaign, 3 scenes, 5 tables
  ASSERT_GE(document_["figures"].size(), 5u);
  for (const auto& figure : document_["figures"]) {
    const std::string data = folder_->read(figure["data"]);  // a line of names, lines of values
    EXPECT_LT(data.find(','), data.find('\n')) << figure["data"];
    EXPECT_LT(data.find('\n') + 1, data.size()) << figure["data"];
    EXPECT_THAT(folder_->read(figure["figure"]), HasSubstr("</svg>"));
  }
  const std::string page = folder_->read("report.html");
  EXPECT_LT(page.size(), 8'000'000u);
  EXPECT_TRUE(page.ends_with("</html>\n"));
  EXPECT_THAT(page, Not(HasSubstr("src=\"http")));
  EXPECT_THAT(page, HasSubstr("Time of each stage"));
  EXPECT_THAT(run_.out, HasSubstr("report.html"));
}

// The load cell's errors, or tensions known to 2 %, leave nearly all of the cable's disagreement;
// free tensions explain more than half of it. States are held out.
TEST_F(PublishedTables, FitsOfTheCableShowWhatTensionsExplain) {
  const auto fit = [](const char* name) { return named(document_["fits"], "name", name); };
  const auto rms = [](const Document& one) { return one.at("rms_relative_error").get<double>(); };
  const double published = fit("fit-cable-tension-free")["rms_relative_error_before"];
  EXPECT_GT(rms(fit("fit-cable-load-cell")), 0.8 * published);
  EXPECT_GT(rms(fit("fit-cable-tension-known")), 0.9 * published);
  EXPECT_LT(rms(fit("fit-cable-tension-free")), 0.5 * published);
  for (const char* name : {"fit-cable-load-cell", "fit-cable-tension-known"}) {
    EXPECT_EQ(fit(name)["hold_out"].size(), 8u) << name;
    EXPECT_GE(fit(name)["rms_relative_error_held_out"].get<double>(), rms(fit(name))) << name;
  }
}

// Equation (19) solved for EI from the slope that each published EI means gives that EI back; the
// inversion is good to some units in the last place times the sensitivity of EI (below 10 here).
TEST_F(PublishedTables, BendingEquationGivesTableOneBack) {
  const auto& bending = named(document_["bending"], "test", "bending");
  const double published[] = {0.2549, 0.4948, 0.5972, 0.8283};
  ASSERT_EQ(bending["tests"].size(), 4u);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(bending["tests"][i]["EI_Nm2"]["value"], published[i], 1e-12 * published[i]);
  }
  // (20) and (21) as printed; EImin's wire diameter was inferred to four digits.
  EXPECT_NEAR(bending["bounds"]["EI_min_Nm2"], 0.0306, 1e-3 * 0.0306);
  EXPECT_NEAR(bending["bounds"]["EI_max_Nm2"], 15.5632, 1e-4 * 15.5632);
}

// Modes are paired, not compared by row: the second rows of Table 4 at 100 and 200 N lie at the
// in-plane fundamental and must be found as such.
TEST_F(PublishedTables, CrossPlaneRowsOfTableFourAreFound) {
  const auto& modal = named(document_["modal"], "test", "cable-out-of-plane");
  for (const auto& state : modal["states"]) {
    const double T = state["tension_N"];
    EXPECT_NEAR(state["equilibrium"]["members"][0]["tension_N"], T, 1e-6 * T);
    if (T != 100 && T != 200) continue;
    EXPECT_TRUE(state["pairs"][1]["other_plane"].get<bool>()) << T;
    EXPECT_EQ(state["pairs"][1]["plane"], "in") << T;
    EXPECT_FALSE(state["pairs"][0]["other_plane"].get<bool>()) << T;
  }
}

TEST_F(PublishedTables, NoValueIsLeftWithoutANumberWhereOneIsDue) {
  for (const auto& modal : document_["modal"]) {
    EXPECT_TRUE(modal["rms_relative_error"].is_number()) << modal["test"];
    for (const auto& state : modal["states"]) {
      EXPECT_EQ(state["equilibrium"]["status"], "converged");
      for (const auto& mode : state["modes"]) EXPECT_TRUE(mode["frequency_hz"].is_number());
      for (const auto& pair : state["pairs"]) EXPECT_TRUE(pair["measured_hz"].is_number());
    }
  }
}

TEST_F(PublishedTables, SameNumbersOnOneThread) {
  const TemporaryFolder other;
  const std::string before = R"({"command": "report", "title": "Another rig"})";
  other.write("report.json", before);
  const std::string command = "report $/jalali2021/campaign.toml --quiet --out {}";
  const auto refused = run_line(command, {other.path().string()});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("Another rig"), HasSubstr("--force")));
  EXPECT_EQ(other.read("report.json"), before);
  const auto run = run_line(command + " --force", {other.path().string()});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(other.read("report.json"), folder_->read("report.json"));
  // The same campaign's, though its title was another.
  auto own = Json::parse(other.read("report.json"));
  own["title"] = "Another rig";
  other.write("report.json", own.dump());
  EXPECT_EQ(run_line(command, {other.path().string()}).exit_code, 0);
}

// Two campaigns side by side: virtual laboratories of one beam, and of a beam that is 20 % stiffer.
// What was changed is named, what was not is not.

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

}  // namespace rigfit::apps::report_test
