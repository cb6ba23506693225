#include "signal/modal/local_modes.h"

#include "signal/modal/modal_identification.h"
#include "tests/reference/defective_frfs.h"
#include "tests/test.h"

namespace rigfit::signal::local_modes_test {

testing::DefectiveFrfOptions small_set() {
  testing::DefectiveFrfOptions options;
  options.frequency_hz = (Eigen::VectorXd(2) << 30, 52).finished();
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
