// A figure as data: drawn as SVG for page and papers, and kept as CSV.
#pragma once

#include "apps/describe/standard.h"
#include "ident/campaign/single_tests/test_recording.h"

namespace rigfit::apps {

/// Where a value comes from. Told apart by colour and word in text, by marker and dash in figures.
using ident::Origin;
/// The word shown, such as "published test".
[[nodiscard]] const char* name_of(Origin origin);
/// The CSS class and JSON word, such as "published-model".
[[nodiscard]] const char* word_of(Origin origin);

/// The place of a series in the palette, which begins again beyond its end.
[[nodiscard]] std::size_t palette_place(int number);
/// Its colour on white.
[[nodiscard]] const char* series_colour(int number);
/// Style sheet with a custom property per origin (--measured ...) and classes .s0 .s1 ... for
/// series, for light and dark screens and for print.
[[nodiscard]] std::string palette_css();

struct PlotSeries {
  enum class Style { line, dashed, points, line_and_points };
  std::string name = {};
  Origin origin = Origin::modelled;
  /// Number among the figure's series (sensors, states, files): its colour.
  int variant = 0;
  Style style = Style::line;
  /// A group of series switched together in the legend; empty: its own name.
  std::string group = {};
  std::vector<double> x = {}, y = {};       ///< NaN in y: a gap
  std::vector<double> low = {}, high = {};  ///< interval of y (bars at points, a band at lines)

  void add(double at, double value) { x.push_back(at), y.push_back(value); }
  void add(double at, double value, double from, double to) {
    add(at, value);
    low.push_back(from), high.push_back(to);
  }
};

/// How a series is drawn, in the figure and in its legend: colour by its number (`variant`), marker
/// and dash by where it comes from.
struct SeriesLook {
  enum class Marker { none, dot, circle, square, diamond, cross };
  Marker marker = Marker::none;
  bool hollow = false;    ///< a marker of paper with a coloured edge
  bool line = false;      ///< its points are joined
  const char* dash = "";  ///< as in SVG; empty: full line
};
/// `overlaid`: a test stands in the same figure, and a model is broken.
[[nodiscard]] SeriesLook look_of(const PlotSeries& series, bool overlaid = false);

/// An upright line at a place of the abscissa: a mode, an instant.
struct PlotMark {
  double x = 0;
  std::string label;
  bool doubtful = false;  ///< broken
};

struct Plot {
  std::string id = {};  ///< file name and anchor
  std::string title = {};
  std::string caption = {};  ///< what there is to see, for a technician
  std::string x_label = {}, y_label = {};
  bool log_x = false, log_y = false;
  std::vector<PlotSeries> series = {};
  std::vector<PlotMark> marks = {};
  /// Plots with the same word here share the abscissa: the page zooms and reads them together.
  std::string link = {};

  void add(PlotSeries one) {
    if (!one.x.empty()) series.push_back(std::move(one));
  }
  /// The series of that name, added with the next colour where there is none.
  PlotSeries& named(const std::string& name, Origin origin = Origin::modelled,
                    PlotSeries::Style style = PlotSeries::Style::points);
};

/// Columns series, x, y (and low, high), one line a point; numbers that read back exactly.
[[nodiscard]] std::string plot_csv(const Plot& plot);

// As SVG (svg_plot.cc), fit for a paper: vector text, axes with round ticks, a legend, points with
// their intervals. Standing alone it carries its own colours; inside a page it takes the page's,
// and the page's script (assets/figures.js) zooms it and reads its values.

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
