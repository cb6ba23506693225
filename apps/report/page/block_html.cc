#include "apps/report/page/block_html.h"

#include "apps/cli/assets.h"
#include "apps/report/drawing/html_text.h"
#include "apps/report/drawing/plot.h"

namespace rigfit::apps {
namespace {

// px of a figure on the page: in a column of a screen, a phone or half a sheet of paper its letters
// of 12 px are 9 to 15 px high; on paper 6.8 pt.
constexpr double kPageWidth = 440, kPageHeight = 290;
constexpr std::size_t kMostTabs = 60;  // states of a group of figures on the page

/// What a sheet shows of a figure, as large as it is by itself.
Picture picture_of(const Plot& plot) { return {plot.id, plot.title, "", svg_plot(plot), ""}; }
const Picture& picture_of(const Picture& picture) { return picture; }

/// "Figure 3.", "Table 2."
std::string numbered(const char* what, int number) {
  return fmt::format("<span class=\"number\">{}&nbsp;{}.</span>", what, number);
}

}  // namespace

void add_rows(ReportTable& table, std::vector<Cell> front, const describe::Table& rows,
              std::optional<Origin> origin) {
  const bool first = table.columns.size() == front.size();
  for (std::size_t c = 0; c < rows.heads.size() && first; ++c) {
    table.columns.push_back({with_signs(rows.heads[c]), std::nullopt, rows.numeric[c]});
  }
  for (const auto& row : rows.rows) {
    auto& cells = table.rows.emplace_back(front);
    for (std::size_t c = 0; c < row.size(); ++c) {
      Cell& cell = cells.emplace_back(with_signs(row[c]));
      if (rows.numeric[c]) cell.origin = origin;
      cell.doubtful = (rows.heads[c] == "remark" && !row[c].empty() && row[c] != "-") ||
                      row[c].starts_with("rejected: ");
    }
    front.assign(front.size(), Cell());
  }
}

ReportTable described_table(const std::string& id, const std::string& caption,
                            const describe::Table& table, std::optional<Origin> origin) {
  ReportTable shown{id, caption};
  add_rows(shown, {}, table, origin);
  return shown;
}

ReportTable described_table(const std::string& id, const std::string& caption,
                            const std::vector<describe::Sheet::Line>& lines,
                            std::optional<Origin> origin) {
  ReportTable shown{id, caption, {{"quantity", {}, false}, {"value", origin}}};
  for (const auto& line : lines) shown.rows.push_back({line.label, with_signs(line.text)});
  return shown;
}

void BlockHtml::add(const Block& block) {
  std::visit([this](const auto& b) { add(b); }, block);
}

std::string BlockHtml::taken() { return std::exchange(html_, {}); }

std::string BlockHtml::head(const std::string& title, const std::string& more) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\" class=\"no-script\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
      "'unsafe-inline'; style-src 'unsafe-inline'; img-src data:\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>{}</title>\n<style>{}{}</style>\n{}</head>\n",
      escaped(title), assets::report_css, palette_css(), more);
}

std::string BlockHtml::script() { return fmt::format("<script>{}</script>\n", assets::figures_js); }

void BlockHtml::add_figure(const auto& figure, const std::string& content) {
  const std::string links =
      files_ ? fmt::format(
                   " <span class=\"files\"><a href=\"figures/{0}.svg\">SVG</a>, <a "
                   "href=\"data/{0}.csv\">CSV</a></span>",
                   escaped(figure.id))
             : "";
  html_ += fmt::format(
      "<figure id=\"{0}\" aria-labelledby=\"{0}-title\"><h{1} id=\"{0}-title\">{2}</h{1}>\n"
      "{3}\n<figcaption>{5} {4}{6}</figcaption>\n</figure>\n",
      escaped(figure.id), heading_, escaped(figure.title), content, escaped(figure.caption),
      numbered("Figure", ++figures_), links);
}

void BlockHtml::add(const Picture& picture) {
  add_figure(picture, fmt::format("<div class=\"picture\">{}</div>", picture.svg));
}

void BlockHtml::add(const Plot& plot) {
  add_figure(plot, fmt::format("<div class=\"plot\">{}</div><div class=\"readout\" "
                               "aria-live=\"polite\"></div>",
                               svg_plot(plot, {.width = kPageWidth, .height = kPageHeight})));
}

void BlockHtml::add(const Paragraph& paragraph) {
  const char* css = paragraph.kind == Paragraph::Kind::warning ? " class=\"warning\""
                    : paragraph.kind == Paragraph::Kind::note  ? " class=\"note\""
                                                               : "";
  html_ += fmt::format("<p{}>{}</p>\n", css, escaped(paragraph.text));
}

