#include "apps/report/report_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/assets.h"
#include "apps/report/figures/svg_plot.h"
#include "apps/report/html_text.h"

namespace rigfit::apps {
namespace {

constexpr std::size_t kLongestTable = 200;  // rows of a plot's table written into the page; of more
                                            // points the page makes one when it is opened
constexpr std::size_t kDensePlot = 500;     // points of a series that need not have all digits

/// Text inside a script element: nothing in it may end that element.
std::string guarded(std::string text) {
  for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3) {
    text.replace(at, 2, "<\\/");
  }
  for (std::size_t at = 0; (at = text.find("<!--", at)) != std::string::npos; at += 6) {
    text.replace(at, 1, "\\u003c");
  }
  return text;
}

std::string embedded(const Json& json) {
  return guarded(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

/// A number with the digits a plot can show; null when not finite.
void add_number(std::string& text, double value, int digits) {
  if (std::isfinite(value)) {
    fmt::format_to(std::back_inserter(text), "{:.{}g}", value, digits);
  } else {
    text += "null";
  }
}

std::string numbers(const std::vector<double>& values, int digits) {
  std::string text = "[";
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) text += ',';
    add_number(text, values[i], digits);
  }
  return text + "]";
}

/// Evenly spaced abscissae as first value, step and number.
std::string abscissae(const std::vector<double>& x) {
  const std::size_t n = x.size();
  if (n > 20) {
    const double step = (x.back() - x.front()) / static_cast<double>(n - 1);
    bool even = std::isfinite(step) && step != 0;
    for (std::size_t i = 0; even && i < n; ++i) {
      even = std::abs(x.front() + static_cast<double>(i) * step - x[i]) <= 1e-6 * std::abs(step);
    }
    if (even) return fmt::format("{{\"from\":{},\"step\":{},\"n\":{}}}", x.front(), step, n);
  }
  return numbers(x, 7);
}

/// Samples as whole numbers of a step, each less the one before: a record takes a third of the
/// room. Gaps are null. The step is a 20 000th of the range: more than a screen or a hand tells
/// apart.
std::string packed(const std::vector<double>& values) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  if (!(high > low)) return numbers(values, 4);
  const double step = (high - low) / 20000;
  std::string text = fmt::format("{{\"from\":{},\"step\":{},\"d\":[", low, step);
  long before = 0;
  bool first = true;
  for (const double v : values) {
    if (!first) text += ',';
    first = false;
    if (!std::isfinite(v)) {
      text += "null";
      continue;
    }
    const long now = std::lround((v - low) / step);
    fmt::format_to(std::back_inserter(text), "{}", now - before);
    before = now;
  }
  return text + "]}";
}

