// FRFs as figures: phase without jumps where it is known, linked plots; frequencies of struck
// points.
#include "apps/report/figures/frf_plots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "apps/report/figures/point_plots.h"

namespace rigfit::apps::frf_plots_test {
namespace {

using Eigen::Index;

/// A delay of 40 ms: the phase falls by 14.4 degrees a Hz, through several turns.
signal::FrfSet delayed() {
  signal::FrfSet frfs;
  frfs.frequency_hz = Eigen::VectorXd::LinSpaced(101, 0, 100);
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
  EXPECT_TRUE(plot.angle);
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
  const auto plots = frf_figures({"test", "200N", Origin::measured}, frfs,
                                 lines_between(frfs, 0, 100), &modal, nullptr);
  ASSERT_EQ(plots.size(), 2u);  // neither coherence nor poles
  for (const auto& plot : plots) {
    EXPECT_EQ(plot.link, "test-frf-200N");
    ASSERT_EQ(plot.marks.size(), 1u);
    EXPECT_EQ(plot.marks[0].x, 30);
    EXPECT_TRUE(plot.marks[0].doubtful);
  }
}

TEST(PointFigures, ShowScatterAndTrendOfEachMode) {
  signal::IdentifiedMode mode;
  mode.frequency_hz = {300, 0.001};
  mode.between_points_std_hz = 0.002;
  mode.trend_hz = {-0.003, 0.0005};
  mode.has_trend = true;
  for (int k = 0; k < 5; ++k) {
    signal::ModeAtPoint at;
    at.order = k;
    at.frequency_hz = {300 - 0.003 * (k - 2), 0.0004};
    mode.points.push_back(at);
  }
  const auto plot = points_plot("points", {mode}, Origin::measured);
  ASSERT_TRUE(plot);
  ASSERT_EQ(plot->series.size(), 2u);
  EXPECT_NEAR(plot->series[0].y[0], 20, 1e-6);  // 0.006 / 300 in ppm
  EXPECT_NEAR(plot->series[1].y[0], 20, 1e-6);  // and so does the trend at the first point
  EXPECT_NEAR(plot->series[0].high[0] - plot->series[0].low[0], 2 * 1.96 * 0.0004 / 300 * 1e6,
              1e-3);
  const auto table = points_table("points-table", {mode}, Origin::measured);
  ASSERT_TRUE(table);
  EXPECT_EQ(table->rows[0][1].text, "5");
  EXPECT_EQ(table->rows[0][4].text, "yes");
  mode.points.resize(1);
  EXPECT_FALSE(points_plot("points", {mode}, Origin::measured));
  EXPECT_FALSE(points_table("points-table", {mode}, Origin::measured));
}

}  // namespace
}  // namespace rigfit::apps::frf_plots_test
