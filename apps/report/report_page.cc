#include "apps/report/report_page.h"

#include <fmt/format.h>

#include "apps/report/block_html.h"
#include "apps/report/html_text.h"

namespace rigfit::apps {
namespace {

class PageWriter {
 public:
  std::string page(const PageFrame& frame, const std::vector<ReportPart>& parts) {
    head(frame);
    summary(parts);
    for (const auto& part : parts) section(part);
    provenance(frame);
    html_ += "</main>\n";
    html_ += fmt::format(
        "<footer><p>Made by rigfit {}. Plots: dygraphs (MIT licence). This page needs no "
        "network.</p>"
        "</footer>\n",
        escaped(frame.version));
    html_ += blocks_.scripts();
    return html_ + "</body>\n</html>\n";
  }

 private:
  void head(const PageFrame& frame) {
    html_ =
        "<!DOCTYPE html>\n<html lang=\"en\" class=\"no-script\">\n<head>\n<meta "
        "charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta name=\"color-scheme\" content=\"light dark\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
        "'unsafe-inline'; style-src 'unsafe-inline'; img-src data:\">\n"
        "<link rel=\"icon\" href=\"data:,\">\n";
    html_ += fmt::format("<title>{}</title>\n", escaped(frame.title));
    html_ += BlockHtml::styles();
    html_ += "</head>\n<body>\n<a class=\"skip\" href=\"#summary\">To the summary</a>\n";
    html_ += fmt::format("<header>\n<h1>{}</h1>\n", escaped(frame.title));
    if (!frame.source.empty()) {
      html_ += fmt::format("<p class=\"source\">Source: {}</p>\n", escaped(frame.source));
    }
    if (!frame.description.empty()) html_ += fmt::format("<p>{}</p>\n", escaped(frame.description));
    html_ += "</header>\n<main>\n";
  }

  void summary(const std::vector<ReportPart>& parts) {
    html_ += "<section aria-labelledby=\"summary\"><h2 id=\"summary\">Summary</h2>\n";
    html_ += "<div class=\"overview\">\n";
    lines(parts, SummaryItem::Kind::result, "Found", "lines");
    lines(parts, SummaryItem::Kind::error, "Model against test", "lines");
    html_ += "<div>\n";
    lines(parts, SummaryItem::Kind::distrust, "Warnings", "lines distrust");
    lines(parts, SummaryItem::Kind::recorded, "Recorded", "lines");
    html_ += "</div>\n</div>\n";
    html_ +=
        "<p class=\"small\">Where a value comes from, in colour and in words, everywhere here:</p>"
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
    html_ += "</ul>\n";
    html_ += "</section>\n";
    html_ +=
        "<nav aria-label=\"Parts of this report\"><ul><li><a href=\"#summary\">Summary</a></li>";
    for (const auto& part : parts) {
      html_ +=
          fmt::format("<li><a href=\"#{}\">{}</a></li>", escaped(part.id), escaped(part.title));
    }
    html_ += "<li><a href=\"#provenance\">Provenance</a></li></ul></nav>\n";
  }

  /// The summary's items of one kind, a line each.
  void lines(const std::vector<ReportPart>& parts, SummaryItem::Kind kind, const char* title,
             const char* css) {
    std::string items;
    for (const auto& part : parts) {
      for (const auto& item : part.summary) {
        if (item.kind != kind) continue;
        items += fmt::format(
            "<li{}><a href=\"#{}\">{}</a>: <span class=\"text\">{}</span>{}</li>\n",
            item.origin ? fmt::format(" class=\"o-{}\"", word_of(*item.origin)) : "",
            escaped(item.anchor), escaped(item.label), escaped(item.text),
            item.origin ? fmt::format(" <span class=\"origin\">({})</span>", name_of(*item.origin))
                        : "");
      }
    }
    if (items.empty()) return;
    html_ += fmt::format("<div><h3>{}</h3>\n<ul class=\"{}\">\n{}</ul></div>\n", title, css, items);
  }

  void section(const ReportPart& part) {
    html_ += fmt::format("<section aria-labelledby=\"{0}\"><h2 id=\"{0}\">{1}</h2>\n",
                         escaped(part.id), escaped(part.title));
    std::size_t others = 0;
    for (const auto& warning : part.warnings) {
      if (!warning.refused)
        ++others;
      else
        blocks_.add(Paragraph{fmt::format("Refused. {}: {}", warning.where, warning.message),
                              Paragraph::Kind::warning});
    }
    for (const auto& block : part.blocks) blocks_.add(block);
    html_ += blocks_.taken();
    if (others > 0) {
      html_ += fmt::format("<details class=\"fold\"><summary>{}</summary>\n<ul class=\"small\">\n",
                           others == 1 ? std::string("1 warning that concerns this part")
                                       : fmt::format("{} warnings that concern this part", others));
      for (const auto& warning : part.warnings) {
        if (warning.refused) continue;
        html_ += fmt::format("<li>{}: {}</li>\n", escaped(warning.where), escaped(warning.message));
      }
      html_ += "</ul></details>\n";
    }
    html_ += "</section>\n";
  }

  void provenance(const PageFrame& frame) {
    html_ += "<section aria-labelledby=\"provenance\"><h2 id=\"provenance\">Provenance</h2>\n";
    html_ += fmt::format("<p>rigfit {}. To repeat: <code>{}</code></p>\n", escaped(frame.version),
                         escaped(frame.repeat));
    html_ += fmt::format(
        "<details class=\"fold\"><summary>{} input files and their SHA-256</summary>\n<div "
        "class=\"table\"><table class=\"hashes\"><caption>Inputs and their "
        "SHA-256.</caption><thead><tr><th scope=\"col\">file</th><th "
        "scope=\"col\">SHA-256</th></tr></thead><tbody>\n",
        frame.inputs.size());
    for (const auto& [path, hash] : frame.inputs) {
      html_ += fmt::format("<tr><td>{}</td><td><code>{}</code></td></tr>\n", escaped(path),
                           escaped(hash));
    }
    html_ += "</tbody></table></div></details>\n";
    if (!frame.warnings.empty()) {
      html_ += fmt::format(
          "<details class=\"fold\"><summary>All {} warnings, with their codes</summary>\n<ul "
          "class=\"small\">\n",
          frame.warnings.size());
      for (const auto& warning : frame.warnings) {
        html_ += fmt::format("<li><code>{}</code> {}: {}</li>\n", escaped(warning.code),
                             escaped(warning.where), escaped(warning.message));
      }
      html_ += "</ul></details>\n";
    }
    html_ += "</section>\n";
  }

  std::string html_;
  BlockHtml blocks_;
};

}  // namespace

std::string report_page(const PageFrame& frame, const std::vector<ReportPart>& parts) {
  return PageWriter().page(frame, parts);
}

}  // namespace rigfit::apps
