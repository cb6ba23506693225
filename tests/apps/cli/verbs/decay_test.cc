#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "tests/apps/run_program.h"

namespace rigfit::apps::decay_test {
namespace {
using ::testing::HasSubstr;

std::string decay_csv(double f, double zeta, double rate, int samples, double noise,
                      int quiet = 0) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal(0, noise);
  const double w = 2 * std::numbers::pi * f, wd = w * std::sqrt(1 - zeta * zeta);
  std::string text = "time (s),force (N)\n";
  for (int j = 0; j < samples; ++j) {
    const double t = (j - quiet) / rate;
    const double y =
        21.6 + (j >= quiet ? std::exp(-zeta * w * t) * std::sin(wd * t) : 0.0) + normal(generator);
    text += std::to_string(j / rate) + "," + std::to_string(y) + "\n";
  }
  return text;
}

TEST(DecayVerb, GivesFrequencyAndDampingOfAFile) {
  TemporaryFolder folder;
  const auto file = folder.write("tap.csv", decay_csv(50, 0.017, 500, 800, 0.003, 200));
  const nlohmann::json json = document_of("decay {} --channel force", {file});
  EXPECT_EQ(json["command"], "decay");
  EXPECT_EQ(json["inputs"].size(), 1u);
  ASSERT_EQ(json["modes"].size(), 1u);
  const auto& mode = json["modes"][0];
  const double f = mode["frequency_hz"]["value"], f_std = mode["frequency_hz"]["std"];
  const double z = mode["damping_ratio"]["value"], z_std = mode["damping_ratio"]["std"];
  EXPECT_NEAR(f, 50, 5 * f_std);
  EXPECT_NEAR(z, 0.017, 5 * z_std);
  EXPECT_LT(f_std, 0.05);
  // The ruler is a check: within a tenth.
  EXPECT_NEAR(mode["damping_ratio_log_decrement"].get<double>(), 0.017, 0.0017);
  EXPECT_GT(mode["r_squared"].get<double>(), 0.99);
  EXPECT_GE(json["window"]["start_s"].get<double>(), 0.399);
  EXPECT_TRUE(json.contains("frequency_drift_hz"));
  EXPECT_GE(json["amplitude_dependence"]["points"].size(), 2u);
}

TEST(DecayVerb, TakesStartEndAndBandInTheFilesTime) {
  TemporaryFolder folder;
  const auto file = folder.write("tap.csv", decay_csv(50, 0.017, 500, 800, 0.003));
  const nlohmann::json json = document_of("decay {} --start 0.1 --end 0.9 --band 30 80", {file});
  EXPECT_NEAR(json["window"]["start_s"].get<double>(), 0.1, 1e-9);
  EXPECT_NEAR(json["window"]["end_s"].get<double>(), 0.9, 1e-9);
}

TEST(DecayVerb, ExitCodesSayWhoseFaultItIs) {
  TemporaryFolder folder;
  const auto file = folder.write("tap.csv", decay_csv(50, 0.017, 500, 800, 0.003));
  EXPECT_EQ(run_line("decay").exit_code, 2);
  EXPECT_EQ(run_line("decay {} --band 80 30", {file}).exit_code, 2);
  EXPECT_EQ(run_line("decay {} --start 5", {file}).exit_code, 2);
  EXPECT_EQ(run_line("decay {}", {folder.at("none.csv")}).exit_code, 3);
  const auto unknown = run_line("decay {} --channel gyro", {file});
  EXPECT_EQ(unknown.exit_code, 3);
  EXPECT_THAT(unknown.err, HasSubstr("force"));
  const auto quiet = folder.write("noise.csv", decay_csv(50, 0.017, 500, 800, 0.003, 800));
  const auto refused = run_line("decay {} --json -", {quiet});
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_EQ(parsed(refused.out)["modes"].size(), 0u);
  EXPECT_THAT(refused.err, HasSubstr("noise"));
}

// Both call ident::run_decay_test: the same numbers to the last digit.
TEST(DecayVerb, AndReportGiveTheSameNumbers) {
  TemporaryFolder folder, out;
  // Two taps: 1.6 s and 2.4 s of the record are decays.
  std::string text = decay_csv(20, 0.02, 500, 800, 0.003, 100);
  const std::string second = decay_csv(20, 0.02, 500, 1200, 0.004, 50);
  int line = 0;
  for (std::size_t at = second.find('\n') + 1; at < second.size(); ++line) {
    const std::size_t comma = second.find(',', at), end = second.find('\n', at);
    text += std::to_string((800 + line) / 500.0) + second.substr(comma, end - comma + 1);
    at = end + 1;
  }
  const auto file = folder.write("taps.csv", text);
  folder.write("campaign.toml", R"(title = "Taps"
[[test]]
name = "taps"
kind = "decay"
[[test.recording]]
files = ["taps.csv"]
)");
  const nlohmann::json verb = document_of("decay {}", {file});
  const auto report =
      run_line("report {} --out {}", {folder.at("campaign.toml"), out.path().string()});
  ASSERT_EQ(report.exit_code, 0) << report.err;
  const auto document = parsed(out.read("report.json"));
  const auto& record = document["decays"][0]["records"][0];
  ASSERT_EQ(verb["decays"].size(), 2u);
  EXPECT_EQ(record["decays"], verb["decays"]);
  ASSERT_EQ(record["modes"].size(), verb["modes"].size());
  for (std::size_t m = 0; m < verb["modes"].size(); ++m) {
    for (const char* key :
         {"frequency_hz", "damping_ratio", "log_decrement", "amplitude", "cycles", "r_squared"}) {
      EXPECT_EQ(record["modes"][m][key], verb["modes"][m][key]) << key;
    }
  }
  // delta = 2 pi zeta / sqrt(1 - zeta^2)
  const double zeta = verb["modes"][0]["damping_ratio"]["value"];
  EXPECT_NEAR(verb["modes"][0]["log_decrement"]["value"].get<double>(),
              2 * std::numbers::pi * zeta / std::sqrt(1 - zeta * zeta), 1e-12);
  const auto each = document_of("decay {} --each", {file});
  ASSERT_EQ(each["pooled"].size(), 1u);
  EXPECT_EQ(each["pooled"][0]["decays"], 2);
  EXPECT_TRUE(each["decays"][0]["fitted"].get<bool>() && each["decays"][1]["fitted"].get<bool>());
}

}  // namespace
}  // namespace rigfit::apps::decay_test
