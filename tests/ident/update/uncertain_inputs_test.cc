// Inputs that all states share: a load cell whose scale and zero are wrong, a rounded sample rate.
#include "ident/update/model_update.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/parameters.h"
#include "tests/ident/update/fit_data.h"
#include "tests/ident/update/hammered_beam.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::ident::uncertain_inputs_test {

constexpr double kScale = 1.03, kZero = -1.5;  // N

std::vector<UpdateState> states(double EI, double std, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<UpdateState> all;
  for (const double reading : {25.0, 100.0, 200.0, 300.0}) {
    const auto truth = model::testing::paper_cable(kScale * reading + kZero, EI, 12);
    UpdateState state{.name = std::to_string(static_cast<int>(reading)) + " N",
                      .scene = model::testing::paper_cable(reading, EI, 12),
                      .measured = testing::modes_of(truth, model::ModePlane::in, 6, std, &random)};
    all.push_back(std::move(state));
  }
  return all;
}

// 95 % intervals of three unknowns over 20 campaigns: within three binomial deviations (8.4 %).
TEST(LoadCell, ScaleAndZeroCommonToAllStatesAreFound) {
  constexpr std::array truth{0.6, kScale, kZero};
  int covered = 0, total = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    UpdateOptions options = testing::plain_options();
    const auto result = update_model(
        states(0.6, 1e-3, seed), {{"cable.EI"}, {"load_cell.scale"}, {"load_cell.zero"}}, options);
    ASSERT_EQ(result.status, UpdateStatus::converged) << result.message;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const auto& found = result.parameters[k];
      EXPECT_GT(found.std, 0);
      covered += std::abs(found.value - truth[k]) <= result.coverage_factor * found.std;
      ++total;
    }
    // Known well enough to be of use: 0.1 % of a frequency is 0.2 % of a tension.
    EXPECT_LT(result.parameters[1].std, 2e-3);
    EXPECT_LT(result.parameters[2].std, 0.2);
  }
  EXPECT_GE(covered, 0.866 * total);
}

// Readings taken for true rule the model out, and a free zero that starts at zero has a scale.
TEST(LoadCell, ReadingsTakenForTrueAreRuledOut) {
  UpdateOptions options = testing::plain_options();
  const auto wrong = update_model(states(0.6, 1e-3, 1), {{"cable.EI"}}, options);
  EXPECT_LT(wrong.fit.p_value, 1e-6);
  const auto right = update_model(states(0.6, 1e-3, 1),
                                  {{"cable.EI"}, {"load_cell.scale"}, {"load_cell.zero"}}, options);
  EXPECT_GT(right.fit.p_value, 1e-3);
}

// A sample rate that files state rounded: common to all recordings.

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

}  // namespace rigfit::ident::uncertain_inputs_test
