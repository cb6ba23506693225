#include "apps/report/page/report_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "apps/cli/assets.h"
#include "apps/report/drawing/html_text.h"
#include "apps/report/page/block_html.h"
#include "apps/report/page/first_page.h"
#include "apps/report/page/parameter_words.h"

namespace rigfit::apps {
namespace {

/// Pages of the short report behind the first one, and what things take of one on paper.
constexpr double kShortPages = 6.2, kFigurePages = 0.27, kTextPages = 0.075, kRowPages = 0.021;
constexpr std::size_t kLongestShortTable = 16;  // rows

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
  for (auto& section : sections) {
    constexpr std::string_view kSuffix = ": recordings";
    if (section.title.ends_with(kSuffix)) {
      section.title.resize(section.title.size() - kSuffix.size());
    }
  }
  return sections;
}

std::string id_of(const Block& block) {
  return std::visit(
      [](const auto& one) -> std::string {
        if constexpr (requires { one.id; }) {
          return one.id;
        } else {
          return {};
        }
      },
      block);
}

double pages_of(const Block& block) {
  if (const auto* table = std::get_if<ReportTable>(&block)) {
    return kRowPages * static_cast<double>(table->rows.size() + 4);
  }
  return kFigurePages;
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
    html_ += "<main>\n" + first_page(frame_, overview, parts_, findings_, blocks_);
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

  /// What the short report has room for: its own ids of figures and tables.
  void choose_short() {
    double room = kShortPages;
    for (const auto& section : sections_) {
      room -= kTextPages;
      for (const auto* part : section.parts) {
        for (const auto& block : part->blocks) {
          const std::string id = id_of(block);
          if (std::find(part->brief.begin(), part->brief.end(), id) == part->brief.end()) continue;
          const auto* table = std::get_if<ReportTable>(&block);
          if (table && table->rows.size() > kLongestShortTable) continue;
          if (pages_of(block) > room) continue;
          room -= pages_of(block);
          short_.insert(id);
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

  /// What is on paper at the foot of each page.
  [[nodiscard]] std::string footer_style() const {
    std::string line = frame_.title;
    for (const auto& more : {frame_.details.client, frame_.details.revision}) {
      if (!more.empty()) line += " · " + more;
    }
    std::string quoted;
    for (const char c : line) {
      if (c == '"' || c == '\\') quoted += '\\';
      if (c == '<' || c == '\n') {
        quoted += ' ';
      } else {
        quoted += c;
      }
    }
    return fmt::format(
        "<style>@page {{ @bottom-left {{ content: \"{}\"; font: 8pt sans-serif; color: #555; }} "
        "@bottom-right {{ content: counter(page) \" / \" counter(pages); font: 8pt sans-serif; "
        "color: #555; }} }}</style>\n",
        quoted);
  }

  void head(const std::string& title) {
    html_ =
        "<!DOCTYPE html>\n<html lang=\"en\" class=\"no-script\">\n<head>\n<meta "
        "charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta name=\"color-scheme\" content=\"light dark\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
        "'unsafe-inline'; style-src 'unsafe-inline'; img-src data:\">\n"
        "<link rel=\"icon\" href=\"data:,\">\n";
    html_ += fmt::format("<title>{}</title>\n", escaped(title));
    html_ += BlockHtml::styles();
    html_ += fmt::format("<style>{}</style>\n", assets::page_css) + footer_style();
    html_ += "</head>\n<body>\n<a class=\"skip\" href=\"#main\">To the content</a>\n";
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
        "<nav class=\"side\" aria-label=\"Contents and search\">\n<div class=\"bar\"><a "
        "href=\"#main\">{}</a><button type=\"button\" class=\"menu\" aria-expanded=\"false\" "
        "aria-controls=\"side-list\">Menu</button></div>\n<div id=\"side-list\"><label "
        "class=\"search\">Search <input type=\"search\" id=\"search\" autocomplete=\"off\"></label>"
        "<ul id=\"found\" aria-label=\"Found\" aria-live=\"polite\"></ul>\n{}</div>\n</nav>\n<div "
        "id=\"main\"></div>\n",
        escaped(frame_.title), contents(report, appendix));
  }

  /// One figure in the short report with no figure and no narrow table at its side.
  [[nodiscard]] bool lone_figure(const Section& section) const {
    constexpr std::size_t kNarrow = 4;  // columns, as in page.css
    std::size_t figures = 0, narrow = 0;
    for (const auto* part : section.parts) {
      for (const auto& block : part->blocks) {
        if (!is_short(block)) continue;
        const auto* table = std::get_if<ReportTable>(&block);
        figures += table == nullptr ? 1 : 0;
        narrow += table != nullptr && table->columns.size() <= kNarrow ? 1 : 0;
      }
    }
    return figures == 1 && narrow == 0;
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
    html_ += lone_figure(section) ? "<div class=\"pair lone\">\n" : "<div class=\"pair\">\n";
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
    const auto note = std::find_if(findings_.begin(), findings_.end(),
                                   [](const ReportFinding& one) { return one.note; });
    const auto warnings = static_cast<std::size_t>(note - findings_.begin());
    const std::span<const ReportFinding> all(findings_);
    html_ +=
        "<section class=\"brief\" aria-labelledby=\"more-warnings\"><h2 "
        "id=\"more-warnings\">Warnings</h2>\n";
    html_ += warnings == 0 ? "<p>No warning that would change these results.</p>\n"
                           : "<ul class=\"lines distrust\">\n" +
                                 findings_html(all.first(warnings)) + "</ul>\n";
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
    html_ += fmt::format("<p>rigfit {}. To repeat: <code>{}</code></p>\n", escaped(frame_.version),
                         escaped(frame_.repeat));
    constexpr std::size_t kMost = 400;
    html_ += fmt::format(
        "<details class=\"fold\"><summary>{} input files and their SHA-256</summary>\n<div "
        "class=\"table\"><table class=\"hashes\"><caption>Inputs and their SHA-256{}.</caption>"
        "<thead><tr><th scope=\"col\">file</th><th "
        "scope=\"col\">SHA-256</th></tr></thead><tbody>\n",
        frame_.inputs.size(),
        frame_.inputs.size() > kMost ? fmt::format(", the first {}; report.json has all", kMost)
                                     : std::string());
    for (std::size_t i = 0; i < std::min(frame_.inputs.size(), kMost); ++i) {
      const auto& [path, hash] = frame_.inputs[i];
      html_ += fmt::format("<tr><td>{}</td><td><code>{}</code></td></tr>\n", escaped(path),
                           escaped(hash));
    }
    html_ += "</tbody></table></div></details>\n";
    html_ += "</section>\n";
  }

  std::string finished() {
    html_ += fmt::format(
        "</main>\n<footer><p>Made by rigfit {}. This page needs no network.</p></footer>\n",
        escaped(frame_.version));
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

std::string report_page(const PageFrame& frame, const ReportPart& overview,
                        std::span<const ReportPart> parts) {
  return PageWriter(frame, parts).report(overview);
}

std::string appendix_page(const PageFrame& frame, std::span<const ReportPart> parts) {
  return PageWriter(frame, parts).appendix_alone();
}

}  // namespace rigfit::apps
