#include "signal/modal/local_modes.h"

#include "signal/modal/modal_identification.h"
#include "tests/reference/defective_frfs.h"
#include "tests/test.h"

namespace rigfit::signal::local_modes_test {

testing::DefectiveFrfOptions small_set() {
  testing::DefectiveFrfOptions options;
  options.frequency_hz = (VectorXd(2) << 30, 52).finished();
  options.low_hz = 25;
  options.high_hz = 60;
  options.spacing_hz = 0.01;
  options.seed = 3;
  return options;
}

// Five half-power bandwidths from the first point to the last: one mode, not one a point, its value
// that of the mean rig, its scatter that of eight equal steps (0.33 of the range).
TEST(LocalModes, AModeThatDriftsBetweenPointsIsOne) {
  testing::DefectiveFrfOptions options = small_set();
  options.drift = 5;
  const ModalResult result = identify_modes(testing::defective_frfs(options));
  ASSERT_EQ(result.model.modes.size(), 2u);
  for (std::size_t r = 0; r < 2; ++r) {
    const IdentifiedMode& mode = result.model.modes[r];
    const double f = options.frequency_hz[r];
    const double range = 5 * 2 * options.damping_ratio * f;
    EXPECT_EQ(mode.refinement, "local");
    EXPECT_LT(std::abs(mode.frequency_hz.value - f), 4 * mode.frequency_hz.std + 1e-4 * range);
    // Eight points scatter by 0.35 of the range: its mean by a third of that, by Student's t.
    EXPECT_LT(mode.frequency_hz.std, 0.16 * range);
    EXPECT_LT(std::abs(mode.damping_ratio.value - options.damping_ratio),
              4 * mode.damping_ratio.std);
    EXPECT_NEAR(mode.between_points_std_hz, 0.35 * range, 0.08 * range);
    EXPECT_GE(mode.points.size(), 6u);
    EXPECT_EQ(mode.points.front().point.name, "p1");
  }
}

// Six points a half-power bandwidth apart, two sensors: a common fit of a pole for each point
// leaves noise alone. The mean to a tenth of a step between points; at each of them damping is
// known to 1 % or better.
TEST(LocalModes, AModeThatDriftsBetweenPointsIsOneToTwoSensors) {
  testing::DefectiveFrfOptions options = small_set();
  options.drift = 5, options.points = 6, options.fixed = {0.37, 0.21};
  options.spacing_hz = 0.02, options.noise = 5e-3;
  for (options.seed = 1; options.seed <= 2; ++options.seed) {
    const auto modes = identify_modes(testing::defective_frfs(options)).model.modes;
    ASSERT_EQ(modes.size(), 2u) << options.seed;
    for (Index r = 0; r < 2; ++r) {
      const IdentifiedMode& mode = modes[static_cast<std::size_t>(r)];
      const double step = 2 * options.damping_ratio * options.frequency_hz[r];
      EXPECT_EQ(mode.points.size(), 6u);
      EXPECT_NEAR(mode.frequency_hz.value, options.frequency_hz[r], 0.1 * step);
      EXPECT_NEAR(mode.damping_ratio.value / options.damping_ratio, 1, 0.01);
      for (const auto& point : mode.points) {
        EXPECT_LT(point.damping_ratio.std, 0.01 * options.damping_ratio);
      }
    }
  }
}

// Two members, two of ten points each, with modes of their own within a half-power bandwidth.
TEST(LocalModes, ModesOfMembersWithinEachOthersResonanceStayTwoToTwoSensors) {
  testing::DefectiveFrfOptions options = small_set();
  options.damping_ratio = 0.01, options.points = 10, options.fixed = {0.37, 0.21};
  options.spacing_hz = 0.05, options.noise = 5e-3;
  FrfSet set = testing::defective_frfs(options);
  const VectorXcd s = Complex(0, 2 * kPi) * set.frequency_hz.cast<Complex>();
  for (const auto& [f, first] : {std::pair(40.0, 0), std::pair(40.6, 8)}) {
    const double w = 2 * kPi * f;
    const VectorXcd H =
        0.4 * s.array().square() / (s.array().square() + 0.02 * w * s.array() + w * w);
    for (const Index c : {0, 1, 10, 11}) set.H.col(first + c) += H;
  }
  std::vector<double> found;
  for (const auto& mode : identify_modes(set).model.modes) found.push_back(mode.frequency_hz.value);
  const auto near = [](double f) {
    return ::testing::DoubleNear(f, 0.1);
  };  // an eighth of a bandwidth
  EXPECT_THAT(found, ElementsAre(near(30), near(40), near(40.6), near(52)));
}

// Points that scatter by three half-power bandwidths leave gaps that no point fills.
TEST(LocalModes, ModesThatScatterBetweenPointsAreOneEach) {
  testing::DefectiveFrfOptions options = small_set();
  options.scatter = 3, options.points = 7;
  for (options.seed = 1; options.seed <= 5; ++options.seed) {
    const auto modes = identify_modes(testing::defective_frfs(options)).model.modes;
    ASSERT_EQ(modes.size(), 2u) << options.seed;
    for (const auto& mode : modes) EXPECT_GE(mode.points.size(), 6u) << options.seed;
  }
}

// Members with modes of their own: at half of the points 20 Hz, at the others 36 Hz. With 2 %
// damping 20 half-power bandwidths reach from one to the other.
TEST(LocalModes, ModesOfDifferentMembersAreTwo) {
  testing::DefectiveFrfOptions options = small_set();
  options.damping_ratio = 0.02, options.scatter = 0.15, options.points = 6;
  options.low_hz = 5, options.high_hz = 75, options.spacing_hz = 0.05;
  options.frequency_hz = Eigen::Vector3d(12, 20, 60);
  FrfSet set = testing::defective_frfs(options);
  options.frequency_hz[1] = 36, options.seed = 4;
  const FrfSet other = testing::defective_frfs(options);
  set.H.conservativeResize(Eigen::NoChange, 12);
  set.H.rightCols(6) = other.H;
  for (Index i = 0; i < 6; ++i) {
    set.inputs.push_back({fmt::format("q{}", i), static_cast<int>(20 + i), 3});
    set.hit_impulse.push_back({1});
  }
  std::vector<double> found;
  for (const auto& mode : identify_modes(set).model.modes) found.push_back(mode.frequency_hz.value);
  EXPECT_THAT(found, ElementsAre(::testing::DoubleNear(12, 0.3), ::testing::DoubleNear(20, 0.5),
                                 ::testing::DoubleNear(36, 0.9), ::testing::DoubleNear(60, 1.5)));
}

// What drifts by 4 % lies at some points nearer to the next mode than to its own first place.
TEST(LocalModes, TenThatDriftKeepTheirPoints) {
  testing::DefectiveFrfOptions options = small_set();
  options.frequency_hz.resize(10);
  options.frequency_hz << 22.4, 35.7, 41.8, 59.2, 78.5, 94.9, 122.4, 143.8, 169.3, 194;
  options.damping_ratio = 4e-3, options.drift = 5, options.points = 16;
  options.low_hz = 10, options.high_hz = 250, options.spacing_hz = 0.25;
  const auto modes = identify_modes(testing::defective_frfs(options)).model.modes;
  ASSERT_EQ(modes.size(), 10u);
  for (std::size_t r = 0; r < 10; ++r) {
    const double f = options.frequency_hz[static_cast<Index>(r)];
    EXPECT_NEAR(modes[r].frequency_hz.value, f, 4 * modes[r].frequency_hz.std);
    EXPECT_LT(modes[r].frequency_hz.std, 0.006 * f);
  }
}

// Points that agree: all FRFs together, without scatter to speak of.
TEST(LocalModes, PointsThatAgreeAreFittedTogether) {
  const testing::DefectiveFrfOptions options = small_set();
  const ModalResult result = identify_modes(testing::defective_frfs(options));
  ASSERT_EQ(result.model.modes.size(), 2u);
  for (std::size_t r = 0; r < 2; ++r) {
    const IdentifiedMode& mode = result.model.modes[r];
    const double f = options.frequency_hz[r];
    EXPECT_EQ(mode.refinement, "global");
    EXPECT_LT(std::abs(mode.frequency_hz.value - f), 4 * mode.frequency_hz.std);
    EXPECT_LT(mode.between_points_std_hz, 0.1 * 2 * options.damping_ratio * f);
  }
}

}  // namespace rigfit::signal::local_modes_test
