#include "signal/variation/hit_jackknife.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "signal/modal/modal_identification.h"
#include "signal/numerics/numbers.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr double kDamping = 0.01;

/// Accelerances of a mode at `hz` at two points, 10 to 30 Hz.
Eigen::MatrixXcd accelerances(const Eigen::VectorXcd& s, double hz) {
  const double w = kTwoPi * hz;
  const Eigen::VectorXcd one =
      s.array().square() / (s.array().square() + 2 * kDamping * w * s.array() + w * w);
  Eigen::MatrixXcd H(s.size(), 2);
  H << one, -0.6 * one;
  return H;
}

/// Hits whose mode is at 20 Hz and a little beside it, averaged by their squared impulses.
FrfSet set_of_hits(const std::vector<double>& beside_hz, const std::vector<double>& impulse) {
  FrfSet set;
  set.form = FrfForm::accelerance;
  set.frequency_hz = Eigen::VectorXd::LinSpaced(401, 10, 30);
  const Eigen::VectorXcd s = Complex(0, kTwoPi) * set.frequency_hz.cast<Complex>();
  set.H = Eigen::MatrixXcd::Zero(401, 2);
  double sum = 0;
  for (std::size_t h = 0; h < beside_hz.size(); ++h) {
    set.by_hit.push_back(accelerances(s, 20 + beside_hz[h]));
    set.H += impulse[h] * impulse[h] * set.by_hit.back();
    sum += impulse[h] * impulse[h];
  }
  set.H /= sum;
  set.hit_impulse = {impulse};
  set.responses = {{"a", 1, 3}, {"b", 2, 3}};
  set.inputs = {{"hammer", 9, 3}};
  return set;
}

std::vector<JackknifeOfHits> found_in(const FrfSet& set) {
  std::vector<Note> notes;
  const ModalBand band = select_band(set, 0, 0, notes);
  const FrfNoise noise = first_noise(band);
  const ModalRefineResult fit = refine_modes(
      band.lines, noise, Eigen::VectorXcd::Constant(1, Complex(-1.2, kTwoPi * 20)), {});
  return jackknife_of_hits(set, band, noise, fit);
}

// A ten-thousandth of the bandwidth of 0.4 Hz: errors of second order are as small a part, which
// is a tenth of the tests' tolerance.
const std::vector<double> kBeside{3e-5, -1e-5, 2e-5, -5e-5, 1e-5};

TEST(HitJackknife, EqualHitsGiveTheStandardErrorOfTheMean) {
  const auto found = found_in(set_of_hits(kBeside, {2, 2, 2, 2, 2}));
  ASSERT_EQ(found.size(), 1u);
  const double square = 9e-10 + 1e-10 + 4e-10 + 25e-10 + 1e-10;  // their mean is 0
  EXPECT_NEAR(found[0].frequency_std_hz, std::sqrt(square / 20), 1e-3 * std::sqrt(square / 20));
  EXPECT_NEAR(found[0].freedom, 4, 1e-9);
  // Damping changes by second order only: a hundredth leaves room for the differences in H.
  EXPECT_LT(found[0].damping_ratio_std, 1e-2 * found[0].frequency_std_hz / 20);
}

TEST(HitJackknife, HitsAreWeighedByTheirSquaredImpulses) {
  const std::vector<double> impulse{1, 2, 1, 3, 2};
  const auto found = found_in(set_of_hits(kBeside, impulse));
  ASSERT_EQ(found.size(), 1u);
  // Leaving out one hit at a time from the weighted mean.
  std::vector<double> left;
  double mean = 0;
  for (std::size_t out = 0; out < 5; ++out) {
    double sum = 0, weight = 0;
    for (std::size_t h = 0; h < 5; ++h) {
      if (h == out) continue;
      sum += impulse[h] * impulse[h] * kBeside[h];
      weight += impulse[h] * impulse[h];
    }
    left.push_back(sum / weight);
    mean += left.back() / 5;
  }
  double square = 0;
  for (const double one : left) square += (one - mean) * (one - mean);
  EXPECT_NEAR(found[0].frequency_std_hz, std::sqrt(0.8 * square), 1e-3 * std::sqrt(0.8 * square));
}

TEST(HitJackknife, NothingWithoutTwoHitsOverTheBand) {
  FrfSet one = set_of_hits({0}, {1});
  EXPECT_TRUE(found_in(one).empty());
  FrfSet fewer = set_of_hits(kBeside, {1, 1, 1, 1, 1});
  for (Eigen::MatrixXcd& H : fewer.by_hit) H = H.topRows(300).eval();
  EXPECT_TRUE(found_in(fewer).empty());
}

// Noise that all FRFs of a hit share is in the fit's noise: it makes no mode wider than that.
TEST(HitJackknife, NoiseOnTheForceIsNoDifferenceBetweenHits) {
  FrfSet set = set_of_hits({0, 0, 0, 0, 0}, {1, 1, 1, 1, 1});
  std::srand(1);
  set.H.setZero();
  for (Eigen::MatrixXcd& H : set.by_hit) {
    const Eigen::VectorXcd common = Eigen::VectorXcd::Random(H.rows());  // parts of variance 1/3
    H.array().colwise() *= 1 + 0.01 * common.array();
    H += 1e-4 * Eigen::MatrixXcd::Random(H.rows(), H.cols());
    set.H += H / 5;
  }
  const ModalResult result = identify_modes(set, {});
  ASSERT_EQ(result.model.modes.size(), 1u);
  const IdentifiedMode& mode = result.model.modes[0];
  EXPECT_FALSE(mode.between_hits.beyond_noise);
  // One normal error of a thousand is larger.
  EXPECT_LT(std::abs(mode.frequency_hz.value - 20), 3.3 * mode.frequency_hz.std);
  // The bound of a resonance with relative noise of 0.01 / sqrt(3 * 5) on each part of each line:
  // sum over lines of |d ln H / d f|^2, d ln H / d p = 1 / (s - p).
  double information = 0;
  for (const double f : set.frequency_hz) {
    const double relative = 0.01 / std::sqrt(15.0);
    information += 1 / (std::pow(f - 20, 2) + 0.04) / (relative * relative);
  }
  // The scatter of five hits has Student's t of 4 degrees, 1.4 times the normal's: 2 is between
  // that and what fits of single hits gave, 3.6.
  EXPECT_LT(mode.frequency_hz.std, 2 / std::sqrt(information));
}

}  // namespace
}  // namespace rigfit::signal
