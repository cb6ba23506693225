#include "apps/report/page/first_page.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>

#include "apps/report/drawing/html_text.h"

namespace rigfit::apps {
namespace {

constexpr std::size_t kMostAnswers = 14, kMostWarnings = 5;

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  return fmt::format("{:%Y-%m-%d}", parts);
}

void heading(std::string& html, const PageFrame& frame) {
  const auto& details = frame.details;
  html += "<header>\n";
  if (const std::string logo = logo_data_uri(details.logo); !logo.empty()) {
    html += fmt::format("<img class=\"logo\" src=\"{}\" alt=\"{}\">\n", logo,
                        escaped(details.organisation.empty() ? "Logo" : details.organisation));
  }
  html += fmt::format("<h1>{}</h1>\n<dl class=\"details\">", escaped(frame.title));
  for (const auto& [name, value] :
       {std::pair{"Client", details.client}, std::pair{"Project", details.project},
        std::pair{"Author", details.author}, std::pair{"Organisation", details.organisation},
        std::pair{"Date", details.date.empty() ? today() : details.date},
        std::pair{"Revision", details.revision}}) {
    if (value.empty()) continue;
    html += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>", name, escaped(value));
  }
  html += "</dl>\n";
  if (!frame.description.empty()) html += fmt::format("<p>{}</p>\n", escaped(frame.description));
  if (!frame.source.empty()) {
    html += fmt::format("<p class=\"source\">Source: {}</p>\n", escaped(frame.source));
  }
  html += "</header>\n";
}

void answers_table(std::string& html, std::span<const ReportPart> parts) {
  std::vector<const Answer*> list;
  std::size_t all = 0;
  for (int rank = 0; rank < 2; ++rank) {
    std::vector<const Answer*> of_rank;
    for (const auto& part : parts) {
      for (const auto& answer : part.answers) {
        all += rank == 0;
        if (answer.rank == rank && answer.recommended) of_rank.push_back(&answer);
      }
    }
    if (rank > 0 && list.size() + of_rank.size() > kMostAnswers) continue;
    list.insert(list.end(), of_rank.begin(), of_rank.end());
  }
  list.resize(std::min(list.size(), kMostAnswers));
  if (list.empty()) {
    html += "<p class=\"warning\">These recordings gave no answer: the warnings say why.</p>\n";
    return;
  }
  html +=
      "<div class=\"table\"><table class=\"answers short\" id=\"answers\"><caption>Results, ± "
      "standard uncertainty; verdicts are about 95 % intervals.</caption>\n<thead><tr><th "
      "scope=\"col\">quantity</th><th scope=\"col\" class=\"n\">value</th><th "
      "scope=\"col\">unit</th><th scope=\"col\">how known</th><th scope=\"col\">verdict</th></tr>"
      "</thead>\n<tbody>\n";
  for (const auto* answer : list) {
    html += fmt::format(
        "<tr><th scope=\"row\"><a href=\"#{}\">{}</a></th><td class=\"n\">{}</td><td "
        "class=\"u\">{}</td>"
        "<td class=\"o-{}\">{}{}</td><td{}>{}</td></tr>\n",
        escaped(answer->anchor), escaped(quantity_words(*answer)), escaped(value_words(*answer)),
        escaped(shown_unit(*answer)), word_of(answer->origin), escaped(answer->how),
        answer->origin == Origin::synthetic ? " (synthetic)" : "",
        doubtful(*answer) ? " class=\"doubt\"" : "", escaped(verdict_words(*answer)));
  }
  html += "</tbody></table></div>\n";
  if (all > list.size()) {
    html += fmt::format(
        "<p class=\"small\">{} of {} values; all, with their intervals, are in <a "
        "href=\"data/results.csv\">data/results.csv</a>.</p>\n",
        list.size(), all);
  }
}

}  // namespace

std::string first_page(const PageFrame& frame, const ReportPart& overview,
                       std::span<const ReportPart> parts, std::span<const ReportFinding> findings,
                       BlockHtml& blocks) {
  std::string html = "<section class=\"first-page\" aria-labelledby=\"summary\">\n";
  heading(html, frame);
  html += "<h2 id=\"summary\" class=\"hidden\">Summary</h2>\n<div class=\"overview\">\n";
  blocks.heading(3);
  for (const auto& block : overview.blocks) blocks.add(block);
  html += blocks.taken() + "</div>\n<h3 id=\"results\">Results</h3>\n";
  answers_table(html, parts);
  html += "<h3 id=\"warnings\">Warnings</h3>\n";
  const auto count = static_cast<std::size_t>(std::count_if(
      findings.begin(), findings.end(), [](const ReportFinding& one) { return !one.note; }));
  if (count == 0) return html + "<p>No warning that would change these results.</p>\n</section>\n";
  html += "<ul class=\"lines distrust\">\n" +
          findings_html(findings.first(std::min(count, kMostWarnings))) + "</ul>\n";
  if (count > kMostWarnings) {
    html += fmt::format("<p class=\"small\"><a href=\"#more-warnings\">{} more</a></p>\n",
                        count - kMostWarnings);
  }
  return html + "</section>\n";
}

}  // namespace rigfit::apps
