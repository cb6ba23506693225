// A sample rate that files state rounded: common to all recordings.
#include "ident/update/model_update.h"
#include "tests/ident/update/fit_data.h"
#include "tests/ident/update/hammered_beam.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::ident::sample_rate_input_test {

constexpr double kTension = 200, kRate = 3e-4, kNoise = 1e-4;

// `count` tests of one cable, all frequencies measured by the part `off` too high.
std::vector<UpdateState> tests(int count, double off) {
  std::mt19937_64 random(7);
  const auto truth = model::testing::paper_cable(kTension, 0.6, 12);
  std::vector<UpdateState> all;
  for (int k = 0; k < count; ++k) {
    all.push_back({"test " + std::to_string(k + 1), truth,
                   testing::modes_of(truth, model::ModePlane::out, 5, kNoise, &random)});
    for (auto& mode : all.back().measured) mode.frequency_hz.value *= 1 + off;
  }
  return all;
}

UpdatedParameter tension(std::vector<UpdateState> states, double rate_std) {
  for (auto& state : states) state.clock_relative_std = rate_std;
  const auto result = update_model(states, {{"cable.tension"}}, testing::plain_options());
  EXPECT_EQ(result.status, UpdateStatus::converged) << result.message;
  EXPECT_FALSE(result.fit.ruled_out());
  return result.parameters[0];
}

double part_of(const UpdatedParameter& found, const std::string& source) {
  double squares = 0;
  for (const auto& term : found.budget) {
    if (term.source.starts_with(source)) squares += term.std * term.std;
  }
  return std::sqrt(squares);
}

// f goes by sqrt(T) but for the part of EI, some percent of a frequency squared: 2 e of T.
TEST(SampleRateInput, OneClockIsNotAveragedOverItsRecordings) {
  const auto one = tension(tests(1, 0), kRate);
  EXPECT_NEAR(part_of(one, "sample rate"), 2 * kRate * kTension, 0.1 * 2 * kRate * kTension);
  const auto four = tension(tests(4, 0), kRate);
  // A half, were each test's clock its own. The part of EI tells a little of the clock, four tests
  // four times as much.
  EXPECT_GT(four.std, 0.9 * part_of(one, "sample rate"));
  EXPECT_LT(four.std, one.std);
}

TEST(SampleRateInput, TheIntervalHoldsWhereTheRateIsOff) {
  const auto states = tests(4, 1.2 * kRate);
  const auto told = tension(states, kRate), untold = tension(states, 0);
  EXPECT_TRUE(holds(told, kTension));
  EXPECT_GT(untold.low, kTension);
}

// Frequencies of a beam go by sqrt(EI): lines of FRFs that are off by e make EI off by 2 e.
TEST(SampleRateInput, LinesOfFrfsAreOffTogether) {
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(71, 30, 65);
  const testing::HammerTestNoise quiet{
      .place_m = 0, .force = 0, .response = 0.02, .known_std = true};
  auto frfs = testing::hammered_frfs(lines, quiet, 3, 16);
  constexpr double kOff = 1.5;
  for (auto& frf : frfs) frf.frequency_hz *= 1 + kOff * kRate;
  UpdateState state{
      "", testing::hammered_beam(1.01 * testing::kBeamEI, testing::kTipMass, 16), {}, frfs};
  state.clock_relative_std = kRate;
  const auto result = update_model({state}, {{"beam.EI_z"}}, testing::plain_options());
  ASSERT_EQ(result.status, UpdateStatus::converged) << result.message;
  const auto& EI = result.parameters[0];
  const double by_rate = 2 * kRate * testing::kBeamEI;
  // Gravity on the tip takes some percent of the stiffness.
  EXPECT_NEAR(part_of(EI, "sample rate"), by_rate, 0.1 * by_rate);
  EXPECT_GT(std::abs(EI.value - testing::kBeamEI), by_rate);
  EXPECT_TRUE(holds(EI, testing::kBeamEI));
}

}  // namespace rigfit::ident::sample_rate_input_test
