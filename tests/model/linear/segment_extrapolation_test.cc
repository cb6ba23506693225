#include "model/linear/segment_extrapolation.h"

#include <cmath>

#include "model/linear/modal_analysis.h"
#include "tests/model/linear/random_scenes.h"
#include "tests/reference/closed_forms.h"
#include "tests/test.h"

namespace rigfit::model::segment_extrapolation_test {

using testing::paper_cable;

/// A sequence whose series ends is taken to its limit, and the error of less terms is seen.
TEST(SequenceLimit, EndsAPolynomialInTheSquareOfTheLength) {
  const std::vector<double> h{1, 2.0 / 3, 1.0 / 2, 1.0 / 3, 1.0 / 4};
  std::vector<double> f;
  for (const double x : h) f.push_back(7 + 0.3 * x * x - 0.2 * std::pow(x, 4));
  const SequenceLimit exact = sequence_limit(h, f, 3);
  EXPECT_NEAR(exact.value, 7, 1e-14);
  EXPECT_LT(exact.error, 1e-13);
  // Two points leave 0.2 h1^2 h2^2 of the fourth power.
  const SequenceLimit less = sequence_limit(h, f, 2);
  EXPECT_NEAR(less.value - 7, 0.2 / 144, 1e-14);
  EXPECT_TRUE(less.certain);
  EXPECT_NEAR(less.error, 0.2 / 144, 1e-13);
}

/// A series that changes as much with every power is said to be uncertain.
TEST(SequenceLimit, KnowsWhenItDoesNotConverge) {
  const std::vector<double> h{1, 2.0 / 3, 1.0 / 2, 1.0 / 3};
  EXPECT_FALSE(sequence_limit(h, {1, 2, 1, 2}, 2).certain);
}

/// A truth of other places and finer stretches than `start` has.
ResolvedModes truth_of(const Scene& scene, const ModesOptions& options, SequenceStart start) {
  for (auto& stretches : start.stretches) {
    for (Stretch& stretch : stretches) stretch.segments = (7 * stretch.segments + 3) / 4;
  }
  return extrapolate_modes(scene, options, start, 1e-8);
}

/// Cables, beams and rigs drawn at random: the accuracy is met, and the estimate is within a factor
/// of three of the true error (segments_truth: in 99 % of 600). Truth: another sequence, to 1e-8.
TEST(ExtrapolatedModes, EstimateTheirErrorWithinAFactorOfThree) {
  const double accuracy = 1e-5;
  int near = 0;
  for (unsigned seed = 0; seed < 15; ++seed) {
    const int kind = static_cast<int>(seed % 6);
    const Scene scene = testing::random_scene(kind, seed);
    ModesOptions options{.count = kind == 5 ? 12 : 6};
    options.shapes = options.damped = false;
    const ChainModes coarse =
        find_modes(scene, options, std::vector<int>(scene.members.size(), 12));
    const SequenceStart start = sequence_start(scene, coarse, accuracy);
    const ResolvedModes found = extrapolate_modes(scene, options, start, accuracy);
    const ResolvedModes truth = truth_of(scene, options, start);
    ASSERT_TRUE(found.known && truth.known) << seed;
    double worst = 0;
    for (std::size_t i = 0; i < found.frequency_hz.size(); ++i) {
      worst = std::max(worst, std::abs(found.frequency_hz[i] / truth.limit_hz[i] - 1));
    }
    EXPECT_LE(found.relative_error, accuracy) << seed;
    EXPECT_LT(worst, accuracy) << seed;
    EXPECT_LT(found.relative_error, 5 * worst + truth.relative_error) << seed;
    EXPECT_GT(found.relative_error, worst / 5 - truth.relative_error) << seed;
    near += found.relative_error < 3 * worst && found.relative_error > worst / 3;
  }
  EXPECT_GE(near, 14);
}

/// A mass stands at a node of every chain, wherever it is; near an end or beside another too.
TEST(ExtrapolatedModes, HaveNodesWhereMassesStand) {
  Scene scene = paper_cable(200, 0.5972, 0);
  scene.members[0].masses = {{0.3701, 0.02}, {0.003, 0.01}, {0.3723, 0.03}};
  ModesOptions options;
  const ChainModes coarse = find_modes(scene, options, {12});
  const SequenceStart start = sequence_start(scene, coarse, scene.accuracy);
  for (const int factor : {2, 3}) {
    const Chain chain = Chain::from_scene(scene, start.chain(factor, options));
    ASSERT_EQ(chain.masses.size(), 3U);
    for (const PointMass& mass : chain.masses) EXPECT_NEAR(mass.fraction, 0, 1e-12);
    double length = 0;
    for (const Segment& segment : chain.segments) length += segment.length;
    EXPECT_NEAR(length, chain.members[0].unstretched_length, 1e-12);
  }
  scene.accuracy = 1e-6;
  options.shapes = options.damped = false;
  const ModalAnalysis found = analyse_modes(scene, options);
  EXPECT_TRUE(found.extrapolated);
  const ResolvedModes truth = truth_of(scene, options, start);
  for (std::size_t i = 0; i < found.modes.size(); ++i) {
    EXPECT_NEAR(found.modes[i].frequency_hz / truth.limit_hz[i], 1, 1e-6) << i;
  }
}

/// 1e-6 of closed forms from short chains: a cable without weight is a beam in tension. Layers of
/// bending a five hundredth of the member deep at both clamps are seen by them.
TEST(ExtrapolatedModes, MeetAMillionth) {
  for (const bool layers : {false, true}) {
    const double tension = layers ? 2000 : 200, EI = layers ? 0.05 : 0.5972;
    Scene scene = paper_cable(tension, EI, 0);
    for (auto& node : scene.nodes) {
      if (layers) node.support.kind = Support::Kind::clamped;
    }
    scene.accuracy = 1e-6;
    scene.gravity.setZero();
    ModesOptions options;
    options.shapes = options.damped = !layers;
    const ModalAnalysis found = analyse_modes(scene, options);
    ASSERT_TRUE(found.extrapolated);
    EXPECT_LE(found.equilibrium.members[0].segments, 100);
    const double e = tension / 221780;
    const UniformBeam beam{2.4, 0.16667 / (1 + e), EI * (1 + e), tension};
    const auto truth =
        layers ? clamped_beam_frequencies(beam, 3) : pinned_beam_frequencies(beam, 3);
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_NEAR(found.modes[i].frequency_hz / truth[i / 2], 1, 1e-6) << layers << i;
    }
  }
}

