#include "tests/apps/apps_test.h"

namespace rigfit::apps::predict_verb_test {

const std::string kScene = RIGFIT_TESTDATA "/jalali2021/scenes/beam.toml";

// Fitted to the coupled rig alone (Table 5), the bare beam's frequencies (Table 2) come inside
// their intervals, from the second on within 3 %. The first, 2.24 Hz, comes 5.4 % low. 1.6 % of it
// is EI: 2.02 N m2 from the coupled rig, 2.08 from the bare beam's modes 2 to 5. The rest is the
// tip: the scene keeps the 0.02 kg of the coupled rig's sensor and U-bolts, which are not said to
// stay when the cables are taken off, and a mass there moves the first mode most (with 0.010 to
// 0.015 kg all five come within 2 %). So the published first mode must lie between the predictions
// with that mass and with none. The source's own model of the beam errs by 4.5 to 9.7 %.
TEST(PredictVerb, TheBareBeamFromTheCoupledRig) {
  const TemporaryFolder folder;
  const auto fit = folder.at("fit.json");
  const auto update = run_line(
      "update $/jalali2021/scenes/rig.toml --measured $/jalali2021/table5_cable_beam.csv --column "
      "test_Hz --stiffness $/jalali2021/table1_bending_stiffness.csv --free beam.EI_z --segments "
      "12 --starts 1 --out {} --json {}",
      {folder.at("o.toml"), fit});
  ASSERT_TRUE(update.exit_code == 0 || update.exit_code == 4) << update.err;
  const Document json = document_of(
      "predict $/jalali2021/scenes/beam.toml --from {} --count 8 --segments 30 --measured "
      "$/jalali2021/table2_beam_frequencies.csv --column test_Hz --plane in",
      {fit});
  ASSERT_EQ(json["measured"].size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    const auto& row = json["measured"][i];
    if (i > 0) {
      EXPECT_LT(std::abs(row["relative_error"].get<double>()), 0.03) << row.dump();
    }
    EXPECT_TRUE(row["inside"].get<bool>()) << row.dump();
  }
  // What is known of these numbers: the bare beam's tip carries between nothing and the rig's 0.02
  // kg, its mass is 0.29 to 0.30 kg/m, each rectangular (width over sqrt(12)). All five are then
  // within 3 %, inside their intervals, and the first is known less well than by EI alone.
  const Document with = document_of(
      "predict $/jalali2021/scenes/beam.toml --from {} --count 8 --segments 30 --measured "
      "$/jalali2021/table2_beam_frequencies.csv --column test_Hz --plane in --input "
      "tip.mass=0.01,0.00577 --input beam.mass_per_length=0.00289",
      {fit});
  ASSERT_EQ(with["measured"].size(), 5u);
  for (const auto& row : with["measured"]) {
    EXPECT_LT(std::abs(row["relative_error"].get<double>()), 0.03) << row.dump();
    EXPECT_TRUE(row["inside"].get<bool>()) << row.dump();
  }
  EXPECT_GT(with["modes"][0]["frequency_hz"]["std"], json["modes"][0]["frequency_hz"]["std"]);
  ASSERT_EQ(with["uncertain_inputs"].size(), 2u);
  EXPECT_FALSE(with["uncertain_inputs"][0]["shared_with_fit"].get<bool>());
  const auto bare = replaced(testing::content_of(kScene), "mass = 0.02", "mass = 0.00");
  constexpr double kPublished = 2.24;  // Hz, Table 2
  EXPECT_LT(json["measured"][0]["predicted_hz"].get<double>(), kPublished);
  EXPECT_GT(document_of("predict {} --from {} --count 1 --segments 30",
                        {folder.write("bare.toml", bare), fit})["modes"][0]["frequency_hz"]["value"]
                .get<double>(),
            kPublished);
}

// A fit at 195 N in a scene of 200 N: the fit's tension is used and said, or the scene's kept; a
// name that the scene lacks is wrong usage.
TEST(PredictVerb, TheScenesTensionIsReplacedKnowingly) {
  const TemporaryFolder folder;
  const auto scene = folder.write("s.toml", kCableScene);
  const Document both{{"parameters",
                       {{{"name", "cable.EI"}, {"value", 0.6}, {"std", 0.01}},
                        {{"name", "cable.tension"}, {"value", 195}, {"std", 1}}}}};
  const auto fit = folder.write("f.json", both.dump());
  const Document used = document_of("predict {} --from {} --count 1", {scene, fit});
  EXPECT_THAT(
      named(used["warnings"], "code", "input_is_fitted")["message"].get<std::string>(),
      HasSubstr(
          "--map cable.tension= to keep the scene's cable.tension of 200: the fit's 195 +- 1"));
  const Document kept =
      document_of("predict {} --from {} --count 1 --map cable.tension=", {scene, fit});
  EXPECT_TRUE(kept["warnings"].empty());
  EXPECT_NEAR(kept["modes"][0]["frequency_hz"]["value"].get<double>() /
                  used["modes"][0]["frequency_hz"]["value"].get<double>(),
              std::sqrt(200.0 / 195), 1e-3);  // a string's, but for EI
  const auto wrong = run_line("predict {} --from {} --map cable.tension=cable.T", {scene, fit});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("cannot be \"cable.T\""));
}

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

}  // namespace rigfit::apps::predict_verb_test
