#include "signal/modal/modal_identification.h"

#include "signal/impact/impact_frfs.h"
#include "tests/reference/ten_mode_truth.h"
#include "tests/test.h"

namespace rigfit::signal::modal_identification_test {

/// Exact accelerances with white noise of `relative` of their rms.
FrfSet noisy_truth(const testing::TenModeTruth& truth, double relative, double window,
                   unsigned seed, Index lines = 2800) {
  FrfSet set = truth.frfs(VectorXd::LinSpaced(lines, 1400.0 / lines, 1400), window);
  Normal normal(seed);
  const double scale =
      relative * std::sqrt(set.H.squaredNorm() / static_cast<double>(set.H.size()));
  for (Complex& h : set.H.reshaped()) h += scale * Complex(normal(), normal());
  return set;
}

// From recordings, as the truth table (tests/bench/modal_truth) does for hundreds of seeds.
TEST(ModalIdentification, TenModesFromHitsWithAndWithoutWindow) {
  const auto truth = testing::ten_mode_truth();
  for (const double window : {0.0, 1.0}) {
    const Recording recording = testing::impact_recording(truth, {.seed = 11});
    std::vector<std::string> responses;
    for (int j = 1; j <= 20; ++j) responses.push_back("a" + std::to_string(j));
    const ImpactTest test =
        analyse_impact_test({&recording, 1}, "force", responses,
                            {.hits = {.block_s = 4}, .exponential_decay_rate_1_s = window});
    const ModalResult result = identify_modes(test.frfs, {.high_hz = 1400});
    ASSERT_EQ(result.model.modes.size(), 10u) << window;
    EXPECT_EQ(result.end, StepsEnd::converged);
    int covered = 0;
    for (std::size_t r = 0; r < 10; ++r) {
      const IdentifiedMode& mode = result.model.modes[r];
      const auto i = static_cast<Index>(r);
      const double df = mode.frequency_hz.value - truth.frequency_hz[i];
      const double dz = mode.damping_ratio.value - truth.damping_ratio[i];
      EXPECT_LT(std::abs(df), 100e-6 * truth.frequency_hz[i]);
      EXPECT_LT(std::abs(dz), 0.02 * truth.damping_ratio[i]);
      covered += std::abs(df) < 1.96 * mode.frequency_hz.std;
      covered += std::abs(dz) < 1.96 * mode.damping_ratio.std;
      EXPECT_FALSE(mode.doubtful) << mode.doubt;
      EXPECT_GT(mode.modal_phase_collinearity, 0.999);
      EXPECT_LT(mode.reconstruction_error, 0.01);
      EXPECT_NEAR(mode.damping_ratio_with_window * mode.frequency_hz.value * 2 * kPi,
                  -mode.pole_rad_s.real() + window, 1e-3 * -mode.pole_rad_s.real());
    }
    // Binomial of 20 at 0.95: 15 or fewer with a chance of 2.6e-3.
    EXPECT_GE(covered, 16) << window;
    EXPECT_LT(result.model.frf_error.maxCoeff(), 0.02);
    // Shapes are those of the truth: all real, and distinct as sines are.
    EXPECT_LT((result.auto_mac - MatrixXd::Identity(10, 10)).cwiseAbs().maxCoeff(), 0.05);
  }
}

TEST(ModalIdentification, ExportedModesRebuildTheFrfs) {
  const auto truth = testing::ten_mode_truth(6);
  const FrfSet frfs = noisy_truth(truth, 1e-3, 2, 6);
  const ModalResult result = identify_modes(frfs);
  ASSERT_EQ(result.model.modes.size(), 10u);
  const FrfSet again =
      synthesised(result.model, frfs.frequency_hz, frfs.form, frfs.exponential_decay_rate_1_s);
  const MatrixXcd exact = truth.accelerance(frfs.frequency_hz, 2);
  // Below the noise: some 24 parameters an FRF for 5600 numbers.
  EXPECT_LT((again.H - exact).norm(), 0.3 * 1e-3 * std::sqrt(2.0) * exact.norm());
  EXPECT_LT((again.H - exact).norm() / exact.norm(), (frfs.H - exact).norm() / exact.norm());
  // Without the window, and as receptance: the structure itself.
  const FrfSet receptance = synthesised(result.model, frfs.frequency_hz, FrfForm::receptance);
  const ArrayXd w = 2 * kPi * frfs.frequency_hz.array();
  const MatrixXcd accelerance = truth.accelerance(frfs.frequency_hz);
  const MatrixXcd back = (-w.square()).matrix().asDiagonal() * receptance.H;
  EXPECT_LT((back - accelerance).norm(), 2e-3 * accelerance.norm());
  for (Index o = 0; o < 6; ++o) {
    // The misfit per FRF is its noise: 1e-3 of the rms over all FRFs, both parts.
    const double own = frfs.H.col(o).norm() / std::sqrt(static_cast<double>(frfs.H.rows()));
    const double all = std::sqrt(exact.squaredNorm() / static_cast<double>(exact.size()));
    EXPECT_NEAR(result.model.frf_error(o, 0), 1e-3 * std::sqrt(2.0) * all / own,
                0.1 * 1e-3 * std::sqrt(2.0) * all / own);
  }
}

TEST(ModalIdentification, TwoInputsGiveShapesAndParticipations) {
  const auto truth = testing::ten_mode_truth(6);
  FrfSet set = truth.frfs(VectorXd::LinSpaced(2800, 0.5, 1400));
  set.inputs.push_back({"second", 2, 3});
  const VectorXcd p = truth.poles();
  MatrixXcd H(2800, 12);
  Normal normal(8);
  const Index at[2] = {truth.driving_point, 1};
  for (Index k = 0; k < 2800; ++k) {
    const Complex s(0, 2 * kPi * set.frequency_hz[k]);
    for (Index o = 0; o < 6; ++o) {
      for (Index i = 0; i < 2; ++i) {
        Complex sum = 0;
        for (Index r = 0; r < 10; ++r) {
          const Complex residue =
              truth.shapes(o, r) * truth.shapes(at[i], r) / Complex(0, 2 * p[r].imag());
          sum += residue / (s - p[r]) + std::conj(residue) / (s - std::conj(p[r]));
        }
        H(k, 2 * o + i) = s * s * sum + 2e-3 * Complex(normal(), normal());
      }
    }
  }
  set.H = H;
  const ModalResult result = identify_modes(set);
  ASSERT_EQ(result.model.modes.size(), 10u);
  for (Index r = 0; r < 10; ++r) {
    const IdentifiedMode& mode = result.model.modes[r];
    ASSERT_EQ(mode.participation.size(), 2);
    const Complex ratio = mode.participation[1] / mode.participation[0];
    const double expected = truth.shapes(at[1], r) / truth.shapes(at[0], r);
    EXPECT_LT(std::abs(ratio - expected), 0.02 * (1 + std::abs(expected))) << r;
    EXPECT_LT(std::abs(mode.frequency_hz.value - truth.frequency_hz[r]), 5 * mode.frequency_hz.std);
  }
  // The same FRFs with the roles of responses and inputs exchanged: the same poles.
  FrfSet turned = set;
  std::swap(turned.responses, turned.inputs);
  for (Index o = 0; o < 6; ++o) {
    for (Index i = 0; i < 2; ++i) turned.H.col(i * 6 + o) = H.col(2 * o + i);
  }
  const ModalResult other = identify_modes(turned);
  ASSERT_EQ(other.model.modes.size(), 10u);
  for (std::size_t r = 0; r < 10; ++r) {
    EXPECT_NEAR(other.model.modes[r].frequency_hz.value, result.model.modes[r].frequency_hz.value,
                result.model.modes[r].frequency_hz.std);
  }
}

// FRFs of two inputs at which two modes of one frequency have different shapes: one pole, whose
// residues are of no single shape. The second singular value is 0.4 of the first. Under a window.
TEST(ModalIdentification, ModesOfOneFrequencyAreSaid) {
  FrfSet set{.form = FrfForm::accelerance, .exponential_decay_rate_1_s = 0.3};
  set.frequency_hz = VectorXd::LinSpaced(500, 1, 60);
  set.responses = {{"p1", 1, 3}, {"p2", 2, 3}, {"p3", 3, 3}};
  set.inputs = {{"p1", 1, 3}, {"p2", 2, 3}};
  for (const double second : {0.0, 0.4}) {
    MatrixXd residues(3, 2);
    residues << 1, 0, 0, second, 0, second;
    set.H = MatrixXcd(500, 6);
    Normal normal(3);
    for (Index k = 0; k < 500; ++k) {
      const Complex s(0.3, 2 * kPi * set.frequency_hz[k]);
      const double w = 2 * kPi * 30;
      const Complex mode = s * s / (s * s + 0.02 * w * s + w * w);
      for (Index c = 0; c < 6; ++c) {
        set.H(k, c) = mode * residues(c / 2, c % 2) + 0.01 * Complex(normal(), normal());
      }
    }
    const ModalResult result = identify_modes(set);
    ASSERT_EQ(result.model.modes.size(), 1u);
    EXPECT_EQ(says(result.model.notes, "systematic_misfit"), second > 0);
    EXPECT_EQ(result.model.modes[0].reconstruction_error > 0.1, second > 0);
  }
}

TEST(ModalIdentification, NoiseAloneHasNoModes) {
  FrfSet set = testing::ten_mode_truth(4).frfs(VectorXd::LinSpaced(1000, 1, 1000));
  Normal normal(9);
  for (Complex& h : set.H.reshaped()) h = Complex(normal(), normal());
  const ModalResult result = identify_modes(set);
  EXPECT_TRUE(result.model.modes.empty());
  EXPECT_EQ(result.model.notes.back().code, "no_modes");
}

TEST(ModalIdentification, DeadAndBrokenFrfsAreSaid) {
  const auto truth = testing::ten_mode_truth(6);
  FrfSet set = noisy_truth(truth, 1e-3, 0, 10);
  set.H.col(3).setZero();
  set.H(100, 2) = kNaN;
  const ModalResult result = identify_modes(set);
  ASSERT_EQ(result.model.modes.size(), 10u);
  for (const IdentifiedMode& mode : result.model.modes) {
    EXPECT_EQ(std::abs(mode.shape[3]), 0);
    EXPECT_TRUE(mode.shape_std.allFinite());
  }
  EXPECT_EQ(result.lines_used, 2799);
  EXPECT_TRUE(says(result.model.notes, "dead_frf"));
  EXPECT_TRUE(says(result.model.notes, "data_left_out"));
  set.H.setZero();
  EXPECT_TRUE(identify_modes(set).model.modes.empty());
}

TEST(ModalIdentification, WrongSizesAndEmptyBandsThrow) {
  FrfSet set = testing::ten_mode_truth(2).frfs(VectorXd::LinSpaced(100, 1, 100));
  EXPECT_THROW((void)identify_modes(set, {.low_hz = 98}), std::invalid_argument);
  set.responses.pop_back();
  EXPECT_THROW((void)identify_modes(set), std::invalid_argument);
  EXPECT_THROW((void)identify_modes(FrfSet{}), std::invalid_argument);
}

}  // namespace rigfit::signal::modal_identification_test
