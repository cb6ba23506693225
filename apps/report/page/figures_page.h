// Figures alone, as a page or as one picture: what --plot writes.
#pragma once

#include <string>
#include <vector>

#include "apps/report/page/report_part.h"

namespace rigfit::apps {

/// A page that needs nothing else. `repeat`: the command line that makes it again.
[[nodiscard]] std::string figures_page(const std::string& title, const std::string& repeat,
                                       const std::vector<Block>& blocks);

struct FiguresSvg {
  std::string svg;
  double width = 0, height = 0;  ///< px
};
/// All figures below each other; paragraphs, tables and moving shapes are left to the page.
[[nodiscard]] FiguresSvg figures_svg(const std::string& title, const std::vector<Block>& blocks);

}  // namespace rigfit::apps
