// Coverage of fits to FRFs of hits that scatter in place under noise of the force; the larger table
// is tests/bench/frf_coverage.cc.
#include "tests/ident/update/hammered_beam.h"
#include "tests/test.h"

namespace rigfit::ident::frf_coverage_test {

const Eigen::VectorXd& lines() {
  static const Eigen::VectorXd all = Eigen::VectorXd::LinSpaced(71, 30, 65);
  return all;
}

UpdateState state_of(int segments, std::vector<MeasuredFrf> frfs) {
  return {"",
          testing::hammered_beam(1.02 * testing::kBeamEI, testing::kTipMass, segments),
          {},
          std::move(frfs)};
}

// Noise that a force window leaves is alike in neighbouring lines and common to both responses: as
// independent noise of the lines it made errors of 2.6 standard uncertainties, rms. With the mass
// at the tip left out the same FRFs rule the model out.
TEST(FrfCoverage, IntervalsHoldUnderNoiseOfTheForce) {
  constexpr int kSeeds = 8;
  int held = 0;
  double squares = 0, EI_std = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const UpdateOptions options = testing::plain_options();
    UpdateState state = state_of(16, testing::hammered_frfs(lines(), {}, seed, 16));
    const auto result = update_model({state}, {{"beam.EI_z"}, {"beam.damping_ratio"}}, options);
    ASSERT_EQ(result.status, UpdateStatus::converged) << result.message;
    const double truth[] = {testing::kBeamEI, testing::kBeamDamping};
    for (std::size_t p = 0; p < 2; ++p) {
      const auto& one = result.parameters[p];
      held += holds(one, truth[p]);
      squares += std::pow((one.value - truth[p]) / one.std, 2) / (2 * kSeeds);
      EXPECT_NE(
          std::ranges::find(one.budget, "force of the hits of hammer", &UpdateBudgetTerm::source),
          one.budget.end());
    }
    EI_std += result.parameters[0].std / testing::kBeamEI / kSeeds;
    EXPECT_FALSE(result.fit.ruled_out());
    state.scene.nodes[1].mass = 0;
    EXPECT_TRUE(update_model({state}, {{"beam.EI_z"}}, options).fit.ruled_out());
  }
  EXPECT_GE(held, 13);                  // of 16: 95 %, three binomial deviations
  EXPECT_LT(std::sqrt(squares), 1.53);  // 16 values: 1 + 3 / sqrt(2 x 16)
  // What the lines know: half-widths of 1 % with noise of 1 % give 1e-4 of a frequency or so.
  EXPECT_LT(EI_std, 1e-3);
}

// White noise of a stated size, up to the size of the FRF near antiresonances: chi-square of right
// models is its degrees of freedom. Mean of 8 fits of 280 residuals and more: three standard
// deviations of sqrt(2 / (8 x 280)). In the logarithm, lines of 0.3 to 0.5 of noise make it more.
TEST(FrfCoverage, ChiSquareOfWhiteNoiseIsItsDegreesOfFreedom) {
  constexpr int kSeeds = 8;
  double reduced = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const testing::HammerTestNoise noise{
        .place_m = 0, .force = 0, .response = 0.08, .known_std = true};
    const auto result =
        update_model({state_of(16, testing::hammered_frfs(lines(), noise, seed, 16))},
                     {{"beam.EI_z"}, {"beam.damping_ratio"}}, testing::plain_options());
    ASSERT_EQ(result.status, UpdateStatus::converged) << result.message;
    EXPECT_EQ(result.fit.degrees_of_freedom, 282);  // every line counts
    reduced += result.fit.chi2 / result.fit.degrees_of_freedom / kSeeds;
  }
  EXPECT_NEAR(reduced, 1, 3 * std::sqrt(2.0 / (kSeeds * 280)));
}

// A window of 2.5 1/s adds 0.009 to the damping ratio of the mode among the lines, which has 0.01.
// Fitted is what the beam has; as if there had been no window, it is not.
TEST(FrfCoverage, AnExponentialWindowBiasesNothing) {
  constexpr int kSeeds = 8;
  const testing::HammerTestNoise noise{
      .place_m = 0, .force = 0, .response = 0.02, .known_std = true, .decay_rate_1_s = 2.5};
  double deviation = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    UpdateState state = state_of(16, testing::hammered_frfs(lines(), noise, seed, 16));
    const auto damping = [&] {
      return update_model({state}, {{"beam.EI_z"}, {"beam.damping_ratio"}},
                          testing::plain_options())
          .parameters[1];
    };
    const auto found = damping();
    deviation += (found.value - testing::kBeamDamping) / found.std / kSeeds;
    EXPECT_LT(found.std, 0.0005);
    for (auto& frf : state.frfs) frf.decay_rate_1_s = 0;
    if (seed == 0) {
      EXPECT_GT(damping().value, 1.5 * testing::kBeamDamping);
    }
  }
  EXPECT_LT(std::abs(deviation), 3 / std::sqrt(kSeeds));
}

}  // namespace rigfit::ident::frf_coverage_test
