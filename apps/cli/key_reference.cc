#include "apps/cli/key_reference.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "apps/campaign/campaign.h"
#include "apps/cli/assets.h"
#include "apps/cli/terminal.h"

namespace rigfit::apps {
namespace {

using Row = std::vector<std::string>;

/// Cells of "| a | b |", without backticks.
Row cells_of(std::string_view line) {
  Row cells;
  std::size_t at = 1;
  while (at < line.size()) {
    const std::size_t end = std::min(line.find('|', at), line.size());
    std::string cell(line.substr(at, end - at));
    std::erase(cell, '`');
    const std::size_t first = cell.find_first_not_of(' ');
    const std::size_t last = cell.find_last_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
    at = end + 1;
  }
  return cells;
}

/// The columns under each other; the last one wraps.
std::string aligned(const std::vector<Row>& rows) {
  const std::size_t width = text_width();
  constexpr std::size_t kWidest = 44;
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (std::size_t c = 0; c + 1 < row.size(); ++c) {
      widths[c] = std::min(kWidest, std::max(widths[c], row[c].size()));
    }
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    std::size_t indent = 0;
    for (std::size_t c = 0; c + 1 < row.size(); ++c) {
      line += row[c];
      indent += widths[c] + 2;
      if (line.size() + 2 > indent) {
        text += line + '\n';
        line.clear();
      }
      line.resize(indent, ' ');
    }
    text += wrapped(line + row.back(), indent, std::max(width, indent + 30)) + '\n';
  }
  return text;
}

}  // namespace

std::string key_reference(const std::string& document) {
  if (document == "campaign") {
    std::string text = "Paths are relative to the campaign; `rigfit new` writes one.\n";
    for (const auto& section : campaign_keys()) {
      text += '\n' + section.title + '\n' + aligned(section.rows);
    }
    return text;
  }
  constexpr std::array<std::pair<std::string_view, std::string_view>, 2> kSections = {
      {{"scene", "## Scene\n"}, {"sidecar", "## Sidecar\n"}}};
  const auto* const section = std::find_if(kSections.begin(), kSections.end(),
                                           [&](const auto& one) { return one.first == document; });
  if (section == kSections.end()) return "";
  std::string_view page = assets::apps_readme;
  const std::size_t begin = page.find(section->second);
  if (begin == std::string_view::npos) return "";
  page = page.substr(begin + section->second.size());
  page = page.substr(0, page.find("\n## "));
  std::string text;
  std::vector<Row> table;
  const auto flush = [&] {
    if (!table.empty()) text += aligned(table);
    table.clear();
  };
  while (!page.empty()) {
    const std::size_t end = std::min(page.find('\n'), page.size());
    const std::string_view line = page.substr(0, end);
    page = page.substr(std::min(page.size(), end + 1));
    if (line.starts_with("|---")) continue;
    if (line.starts_with("|")) {
      table.push_back(cells_of(line));
      continue;
    }
    flush();
    if (line.starts_with("```")) continue;
    std::string plain(line);
    std::erase(plain, '`');
    text += plain + '\n';
  }
  flush();
  text.erase(0, text.find_first_not_of('\n'));
  return text;
}

}  // namespace rigfit::apps
