#include "ident/bending/bending_equation.h"

#include "tests/apps/apps_test.h"

namespace rigfit::apps::bending_verb_test {

// Loading and unloading straight from the equation, one or more tensions.
std::string table(double EI, const std::vector<double>& tensions, double span) {
  std::string text = "tension (N),load (N),deflection (mm)\n";
  for (double P : tensions) {
    for (int i = 0; i <= 20; ++i) {
      const double d = 1e-3 * (i <= 10 ? i : 20 - i) / 10;
      text += std::to_string(P) + "," + std::to_string(d / ident::midspan_compliance(EI, P, span)) +
              "," + std::to_string(1e3 * d) + "\n";
    }
  }
  return text;
}

TEST(BendingVerb, TableOfRecordsGivesStiffnessAtEachTension) {
  const TemporaryFolder folder;
  const auto file = folder.write("bend.csv", table(0.6, {50, 150, 300}, 0.5));
  const Document json = document_of("bending {} --span 0.5", {file});
  ASSERT_EQ(json["tests"].size(), 3U);
  for (const auto& test : json["tests"]) {
    // The table holds six decimals of newtons and of millimetres: 1e-6 relative, times the
    // conditioning of the equation.
    EXPECT_NEAR(test["EI_Nm2"]["value"], 0.6, 1e-4);
    EXPECT_LE(test["EI_Nm2"]["low"].get<double>(), test["EI_Nm2"]["value"].get<double>());
    EXPECT_GE(test["EI_Nm2"]["high"].get<double>(), test["EI_Nm2"]["value"].get<double>());
  }
  EXPECT_NEAR(json["tests"][2]["tension_N"], 300, 1e-9);
  EXPECT_FALSE(json["laws"].empty());
  EXPECT_TRUE(json["bounds"].is_null());
}

TEST(BendingVerb, ReadsItsOwnIntervals) {
  const TemporaryFolder folder;
  const auto file = folder.write(
      "t.csv", "tension_N,EI_Nm2,low,high\n25,0.25,0.2,0.3\n100,0.5,0.45,0.55\n200,0.6,0.5,0.7\n");
  const Document json = document_of("bending {}", {file});
  EXPECT_DOUBLE_EQ(json["tests"][0]["EI_Nm2"]["low"], 0.2);
  EXPECT_DOUBLE_EQ(json["tests"][0]["EI_Nm2"]["high"], 0.3);
}

TEST(BendingVerb, WrongSpanIsRefusedByName) {
  const TemporaryFolder folder;
  const auto file = folder.write("bend.csv", table(0.05, {300}, 0.6));
  const auto run = run_line("bending {} --span 0.4 --json -", {file});
  EXPECT_EQ(run.exit_code, 4) << run.err;
  const Document json = parsed(run.out);
  EXPECT_TRUE(json["tests"][0]["EI_Nm2"]["value"].is_null());
  EXPECT_THAT(run.err, HasSubstr("not below 1"));
}

// 1 mm is 12.5 % of the first span and 8 % of the second.
TEST(BendingVerb, DeflectionsThatAreNotSmallAreSaid) {
  const TemporaryFolder folder;
  const auto said = [&](double span) {
    const auto file = folder.write("bend.csv", table(0.6, {50}, span));
    const Document json = document_of(fmt::format("bending {{}} --span {}", span), {file});
    return (json["warnings"].dump() + json["notes"].dump()).find("large_deflection") !=
           std::string::npos;
  };
  EXPECT_TRUE(said(0.008));
  EXPECT_FALSE(said(0.0125));
}

}  // namespace rigfit::apps::bending_verb_test
