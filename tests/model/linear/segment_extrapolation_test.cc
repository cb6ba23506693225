#include "model/linear/segment_extrapolation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "model/linear/modal_analysis.h"
#include "model/linear/mode_batch.h"
#include "tests/model/test_scenes.h"
#include "tests/reference/closed_forms.h"

namespace rigfit::model::segment_extrapolation_test {
namespace {
using testing::cable_beam_rig;
using testing::paper_cable;
using testing::vertical_beam;

/// A sequence whose series ends is taken to its limit, and the error of one term less is seen.
TEST(SequenceLimit, EndsAPolynomialInTheSquareOfTheLength) {
  const std::vector<double> h{1, 2.0 / 3, 1.0 / 2, 1.0 / 3};
  std::vector<double> f;
  for (const double x : h) f.push_back(7 + 0.3 * x * x - 0.2 * std::pow(x, 4));
  const SequenceLimit exact = sequence_limit(h, f, 3);
  EXPECT_NEAR(exact.value, 7, 1e-14);
  EXPECT_LT(exact.error, 1e-13);
  // Two points leave 0.2 h1^2 h2^2 of the fourth power.
  const SequenceLimit less = sequence_limit(h, f, 2);
  EXPECT_NEAR(less.value - 7, 0.2 / 36, 1e-14);
  EXPECT_GE(less.error, 0.2 / 36 - 1e-14);
}

/// Cables clamped or pinned, beams and rigs drawn at random: the accuracy is met, and the estimate
/// is within a factor of three of the true error for all but one in ten (segments_truth: 97 % of
/// 200) and of five for all. Truth: another sequence, to 1e-8.
TEST(ExtrapolatedModes, EstimateTheirErrorWithinAFactorOfThree) {
  const double accuracy = 1e-5;
  int near = 0;
  for (unsigned seed = 0; seed < 16; ++seed) {
    std::mt19937 generator(seed);
    const auto between = [&](double low, double high) {
      return std::exp(std::uniform_real_distribution<>(std::log(low), std::log(high))(generator));
    };
    Scene scene = seed % 4 == 3   ? cable_beam_rig(between(50, 500), between(0.1, 2), 0)
                  : seed % 4 == 2 ? vertical_beam(between(0.3, 1), between(1, 10), 0.3, 0)
                                  : paper_cable(between(20, 1000), between(0.05, 5), 0);
    if (seed % 4 == 1) {
      for (auto& node : scene.nodes) node.support.kind = Support::Kind::clamped;
    }
    ModesOptions options;
    options.count = seed % 4 == 3 ? 12 : 6;
    const ChainModes coarse =
        find_modes(scene, options, std::vector<int>(scene.members.size(), 12));
    const SequenceStart start = sequence_start(scene, coarse);
    SequenceStart finer = start;
    for (int& n : finer.first) n = std::max(13, 17 * n / 10);
    const ExtrapolatedModes found = extrapolate_modes(scene, options, start, accuracy);
    const ExtrapolatedModes truth = extrapolate_modes(scene, options, finer, 1e-8);
    ASSERT_TRUE(found.known && truth.known) << seed;
    double worst = 0;
    for (std::size_t i = 0; i < found.frequency_hz.size(); ++i) {
      worst = std::max(worst, std::abs(found.frequency_hz[i] / truth.limit_hz[i] - 1));
    }
    EXPECT_LE(found.relative_error, accuracy) << seed;
    EXPECT_LT(found.relative_error, 5 * worst + truth.relative_error) << seed;
    EXPECT_GT(found.relative_error, worst / 5 - truth.relative_error) << seed;
    near += found.relative_error < 3 * worst && found.relative_error > worst / 3;
  }
  EXPECT_GE(near, 15);
}

/// A mass between nodes spoils the series: said, and the estimate still bounds the error.
TEST(ExtrapolatedModes, KnowThatAMassBetweenNodesIsIrregular) {
  Scene scene = paper_cable(200, 0.5972, 0);
  scene.members[0].masses = {{0.3701, 0.02}};
  ModesOptions options;
  const ChainModes coarse = find_modes(scene, options, {12});
  EXPECT_FALSE(sequence_start(scene, coarse).regular);
  scene.accuracy = 1e-4;
  const ModalAnalysis found = analyse_modes(scene, options);
  // A tenth of a segment off a node: what that leaves goes with a thousandth of the length.
  options.segments = 1000;
  options.error_estimate = false;
  const ModalAnalysis fine = analyse_modes(scene, options);
  for (std::size_t i = 0; i < found.modes.size(); ++i) {
    EXPECT_NEAR(found.modes[i].frequency_hz / fine.modes[i].frequency_hz, 1, 1e-4) << i;
  }
  scene.members[0].masses = {{0.35, 0.02}};
  EXPECT_TRUE(sequence_start(scene, coarse).regular);
}

/// 1e-6 of a closed form from short chains: the cable without weight is a beam in tension.
TEST(ExtrapolatedModes, MeetAMillionth) {
  Scene scene = paper_cable(200, 0.5972, 0);
  scene.gravity.setZero();
  scene.accuracy = 1e-6;
  const ModalAnalysis found = analyse_modes(scene);
  const double e = 200 / 221780.0;
  const auto truth = pinned_beam_frequencies({2.4, 0.16667 / (1 + e), 0.5972 * (1 + e), 200}, 3);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(found.modes[i].frequency_hz / truth[i / 2], 1, 1e-6) << i;
  }
  EXPECT_TRUE(found.extrapolated);
  EXPECT_LE(found.equilibrium.members[0].segments, 100);
}

/// Every scene of a batch as by itself, most of them without an extrapolation of their own; one
/// that cannot stand is said to be unsolved.
TEST(ModeBatch, AgreesWithScenesOneByOne) {
  std::vector<Scene> scenes;
  for (int i = 0; i < 40; ++i) {
    scenes.push_back(paper_cable(150 + 3 * i, 0.5 + 0.005 * ((7 * i) % 40), 0));
  }
  scenes[20].members[0].tension.reset();
  scenes[20].members[0].unstretched_length = 2.4 * 40;
  scenes[20].members[0].EI = {5e3, 5e3};
  const bool stands = analyse_modes(scenes[20]).equilibrium.status == EquilibriumStatus::converged;
  ModesOptions options;
  const double accuracy = 1e-5;
  const ModeBatch batch = batch_modes(scenes, options, accuracy);
  EXPECT_LE(batch.relative_error_estimate, accuracy);
  EXPECT_LE(batch.extrapolated, 1);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (i == 20) {
      EXPECT_EQ(batch.solved[i], stands);
      continue;
    }
    ASSERT_TRUE(batch.solved[i]) << i;
    if (i % 4 != 0) continue;
    scenes[i].accuracy = 1e-8;
    const ModalAnalysis alone = analyse_modes(scenes[i], options);
    for (int k = 0; k < 6; ++k) {
      EXPECT_NEAR(batch.frequency_hz(static_cast<Eigen::Index>(i), k) /
                      alone.modes[static_cast<std::size_t>(k)].frequency_hz,
                  1, accuracy)
          << i << ' ' << k;
    }
  }
}

}  // namespace
}  // namespace rigfit::model::segment_extrapolation_test
