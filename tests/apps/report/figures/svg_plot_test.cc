#include "apps/report/drawing/plot.h"

#include "apps/report/figures/figures.h"
#include "tests/test.h"

namespace rigfit::apps::svg_plot_test {

TEST(AxisTicks, AreRoundAndInside) {
  EXPECT_THAT(axis_ticks(0, 300, 6, false), ElementsAre(0, 50, 100, 150, 200, 250, 300));
  EXPECT_THAT(axis_ticks(-1, 1, 4, false), ElementsAre(-1, -0.5, 0, 0.5, 1));
  EXPECT_THAT(axis_ticks(1, 1000, 6, true), ElementsAre(1, 10, 100, 1000));
  EXPECT_THAT(axis_ticks(1, 10, 6, true), ElementsAre(1, 2, 3, 5, 7, 10));
  EXPECT_TRUE(axis_ticks(1, 1, 6, false).empty());
  EXPECT_TRUE(axis_ticks(-1, 10, 6, true).empty());
  EXPECT_TRUE(axis_ticks(0, kInf, 6, false).empty());
}

TEST(SvgPlot, DrawsEverySeriesOnceAndNeverANonNumber) {
  Plot plot{.id = "demo", .title = "a < b & c"};
  plot.x_label = "tension, N";
  plot.y_label = "EI, N m²";
  PlotSeries points{.name = "test <1>",
                    .origin = Origin::published,
                    .style = PlotSeries::Style::points,
                    .x = {1, 2, 3},
                    .y = {1, kNaN, 3},
                    .low = {0.5, kNaN, 2},
                    .high = {1.5, kNaN, 4}};
  PlotSeries line{.name = "model", .x = {1, 2, 3}, .y = {1.1, 2.1, 3.1}};
  plot.series = {points, line};
  const std::string svg = svg_plot(plot);
  EXPECT_THAT(svg, HasSubstr("a &lt; b &amp; c"));
  EXPECT_THAT(svg, HasSubstr("test &lt;1&gt;"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  EXPECT_EQ(count(svg, "class=\"m\""), 3u);  // two points and the legend's
  EXPECT_EQ(count(svg, "data-k=\"model\""), 2u);
  EXPECT_TRUE(svg.ends_with("</svg>\n"));

  // A logarithmic axis leaves out what it cannot show.
  plot.log_y = true;
  plot.series[0].y = {0, -1, 3};
  plot.series[0].low = plot.series[0].high = {};
  EXPECT_EQ(count(svg_plot(plot), "class=\"m\""), 2u);
  // Nothing at all still gives axes.
  plot.series.clear();
  EXPECT_THAT(svg_plot(plot), Not(HasSubstr("nan")));
}

TEST(SvgPlot, LongRecordsKeepTheirExtremesAndStaySmall) {
  Plot plot{.id = "long"};
  PlotSeries line{.name = "record"};
  for (int i = 0; i < 200000; ++i) {
    line.x.push_back(i);
    line.y.push_back(i == 123456 ? 10 : std::sin(0.01 * i));
  }
  plot.series.push_back(line);
  const std::string svg = svg_plot(plot);
  EXPECT_LT(svg.size(), 100000u);
  // The spike is the highest point; the axis leaves 5 % of the range [-1, 10] above and below it.
  const double top = 12, bottom = 440 - 72;
  const double spike = top + (bottom - top) * 0.05 / 1.1;
  EXPECT_THAT(svg, HasSubstr(fmt::format(" {:.1f}L", spike)));
}

/// The numbers of an attribute such as `y="12.5"` in all elements that begin so.
std::vector<double> numbers_after(const std::string& text, const std::string& what) {
  std::vector<double> list;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos;) {
    at += what.size();
    list.push_back(std::stod(text.substr(at)));
  }
  return list;
}

TEST(SvgPlot, ErrorBarsLieInsideTheAxes) {
  Plot plot{.id = "bars"};
  PlotSeries points{.name = "test",
                    .style = PlotSeries::Style::line_and_points,
                    .x = {1, 2},
                    .y = {1.0, 1.1},
                    .low = {-50, 1},
                    .high = {60, 1.2}};
  plot.series = {points};
  const std::string svg = svg_plot(plot);
  // Bars are drawn as M x high V low: both between the frame's top (12) and bottom.
  const double bottom = 440 - 72;
  for (const double y : numbers_after(svg, "V")) {
    EXPECT_GE(y, 12);
    EXPECT_LE(y, bottom);
  }
}

TEST(SvgPlot, HasTheSizeAndFontThatAPaperAsksFor) {
  Plot plot{.id = "paper"};
  plot.x_label = "tension, N";
  PlotSeries line{.name = "model", .x = {0, 1}, .y = {0, 1}};
  plot.series = {line};
  const std::string svg = svg_plot(plot, print_size(85, 60, "Times New Roman", 8));
  EXPECT_THAT(svg, HasSubstr("width=\"85mm\" height=\"60mm\""));
  EXPECT_THAT(svg, HasSubstr("font-family=\"Times New Roman\""));
  // Letters are 12 of the drawing's px: 8 points where 85 mm are 85 / 25.4 * 72 * 12 / 8 of them.
  EXPECT_THAT(svg, HasSubstr("viewBox=\"0 0 361.417 255.118\""));
  EXPECT_THAT(svg, HasSubstr("font-size=\"12\""));
  for (const double x : numbers_after(svg, "<text class=\"t\" x=\"")) EXPECT_LT(x, 361.5);
}

TEST(PlotCsv, HoldsEveryValueExactly) {
  Plot plot{.x_label = "x"};
  plot.y_label = "y, \"units\"";
  PlotSeries series;
  series.name = "a,b";
  series.x = {0.1, 1.0 / 3};
  series.y = {1e-300, kNaN};
  plot.series.push_back(series);
  EXPECT_EQ(plot_csv(plot),
            "series,origin,\"x\",\"y, \"\"units\"\"\",low,high\n\"a,b\",modelled,0.1,1e-300,,\n"
            "\"a,b\",modelled,0.3333333333333333,,,\n");
}

// FRFs as figures: phase without jumps where it is known.

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

}  // namespace rigfit::apps::svg_plot_test
