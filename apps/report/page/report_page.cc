#include "apps/report/page/report_page.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <set>

#include "apps/cli/assets.h"
#include "apps/cli/warning_lines.h"
#include "apps/report/drawing/html_text.h"
#include "apps/report/page/answer.h"
#include "apps/report/page/block_html.h"
#include "apps/report/page/tables.h"

namespace rigfit::apps {
namespace {

constexpr std::size_t kLongestShortTable = 16;  // rows
constexpr std::size_t kMostShort = 16;          // figures and tables, some five pages

/// The parts of one test or fit.
struct Section {
  std::string id, title;
  std::vector<const ReportPart*> parts;
};

std::vector<Section> sections_of(std::span<const ReportPart> parts) {
  std::vector<Section> sections;
  for (const auto& part : parts) {
    if (part.blocks.empty()) continue;
    const std::string& id = part.test.empty() ? part.id : part.test;
    auto at = std::find_if(sections.begin(), sections.end(),
                           [&](const Section& one) { return one.id == id; });
    if (at == sections.end()) {
      sections.push_back({id, part.title, {}});
      at = sections.end() - 1;
    }
    if (part.id == id) at->title = part.title;
    at->parts.push_back(&part);
  }
  return sections;
}

std::string id_of(const Block& block) {
  return std::visit(
      [](const auto& one) -> std::string {
        if constexpr (requires { one.id; }) return one.id;
        return {};
      },
      block);
}

int rank_of(const ReportFinding& one) {
  return one.refused ? -1 : static_cast<int>(level_of(one.code));
}

/// Without the folders of a file.
std::string place_of(const std::string& where) {
  const auto slash = where.rfind('/', where.find(": "));
  return slash == std::string::npos ? where : where.substr(slash + 1);
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

/// The recommended answers: those of the first page, others where there is room.
ReportTable answers_table(std::span<const ReportPart> parts) {
  ReportTable table{"answers",
                    "Results, ± standard uncertainty; verdicts are about 95 % intervals.",
                    {{"quantity", {}, false},
                     {"value"},
                     {"unit", {}, false},
                     {"how known", {}, false},
                     {"verdict", {}, false}}};
  for (int rank = 0; rank < 2; ++rank) {
    auto rows = table.rows;
    for (const auto& part : parts) {
      for (const auto& answer : part.answers) {
        if (answer.rank != rank || !answer.recommended) continue;
        Cell quantity(quantity_words(answer)), verdict(verdict_words(answer));
        quantity.anchor = answer.anchor;
        verdict.doubtful = doubtful(answer);
        const char* synthetic = answer.origin == Origin::synthetic ? " (synthetic)" : "";
        rows.push_back({std::move(quantity), value_words(answer), shown_unit(answer),
                        Cell(answer.how + synthetic, answer.origin), std::move(verdict)});
      }
    }
    if (rank == 0 || rows.size() <= kMostAnswers) table.rows = std::move(rows);
  }
  table.rows.resize(std::min(table.rows.size(), kMostAnswers));
  return table;
}

class PageWriter {
 public:
  PageWriter(const PageFrame& frame, std::span<const ReportPart> parts)
      : frame_(frame), parts_(parts), sections_(sections_of(parts)), findings_(findings_of(parts)) {
    choose_short();
  }

  std::string report(const ReportPart& overview) {
    const bool all = frame_.style == ReportStyle::lab;
    head(frame_.title);
    navigation(true, all);
    html_ += "<main>\n";
    first_page(overview);
    html_ += "<div class=\"contents\"><h2>Contents</h2>\n" + contents(true, all) + "</div>\n";
    for (const auto& section : sections_) short_section(section);
    more_warnings();
    if (all) appendix();
    provenance();
    if (!all) link_to_appendix();
    return finished();
  }

  std::string appendix_alone() {
    head(frame_.title + ": appendix");
    navigation(false, true);
    html_ += fmt::format(
        "<main>\n<header><h1>{}: appendix</h1>\n<p><a href=\"report.html\">"
        "Report</a></p></header>\n",
        escaped(frame_.title));
    appendix();
    return finished();
  }

 private:
  /// What stands in the appendix is in another file of a client's report.
  void link_to_appendix() {
    for (const auto& part : parts_) {
      const auto section = std::find_if(sections_.begin(), sections_.end(),
                                        [&](const Section& one) { return one.id == part.id; });
      if (section != sections_.end() && has_short(*section)) continue;
      const std::string link = fmt::format("href=\"#{}\"", escaped(part.id));
      for (std::size_t at = 0; (at = html_.find(link, at)) != std::string::npos; at += 6) {
        html_.insert(at + 6, "appendix.html");
      }
    }
  }

  /// One page on paper.
  void first_page(const ReportPart& overview) {
    html_ += "<section class=\"first-page\" aria-labelledby=\"summary\">\n";
    heading(html_, frame_);
    html_ += "<h2 id=\"summary\" class=\"hidden\">Summary</h2>\n<div class=\"overview\">\n";
    blocks_.heading(3);
    for (const auto& block : overview.blocks) blocks_.add(block);
    html_ += blocks_.taken() + "</div>\n<h3 id=\"results\">Results</h3>\n";
    const ReportTable answers = answers_table(parts_);
    std::size_t all = 0;
    for (const auto& part : parts_) all += part.answers.size();
    if (answers.rows.empty()) {
      blocks_.add(Paragraph{"These recordings gave no answer: the warnings say why.",
                            Paragraph::Kind::warning});
    } else {
      blocks_.add(answers);
    }
    html_ += blocks_.taken();
    if (all > answers.rows.size()) {
      html_ += fmt::format(
          "<p class=\"small\">{} of {} values; all, with their intervals, are in <a "
          "href=\"data/results.csv\">data/results.csv</a>.</p>\n",
          answers.rows.size(), all);
    }
    html_ += "<h3 id=\"warnings\">Warnings</h3>\n";
    const std::size_t count = count_warnings();
    html_ += warnings_html(count, kMostWarnings);
    if (count > kMostWarnings) {
      html_ += fmt::format("<p class=\"small\"><a href=\"#more-warnings\">{} more</a></p>\n",
                           count - kMostWarnings);
    }
    html_ += "</section>\n";
  }

  /// The first `most` of the warnings as a list.
  [[nodiscard]] std::string warnings_html(std::size_t count, std::size_t most) const {
    if (count == 0) return "<p>No warning that would change these results.</p>\n";
    return "<ul class=\"lines distrust\">\n" +
           findings_html(std::span(findings_).first(std::min(count, most))) + "</ul>\n";
  }

  [[nodiscard]] std::size_t count_warnings() const {
    return static_cast<std::size_t>(std::count_if(findings_.begin(), findings_.end(),
                                                  [](const auto& one) { return !one.note; }));
  }

  /// What the short report has room for: its own ids of figures and tables.
  void choose_short() {
    for (const auto& section : sections_) {
      for (const auto* part : section.parts) {
        for (const auto& block : part->blocks) {
          const std::string id = id_of(block);
          if (std::find(part->brief.begin(), part->brief.end(), id) == part->brief.end()) continue;
          const auto* table = std::get_if<ReportTable>(&block);
          if (table && table->rows.size() > kLongestShortTable) continue;
          if (short_.size() < kMostShort) short_.insert(id);
        }
      }
    }
  }

  [[nodiscard]] bool is_short(const Block& block) const { return short_.contains(id_of(block)); }

  static bool has_short(const Section& section) {
    return std::any_of(section.parts.begin(), section.parts.end(), [](const ReportPart* part) {
      return !part->brief.empty() || !part->summary.empty();
    });
  }

  /// Something of it is left for the appendix, or it has no other place.
  [[nodiscard]] bool has_details(const Section& section) const {
    return !has_short(section) ||
           std::any_of(section.parts.begin(), section.parts.end(), [&](const ReportPart* part) {
             return std::any_of(part->blocks.begin(), part->blocks.end(),
                                [&](const Block& block) { return !is_short(block); });
           });
  }

  void head(const std::string& title) {
    html_ = BlockHtml::head(title, fmt::format("<style>{}</style>\n", assets::page_css));
    html_ += "<body>\n<a class=\"skip\" href=\"#main\">To the content</a>\n";
  }

  /// The lists of a contents: the report's sections, the appendix' sections.
  [[nodiscard]] std::string contents(bool report, bool appendix) const {
    std::string html = "<ol>\n";
    if (report) {
      html += "<li><a href=\"#summary\">Summary</a></li>\n";
      for (const auto& section : sections_) {
        if (!has_short(section)) continue;
        html += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", escaped(section.id),
                            escaped(section.title));
      }
      html += "<li><a href=\"#more-warnings\">Warnings</a></li>\n";
    }
    if (appendix) {
      html += "<li class=\"part\"><a href=\"#appendix\">Appendix</a>\n<ol>\n";
      for (const auto& section : sections_) {
        if (!has_details(section)) continue;
        html += fmt::format("<li><a href=\"#{}-details\">{}</a></li>\n", escaped(section.id),
                            escaped(section.title));
      }
      html += "</ol></li>\n";
    } else {
      html += "<li><a href=\"appendix.html\">Appendix</a></li>\n";
    }
    if (report) html += "<li><a href=\"#provenance\">Provenance</a></li>\n";
    for (const auto& [file, title] : frame_.links) {
      html += fmt::format("<li><a href=\"{}\">{}</a></li>\n", escaped(file), escaped(title));
    }
    return html + "</ol>\n";
  }

  void navigation(bool report, bool appendix) {
    html_ += fmt::format(
        "<nav class=\"side\" aria-label=\"Contents\">\n<div class=\"bar\"><a "
        "href=\"#main\">{}</a><button type=\"button\" class=\"menu\" aria-expanded=\"false\" "
        "aria-controls=\"side-list\">Menu</button></div>\n<div "
        "id=\"side-list\">{}</div>\n</nav>\n<div "
        "id=\"main\"></div>\n",
        escaped(frame_.title), contents(report, appendix));
  }

  /// What was found, with the figure and the table that say most.
  void short_section(const Section& section) {
    if (!has_short(section)) return;
    html_ +=
        fmt::format("<section class=\"brief\" aria-labelledby=\"{0}\"><h2 id=\"{0}\">{1}</h2>\n",
                    escaped(section.id), escaped(section.title));
    std::string items;
    for (const auto* part : section.parts) {
      const bool tabled =
          std::any_of(part->blocks.begin(), part->blocks.end(), [&](const Block& block) {
            return std::holds_alternative<ReportTable>(block) && is_short(block);
          });
      for (const auto& item : part->summary) {
        // The table says it, and the first page did.
        if (item.kind == SummaryItem::Kind::result && tabled) continue;
        const bool own = item.label == section.title;
        items +=
            fmt::format("<li{}>{}<span class=\"text\">{}</span></li>\n",
                        item.origin ? fmt::format(" class=\"o-{}\"", word_of(*item.origin)) : "",
                        own ? std::string() : fmt::format("<b>{}</b>: ", escaped(item.label)),
                        escaped(item.text));
      }
    }
    if (!items.empty()) html_ += "<ul class=\"lines\">\n" + items + "</ul>\n";
    html_ += "<div class=\"pair\">\n";
    blocks_.heading(3);
    for (const auto* part : section.parts) {
      for (const auto& block : part->blocks) {
        if (is_short(block)) blocks_.add(block);
      }
    }
    html_ += blocks_.taken() + "</div>\n";
    if (has_details(section)) {
      html_ += fmt::format("<p class=\"small more\"><a href=\"{}#{}-details\">Details</a></p>\n",
                           frame_.style == ReportStyle::client ? "appendix.html" : "",
                           escaped(section.id));
    }
    html_ += "</section>\n";
  }

  /// All of them; notes folded.
  void more_warnings() {
    const std::size_t warnings = count_warnings();
    const std::span<const ReportFinding> all(findings_);
    html_ +=
        "<section class=\"brief\" aria-labelledby=\"more-warnings\"><h2 "
        "id=\"more-warnings\">Warnings</h2>\n" +
        warnings_html(warnings, warnings);
    if (warnings < all.size()) {
      html_ += fmt::format(
          "<details class=\"fold\"><summary>{}: normal operation, or allowed for in the values"
          "</summary>\n<ul class=\"small\">\n{}</ul></details>\n",
          counted(all.size() - warnings, "note"), findings_html(all.subspan(warnings)));
    }
    html_ += "</section>\n";
  }

  void appendix() {
    html_ +=
        "<section class=\"appendix\" aria-labelledby=\"appendix\"><h2 id=\"appendix\">Appendix"
        "</h2>\n<p class=\"small\">Where a value comes from, in colour and in words:</p>"
        "<ul class=\"key\">";
    for (const auto& [origin, what] :
         {std::pair{Origin::measured, "from recordings of this campaign"},
          std::pair{Origin::published, "a measurement someone published"},
          std::pair{Origin::published_model, "a result of someone's model"},
          std::pair{Origin::synthetic, "from a virtual laboratory, not a real rig"},
          std::pair{Origin::modelled, "computed here"}}) {
      html_ += fmt::format("<li class=\"o-{}\"><b>{}</b>: {}</li>", word_of(origin),
                           name_of(origin), what);
    }
    html_ += "</ul>\n</section>\n";
    for (const auto& section : sections_) {
      if (has_details(section)) details(section);
    }
  }

  /// Everything of a test that the short report has no room for: recordings, FRFs, modes, model.
  void details(const Section& section) {
    if (!has_short(section)) html_ += fmt::format("<div id=\"{}\"></div>\n", escaped(section.id));
    html_ += fmt::format(
        "<section class=\"details\" aria-labelledby=\"{0}-details\"><h2 "
        "id=\"{0}-details\">{1}</h2>\n",
        escaped(section.id), escaped(section.title));
    for (const auto* part : section.parts) {
      const bool several = section.parts.size() > 1;
      if (several) {
        const bool own = part->id == section.id;
        html_ += fmt::format("<h3 id=\"{}{}\">{}</h3>\n", escaped(part->id), own ? "-model" : "",
                             escaped(own                                 ? "Model against test"
                                     : part->id.ends_with("-recordings") ? "Recordings"
                                                                         : part->title));
      }
      blocks_.heading(several ? 4 : 3);
      for (const auto& warning : part->warnings) {
        if (!warning.refused) continue;
        blocks_.add(Paragraph{fmt::format("Refused. {}: {}", warning.where, warning.message),
                              Paragraph::Kind::warning});
      }
      for (const auto& block : part->blocks) {
        if (!is_short(block)) blocks_.add(block);
      }
      html_ += blocks_.taken();
    }
    html_ += "</section>\n";
  }

  void provenance() {
    html_ += "<section aria-labelledby=\"provenance\"><h2 id=\"provenance\">Provenance</h2>\n";
    html_ += fmt::format("<p>rigfit {}. To repeat: <code>{}</code></p>\n", escaped(RIGFIT_VERSION),
                         escaped(frame_.repeat));
    ReportTable table{"inputs",
                      "Inputs and their SHA-256.",
                      {{"file", {}, false}, {"SHA-256", {}, false}},
                      {},
                      counted(frame_.inputs.size(), "input file") + " and their SHA-256"};
    for (const auto& [path, hash] : frame_.inputs) table.rows.push_back({path, hash});
    blocks_.add(table);
    html_ += blocks_.taken() + "</section>\n";
  }

  std::string finished() {
    html_ += fmt::format(
        "</main>\n<footer><p>Made by rigfit {}. This page needs no network.</p></footer>\n",
        escaped(RIGFIT_VERSION));
    html_ += BlockHtml::script();
    html_ += fmt::format("<script>{}</script>\n</body>\n</html>\n", assets::page_js);
    return std::move(html_);
  }

  const PageFrame& frame_;
  std::span<const ReportPart> parts_;
  std::vector<Section> sections_;
  std::vector<ReportFinding> findings_;
  std::set<std::string> short_;  ///< ids of what stands in the short report
  std::string html_;
  BlockHtml blocks_;
};

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

std::string report_page(const PageFrame& frame, const ReportPart& overview,
                        std::span<const ReportPart> parts) {
  return PageWriter(frame, parts).report(overview);
}

std::string appendix_page(const PageFrame& frame, std::span<const ReportPart> parts) {
  return PageWriter(frame, parts).appendix_alone();
}

}  // namespace rigfit::apps
