#include "apps/report/page/report_page.h"

#include <fmt/chrono.h>

#include <ctime>
#include <set>

#include "apps/cli/assets.h"
#include "apps/cli/warning_lines.h"
#include "apps/describe/sheet.h"
#include "apps/report/drawing/html_text.h"
#include "apps/report/page/answer.h"
#include "apps/report/page/block_html.h"

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
    auto at = std::ranges::find(sections, id, &Section::id);
    if (at == sections.end()) at = sections.insert(at, {id, part.title, {}});
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

constexpr std::size_t kMostAnswers = 14, kMostWarnings = 5;

void heading(std::string& html, const PageFrame& frame) {
  const auto& details = frame.details;
  html += "<header>\n";
  html += fmt::format("<h1>{}</h1>\n<dl class=\"details\">", escaped(frame.title));
  for (const auto& [name, value] :
       {std::pair{"Client", details.client}, std::pair{"Project", details.project},
        std::pair{"Author", details.author}, std::pair{"Organisation", details.organisation},
        std::pair{"Date", details.date.empty()
                              ? fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)))
                              : details.date},
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

class PageWriter {
 public:
  PageWriter(const PageFrame& frame, std::span<const ReportPart> parts)
      : frame_(frame), parts_(parts), sections_(sections_of(parts)), findings_(findings_of(parts)) {
    choose_short();
    const auto count = std::ranges::count(findings_, false, &FindingKind::note);  // they are first
    warnings_ = std::span(findings_).first(static_cast<std::size_t>(count));
    notes_ = std::span(findings_).subspan(warnings_.size());
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
  /// Where a part is: on this page, or in a client's appendix.
  [[nodiscard]] std::string link_to(const std::string& id) const {
    const auto section = std::ranges::find(sections_, id, &Section::id);
    const bool here =
        frame_.style == ReportStyle::lab || (section != sections_.end() && has_short(*section));
    return (here ? "#" : "appendix.html#") + id;
  }

  [[nodiscard]] std::string findings_html(std::span<const FindingKind> findings) const {
    std::string html;
    for (const auto& one : findings) {
      const bool refused = one.first.refused;
      html +=
          fmt::format("<li><a href=\"{}\">{}</a>{}: {}{}</li>\n", escaped(link_to(one.anchor)),
                      escaped(one.title), refused ? ", refused" : "", escaped(one.first.message),
                      one.count > 1 || refused ? escaped(" (" + one.listed() + ")") : "");
    }
    return html;
  }

  /// The recommended answers: those of the first page, others where there is room.
  [[nodiscard]] ReportTable answers_table() const {
    ReportTable table{"answers",
                      "Results, ± standard uncertainty; verdicts are about 95 % intervals.",
                      {{"quantity", {}, false},
                       {"value"},
                       {"unit", {}, false},
                       {"how known", {}, false},
                       {"verdict", {}, false}}};
    for (int rank = 0; rank < 2; ++rank) {
      auto rows = table.rows;
      for (const auto& part : parts_) {
        for (const auto& answer : part.answers) {
          if (answer.rank != rank || !answer.recommended) continue;
          Cell quantity(quantity_words(answer)), verdict(verdict_words(answer));
          quantity.link = link_to(answer.anchor);
          verdict.doubtful = doubtful(answer);
          const char* synthetic = answer.origin == Origin::synthetic ? " (synthetic)" : "";
          rows.push_back({std::move(quantity), value_words(answer),
                          std::string(describe::shown_unit(answer.unit).name),
                          Cell(answer.how + synthetic, answer.origin), std::move(verdict)});
        }
      }
      if (rank == 0 || rows.size() <= kMostAnswers) table.rows = std::move(rows);
    }
    table.rows.resize(std::min(table.rows.size(), kMostAnswers));
    return table;
  }

  /// One page on paper.
  void first_page(const ReportPart& overview) {
    html_ += "<section class=\"first-page\" aria-labelledby=\"summary\">\n";
    heading(html_, frame_);
    html_ += "<h2 id=\"summary\" class=\"hidden\">Summary</h2>\n<div class=\"overview\">\n";
    blocks_.heading(3);
    for (const auto& block : overview.blocks) blocks_.add(block);
    html_ += blocks_.taken() + "</div>\n<h3 id=\"results\">Results</h3>\n";
    const ReportTable answers = answers_table();
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
    html_ += warnings_html(kMostWarnings);
    if (warnings_.size() > kMostWarnings) {
      html_ += fmt::format("<p class=\"small\"><a href=\"#more-warnings\">{} more</a></p>\n",
                           warnings_.size() - kMostWarnings);
    }
    html_ += "</section>\n";
  }

  /// The first `most` of the warnings as a list.
  [[nodiscard]] std::string warnings_html(std::size_t most) const {
    if (warnings_.empty()) return "<p>No warning that would change these results.</p>\n";
    return "<ul class=\"lines distrust\">\n" +
           findings_html(warnings_.first(std::min(warnings_.size(), most))) + "</ul>\n";
  }

  /// What the short report has room for: its own ids of figures and tables.
  void choose_short() {
    for (const auto& section : sections_) {
      for (const auto* part : section.parts) {
        for (const auto& block : part->blocks) {
          const std::string id = id_of(block);
          if (std::ranges::find(part->brief, id) == part->brief.end()) continue;
          const auto* table = std::get_if<ReportTable>(&block);
          if (table && table->rows.size() > kLongestShortTable) continue;
          if (short_.size() < kMostShort) short_.insert(id);
        }
      }
    }
  }

  [[nodiscard]] bool is_short(const Block& block) const { return short_.contains(id_of(block)); }

  static bool has_short(const Section& section) {
    return std::ranges::any_of(section.parts, [](const ReportPart* part) {
      return !part->brief.empty() || !part->summary.empty();
    });
  }

  /// Something of it is left for the appendix, or it has no other place.
  [[nodiscard]] bool has_details(const Section& section) const {
    return !has_short(section) || std::ranges::any_of(section.parts, [&](const ReportPart* part) {
      return !std::ranges::all_of(part->blocks, [&](const auto& one) { return is_short(one); });
    });
  }

  void head(const std::string& title) {
    html_ = BlockHtml::head(title, fmt::format("<style>{}</style>\n", assets::page_css));
    html_ += "<body>\n<a class=\"skip\" href=\"#main\">To the content</a>\n";
  }

  /// The lists of a contents: the report's sections, the appendix' sections.
  [[nodiscard]] std::string contents(bool report, bool appendix) const {
    std::string html = "<ol>\n";
    const auto item = [&](const std::string& to, const std::string& title) {
      html += fmt::format("<li><a href=\"{}\">{}</a></li>\n", escaped(to), escaped(title));
    };
    if (report) {
      item("#summary", "Summary");
      for (const auto& section : sections_) {
        if (has_short(section)) item("#" + section.id, section.title);
      }
      item("#more-warnings", "Warnings");
    }
    if (appendix) {
      html += "<li class=\"part\"><a href=\"#appendix\">Appendix</a>\n<ol>\n";
      for (const auto& section : sections_) {
        if (has_details(section)) item("#" + section.id + "-details", section.title);
      }
      html += "</ol></li>\n";
    } else {
      item("appendix.html", "Appendix");
    }
    if (report) item("#provenance", "Provenance");
    for (const auto& [file, title] : frame_.links) item(file, title);
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
      const bool tabled = std::ranges::any_of(part->blocks, [&](const Block& block) {
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
    html_ +=
        "<section class=\"brief\" aria-labelledby=\"more-warnings\"><h2 "
        "id=\"more-warnings\">Warnings</h2>\n" +
        warnings_html(warnings_.size());
    if (!notes_.empty()) {
      html_ += fmt::format(
          "<details class=\"fold\"><summary>{}: normal operation, or allowed for in the values"
          "</summary>\n<ul class=\"small\">\n{}</ul></details>\n",
          counted(notes_.size(), "note"), findings_html(notes_));
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
    if (frame_.style == ReportStyle::lab && !frame_.times.rows.empty()) blocks_.add(frame_.times);
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
  std::vector<FindingKind> findings_;
  std::span<const FindingKind> warnings_, notes_;  ///< its parts
  std::set<std::string> short_;                    ///< ids of what stands in the short report
  std::string html_;
  BlockHtml blocks_;
};

}  // namespace

std::vector<FindingKind> findings_of(std::span<const ReportPart> parts) {
  std::vector<FindingKind> kinds;
  for (const auto& part : parts) {
    for (const auto& warning : part.warnings) {
      if (auto* begun = add(kinds, warning)) begun->title = part.title, begun->anchor = part.id;
    }
  }
  for (auto& one : kinds) one.first.message = with_parameter_words(one.first.message);
  sort_by_level(kinds);
  return kinds;
}

std::string report_page(const PageFrame& frame, const ReportPart& overview,
                        std::span<const ReportPart> parts) {
  return PageWriter(frame, parts).report(overview);
}

std::string appendix_page(const PageFrame& frame, std::span<const ReportPart> parts) {
  return PageWriter(frame, parts).appendix_alone();
}

}  // namespace rigfit::apps
