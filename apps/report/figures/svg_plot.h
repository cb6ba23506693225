// A figure as SVG, fit for a paper: vector text, axes with round ticks, a legend, points with
// their intervals. Standing alone it carries its own colours; inside a page it takes the page's.
#pragma once

#include <string>
#include <vector>

#include "apps/report/figures/plot.h"

namespace rigfit::apps {

struct SvgOptions {
  double width = 760, height = 440;  ///< px
  bool standalone = true;            ///< with XML header and its own style sheet
};

[[nodiscard]] std::string svg_plot(const Plot& plot, const SvgOptions& options = {});

/// Round numbers that cover [low, high], about `count` of them; powers of ten (and 2, 5 between
/// when few) on a logarithmic axis.
[[nodiscard]] std::vector<double> axis_ticks(double low, double high, int count, bool logarithmic);

}  // namespace rigfit::apps
