#include "tests/apps/apps_test.h"

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

}  // namespace rigfit::apps::report_test
