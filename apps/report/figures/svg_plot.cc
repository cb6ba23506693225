#include "apps/report/figures/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "apps/report/html_text.h"

namespace rigfit::apps {
namespace {

/// Colours that stay apart for colour-blind readers (Okabe and Ito 2008).
const char* colour_of(Origin origin) {
  switch (origin) {
    case Origin::measured:
      return "#0072b2";
    case Origin::published:
      return "#00795a";
    case Origin::published_model:
      return "#b37400";
    case Origin::synthetic:
      return "#a8518a";
    case Origin::modelled:
      return "#c2410c";
  }
  return "#000";
}

/// Series of one origin differ in shade: as it is, darker, lighter.
std::string colour_of(const PlotSeries& series) {
  const std::string base = colour_of(series.origin);
  const int variant = series.variant % 3;
  if (variant == 0 || series.origin == Origin::published_model) return base;
  const int towards = variant == 1 ? 0x22 : 0xff;
  std::string mixed = "#";
  for (std::size_t i = 1; i < 7; i += 2) {
    const int part = std::stoi(base.substr(i, 2), nullptr, 16);
    mixed += fmt::format("{:02x}", (6 * part + 4 * towards + 5) / 10);
  }
  return mixed;
}

/// The class that gives a series its colour inside a page.
std::string class_of(const PlotSeries& series) {
  std::string name = fmt::format("o-{}", word_of(series.origin));
  if (series.variant % 3 != 0 && series.origin != Origin::published_model) {
    name += fmt::format(" v{}", series.variant % 3);
  }
  return name;
}

struct Axis {
  double low = 0, high = 1, from = 0, to = 1;
  bool logarithmic = false;
  std::vector<double> ticks;

