// Blocks of a report as HTML: paragraphs, tables, figures with their data. A report's page and the
// page that a verb writes by --plot are made of them, so that a figure looks the same in both.
#pragma once

#include "apps/report/page/report_part.h"

namespace rigfit::apps {

/// Collects blocks one after the other.
class BlockHtml {
 public:
  /// `files`: figures/ID.svg and data/ID.csv lie beside the page, and figures say so.
  explicit BlockHtml(bool files = true) : files_(files) {}

  void add(const Block& block);
  void add(const Paragraph& paragraph);
  void add(const ReportTable& table);
  void add(const Plot& plot);
  void add(const PlotGroup& group);
  void add(const Picture& picture);

  /// Level of the titles of figures from here on; those within a group are one lower.
  void heading(int level) { heading_ = level; }

  /// What was added since the last call.
  [[nodiscard]] std::string taken();

  /// Begin of a page that loads nothing, to the end of its head. `more`: elements of the head.
  [[nodiscard]] static std::string head(const std::string& title, const std::string& more = {});
  /// The script that zooms figures and switches tabs: for the end of its body.
  [[nodiscard]] static std::string script();

 private:
  /// A plot or picture with its title, number and caption around `content`.
  void add_figure(const auto& figure, const std::string& content);

  bool files_;
  std::string html_;
  int heading_ = 3;               ///< level of a figure's title
  int figures_ = 0, tables_ = 0;  ///< numbered through the page
};

// Figures alone: what --plot writes.

/// A page that needs nothing else. `repeat`: the command line that makes it again.
[[nodiscard]] std::string figures_page(const std::string& title, const std::string& repeat,
                                       const std::vector<Block>& blocks);

struct FiguresSvg {
  std::string svg;
  double width = 0, height = 0;  ///< px
};
/// All figures below each other, 0 px high without any; paragraphs and tables are left to the page.
[[nodiscard]] FiguresSvg figures_svg(const std::string& title, const std::vector<Block>& blocks);

}  // namespace rigfit::apps
