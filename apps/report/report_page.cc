#include "apps/report/report_page.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "apps/report/assets.h"
#include "apps/report/html_text.h"
#include "apps/report/svg_plot.h"

namespace rigfit::apps {
namespace {

constexpr std::size_t kLongestTable = 400;  // rows of a plot's table on the page; the CSV has all

/// JSON inside a script element: no text in it may end that element.
std::string embedded(const Json& json) {
  std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3) {
    text.replace(at, 2, "<\\/");
  }
  for (std::size_t at = 0; (at = text.find("<!--", at)) != std::string::npos; at += 6) {
    text.replace(at, 1, "\\u003c");
  }
  return text;
}

/// A number with the digits a plot can show; null when not finite.
Json plotted(double value) {
  if (!std::isfinite(value)) return nullptr;
  if (value == 0) return 0;
  const double unit = std::pow(10, 6 - std::ceil(std::log10(std::abs(value))));
  if (!std::isfinite(unit) || unit == 0) return value;
  return std::round(value * unit) / unit;
}

Json plotted(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(plotted(value));
  return list;
}

Json plot_data(const Plot& plot) {
  Json series_list = Json::array();
  for (const auto& series : plot.series) {
    Json s;
    s["name"] = series.name;
    s["group"] = series.group;
    s["origin"] = word_of(series.origin);
    s["variant"] = series.variant;
    s["line"] = series.style != PlotSeries::Style::points;
    s["dashed"] = series.style == PlotSeries::Style::dashed;
    s["points"] = series.style == PlotSeries::Style::points ||
                  series.style == PlotSeries::Style::line_and_points;
    s["x"] = plotted(series.x);
    s["y"] = plotted(series.y);
    if (!series.low.empty()) {
      s["low"] = plotted(series.low);
      s["high"] = plotted(series.high);
    }
    series_list.push_back(std::move(s));
  }
  return {{"title", plot.title}, {"x_label", plot.x_label}, {"y_label", plot.y_label},
          {"log_x", plot.log_x}, {"log_y", plot.log_y},     {"series", std::move(series_list)}};
}

class Writer {
 public:
  std::string page(const PageFrame& frame, const std::vector<ReportPart>& parts) {
    head(frame);
    summary(frame, parts);
    for (const auto& part : parts) section(part);
    provenance(frame);
    html_ += "</main>\n";
    html_ += fmt::format(
        "<footer><p>Made by rigfit {}. Plots: dygraphs (MIT licence). This page needs no "
        "network.</p>"
        "</footer>\n",
        escaped(frame.version));
    html_ += "<script type=\"application/json\" id=\"plots\">" + embedded(plots_) + "</script>\n";
    for (const auto script : {assets::dygraph_js, assets::plots_js, assets::shapes_js}) {
      html_ += "<script>";
      // A source map is a separate file that no reader of a report has.
      const auto map = script.find("//# sourceMappingURL");
      html_ += script.substr(0, map);
      html_ += "</script>\n";
    }
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
    html_ += fmt::format("<title>{}</title>\n<style>", escaped(frame.title));
    const auto map = assets::dygraph_css.find("/*# sourceMappingURL");
    html_ += assets::dygraph_css.substr(0, map);
    html_ += assets::report_css;
    html_ += "</style>\n</head>\n<body>\n<a class=\"skip\" href=\"#summary\">To the summary</a>\n";
    html_ += fmt::format("<header>\n<h1>{}</h1>\n", escaped(frame.title));
    if (!frame.source.empty()) {
      html_ += fmt::format("<p class=\"source\">Source: {}</p>\n", escaped(frame.source));
    }
    if (!frame.description.empty()) html_ += fmt::format("<p>{}</p>\n", escaped(frame.description));
    html_ += "</header>\n<main>\n";
  }

  void summary(const PageFrame& frame, const std::vector<ReportPart>& parts) {
    html_ +=
        "<nav aria-label=\"Parts of this report\"><ul><li><a href=\"#summary\">Summary</a></li>";
    for (const auto& part : parts) {
      html_ +=
          fmt::format("<li><a href=\"#{}\">{}</a></li>", escaped(part.id), escaped(part.title));
    }
    html_ += "<li><a href=\"#provenance\">Provenance</a></li></ul></nav>\n";
    html_ += "<section aria-labelledby=\"summary\"><h2 id=\"summary\">Summary</h2>\n";
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
    cards(parts, SummaryItem::Kind::result, "cards");
    const auto count = cards_count(parts, SummaryItem::Kind::distrust);
    if (count > 0) {
      html_ += "<h3>What to distrust</h3>\n";
      cards(parts, SummaryItem::Kind::distrust, "cards distrust");
    }
    for (const auto& warning : frame.warnings) {
      if (!warning.refused) continue;
      html_ += fmt::format("<p class=\"warning\"><b>Refused.</b> {}: {}</p>\n",
                           escaped(warning.where), escaped(warning.message));
    }
    html_ += "</section>\n";
  }

