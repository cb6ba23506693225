// A figure as the data that the page's script (assets/plots.js) draws it from.
#pragma once

#include <string>

#include "apps/report/drawing/plot.h"

namespace rigfit::apps {

/// The plot as JSON. Written by hand: a long record as a tree of numbers takes many times the time.
[[nodiscard]] std::string plot_data(const Plot& plot);

/// A text as a JSON string; bytes that are no UTF-8 are replaced.
[[nodiscard]] std::string json_text(const std::string& text);

}  // namespace rigfit::apps
