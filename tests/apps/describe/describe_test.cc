// A field or an option that is described is found wherever it is shown, without another line.
#include "apps/cli/verb.h"
#include "apps/describe/sheet.h"
#include "signal/numerics/numbers.h"
#include "tests/test.h"

namespace rigfit::describe_test {

struct Row {
  double length_m = 0, share = 0;
  signal::Estimate EA_N;

  static constexpr std::string_view title = "by length";
  static bool shown(const Row& row) { return row.share > 0; }
  static constexpr auto fields() {
    using T = Row;
    return std::tuple{field("length_m", &T::length_m, "m", "length", "between the grips"),
                      field("share", &T::share, "%", "share", "of the variance", 2),
                      field("EA_N", &T::EA_N, "N", "EA", "axial rigidity")};
  }
};
struct Result {
  describe::Bounded EA_N;
  std::optional<double> stiffness;
  double formula_N = NAN;
  std::vector<Row> rows;

  static constexpr auto fields() {
    using T = Result;
    return std::tuple{
        field("EA_N", &T::EA_N, "N", "EA", "axial rigidity"),
        field("stiffness_N_m", &T::stiffness, "N/m", "stiffness", "where it is known"),
        field("formula_N", &T::formula_N, "N", "a formula", "from the lowest mode"),
        field("rows", &T::rows, "", "rows", "what each length says")};
  }
};

namespace {

Result result() {
  return {{205188.4, 338, 204330, 206040},
          std::nullopt,
          NAN,
          {{0.7, 0.8, {205100, 900}}, {1.0, 0, {205230, 610}}}};
}

TEST(Describe, AFieldIsInTextJsonAndSchema) {
  const auto json = describe::json_of(result());
  EXPECT_EQ(
      json["EA_N"],
      (describe::Json{{"value", 205188.4}, {"std", 338.0}, {"low", 204330.0}, {"high", 206040.0}}));
  EXPECT_TRUE(json.at("stiffness_N_m").is_null());  // not known
  EXPECT_TRUE(json["formula_N"].is_null());
  EXPECT_EQ(json["rows"].size(), 2u);
  const auto schema = describe::schema_of<Result>();
  EXPECT_EQ(schema["properties"]["rows"]["items"]["properties"]["length_m"]["description"],
            "between the grips (m)");
  EXPECT_EQ(schema["properties"]["rows"]["items"]["properties"]["share"]["description"],
            "of the variance (1)");
  EXPECT_EQ(schema["properties"]["stiffness_N_m"]["anyOf"].size(), 2u);
  std::ostringstream out;
  describe::print(out, describe::sheet_of(result()));
  EXPECT_EQ(out.str(),
            "EA         205190 +- 340 N (95 %: 204330 to 206040)\n"
            "a formula  not applicable\n"
            "\n"
            "by length\n"
            "length, m  share, %          EA, N\n"
            "      0.7        80  205100 +- 900\n");  // the row without a share is left out
}

TEST(Describe, NumbersHaveNoExponentsWhereTheyStayReadable) {
  EXPECT_EQ(describe::number_text(0.9999, "%", 2), "100");
  EXPECT_EQ(describe::number_text(299.6, "N", 2), "300");
  EXPECT_EQ(describe::number_text(0.0213, "", 2), "0.021");
  EXPECT_EQ(describe::number_text(207.0224, "N", 6), "207.022");
  EXPECT_EQ(describe::estimate_text(-1e-10, 1.2e-8, "m/N"), "0.000 +- 0.012");
  EXPECT_EQ(describe::estimate_text(3.2e-14, 1.1e-15, ""), "3.20e-14 +- 1.1e-15");
  EXPECT_EQ(describe::estimate_text(0.5, 0.0996, ""), "0.50 +- 0.10");
  EXPECT_EQ(describe::estimate_text(1.23456789, NAN, ""), "1.23457");
  EXPECT_EQ(describe::estimate_text(42.4567980499, 1.4e-10, "Hz"), "42.4568");
  EXPECT_EQ(describe::estimate_text(42.4567980499, 1.4e-6, "Hz"), "42.4567980 +- 0.0000014");
}

TEST(Describe, AnOptionIsOnTheCommandLineAndInItsHelp) {
  double mass = 0;
  int draws = 20000;
  std::vector<double> lengths;
  apps::Verb verb;
  verb.name = "weigh";
  verb.does = "Weighs";
  verb.options = {
      describe::option("--mass", mass, "Hung mass, adapter included", "kg").required().positive(),
      describe::option("--draws", draws, "Monte Carlo draws").within(0, 100000),
      describe::option("--length", lengths, "Cable lengths", "m").positive()};
  apps::parse_options(verb, {"--mass", "2.5", "--length", "1", "2"});
  EXPECT_EQ(mass, 2.5);
  EXPECT_EQ(lengths, (std::vector<double>{1, 2}));
  const std::string help = apps::verb_help(verb, 60);
  EXPECT_THAT(help, HasSubstr("Hung mass, adapter included, kg"));
  EXPECT_THAT(help, HasSubstr("(0 to 100000;"));
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 60u) << line;
  EXPECT_THAT(
      [&] {
        apps::parse_options(verb, {"--mass", "nan"});
      },
      ::testing::ThrowsMessage<apps::UsageError>(HasSubstr("no positive number")));
  EXPECT_THAT(
      [&] {
        apps::parse_options(verb, {"--mas", "1"});
      },
      ::testing::ThrowsMessage<apps::UsageError>(HasSubstr("did you mean --mass?")));
}

TEST(Describe, HelpOfEveryVerbFitsEightyColumns) {
  const auto verbs = apps::all_verbs();
  for (const auto& verb : verbs) {
    std::istringstream lines(apps::verb_help(verb, 80));
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("Example")) break;  // commands stay as they are
      EXPECT_LE(line.size(), 80u) << verb.name << ": " << line;
    }
    for (const auto& option : verb.options) EXPECT_FALSE(option.text().empty()) << option.name;
  }
}

}  // namespace
}  // namespace rigfit::describe_test