void BlockHtml::add(const ReportTable& table) {
  if (!table.fold.empty()) {
    html_ += fmt::format("<details class=\"fold\"><summary>{}</summary>\n", escaped(table.fold));
  }
  // A column with nothing in it says nothing: remarks where there are none.
  std::vector<bool> shown_column(table.columns.size(), table.rows.empty());
  bool grouped = false;  // what is above is not repeated
  for (const auto& row : table.rows) {
    grouped = grouped || row[0].text.empty();
    for (std::size_t i = 0; i < std::min(row.size(), shown_column.size()); ++i) {
      if (!row[i].text.empty() && row[i].text != "–") shown_column[i] = true;
    }
  }
  constexpr std::ptrdiff_t kNarrow = 4;  // columns; a table of these stands beside a figure
  const auto columns = std::count(shown_column.begin(), shown_column.end(), true);
  html_ += fmt::format(
      "<div class=\"table\"><table id=\"{}\" class=\"{}{}\"><caption>{} {}</caption>\n<thead><tr>",
      escaped(table.id), table.rows.size() <= 12 ? "short" : "",
      columns <= kNarrow ? " narrow" : "", numbered("Table", ++tables_), escaped(table.caption));
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (!shown_column[i]) continue;
    const auto& column = table.columns[i];
    html_ += fmt::format("<th scope=\"col\"{}>{}</th>", column.numeric ? " class=\"n\"" : "",
                         column.origin ? fmt::format("<span class=\"o-{}\" title=\"{}\">{}</span>",
                                                     word_of(*column.origin),
                                                     name_of(*column.origin), escaped(column.name))
                                       : escaped(column.name));
  }
  html_ += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    const bool starts = grouped && !row[0].text.empty();
    html_ += starts ? "<tr class=\"state\">" : "<tr>";
    for (std::size_t i = 0; i < std::min(row.size(), shown_column.size()); ++i) {
      if (!shown_column[i]) continue;
      std::string css = table.columns[i].numeric ? "n" : "";
      const auto origin = row[i].origin ? row[i].origin : table.columns[i].origin;
      if (origin) css += fmt::format(" o-{}", word_of(*origin));
      if (row[i].doubtful) css += " doubt";
      std::string text = escaped(row[i].text);
      if (!row[i].link.empty()) {
        text = fmt::format("<a href=\"{}\">{}</a>", escaped(row[i].link), text);
      }
      html_ += fmt::format("<td{}>{}</td>", css.empty() ? "" : " class=\"" + css + "\"", text);
    }
    html_ += "</tr>\n";
  }
  html_ += "</tbody></table></div>\n";
  if (!table.fold.empty()) html_ += "</details>\n";
}

void BlockHtml::add(const PlotGroup& group) {
  html_ += fmt::format("<div class=\"group\" id=\"{0}\"><h{2}>{1}</h{2}>\n", escaped(group.id),
                       escaped(group.title), heading_);
  const bool several = group.tabs.size() > 1;
  const std::size_t tabs = std::min(group.tabs.size(), kMostTabs);
  if (tabs < group.tabs.size()) {
    html_ += fmt::format(
        "<p class=\"note\">The first {} of {} states; figures/ and data/ have all.</p>\n", tabs,
        group.tabs.size());
  }
  if (several) {
    html_ += fmt::format("<div class=\"tabs\" role=\"tablist\" aria-label=\"{}: state shown\">",
                         escaped(group.title));
    for (std::size_t i = 0; i < tabs; ++i) {
      html_ += fmt::format(
          "<button type=\"button\" role=\"tab\" id=\"{0}-t{1}\" aria-controls=\"{0}-p{1}\" "
          "aria-selected=\"{2}\" tabindex=\"{3}\">{4}</button>",
          escaped(group.id), i, i == 0, i == 0 ? 0 : -1, escaped(group.tabs[i].label));
    }
    html_ += "</div>\n";
  }
  for (std::size_t i = 0; i < tabs; ++i) {
    if (several) {
      html_ += fmt::format(
          "<div role=\"tabpanel\" id=\"{0}-p{1}\" aria-labelledby=\"{0}-t{1}\" "
          "class=\"panel{2}\">"
          "<p class=\"panel-title\"><b>{3}</b></p>\n",
          escaped(group.id), i, i == 0 ? "" : " other", escaped(group.tabs[i].label));
    }
    ++heading_;
    for (const auto& plot : group.tabs[i].plots) add(plot);
    --heading_;
    if (several) html_ += "</div>\n";
  }
  html_ += "</div>\n";
}

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
  constexpr double kTitle = 30, kGap = 14;
  FiguresSvg sheet;
  std::string figures;
  each_figure(blocks, [&](const auto& figure, const std::string& label) {
    const Picture& one = picture_of(figure);
    figures += fmt::format(
        "<text x=\"12\" y=\"{:g}\" font-size=\"14\" font-weight=\"bold\" "
        "fill=\"#222\">{}{}{}</text>\n"
        "<g transform=\"translate(0 {:g})\">\n{}</g>\n",
        sheet.height + 20, escaped(label), label.empty() ? "" : ": ", escaped(one.title),
        sheet.height + kTitle, one.svg);
    sheet.width = std::max(sheet.width, one.width);
    sheet.height += kTitle + one.height + kGap;
  });
  sheet.svg = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
      "viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" height=\"{1:g}\" font-family=\"sans-serif\" "
      "font-size=\"12\">\n<title>{2}</title>\n<rect width=\"100%\" height=\"100%\" "
      "fill=\"#fff\"/>\n{3}</svg>\n",
      sheet.width, sheet.height, escaped(title), figures);
  return sheet;
}

}  // namespace rigfit::apps