  static int cards_count(const std::vector<ReportPart>& parts, SummaryItem::Kind kind) {
    int count = 0;
    for (const auto& part : parts) {
      for (const auto& item : part.summary) count += item.kind == kind;
    }
    return count;
  }

  void cards(const std::vector<ReportPart>& parts, SummaryItem::Kind kind, const char* css) {
    html_ += fmt::format("<ul class=\"{}\">\n", css);
    for (const auto& part : parts) {
      for (const auto& item : part.summary) {
        if (item.kind != kind) continue;
        html_ += fmt::format(
            "<li{}><b><a href=\"#{}\">{}</a></b><span>{}</span>{}</li>\n",
            item.origin ? fmt::format(" class=\"o-{}\"", word_of(*item.origin)) : "",
            escaped(item.anchor), escaped(item.label), escaped(item.text),
            item.origin ? fmt::format(" <span class=\"origin\">({})</span>", name_of(*item.origin))
                        : "");
      }
    }
    html_ += "</ul>\n";
  }

  void section(const ReportPart& part) {
    html_ += fmt::format("<section aria-labelledby=\"{0}\"><h2 id=\"{0}\">{1}</h2>\n",
                         escaped(part.id), escaped(part.title));
    for (const auto& block : part.blocks) {
      std::visit([this](const auto& b) { add(b); }, block);
    }
    html_ += "</section>\n";
  }

  void add(const Paragraph& paragraph) {
    const char* css = paragraph.kind == Paragraph::Kind::warning ? " class=\"warning\""
                      : paragraph.kind == Paragraph::Kind::note  ? " class=\"note\""
                                                                 : "";
    html_ += fmt::format("<p{}>{}</p>\n", css, escaped(paragraph.text));
  }

  void add(const ReportTable& table) {
    html_ += fmt::format("<div class=\"table\"><table id=\"{}\"><caption>{}</caption>\n<thead><tr>",
                         escaped(table.id), escaped(table.caption));
    for (const auto& column : table.columns) {
      html_ +=
          fmt::format("<th scope=\"col\"{}>{}</th>", column.numeric ? " class=\"n\"" : "",
                      column.origin ? fmt::format("<span class=\"o-{}\" title=\"{}\">{}</span>",
                                                  word_of(*column.origin), name_of(*column.origin),
                                                  escaped(column.name))
                                    : escaped(column.name));
    }
    html_ += "</tr></thead>\n<tbody>\n";
    for (const auto& row : table.rows) {
      const bool starts = !row.empty() && !row[0].text.empty() && table.rows.size() > 6;
      html_ += starts ? "<tr class=\"state\">" : "<tr>";
      for (std::size_t i = 0; i < row.size(); ++i) {
        std::string css;
        if (i < table.columns.size() && table.columns[i].numeric) css += "n";
        if (row[i].origin) css += fmt::format(" o-{}", word_of(*row[i].origin));
        if (row[i].doubtful) css += " doubt";
        html_ += fmt::format("<td{}>{}</td>", css.empty() ? "" : " class=\"" + css + "\"",
                             escaped(row[i].text));
      }
      html_ += "</tr>\n";
    }
    html_ += "</tbody></table></div>\n";
  }

