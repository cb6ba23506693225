#include <numeric>

#include "tests/apps/apps_test.h"

namespace rigfit::apps::tension_verb_test {

// A pinned cable of 20 m, 5 kg/m and 50 kN with EI = 200 N m2: f_n = sqrt(n^2 T / (4 m L^2) +
// n^4 pi^2 EI / (4 m L^4)), sag w L / (8 T) = 2.5e-3 of the span.
constexpr double kLength = 20, kMass = 5, kTension = 5e4, kEI = 200;

double frequency(int n) {
  return std::sqrt(n * n * kTension / (4 * kMass * kLength * kLength) +
                   std::pow(n, 4) * kPi * kPi * kEI / (4 * kMass * std::pow(kLength, 4)));
}

const std::string kCable =
    "tension --length 20,0.002 --mass-per-length 5,0.005 --EI 200,10 --EA 2e7 --mass-of installed "
    "--plane out ";

std::string frequencies(std::vector<int> orders) {
  std::string text = " --frequencies";
  for (const int n : orders) text += " " + std::to_string(frequency(n));
  return text;
}

void expect_tension(const Document& json) {
  const auto& T = json["tension_N"];
  EXPECT_LT(T["low"].get<double>(), kTension);
  EXPECT_GT(T["high"].get<double>(), kTension);
  EXPECT_NEAR(T["value"].get<double>() / kTension, 1, 0.02);
  EXPECT_TRUE(json["decided"].get<bool>());
  ASSERT_EQ(json["candidates"].size(), 4u);
  double weights = 0, squares = 0;
  for (const auto& one : json["candidates"]) weights += one["weight"].get<double>();
  EXPECT_NEAR(weights, 1, 1e-9);
  for (const auto& term : json["budget"]) squares += std::pow(term["std_N"].get<double>(), 2);
  EXPECT_NEAR(std::sqrt(squares) / T["std"].get<double>(), 1, 1e-6);
}

TEST(TensionVerb, FromFrequenciesWithAMissingAndAFalseOne) {
  const auto json = document_of(kCable + "--frequency-std 0.004" + frequencies({1, 2, 4, 5}) + " " +
                                std::to_string(1.17 * frequency(2)));  // no mode of this cable
  expect_tension(json);
  std::vector<int> orders;
  for (const auto& mode : json["modes"])
    orders.push_back(mode["order"].is_null() ? 0 : mode["order"].get<int>());
  EXPECT_EQ(orders, (std::vector<int>{1, 2, 0, 4, 5}));
  EXPECT_NEAR(json["formulas"]["pinned_beam_N"].get<double>() / kTension, 1, 1e-2);
}

TEST(TensionVerb, OneFrequencyWhoseOrderIsStated) {
  const auto json = document_of(kCable + "--frequency-std 0.004" + frequencies({3}) + " --order 3");
  EXPECT_LT(json["tension_N"]["low"].get<double>(), kTension);
  EXPECT_GT(json["tension_N"]["high"].get<double>(), kTension);
  EXPECT_EQ(json["modes"][0]["order"], 3);
}

TEST(TensionVerb, OrdersOfATable) {
  const TemporaryFolder folder;
  // Every second mode alone looks like a string of four times the tension.
  std::ostringstream table;
  table << "order,frequency_hz,frequency_std_hz\n";
  for (const int n : {2, 4, 6}) table << n << ',' << frequency(n) << ",0.004\n";
  const auto json = document_of(kCable + "--measured {}", {folder.write("modes.csv", table.str())});
  EXPECT_NEAR(json["tension_N"]["value"].get<double>() / kTension, 1, 0.02);
}

TEST(TensionVerb, SixtyFrequencies) {
  std::vector<int> orders(60);
  std::iota(orders.begin(), orders.end(), 1);
  const auto json = document_of(kCable + "--frequency-std 0.01" + frequencies(orders));
  EXPECT_NEAR(json["tension_N"]["value"].get<double>() / kTension, 1, 0.02);
}

TEST(TensionVerb, FromAnAmbientRecording) {
  // Resonators at the cable's frequencies, 0.5 % damping, driven by noise: 400 s at 50 Hz.
  const TemporaryFolder folder;
  Normal normal(3);
  const double dt = 0.02;
  std::vector<double> before(4, 0), last(4, 0);
  std::ostringstream csv;
  csv.precision(7);
  csv << "time (s),acc (m/s2)\n";
  for (int i = 0; i < 20000; ++i) {
    double sum = 0.1 * normal();
    for (int n = 1; n <= 4; ++n) {
      const auto k = static_cast<std::size_t>(n - 1);
      const double w = 2 * kPi * frequency(n), r = std::exp(-0.005 * w * dt);
      const double next = 2 * r * std::cos(w * std::sqrt(1 - 2.5e-5) * dt) * last[k] -
                          r * r * before[k] + 0.05 * normal();
      before[k] = last[k];
      last[k] = next;
      sum += next;
    }
    csv << i * dt << ',' << sum << '\n';
  }
  const auto json =
      document_of(kCable + "{} --band 1 12", {folder.write("ambient.csv", csv.str())});
  expect_tension(json);
  EXPECT_GE(json["peaks"].size(), 4u);
}

TEST(TensionVerb, AModelThatIsRuledOutIsSaidOnTheFirstPageOfTheReport) {
  // Frequencies that no cable has to 2 mHz.
  const TemporaryFolder folder;
  folder.write("campaign.toml",
               "title = \"cable\"\n[[test]]\nname = \"stay\"\nkind = \"tension\"\nlength = 20\n"
               "length_std = 0.002\nmass_per_length = 5\nmass_per_length_std = 0.005\nEI = 2\n"
               "EI_std = 0.1\nEA = 2e7\nfrequencies = [2.50, 5.03, 7.46, 10.04, 12.48]\n"
               "frequency_std = 0.002\n");
  const auto report = run_line("report {} --out {} --quiet --json -",
                               {folder.path() / "campaign.toml", folder.path() / "out"});
  EXPECT_THAT(parsed(report.out)["warnings"].dump(), HasSubstr("chi-square"));
}

}  // namespace rigfit::apps::tension_verb_test
