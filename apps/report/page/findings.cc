#include "apps/report/page/findings.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/cli/warning_lines.h"
#include "apps/report/drawing/html_text.h"
#include "apps/report/page/parameter_words.h"

namespace rigfit::apps {
namespace {

int rank_of(const ReportFinding& one) {
  return one.refused ? -1 : static_cast<int>(level_of(one.code));
}

/// Without the folders of a file.
std::string place_of(const std::string& where) {
  const auto slash = where.rfind('/', where.find(": "));
  return slash == std::string::npos ? where : where.substr(slash + 1);
}

}  // namespace

std::vector<ReportFinding> findings_of(std::span<const ReportPart> parts) {
  constexpr std::size_t kMostPlaces = 4;
  std::vector<ReportFinding> list;
  for (const auto& part : parts) {
    for (const auto& warning : part.warnings) {
      const auto same = std::find_if(list.begin(), list.end(), [&](const ReportFinding& one) {
        return !one.refused && !warning.refused && one.code == warning.code;
      });
      if (same == list.end()) {
        list.push_back({warning.code, with_parameter_words(warning.message),
                        place_of(warning.where), part.title, part.id, 1, warning.refused,
                        !warning.refused && is_note(warning.code)});
      } else if (++same->count <= kMostPlaces) {
        same->where += "; " + place_of(warning.where);
      }
    }
  }
  for (auto& one : list) {
    if (one.count > kMostPlaces) one.where += fmt::format(" and {} more", one.count - kMostPlaces);
  }
  std::stable_sort(list.begin(), list.end(), [](const ReportFinding& a, const ReportFinding& b) {
    return rank_of(a) < rank_of(b);
  });
  return list;
}

std::string findings_html(std::span<const ReportFinding> findings) {
  std::string html;
  for (const auto& one : findings) {
    html += fmt::format("<li><a href=\"#{}\">{}</a>{}: {}{}</li>\n", escaped(one.anchor),
                        escaped(one.title), one.refused ? ", refused" : "", escaped(one.message),
                        one.count > 1 || one.refused ? escaped(" (" + one.where + ")") : "");
  }
  return html;
}

}  // namespace rigfit::apps