  void add(const Plot& plot) {
    plots_[plot.id] = plot_data(plot);
    SvgOptions options;
    options.standalone = false;
    html_ += fmt::format(
        "<figure id=\"{0}\"><h3>{1}</h3>\n<div class=\"plot-tools\" role=\"group\" "
        "aria-label=\"Series shown and view\"></div>\n<div class=\"plot\" "
        "data-plot=\"{0}\"></div>\n"
        "<div class=\"readout\" aria-live=\"polite\"></div>\n<div class=\"static\">{2}</div>\n"
        "<figcaption>{3} <a href=\"figures/{0}.svg\">SVG</a>, <a href=\"data/{0}.csv\">CSV</a>"
        "</figcaption>\n",
        escaped(plot.id), escaped(plot.title), svg_plot(plot, options), escaped(plot.caption));
    html_ +=
        "<details><summary>Values as a table</summary><div class=\"table\"><table><thead><tr><th "
        "scope=\"col\">series</th><th scope=\"col\">origin</th>";
    html_ +=
        fmt::format("<th scope=\"col\" class=\"n\">{}</th><th scope=\"col\" class=\"n\">{}</th>",
                    escaped(plot.x_label), escaped(plot.y_label));
    html_ += "<th scope=\"col\" class=\"n\">95 % interval</th></tr></thead><tbody>\n";
    std::size_t rows = 0, all = 0;
    for (const auto& series : plot.series) all += series.x.size();
    const std::size_t every = 1 + all / kLongestTable;
    for (const auto& series : plot.series) {
      for (std::size_t i = 0; i < series.x.size(); i += every, ++rows) {
        const bool interval = i < series.low.size() && std::isfinite(series.low[i]);
        html_ += fmt::format(
            "<tr><td>{}</td><td class=\"o-{}\">{}</td><td class=\"n\">{}</td><td "
            "class=\"n\">{}</td><td "
            "class=\"n\">{}</td></tr>\n",
            escaped(series.name), word_of(series.origin), name_of(series.origin),
            shown(series.x[i], 5), shown(series.y[i], 5),
            interval ? shown(series.low[i], 4) + " to " + shown(series.high[i], 4) : "");
      }
    }
    html_ += "</tbody></table></div>";
    if (every > 1) {
      html_ += fmt::format("<p class=\"small\">Every {}th of {} values; the CSV has all.</p>",
                           every, all);
    }
    html_ += "</details></figure>\n";
  }

  void add(const ShapeViewer& viewer) {
    html_ += fmt::format(
        "<figure id=\"{0}\" class=\"shapes\" data-shapes=\"{0}-data\"><h3>Mode shapes</h3>\n"
        "<div class=\"plot-tools\"><label>State <select "
        "class=\"state\"></select></label><label>Mode "
        "<select class=\"mode\"></select></label><button type=\"button\" "
        "class=\"play\">Move</button>"
        "<span class=\"key\"><span class=\"mark\" style=\"color:var(--cable)\">cable</span><span "
        "class=\"mark\" style=\"color:var(--beam)\">beam</span><span class=\"mark\" "
        "style=\"color:var(--hybrid)\">hybrid</span></span></div>\n"
        "<div class=\"shapes-stage\"><canvas tabindex=\"0\" role=\"img\" aria-label=\"Moving mode "
        "shape; "
        "arrow keys turn it\"></canvas></div>\n<figcaption>{1}</figcaption>\n<script "
        "type=\"application/json\" id=\"{0}-data\">{2}</script></figure>\n",
        escaped(viewer.id), escaped(viewer.caption), embedded(viewer.states));
  }

  void provenance(const PageFrame& frame) {
    html_ += "<section aria-labelledby=\"provenance\"><h2 id=\"provenance\">Provenance</h2>\n";
    html_ += fmt::format("<p>rigfit {}. To repeat: <code>{}</code></p>\n", escaped(frame.version),
                         escaped(frame.repeat));
    html_ +=
        "<div class=\"table\"><table><caption>Inputs and their SHA-256.</caption><thead><tr><th "
        "scope=\"col\">file</th><th scope=\"col\">SHA-256</th></tr></thead><tbody>\n";
    for (const auto& [path, hash] : frame.inputs) {
      html_ += fmt::format("<tr><td>{}</td><td class=\"hash\"><code>{}</code></td></tr>\n",
                           escaped(path), escaped(hash));
    }
    html_ += "</tbody></table></div>\n";
    if (!frame.warnings.empty()) {
      html_ += "<h3>All warnings</h3><ul>\n";
      for (const auto& warning : frame.warnings) {
        html_ += fmt::format("<li><code>{}</code> {}: {}</li>\n", escaped(warning.code),
                             escaped(warning.where), escaped(warning.message));
      }
      html_ += "</ul>\n";
    }
    html_ += "</section>\n";
  }

  std::string html_;
  Json plots_ = Json::object();
};

}  // namespace

std::string report_page(const PageFrame& frame, const std::vector<ReportPart>& parts) {
  return Writer().page(frame, parts);
}

}  // namespace rigfit::apps