std::string json_text(const std::string& text) {
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// The plot as JSON. Written by hand: a long record as a tree of numbers takes many times the time.
std::string plot_data(const Plot& plot) {
  std::string text = fmt::format(
      "{{\"title\":{},\"x_label\":{},\"y_label\":{},\"log_x\":{},\"log_y\":{},\"series\":[",
      json_text(plot.title), json_text(plot.x_label), json_text(plot.y_label), plot.log_x,
      plot.log_y);
  for (std::size_t k = 0; k < plot.series.size(); ++k) {
    const auto& series = plot.series[k];
    const bool points = series.style == PlotSeries::Style::points;
    text += fmt::format(
        "{}{{\"name\":{},\"group\":{},\"origin\":\"{}\",\"variant\":{},\"line\":{},"
        "\"dashed\":{},\"points\":{},\"x\":",
        k > 0 ? "," : "", json_text(series.name), json_text(series.group), word_of(series.origin),
        series.variant, !points, series.style == PlotSeries::Style::dashed,
        points || series.style == PlotSeries::Style::line_and_points);
    std::size_t same = 0;
    while (same < k && plot.series[same].x != series.x) ++same;
    text += same < k ? fmt::format("{}", same) : abscissae(series.x);
    const int digits = series.x.size() > kDensePlot ? 4 : 6;
    const bool dense = series.x.size() > kDensePlot && !plot.log_y;
    text += ",\"y\":" + (dense ? packed(series.y) : numbers(series.y, digits));
    if (!series.low.empty()) {
      text += ",\"low\":" + numbers(series.low, digits - 1);
      text += ",\"high\":" + numbers(series.high, digits - 1);
    }
    text += "}";
  }
  return text + "]}";
}

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
    html_ += "<script type=\"application/json\" id=\"plots\">{" + guarded(plots_) + "}</script>\n";
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
        add(Paragraph{fmt::format("Refused. {}: {}", warning.where, warning.message),
                      Paragraph::Kind::warning});
    }
    for (const auto& block : part.blocks) {
      std::visit([this](const auto& b) { add(b); }, block);
    }
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

  void add(const Paragraph& paragraph) {
    const char* css = paragraph.kind == Paragraph::Kind::warning ? " class=\"warning\""
                      : paragraph.kind == Paragraph::Kind::note  ? " class=\"note\""
                                                                 : "";
    html_ += fmt::format("<p{}>{}</p>\n", css, escaped(paragraph.text));
  }

  void add(const ReportTable& table) {
    if (!table.fold.empty()) {
      html_ += fmt::format("<details class=\"fold\"><summary>{}</summary>\n", escaped(table.fold));
    }
    // A short table stays on one page.
    html_ +=
        fmt::format("<div class=\"table\"><table id=\"{}\"{}><caption>{}</caption>\n<thead><tr>",
                    escaped(table.id), table.rows.size() <= 12 ? " class=\"short\"" : "",
                    escaped(table.caption));
    // A column with nothing in it says nothing: remarks where there are none.
    std::vector<bool> shown_column(table.columns.size(), table.rows.empty());
    for (const auto& row : table.rows) {
      for (std::size_t i = 0; i < std::min(row.size(), shown_column.size()); ++i) {
        if (!row[i].text.empty()) shown_column[i] = true;
      }
    }
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      if (!shown_column[i]) continue;
      const auto& column = table.columns[i];
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
        if (i < shown_column.size() && !shown_column[i]) continue;
        std::string css;
        if (i < table.columns.size() && table.columns[i].numeric) css += "n";
        if (row[i].origin) css += fmt::format(" o-{}", word_of(*row[i].origin));
        if (row[i].doubtful) css += " doubt";
        if (row[i].shade) css += " shade";
        html_ += fmt::format(
            "<td{}{}>{}</td>", css.empty() ? "" : " class=\"" + css + "\"",
            row[i].shade ? fmt::format(" style=\"--shade:{:.0f}%\"", 100 * *row[i].shade) : "",
            escaped(row[i].text));
      }
      html_ += "</tr>\n";
    }
    html_ += "</tbody></table></div>\n";
    if (!table.fold.empty()) html_ += "</details>\n";
  }

  void add(const PlotGroup& group) {
    html_ += fmt::format("<div class=\"group\" id=\"{0}\"><h3>{1}</h3>\n", escaped(group.id),
                         escaped(group.title));
    const bool several = group.tabs.size() > 1;
    if (several) {
      html_ += fmt::format("<div class=\"tabs\" role=\"tablist\" aria-label=\"{}: state shown\">",
                           escaped(group.title));
      for (std::size_t i = 0; i < group.tabs.size(); ++i) {
        html_ += fmt::format(
            "<button type=\"button\" role=\"tab\" id=\"{0}-t{1}\" aria-controls=\"{0}-p{1}\" "
            "aria-selected=\"{2}\" tabindex=\"{3}\">{4}</button>",
            escaped(group.id), i, i == 0, i == 0 ? 0 : -1, escaped(group.tabs[i].label));
      }
      html_ += "</div>\n";
    }
    for (std::size_t i = 0; i < group.tabs.size(); ++i) {
      if (several) {
        html_ += fmt::format(
            "<div role=\"tabpanel\" id=\"{0}-p{1}\" aria-labelledby=\"{0}-t{1}\" "
            "class=\"panel{2}\">"
            "<p class=\"panel-title\"><b>{3}</b></p>\n",
            escaped(group.id), i, i == 0 ? "" : " other", escaped(group.tabs[i].label));
      }
      heading_ = 4;
      for (const auto& plot : group.tabs[i].plots) add(plot);
      heading_ = 3;
      if (several) html_ += "</div>\n";
    }
    html_ += "</div>\n";
  }

  void add(const Plot& plot) {
    plots_ += (plots_.empty() ? "" : ",\n") + json_text(plot.id) + ":" + plot_data(plot);
    SvgOptions options;
    options.standalone = false;
    html_ += fmt::format(
        "<figure id=\"{0}\" aria-labelledby=\"{0}-title\"><h{4} id=\"{0}-title\">{1}</h{4}>\n"
        "<div class=\"plot-tools\" role=\"group\" aria-label=\"{1}: series shown and "
        "view\"></div>\n<div class=\"plot\" "
        "data-plot=\"{0}\"></div>\n"
        "<div class=\"readout\" aria-live=\"polite\"></div>\n<div class=\"static\">{2}</div>\n"
        "<figcaption>{3} <span class=\"files\"><a href=\"figures/{0}.svg\">SVG</a>, <a "
        "href=\"data/{0}.csv\">CSV</a></span></figcaption>\n",
        escaped(plot.id), escaped(plot.title), svg_plot(plot, options), escaped(plot.caption),
        heading_);
    values_table(plot);
    html_ += "</figure>\n";
  }

  void values_table(const Plot& plot) {
    std::size_t all = 0;
    for (const auto& series : plot.series) all += series.x.size();
    html_ += fmt::format(
        "<details class=\"values\"{}><summary>Values as a table<span class=\"hidden\">: {}</span>"
        "</summary><div class=\"table\"><table aria-label=\"{}: values\"><thead><tr><th "
        "scope=\"col\">series</th><th "
        "scope=\"col\">origin</th><th scope=\"col\" class=\"n\">{}</th><th scope=\"col\" "
        "class=\"n\">{}</th><th scope=\"col\" class=\"n\">95 % interval</th></tr></thead><tbody>",
        all > kLongestTable ? fmt::format(" data-of=\"{}\"", escaped(plot.id)) : "",
        escaped(plot.title), escaped(plot.title), escaped(plot.x_label), escaped(plot.y_label));
    if (all <= kLongestTable) {
      html_ += "\n";
      for (const auto& series : plot.series) {
        for (std::size_t i = 0; i < series.x.size(); ++i) {
          if (!std::isfinite(series.y[i])) continue;
          const bool interval = i < series.low.size() && std::isfinite(series.low[i]);
          html_ += fmt::format(
              "<tr><td>{}</td><td class=\"o-{}\">{}</td><td class=\"n\">{}</td><td "
              "class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
              escaped(series.name), word_of(series.origin), name_of(series.origin),
              shown(series.x[i], 5), shown(series.y[i], 5),
              interval ? shown(series.low[i], 4) + " to " + shown(series.high[i], 4) : "");
        }
      }
    }
    html_ += "</tbody></table></div></details>\n";
  }

  void add(const ShapeViewer& viewer) {
    html_ += fmt::format(
        "<figure id=\"{0}\" class=\"shapes\" data-shapes=\"{0}-data\" "
        "aria-labelledby=\"{0}-title\">"
        "<h3 id=\"{0}-title\">Mode shapes</h3>\n"
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
  int heading_ = 3;    ///< level of a figure's title
  std::string plots_;  ///< JSON members, by the plot's id
};

}  // namespace

std::string report_page(const PageFrame& frame, const std::vector<ReportPart>& parts) {
  return PageWriter().page(frame, parts);
}

}  // namespace rigfit::apps
