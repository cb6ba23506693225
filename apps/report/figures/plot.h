// A figure as data: drawn as SVG for print and papers, interactively on the page, listed as a
// table for readers of screens, and kept as CSV.
#pragma once

#include <string>
#include <vector>

#include "ident/campaign/origin.h"

namespace rigfit::apps {

/// Where a value comes from. Told apart everywhere by colour, marker and word.
using ident::Origin;
/// The word shown, such as "published test".
[[nodiscard]] const char* name_of(Origin origin);
/// The CSS class and JSON word, such as "published-model".
[[nodiscard]] const char* word_of(Origin origin);

struct PlotSeries {
  enum class Style { line, dashed, points, line_and_points };
  std::string name;
  Origin origin = Origin::modelled;
  Style style = Style::line;
  std::vector<double> x, y;       ///< NaN in y: a gap
  std::vector<double> low, high;  ///< interval of y (bars at points, a band at lines); empty: none
  /// Index that varies the shade and marker among series of one origin.
  int variant = 0;
  /// A group of series switched together in the legend; empty: its own name.
  std::string group;
};

struct Plot {
  std::string id;  ///< file name and anchor
  std::string title;
  std::string caption;  ///< what there is to see, for a technician
  std::string x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<PlotSeries> series;
};

/// Columns series, x, y (and low, high), one line a point; numbers that read back exactly.
[[nodiscard]] std::string plot_csv(const Plot& plot);

}  // namespace rigfit::apps
