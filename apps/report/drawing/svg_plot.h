// A figure as SVG, fit for a paper: vector text, axes with round ticks, a legend, points with
// their intervals. Standing alone it carries its own colours; inside a page it takes the page's,
// and the page's script (assets/figures.js) zooms it and reads its values.
#pragma once

#include "apps/report/drawing/plot.h"

namespace rigfit::apps {

struct SvgOptions {
  double width = 760, height = 440;  ///< px of the drawing, in which letters are 12 px high
  std::string font = "sans-serif";   ///< CSS font-family
  double px_per_mm = 0;              ///< scale of a printed drawing; 0: it is shown in px
};

/// For a paper: width and height in mm, the font's name and its size in points. Markers, strokes
/// and margins go with the font.
[[nodiscard]] SvgOptions print_size(double width_mm, double height_mm, const std::string& font,
                                    double size_pt);

[[nodiscard]] std::string svg_plot(const Plot& plot, const SvgOptions& options = {});

/// An svg element (of svg_plot, a Picture) as a file of its own: XML header and white paper.
[[nodiscard]] std::string standalone_svg(const std::string& svg);

/// Round numbers that cover [low, high], about `count` of them; powers of ten (and 2, 5 between
/// when few) on a logarithmic axis.
[[nodiscard]] std::vector<double> axis_ticks(double low, double high, int count, bool logarithmic);

}  // namespace rigfit::apps
