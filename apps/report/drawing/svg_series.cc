#include "apps/report/drawing/svg_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/drawing/palette.h"

namespace rigfit::apps {
namespace {

using Marker = SeriesLook::Marker;

std::string colour(const PlotSeries& series, const SeriesLook& look) {
  return colour_of(series.origin, look.shade);
}

/// The class that gives a series its colour inside a page.
std::string class_of(const PlotSeries& series, const SeriesLook& look) {
  std::string name = fmt::format("o-{}", word_of(series.origin));
  if (look.shade != 0) name += fmt::format(" v{}", look.shade);
  return name;
}

std::string dash(const SeriesLook& look, double scale) {
  if (look.dash.empty()) return "";
  std::string text;
  for (const double length : look.dash) {
    text += fmt::format("{}{:g}", text.empty() ? "" : " ", length * scale);
  }
  return fmt::format(" stroke-dasharray=\"{}\"", text);
}

/// Points of a line that a reader of the figure can tell apart: at most two per pixel column
/// (their extremes), so that long records stay small.
std::vector<std::size_t> visible(const PlotSeries& series, const SvgAxis& x, const SvgAxis& y) {
  std::vector<std::size_t> kept;
  const std::size_t n = series.x.size();
  if (n <= kDenseSeries) {
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

std::string marker(const PlotSeries& series, double x, double y, double r) {
  const SeriesLook look = look_of(series);
  const std::string ink = colour(series, look);
  std::string path;
  switch (look.marker) {
    case Marker::none:
    case Marker::dot:
      return "";
    case Marker::circle:
      return fmt::format(
          "<circle class=\"{}{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\" fill=\"{}\" "
          "stroke=\"{}\" stroke-width=\"1.5\"/>",
          class_of(series, look), look.hollow ? " hollow" : "", x, y, r, look.hollow ? "#fff" : ink,
          ink);
    case Marker::square:
      path = fmt::format("M{0:.1f} {1:.1f}h{2:g}v{2:g}h-{2:g}z", x - 0.9 * r, y - 0.9 * r, 1.8 * r);
      break;
    case Marker::triangle:
      path = fmt::format("M{0:.1f} {1:.1f}l{2:g} {3:g}h-{4:g}z", x, y - 1.2 * r, 1.15 * r, 2 * r,
                         2.3 * r);
      break;
    case Marker::diamond:
      path = fmt::format("M{0:.1f} {1:.1f}l{2:g} {2:g}l-{2:g} {2:g}l-{2:g} -{2:g}z", x, y - 1.2 * r,
                         1.2 * r);
      break;
    case Marker::plus:
      path =
          fmt::format("M{0:.1f} {1:.1f}h{2:g}m-{3:g} -{3:g}v{2:g}", x - 1.5 * r, y, 3 * r, 1.5 * r);
      break;
    case Marker::cross:
      path = fmt::format("M{0:.1f} {1:.1f}l{2:g} {2:g}m0 -{2:g}l-{2:g} {2:g}", x - r, y - r, 2 * r);
      break;
  }
  const bool strokes = look.marker == Marker::plus || look.marker == Marker::cross;
  return fmt::format(
      "<path class=\"{}{}\" d=\"{}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"{}\"/>",
      class_of(series, look),
      strokes       ? " line"
      : look.hollow ? " hollow"
                    : "",
      path,
      strokes       ? "none"
      : look.hollow ? "#fff"
                    : ink,
      ink, strokes ? 2 : 1.5);
}

/// Upper and lower end of a band, one pair a pixel column where it is dense.
void draw_band(std::string& svg, const PlotSeries& series, const SvgAxis& x, const SvgAxis& y) {
  struct Slice {
    double px = 0, top = 0, bottom = 0;
  };
  std::vector<Slice> slices;
  const bool dense = series.x.size() > kDenseSeries;
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
  const SeriesLook look = look_of(series);
  std::string path;
  for (const auto& slice : slices) {
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", slice.px, slice.top);
  }
  for (auto slice = slices.rbegin(); slice != slices.rend(); ++slice) {
    path += fmt::format("L{:.1f} {:.1f}", slice->px, slice->bottom);
  }
  svg += fmt::format(
      "<path class=\"{} band\" d=\"{}z\" fill=\"{}\" fill-opacity=\"0.18\" stroke=\"none\"/>\n",
      class_of(series, look), path, colour(series, look));
}

void draw_line(std::string& svg, const PlotSeries& series, const SvgAxis& x, const SvgAxis& y,
               const SvgSeriesOptions& options) {
  std::string path;
  bool pen_down = false;
  for (const std::size_t i : visible(series, x, y)) {
    if (!x.shows(series.x[i]) || !y.shows(series.y[i])) {
      pen_down = false;
      continue;
    }
    path += fmt::format("{}{:.{}f} {:.{}f}", pen_down ? "L" : "M", x.at(series.x[i]),
                        options.digits, y.at(series.y[i]), options.digits);
    pen_down = true;
  }
  const SeriesLook look = look_of(series);
  const double width = options.beneath ? 3 : series.x.size() > kDenseSeries ? 1.2 : 1.8;
  svg += fmt::format(
      "<path class=\"{} line\" d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:g}\" "
      "stroke-linejoin=\"round\"{}/>\n",
      class_of(series, look), path, colour(series, look), width * options.scale,
      dash(look, options.scale));
}

void draw_points(std::string& svg, const PlotSeries& series, const SvgAxis& x, const SvgAxis& y,
                 const SvgSeriesOptions& options) {
  const SeriesLook look = look_of(series);
  std::string dots;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!x.shows(series.x[i]) || !y.shows(series.y[i])) continue;
    const double px = x.at(series.x[i]), py = y.at(series.y[i]);
    if (i < series.low.size() && y.shows(series.low[i]) && y.shows(series.high[i])) {
      const double top = y.at(series.high[i]), bottom = y.at(series.low[i]);
      svg += fmt::format(
          "<path class=\"{0} line\" d=\"M{1:.1f} {2:.1f}V{3:.1f}M{4:.1f} {2:.1f}h{6:g}M{4:.1f} "
          "{3:.1f}h{6:g}\" fill=\"none\" stroke=\"{5}\" stroke-width=\"1.3\"/>\n",
          class_of(series, look), px, top, bottom, px - 4 * options.scale, colour(series, look),
          8 * options.scale);
    }
    if (look.marker == Marker::dot) {
      dots += fmt::format("M{:.1f} {:.1f}h0", px, py);
    } else {
      svg += marker(series, px, py, 4 * options.scale) + "\n";
    }
  }
  if (dots.empty()) return;
  svg += fmt::format(
      "<path class=\"{} line\" d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:g}\" "
      "stroke-linecap=\"round\"/>\n",
      class_of(series, look), dots, colour(series, look),
      options.scale * (look.shade == 0 ? 4.5 : 2.5));
}

}  // namespace

double SvgAxis::at(double value) const {
  const double t =
      logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  return from + t * (to - from);
}

bool SvgAxis::shows(double value) const {
  return std::isfinite(value) && (!logarithmic || value > 0);
}

void draw_series(std::string& svg, const PlotSeries& series, const SvgAxis& x, const SvgAxis& y,
                 const SvgSeriesOptions& options) {
  const SeriesLook look = look_of(series);
  const bool points = look.marker != Marker::none;
  if (look.line) {
    if (!series.low.empty() && !points) draw_band(svg, series, x, y);
    draw_line(svg, series, x, y, options);
  }
  if (points) draw_points(svg, series, x, y, options);
}

std::string legend_key(const PlotSeries& series, double left, double y, double scale) {
  const SeriesLook look = look_of(series);
  std::string svg;
  const double middle = left + 12 * scale;
  if (look.line) {
    svg += fmt::format(
        "<path class=\"{} line\" d=\"M{:.1f} {:.1f}h{:g}\" fill=\"none\" stroke=\"{}\" "
        "stroke-width=\"{:g}\"{}/>\n",
        class_of(series, look), left, y, 24 * scale, colour(series, look), 2 * scale,
        dash(look, scale));
  }
  if (look.marker == Marker::dot) {
    for (const double offset : {-7.0, 0.0, 7.0}) {
      svg +=
          fmt::format("<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\" fill=\"{}\"/>\n",
                      class_of(series, look), middle + offset * scale, y,
                      scale * (look.shade == 0 ? 2.2 : 1.3), colour(series, look));
    }
  } else if (look.marker != Marker::none) {
    svg += marker(series, middle, y, 4 * scale) + "\n";
  }
  return svg;
}

}  // namespace rigfit::apps