/// A string that hangs under its own weight, T = T_m + m g (x - L / 2), has frequencies where
/// J0(a) Y0(b) = J0(b) Y0(a) with a, b = 2 w sqrt(T / m) / g at its ends.
TEST(ExtrapolatedModes, OfAHeavyVerticalCableHaveItsTensionInTheMiddle) {
  Scene scene = paper_cable(3, 1e-7, 0);
  scene.nodes[1].position = {0, -2.4, 0};
  scene.members[0].EA = 1e9;
  scene.accuracy = 1e-6;
  const ModalAnalysis found = analyse_modes(scene, {});
  ASSERT_TRUE(found.extrapolated);
  EXPECT_LT(found.relative_error_estimate, 1e-6);
  const double m = 0.16667, g = scene.gravity.norm();
  const auto cross = [&](double frequency_hz) {
    const double scale = 4 * M_PI * frequency_hz / g;
    const double a = scale * std::sqrt(3 / m - 1.2 * g), b = scale * std::sqrt(3 / m + 1.2 * g);
    return std::cyl_bessel_j(0, a) * std::cyl_neumann(0, b) -
           std::cyl_bessel_j(0, b) * std::cyl_neumann(0, a);
  };
  for (std::size_t i = 0; i < 6; ++i) {
    const double f = found.modes[i].frequency_hz;
    EXPECT_LT(cross(f * (1 - 2e-6)) * cross(f * (1 + 2e-6)), 0) << i;
  }
}

}  // namespace rigfit::model::segment_extrapolation_test
