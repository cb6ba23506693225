// FRFs as figures: phase without jumps where it is known.
#include "apps/report/figures/figures.h"

#include "tests/test.h"

namespace rigfit::apps::frf_plots_test {

/// A delay of 40 ms: the phase falls by 14.4 degrees a Hz, through several turns.
signal::FrfSet delayed() {
  signal::FrfSet frfs{.frequency_hz = Eigen::VectorXd::LinSpaced(101, 0, 100)};
  frfs.responses.resize(1);
  frfs.inputs.resize(1);
  frfs.H.resize(101, 1);
  frfs.H_std = Eigen::MatrixXd::Constant(101, 1, 0.01);
  for (Index k = 0; k < 101; ++k) {
    frfs.H(k, 0) = std::polar(1.0, -2 * kPi * 0.04 * frfs.frequency_hz[k]);
  }
  return frfs;
}

TEST(FrfFigures, PhaseHasNoJumpsAndGapsWhereItIsNotKnown) {
  ident::HammerTest test;
  auto& frfs = test.frfs = delayed();
  for (Index k = 40; k < 50; ++k) {
    frfs.H_std(k, 0) = 2;  // noise
    frfs.H(k, 0) = std::polar(1.0, 1.7 * static_cast<double>(k * k));
  }
  const auto plot = hammer_plots({.places = {}, .test = test}).at(1);
  ASSERT_EQ(plot.series.size(), 1u);
  const auto& s = plot.series[0];
  ASSERT_EQ(s.x.size(), 100u);  // the line at 0 Hz is left out
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    if (s.x[i] > 39.5 && s.x[i] < 49.5) {
      EXPECT_TRUE(std::isnan(s.y[i])) << s.x[i];
    } else if (s.x[i] < 40) {
      EXPECT_NEAR(s.y[i], -14.4 * s.x[i], 1e-9) << s.x[i];
    } else {  // beyond the gap, whole turns are open; the slope is not
      EXPECT_NEAR(std::remainder(s.y[i] + 14.4 * s.x[i], 360), 0, 1e-9);
      if (s.x[i] > 50.5) {
        EXPECT_NEAR(s.y[i] - s.y[i - 1], -14.4, 1e-9);
      }
    }
  }
}

}  // namespace rigfit::apps::frf_plots_test
