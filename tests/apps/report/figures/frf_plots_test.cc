// FRFs as figures: phase without jumps where it is known, linked plots; frequencies of struck
// points.
#include "apps/report/figures/figures.h"

#include "tests/test.h"

namespace rigfit::apps::frf_plots_test {
namespace {

using Eigen::Index;

/// A delay of 40 ms: the phase falls by 14.4 degrees a Hz, through several turns.
signal::FrfSet delayed() {
  signal::FrfSet frfs{.frequency_hz = Eigen::VectorXd::LinSpaced(101, 0, 100)};
  frfs.responses.resize(1);
  frfs.inputs.resize(1);
  frfs.H.resize(101, 1);
  frfs.H_std = Eigen::MatrixXd::Constant(101, 1, 0.01);
  for (Index k = 0; k < 101; ++k) {
    frfs.H(k, 0) = std::polar(1.0, -2 * std::numbers::pi * 0.04 * frfs.frequency_hz[k]);
  }
  return frfs;
}

TEST(FrfFigures, PhaseHasNoJumpsAndGapsWhereItIsNotKnown) {
  signal::FrfSet frfs = delayed();
  for (Index k = 40; k < 50; ++k) {
    frfs.H_std(k, 0) = 2;  // noise
    frfs.H(k, 0) = std::polar(1.0, 1.7 * static_cast<double>(k * k));
  }
  const auto plot = phase_plot("p", frfs, lines_between(frfs, 0, 100), Origin::measured);
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

TEST(FrfFigures, AreLinkedAndMarkTheModes) {
  const signal::FrfSet frfs = delayed();
  signal::ModalResult modal;
  modal.model.modes.resize(1);
  modal.model.modes[0].frequency_hz = {30, 0.1};
  modal.model.modes[0].doubtful = true;
  modal.model.responses.resize(1);
  modal.model.inputs.resize(1);
  modal.model.lower_residual = modal.model.upper_residual = Eigen::MatrixXcd::Zero(1, 1);
  modal.model.modes[0].pole_rad_s = {-1, 188};
  modal.model.modes[0].participation = modal.model.modes[0].shape = Eigen::VectorXcd::Ones(1);
  const auto plots = hammer_plots({nullptr, nullptr, frfs, 0, 100, &modal, "test", "200N"});
  ASSERT_EQ(plots.size(), 2u);  // neither hits nor coherence nor poles
  for (const auto& plot : plots) {
    EXPECT_EQ(plot.link, "test-frf-200N");
    ASSERT_EQ(plot.marks.size(), 1u);
    EXPECT_EQ(plot.marks[0].x, 30);
    EXPECT_TRUE(plot.marks[0].doubtful);
  }
}

}  // namespace
}  // namespace rigfit::apps::frf_plots_test
