#include "tests/apps/apps_test.h"

namespace rigfit::apps::plan_verb_test {

TEST(PlanVerb, ProposesTestsUntilTheGoalsAreReached) {
  const Document json = document_of(
      "plan $/jalali2021/scenes/rig.toml --goal beam.EI_z=1% tip.mass=0.0001 --free 'tension=left "
      "cable.tension,right cable.tension'");
  ASSERT_EQ(json["goals"].size(), 2u);
  for (const auto& goal : json["goals"]) EXPECT_TRUE(goal["reached"].get<bool>()) << goal.dump();
  EXPECT_NEAR(json["goals"][0]["std"], 0.021, 1e-12);
  EXPECT_NEAR(json["goals"][1]["std"], 0.0001, 1e-12);
  ASSERT_GE(json["proposals"].size(), 1u);
  // The last step leaves what the parameters say; each costs its five hits of 4 s at least.
  for (const auto& proposal : json["proposals"]) {
    EXPECT_GE(proposal["cost"].get<double>(), 20);
    ASSERT_EQ(proposal["parameters"].size(), 3u);
  }
  for (std::size_t p = 0; p < 3; ++p) {
    const auto& parameter = json["parameters"][p];
    EXPECT_EQ(json["proposals"].back()["parameters"][p]["std"], parameter["std"]);
    EXPECT_LE(parameter["best_std"].get<double>(), parameter["std"].get<double>());
  }
  EXPECT_TRUE(json["not_identifiable"].empty());
  EXPECT_GE(json["modes"].size(), 3u);
  const auto text = run_line("plan $/jalali2021/scenes/cable.toml --goal cable.EI=5%");
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("hits of 4 s"));
  EXPECT_THAT(text.out, HasSubstr("goal 0.030: reached"));
}

TEST(PlanVerb, RefusesAGoalOutOfReachAndSaysWhatItWouldTake) {
  const auto run = run_line(
      "plan $/jalali2021/scenes/cable.toml --goal cable.EI=0.001% --free cable.GJ --json -");
  ASSERT_EQ(run.exit_code, 4) << run.err;
  EXPECT_THAT(run.err, HasSubstr("times more accurate"));
  const auto json = parsed(run.out);
  EXPECT_FALSE(json["goals"][0]["reached"].get<bool>());
  EXPECT_FALSE(json["proposals"].empty());
  ASSERT_EQ(json["not_identifiable"].size(), 1u);
  EXPECT_EQ(json["not_identifiable"][0]["parameters"][0], "cable.GJ");
  EXPECT_TRUE(json["parameters"][0]["std"].is_null());
}

}  // namespace rigfit::apps::plan_verb_test
