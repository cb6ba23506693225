#include "tests/apps/apps_test.h"

namespace rigfit::apps::decay_test {

std::string decay_csv(double f, double zeta, double rate, int samples, double noise, int quiet) {
  Normal normal(3);
  const double w = 2 * kPi * f, wd = w * std::sqrt(1 - zeta * zeta);
  std::string text = "time (s),force (N)\n";
  for (int j = 0; j < samples; ++j) {
    const double t = (j - quiet) / rate;
    const double y =
        21.6 + (j >= quiet ? std::exp(-zeta * w * t) * std::sin(wd * t) : 0.0) + noise * normal();
    text += std::to_string(j / rate) + "," + std::to_string(y) + "\n";
  }
  return text;
}

TEST(DecayVerb, GivesFrequencyAndDampingOfAFile) {
  TemporaryFolder folder;
  const auto file = folder.write("tap.csv", decay_csv(50, 0.017, 500, 800, 0.003, 200));
  const Document json = document_of("decay {} --channel force", {file});
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
  EXPECT_NEAR(mode["damping_ratio_log_decrement"], 0.017, 0.0017);
  EXPECT_GT(mode["r_squared"].get<double>(), 0.99);
  EXPECT_GE(json["window"]["start_s"].get<double>(), 0.399);
  EXPECT_TRUE(json.contains("frequency_drift_hz"));
  EXPECT_GE(json["amplitude_dependence"]["points"].size(), 2u);
  // Start and end are in the file's time.
  const auto given = document_of("decay {} --start 0.5 --end 0.9 --band 30 80", {file})["window"];
  EXPECT_NEAR(given["start_s"], 0.5, 1e-9);
  EXPECT_NEAR(given["end_s"], 0.9, 1e-9);
}

}  // namespace rigfit::apps::decay_test
