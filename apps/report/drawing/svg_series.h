// A series as SVG elements, between axes that are laid out: line, band, markers, intervals.
#pragma once

#include <string>
#include <vector>

#include "apps/report/drawing/plot.h"

namespace rigfit::apps {

/// An axis of a figure: the range of values low..high lies between the pixels from..to.
struct SvgAxis {
  double low = 0, high = 1, from = 0, to = 1;
  bool logarithmic = false;
  std::vector<double> ticks;

  [[nodiscard]] double at(double value) const;
  /// A number that has a place on such an axis.
  [[nodiscard]] bool shows(double value) const;
};

inline constexpr std::size_t kDenseSeries = 700;  ///< more points than a figure has pixels across

/// What is common to the series of a figure.
struct SvgSeriesOptions {
  int digits = 1;        ///< of pixels in long paths
  bool beneath = false;  ///< a model is drawn over it, and must not hide it
  double scale = 1;      ///< of markers and strokes
};

void draw_series(std::string& svg, const PlotSeries& series, const SvgAxis& x, const SvgAxis& y,
                 const SvgSeriesOptions& options);

/// What stands for the series in a legend, `left` px to the right, centred at height `y`, 24 px
/// (times scale) wide.
[[nodiscard]] std::string legend_key(const PlotSeries& series, double left, double y, double scale);

}  // namespace rigfit::apps
