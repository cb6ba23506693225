#include "apps/report/page/figures_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/report/drawing/html_text.h"
#include "apps/report/drawing/svg_plot.h"
#include "apps/report/page/block_html.h"

namespace rigfit::apps {
namespace {

SvgPanel panel_of(const Plot& plot, const std::string& state) {
  SvgOptions options;
  return {state.empty() ? plot.title : state + ": " + plot.title, svg_plot(plot, options),
          options.width, options.height};
}

}  // namespace

std::string figures_page(const std::string& title, const std::string& repeat,
                         const std::vector<Block>& blocks) {
  BlockHtml html(false);
  for (const auto& block : blocks) html.add(block);
  std::string page = BlockHtml::head(title);
  page += fmt::format("<body class=\"figures\">\n<main>\n<h1>{}</h1>\n", escaped(title));
  page += html.taken();
  page += fmt::format(
      "</main>\n<footer><p>To repeat: <code>{}</code></p><p>This page needs no "
      "network.</p></footer>\n",
      escaped(repeat));
  return page + html.script() + "</body>\n</html>\n";
}

FiguresSvg figures_svg(const std::string& title, const std::vector<Block>& blocks) {
  std::vector<SvgPanel> panels;
  for (const auto& block : blocks) {
    if (const auto* plot = std::get_if<Plot>(&block)) panels.push_back(panel_of(*plot, ""));
    if (const auto* picture = std::get_if<Picture>(&block)) {
      panels.push_back({picture->title, picture->svg, picture->width, picture->height});
    }
    if (const auto* group = std::get_if<PlotGroup>(&block)) {
      for (const auto& tab : group->tabs) {
        for (const auto& plot : tab.plots) panels.push_back(panel_of(plot, tab.label));
      }
    }
  }
  FiguresSvg sheet;
  sheet.svg = svg_sheet(title, panels, sheet.width, sheet.height);
  return sheet;
}

}  // namespace rigfit::apps