  double at(double value) const {
    const double t =
        logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
    return from + t * (to - from);
  }
  bool shows(double value) const { return std::isfinite(value) && (!logarithmic || value > 0); }
};

Axis axis_of(const Plot& plot, bool x_axis) {
  Axis axis;
  axis.logarithmic = x_axis ? plot.log_x : plot.log_y;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto take = [&](const std::vector<double>& values) {
    for (const double value : values) {
      if (!axis.shows(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  };
  for (const auto& series : plot.series) {
    take(x_axis ? series.x : series.y);
    if (!x_axis) {
      take(series.low);
      take(series.high);
    }
  }
  if (!(low <= high)) low = axis.logarithmic ? 1 : 0, high = axis.logarithmic ? 10 : 1;
  if (axis.logarithmic) {
    if (high < 1.01 * low) low /= 2, high *= 2;
    const double margin = std::pow(high / low, 0.04);
    axis.low = low / margin;
    axis.high = high * margin;
  } else {
    const double size = std::max(std::abs(low), std::abs(high));
    if (high - low < 1e-9 * size || high == low) {
      low -= size > 0 ? 0.05 * size : 0.5;
      high += size > 0 ? 0.05 * size : 0.5;
    }
    const double margin = 0.05 * (high - low);
    // An axis that nearly starts at zero starts there.
    axis.low = low >= 0 && low < 0.3 * high ? 0 : low - margin;
    axis.high = high + margin;
  }
  return axis;
}

constexpr std::size_t kDense = 700;  // more points than a figure has pixels across

/// Points of a line that a reader of the figure can tell apart: at most two per pixel column
/// (their extremes), so that long records stay small.
std::vector<std::size_t> visible(const PlotSeries& series, const Axis& x, const Axis& y) {
  std::vector<std::size_t> kept;
  const std::size_t n = series.x.size();
  if (n <= kDense) {
    for (std::size_t i = 0; i < n; ++i) kept.push_back(i);
    return kept;
  }
  constexpr long kNone = std::numeric_limits<long>::min();
  long column = kNone;
  std::size_t lowest = 0, highest = 0;
  const auto flush = [&] {
    if (column == kNone) return;
    kept.push_back(std::min(lowest, highest));
    if (lowest != highest) kept.push_back(std::max(lowest, highest));
    column = kNone;
  };
  for (std::size_t i = 0; i < n; ++i) {
    if (!x.shows(series.x[i]) || !y.shows(series.y[i])) {
      flush();
      kept.push_back(i);  // a gap
      continue;
    }
    const long here = std::lround(x.at(series.x[i]));
    if (here != column) {
      flush();
      column = here;
      lowest = highest = i;
    }
    if (series.y[i] < series.y[lowest]) lowest = i;
    if (series.y[i] > series.y[highest]) highest = i;
  }
  flush();
  return kept;
}

std::string dash(const PlotSeries& series) {
  if (series.style == PlotSeries::Style::dashed) return " stroke-dasharray=\"6 4\"";
  switch (series.variant / 3 % 4) {
    case 1:
      return " stroke-dasharray=\"9 3\"";
    case 2:
      return " stroke-dasharray=\"2 3\"";
    case 3:
      return " stroke-dasharray=\"9 3 2 3\"";
    default:
      return "";
  }
}

std::string marker(const PlotSeries& series, double x, double y) {
  const std::string colour = colour_of(series);
  const std::string word = class_of(series);
  switch (series.origin) {
    case Origin::measured:
    case Origin::published:
      return fmt::format(
          "<circle class=\"{}{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\" "
          "stroke=\"{}\" stroke-width=\"1.5\"/>",
          word, series.variant % 2 ? " hollow" : "", x, y, series.variant % 2 ? "#fff" : colour,
          colour);
    case Origin::published_model:
      if (series.variant % 2 == 0) {
        return fmt::format(
            "<rect class=\"{} hollow\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"7\" height=\"7\" "
            "fill=\"#fff\" stroke=\"{}\" stroke-width=\"1.5\"/>",
            word, x - 3.5, y - 3.5, colour);
      }
      return fmt::format(
          "<path class=\"{} hollow\" d=\"M{:.1f} {:.1f}l4.5 4.5l-4.5 4.5l-4.5 -4.5z\" "
          "fill=\"#fff\" stroke=\"{}\" stroke-width=\"1.5\"/>",
          word, x, y - 4.5, colour);
    case Origin::synthetic:
      return fmt::format(
          "<path class=\"{}\" d=\"M{:.1f} {:.1f}l4.5 8h-9z\" fill=\"{}\" stroke=\"{}\"/>", word, x,
          y - 5, colour, colour);
    case Origin::modelled:
      if (series.variant % 3 == 1) {
        return fmt::format(
            "<path class=\"{}\" d=\"M{:.1f} {:.1f}l8 8m0 -8l-8 8\" fill=\"none\" stroke=\"{}\" "
            "stroke-width=\"2\"/>",
            word, x - 4, y - 4, colour);
      }
      if (series.variant % 3 == 2) {
        return fmt::format(
            "<circle class=\"{} hollow\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"#fff\" "
            "stroke=\"{}\" stroke-width=\"1.5\"/>",
            word, x, y, colour);
      }
      return fmt::format(
          "<path class=\"{}\" d=\"M{:.1f} {:.1f}h13m-6.5 -6.5v13\" fill=\"none\" stroke=\"{}\" "
          "stroke-width=\"2\"/>",
          word, x - 6.5, y, colour);
  }
  return "";
}

bool has_points(const PlotSeries& s) {
  return s.style == PlotSeries::Style::points || s.style == PlotSeries::Style::line_and_points;
}
bool has_line(const PlotSeries& s) { return s.style != PlotSeries::Style::points; }

/// Upper and lower end of a band, one pair a pixel column where it is dense.
void draw_band(std::string& svg, const PlotSeries& series, const Axis& x, const Axis& y) {
  struct Slice {
    double px = 0, top = 0, bottom = 0;
  };
  std::vector<Slice> slices;
  const bool dense = series.x.size() > kDense;
  for (std::size_t i = 0; i < series.x.size() && i < series.low.size(); ++i) {
    if (!x.shows(series.x[i]) || !y.shows(series.low[i]) || !y.shows(series.high[i])) continue;
    Slice here{x.at(series.x[i]), y.at(series.high[i]), y.at(series.low[i])};
    if (dense) here.px = std::round(here.px);
    if (dense && !slices.empty() && slices.back().px == here.px) {
      slices.back().top = std::min(slices.back().top, here.top);
      slices.back().bottom = std::max(slices.back().bottom, here.bottom);
    } else {
      slices.push_back(here);
    }
  }
  if (slices.empty()) return;
  std::string path;
  for (const auto& slice : slices) {
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", slice.px, slice.top);
  }
  for (auto slice = slices.rbegin(); slice != slices.rend(); ++slice) {
    path += fmt::format("L{:.1f} {:.1f}", slice->px, slice->bottom);
  }
  svg += fmt::format(
      "<path class=\"{} band\" d=\"{}z\" fill=\"{}\" fill-opacity=\"0.18\" stroke=\"none\"/>\n",
      class_of(series), path, colour_of(series));
}

/// `beneath`: a model is drawn over it, and must not hide it.
void draw_line(std::string& svg, const PlotSeries& series, const Axis& x, const Axis& y, int digits,
               bool beneath) {
  std::string path;
  bool pen_down = false;
  for (const std::size_t i : visible(series, x, y)) {
    if (!x.shows(series.x[i]) || !y.shows(series.y[i])) {
      pen_down = false;
      continue;
    }
    path += fmt::format("{}{:.{}f} {:.{}f}", pen_down ? "L" : "M", x.at(series.x[i]), digits,
                        y.at(series.y[i]), digits);
    pen_down = true;
  }
  const double width = beneath ? 3 : series.x.size() > kDense ? 1.2 : 1.8;
  svg += fmt::format(
      "<path class=\"{} line\" d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" "
      "stroke-linejoin=\"round\"{}/>\n",
      class_of(series), path, colour_of(series), width, dash(series));
}

void draw_points(std::string& svg, const PlotSeries& series, const Axis& x, const Axis& y) {
  constexpr std::size_t kMany = 150;  // as dots of one path from here on
  std::string dots;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!x.shows(series.x[i]) || !y.shows(series.y[i])) continue;
    const double px = x.at(series.x[i]), py = y.at(series.y[i]);
    if (i < series.low.size() && y.shows(series.low[i]) && y.shows(series.high[i])) {
      const double top = y.at(series.high[i]), bottom = y.at(series.low[i]);
      svg += fmt::format(
          "<path class=\"{0} line\" d=\"M{1:.1f} {2:.1f}V{3:.1f}M{4:.1f} {2:.1f}h8M{4:.1f} "
          "{3:.1f}h8\" fill=\"none\" stroke=\"{5}\" stroke-width=\"1.3\"/>\n",
          class_of(series), px, top, bottom, px - 4, colour_of(series));
    }
    if (series.x.size() > kMany) {
      dots += fmt::format("M{:.1f} {:.1f}h0", px, py);
    } else {
      svg += marker(series, px, py) + "\n";
    }
  }
  if (dots.empty()) return;
  svg += fmt::format(
      "<path class=\"{} line\" d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" "
      "stroke-linecap=\"round\"/>\n",
      class_of(series), dots, colour_of(series), series.variant % 2 ? 2.5 : 4.5);
}

void draw_series(std::string& svg, const PlotSeries& series, const Axis& x, const Axis& y,
                 int digits, bool beneath) {
  if (has_line(series)) {
    if (!series.low.empty() && !has_points(series)) draw_band(svg, series, x, y);
    draw_line(svg, series, x, y, digits, beneath);
  }
  if (has_points(series)) draw_points(svg, series, x, y);
}

}  // namespace

std::vector<double> axis_ticks(double low, double high, int count, bool logarithmic) {
  std::vector<double> ticks;
  if (!(high > low) || !std::isfinite(low) || !std::isfinite(high) || count < 1) return ticks;
  if (logarithmic) {
    if (!(low > 0)) return ticks;
    const double decades = std::log10(high / low);
    const int every = std::max(1, static_cast<int>(std::ceil(decades / count)));
    const std::vector<double> between = decades < 1.5 ? std::vector<double>{1, 2, 3, 5, 7}
                                        : decades < 3 ? std::vector<double>{1, 2, 5}
                                                      : std::vector<double>{1};
    for (int e = static_cast<int>(std::floor(std::log10(low))); std::pow(10, e) <= high; ++e) {
      if (e % every != 0) continue;
      for (const double m : between) {
        const double tick = m * std::pow(10, e);
        if (tick >= low * (1 - 1e-12) && tick <= high * (1 + 1e-12)) ticks.push_back(tick);
      }
    }
    return ticks;
  }
  const double rough = (high - low) / count;
  const double power = std::pow(10, std::floor(std::log10(rough)));
  const double lead = rough / power;
  const double step = power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) {
    ticks.push_back(k == 0 ? 0 : k * step);
  }
  return ticks;
}

std::string svg_plot(const Plot& plot, const SvgOptions& options) {
  Axis x = axis_of(plot, true), y = axis_of(plot, false);
  // The legend stands below in rows; one entry a group.
  struct Entry {
    const PlotSeries* series;
    std::string name;
    double width;
  };
  std::vector<std::vector<Entry>> rows(1);
  std::map<std::string, bool> listed;
  double row_width = 0;
  const double left = 70, right = 16, top = 12;
  for (const auto& series : plot.series) {
    const std::string name = series.group.empty() ? series.name : series.group;
    if (listed[name]) continue;
    listed[name] = true;
    const double width = 44 + 6.6 * static_cast<double>(name.size());
    if (row_width + width > options.width - left - right && row_width > 0) {
      rows.emplace_back();
      row_width = 0;
    }
    rows.back().push_back({&series, name, width});
    row_width += width;
  }
  const double bottom = 52 + 20 * static_cast<double>(rows.size());
  x.from = left;
  x.to = options.width - right;
  y.from = options.height - bottom;
  y.to = top;
  x.ticks = axis_ticks(x.low, x.high, 8, x.logarithmic);
  y.ticks = axis_ticks(y.low, y.high, 6, y.logarithmic);
  const auto whole = [](double value) { return value == std::round(value); };
  if (std::all_of(plot.series.begin(), plot.series.end(), [&](const PlotSeries& series) {
        return std::all_of(series.x.begin(), series.x.end(), whole);
      })) {
    std::erase_if(x.ticks, [&](double tick) { return !whole(tick); });  // what is counted
  }

  std::string svg;
  if (options.standalone) svg += "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  svg += fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
      "height=\"{1}\" role=\"img\" font-family=\"sans-serif\" "
      "font-size=\"12\">\n<title>{2}</title>\n"
      "<desc>{3}</desc>\n",
      options.width, options.height, escaped(plot.title), escaped(plot.caption));
  if (options.standalone) svg += "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  const std::string clip = "clip-" + plot.id;
  svg += fmt::format(
      "<clipPath id=\"{}\"><rect x=\"{}\" y=\"{}\" width=\"{:.1f}\" "
      "height=\"{:.1f}\"/></clipPath>\n",
      escaped(clip), x.from, y.to, x.to - x.from, y.from - y.to);
  for (const double tick : x.ticks) {
    svg += fmt::format(
        "<path class=\"grid\" d=\"M{0:.1f} {1:.1f}V{2:.1f}\" stroke=\"#ddd\"/><text class=\"t\" "
        "x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\" fill=\"#222\">{4}</text>\n",
        x.at(tick), y.from, y.to, y.from + 17, fmt::format("{:g}", tick));
  }
  for (const double tick : y.ticks) {
    svg += fmt::format(
        "<path class=\"grid\" d=\"M{0:.1f} {1:.1f}H{2:.1f}\" stroke=\"#ddd\"/><text class=\"t\" "
        "x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\" fill=\"#222\">{5}</text>\n",
        x.from, y.at(tick), x.to, x.from - 7, y.at(tick) + 4, fmt::format("{:g}", tick));
  }
  svg += fmt::format(
      "<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" "
      "stroke=\"#888\"/>\n",
      x.from, y.to, x.to - x.from, y.from - y.to);
  svg += fmt::format(
      "<text class=\"t\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" "
      "fill=\"#222\">{}</text>\n",
      0.5 * (x.from + x.to), y.from + 36, escaped(plot.x_label));
  svg += fmt::format(
      "<text class=\"t\" transform=\"translate(18 {:.1f}) rotate(-90)\" text-anchor=\"middle\" "
      "fill=\"#222\">{}</text>\n",
      0.5 * (y.from + y.to), escaped(plot.y_label));
  svg += fmt::format("<g clip-path=\"url(#{})\">\n", escaped(clip));
  // Inside a page whole pixels do for what is dense; a figure for a paper has tenths.
  const auto digits = [&](const PlotSeries& series) {
    return options.standalone || series.x.size() <= kDense ? 1 : 0;
  };
  const bool overlaid = std::any_of(plot.series.begin(), plot.series.end(), [](const auto& s) {
    return has_line(s) && s.origin == Origin::modelled;
  });
  for (const bool lines : {true, false}) {
    for (const auto& series : plot.series) {
      if (has_line(series) != lines) continue;
      draw_series(svg, series, x, y, digits(series), overlaid && series.origin != Origin::modelled);
    }
  }
  svg += "</g>\n";
  double row_y = y.from + 56;
  for (const auto& row : rows) {
    double row_x = left;
    for (const auto& entry : row) {
      if (has_line(*entry.series)) {
        svg += fmt::format(
            "<path class=\"{} line\" d=\"M{:.1f} {:.1f}h24\" fill=\"none\" stroke=\"{}\" "
            "stroke-width=\"2\"{}/>\n",
            class_of(*entry.series), row_x, row_y - 4, colour_of(*entry.series),
            dash(*entry.series));
      }
      if (has_points(*entry.series)) svg += marker(*entry.series, row_x + 12, row_y - 4) + "\n";
      svg += fmt::format("<text class=\"t\" x=\"{:.1f}\" y=\"{:.1f}\" fill=\"#222\">{}</text>\n",
                         row_x + 30, row_y, escaped(entry.name));
      row_x += entry.width;
    }
    row_y += 20;
  }
  return svg + "</svg>\n";
}

}  // namespace rigfit::apps
