#include "apps/report/drawing/plot.h"

#include <set>

#include "apps/report/drawing/html_text.h"

namespace rigfit::apps {
namespace {

using Marker = SeriesLook::Marker;

constexpr double kCharacter = 6.6;  // px that a character of 12 px takes, on the mean
// Longer series: only the extremes by half pixel are drawn.
constexpr std::size_t kDenseSeries = 900;

/// The range of values low..high lies between the pixels from..to.
struct SvgAxis {
  double low = 0, high = 1, from = 0, to = 1;
  bool logarithmic = false;
  std::vector<double> ticks;

  [[nodiscard]] double at(double value) const {
    const double t =
        logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
    return from + t * (to - from);
  }
  /// A number that has a place on such an axis.
  [[nodiscard]] bool shows(double value) const {
    return std::isfinite(value) && (!logarithmic || value > 0);
  }
};

SvgAxis axis_of(const Plot& plot, bool x_axis) {
  SvgAxis axis;
  axis.logarithmic = x_axis ? plot.log_x : plot.log_y;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto take = [&](const std::vector<double>& values) {
    for (const double value : values) {
      if (axis.shows(value)) low = std::min(low, value), high = std::max(high, value);
    }
  };
  for (const auto& series : plot.series) {
    take(x_axis ? series.x : series.y);
    if (!x_axis) take(series.low), take(series.high);
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

/// Tick values in as few digits as tell them apart.
std::vector<std::string> tick_labels(const SvgAxis& axis) {
  std::vector<std::string> labels;
  for (const double tick : axis.ticks) {
    double step = std::numeric_limits<double>::infinity();
    if (!axis.logarithmic && axis.ticks.size() > 1) step = axis.ticks[1] - axis.ticks[0];
    const double decimals = -std::floor(std::log10(step) + 1e-9);  // -inf without a step
    std::string label = decimals >= 0 && decimals < 7 && std::abs(tick) < 1e6
                            ? fmt::format("{:.{}f}", tick, static_cast<int>(decimals))
                            : fmt::format("{:g}", tick);
    if (label.starts_with('-')) label.replace(0, 1, "\u2212");
    labels.push_back(std::move(label));
  }
  return labels;
}

struct Pixel {
  double x = 0, y = 0;
  bool shown = true;
};

/// Points of a line that a reader can tell apart, zoomed in by two as well: the extremes of every
/// half pixel, so that long records stay small.
std::vector<Pixel> visible(const PlotSeries& series, const SvgAxis& x, const SvgAxis& y) {
  std::vector<Pixel> kept;
  const bool dense = series.x.size() > kDenseSeries;
  bool open = false;
  long column = 0;
  Pixel one, other;  // extremes of the column
  const auto flush = [&] {
    if (!open) return;
    if (other.x < one.x) std::swap(one, other);
    kept.push_back(one);
    if (one.y != other.y) kept.push_back(other);
    open = false;
  };
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!x.shows(series.x[i]) || !y.shows(series.y[i])) {
      flush();
      kept.push_back({0, 0, false});  // a gap
      continue;
    }
    const Pixel here{x.at(series.x[i]), y.at(series.y[i])};
    if (!dense) {
      kept.push_back(here);
      continue;
    }
    if (const long at = std::lround(2 * here.x); !open || at != column) {
      flush();
      column = at, open = true;
      one = other = here;
    }
    if (here.y < one.y) one = here;
    if (here.y > other.y) other = here;
  }
  flush();
  return kept;
}

std::string marker(const SeriesLook& look, double x, double y) {
  static constexpr std::array<const char*, 6> kPaths{// by Marker, 4 px to each side
                                                     "",
                                                     "",
                                                     "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0z",
                                                     "M-3.6 -3.6h7.2v7.2h-7.2z",
                                                     "M0 -5l5 5l-5 5l-5 -5z",
                                                     "M-4.4 -4.4l8.8 8.8m0 -8.8l-8.8 8.8"};
  const char* const path = kPaths[static_cast<std::size_t>(look.marker)];
  if (*path == '\0') return "";
  const bool strokes = look.marker == Marker::cross;
  return fmt::format("<path class=\"m{}\" transform=\"translate({:.1f} {:.1f})\" d=\"{}\"{}/>\n",
                     look.hollow ? " hollow"
                     : strokes   ? " line"
                                 : "",
                     x, y, path,
                     strokes       ? " fill=\"none\" stroke-width=\"2\""
                     : look.hollow ? " fill=\"#fff\""
                                   : "");
}

/// Upper and lower end of a band.
std::string band(const PlotSeries& series, const SvgAxis& x, const SvgAxis& y) {
  PlotSeries ends[2];
  for (std::size_t i = 0; i < series.x.size() && i < series.low.size(); ++i) {
    if (!y.shows(series.low[i]) || !y.shows(series.high[i])) continue;
    for (const int k : {0, 1}) {
      ends[k].x.push_back(series.x[i]);
      ends[k].y.push_back(k == 0 ? series.high[i] : series.low[i]);
    }
  }
  std::string path;
  const auto add = [&](const Pixel& p) {
    if (p.shown) path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", p.x, p.y);
  };
  std::ranges::for_each(visible(ends[0], x, y), add);
  auto below = visible(ends[1], x, y);
  std::ranges::reverse(below);
  std::ranges::for_each(below, add);
  if (path.empty()) return path;
  return fmt::format("<path class=\"band\" d=\"{}z\" fill-opacity=\"0.18\" stroke=\"none\"/>\n",
                     path);
}

std::string dash(const SeriesLook& look) {
  return *look.dash == '\0' ? "" : fmt::format(" stroke-dasharray=\"{}\"", look.dash);
}

std::string points(const PlotSeries& series, const SeriesLook& look, const SvgAxis& x,
                   const SvgAxis& y) {
  std::string svg, dots;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!x.shows(series.x[i]) || !y.shows(series.y[i])) continue;
    const double px = x.at(series.x[i]), py = y.at(series.y[i]);
    if (i < series.low.size() && y.shows(series.low[i]) && y.shows(series.high[i])) {
      svg += fmt::format(
          "<path class=\"line\" d=\"M{0:.1f} {1:.1f}V{2:.1f}M{3:.1f} {1:.1f}h8M{3:.1f} {2:.1f}h8\" "
          "fill=\"none\" stroke-width=\"1.3\"/>\n",
          px, y.at(series.high[i]), y.at(series.low[i]), px - 4);
    }
    if (look.marker == Marker::dot) {
      dots += fmt::format("M{:.1f} {:.1f}h0", px, py);
    } else {
      svg += marker(look, px, py);
    }
  }
  if (dots.empty()) return svg;
  return svg + fmt::format(
                   "<path class=\"line\" d=\"{}\" fill=\"none\" stroke-width=\"3\" "
                   "stroke-linecap=\"round\"/>\n",
                   dots);
}

std::string line(const PlotSeries& series, const SeriesLook& look, const SvgAxis& x,
                 const SvgAxis& y) {
  std::string path;
  bool pen_down = false;
  for (const auto& p : visible(series, x, y)) {
    if (p.shown) path += fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", p.x, p.y);
    pen_down = p.shown;
  }
  return fmt::format(
      "<path class=\"line\" d=\"{}\" fill=\"none\" stroke-width=\"{:g}\" "
      "stroke-linejoin=\"round\"{}/>\n",
      path, (series.x.size() > kDenseSeries ? 1.2 : 1.8), dash(look));
}

/// One figure being laid out and drawn.
class SvgFigure {
 public:
  SvgFigure(const Plot& plot, const SvgOptions& options)
      : plot_(plot), options_(options), x_(axis_of(plot, true)), y_(axis_of(plot, false)) {
    lay_out();
  }

  std::string drawn() {
    open();
    grid();
    // An svg element of its own: the page's script zooms by its viewBox.
    svg_ += fmt::format(
        "<svg class=\"in\" x=\"{0:.1f}\" y=\"{1:.1f}\" width=\"{2:.1f}\" height=\"{3:.1f}\" "
        "viewBox=\"{0:.1f} {1:.1f} {2:.1f} {3:.1f}\" preserveAspectRatio=\"none\">\n",
        x_.from, y_.to, x_.to - x_.from, y_.from - y_.to);
    marks();
    series();
    svg_ += "</svg>\n";
    legend();
    return svg_ + "</svg>\n";
  }

 private:
  struct Entry {
    const PlotSeries* series = nullptr;
    double width = 0;
  };

  void lay_out() {
    y_.ticks = axis_ticks(y_.low, y_.high, ticks_along(options_.height, 62), y_.logarithmic);
    double longest = 6;
    for (const auto& label : tick_labels(y_)) longest = std::max(longest, characters(label));
    const double left = 30 + kCharacter * longest, right = 16;
    const double top = (plot_.marks.empty() ? 12 : 26);
    // The legend stands below in rows; one entry a group.
    std::set<std::string> listed;
    double row_width = 0;
    rows_.emplace_back();
    for (const auto& one : plot_.series) {
      const std::string name = group_of(one);
      if (!listed.insert(name).second) continue;
      const double width = 44 + kCharacter * characters(name);
      if (row_width + width > options_.width - left - right && row_width > 0) {
        rows_.emplace_back();
        row_width = 0;
      }
      rows_.back().push_back({&one, width});
      row_width += width;
    }
    const double bottom = 52 + 20 * static_cast<double>(rows_.size());
    x_.from = left;
    x_.to = options_.width - right;
    y_.from = options_.height - bottom;
    y_.to = top;
    x_.ticks = axis_ticks(x_.low, x_.high, ticks_along(options_.width, 86), x_.logarithmic);
    const auto whole = [](double value) { return value == std::round(value); };
    if (std::ranges::all_of(plot_.series, [&](const PlotSeries& one) {
          return std::ranges::all_of(one.x, whole);
        })) {
      std::erase_if(x_.ticks, [&](double tick) { return !whole(tick); });  // what is counted
    }
  }

  /// How many ticks have room, so many px of 12 px text apart.
  [[nodiscard]] int ticks_along(double length, double apart) const {
    return std::clamp(static_cast<int>(length / (apart)), 2, 12);
  }

  void open() {
    const auto& o = options_;
    const std::string size = o.px_per_mm > 0
                                 ? fmt::format("width=\"{:g}mm\" height=\"{:g}mm\"",
                                               o.width / o.px_per_mm, o.height / o.px_per_mm)
                                 : fmt::format("width=\"{:g}\" height=\"{:g}\"", o.width, o.height);
    svg_ += fmt::format(
        "<svg class=\"fig\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:g} {:g}\" {} "
        "data-x=\"{:g} {:g} {:d}\" data-y=\"{:g} {:g} {:d}\" data-link=\"{}\" role=\"img\" "
        "font-family=\"{}\" font-size=\"12\">\n<title>{}</title>\n<desc>{}</desc>\n",
        o.width, o.height, size, x_.low, x_.high, x_.logarithmic, y_.low, y_.high, y_.logarithmic,
        escaped(plot_.link), escaped(o.font), escaped(plot_.title), escaped(plot_.caption));
  }

  void text(double x, double y, const char* anchor, const std::string& words,
            const char* more = "") {
    svg_ += fmt::format(
        "<text class=\"t\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" "
        "fill=\"#222\"{}>{}</text>\n",
        x, y, anchor, more, escaped(words));
  }

  void grid() {
    const auto x_labels = tick_labels(x_), y_labels = tick_labels(y_);
    svg_ += "<g class=\"ticks\">\n";
    for (std::size_t i = 0; i < x_.ticks.size(); ++i) {
      const double at = x_.at(x_.ticks[i]);
      svg_ += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}V{:.1f}\" stroke=\"#ddd\"/>", at,
                          y_.from, y_.to);
      text(at, y_.from + 17, "middle", x_labels[i]);
    }
    svg_ += "</g>\n";
    for (std::size_t i = 0; i < y_.ticks.size(); ++i) {
      const double at = y_.at(y_.ticks[i]);
      svg_ += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"#ddd\"/>",
                          x_.from, at, x_.to);
      text(x_.from - 7, at + 4, "end", y_labels[i]);
    }
    svg_ += fmt::format(
        "<rect class=\"frame\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
        "fill=\"none\" "
        "stroke=\"#888\"/>\n",
        x_.from, y_.to, x_.to - x_.from, y_.from - y_.to);
    text(0.5 * (x_.from + x_.to), y_.from + 36, "middle", plot_.x_label);
    svg_ += fmt::format(
        "<text class=\"t\" transform=\"translate(16 {:.1f}) rotate(-90)\" "
        "text-anchor=\"middle\" fill=\"#222\">{}</text>\n",
        0.5 * (y_.from + y_.to), escaped(plot_.y_label));
  }

  void marks() {
    double last = -1e9;
    for (const auto& mark : plot_.marks) {
      if (!x_.shows(mark.x) || mark.x < x_.low || mark.x > x_.high) continue;
      const double at = x_.at(mark.x);
      svg_ += fmt::format(
          "<path class=\"mark\" d=\"M{:.1f} {:.1f}V{:.1f}\" fill=\"none\" stroke=\"#888\"{}/>\n",
          at, y_.from, y_.to, mark.doubtful ? " stroke-dasharray=\"3 3\"" : "");
      const double half = 0.5 * kCharacter * characters(mark.label);
      if (at - half < last) continue;  // no room beside the one before
      last = at + half + 4;
      labels_ += fmt::format(
          "<text class=\"t at\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" "
          "fill=\"#222\">{}</text>\n",
          std::clamp(at, x_.from + half, std::max(x_.from + half, x_.to - half)), y_.to - 6,
          escaped(mark.label));
    }
  }

  [[nodiscard]] bool overlaid() const {
    return std::ranges::any_of(plot_.series, [](const PlotSeries& one) {
      return one.origin != Origin::modelled && one.style == PlotSeries::Style::line;
    });
  }

  [[nodiscard]] static std::string group_of(const PlotSeries& one) {
    return one.group.empty() ? one.name : one.group;
  }

  [[nodiscard]] static std::string opened(const PlotSeries& one, const char* more) {
    const char* ink = series_colour(one.variant);
    return fmt::format("<g class=\"s{}{}\" data-k=\"{}\" fill=\"{}\" stroke=\"{}\">",
                       palette_place(one.variant), more, escaped(group_of(one)), ink, ink);
  }

  /// Lines first, points over them.
  void series() {
    for (const bool lines : {true, false}) {
      for (const auto& one : plot_.series) {
        const SeriesLook look = look_of(one, overlaid());
        if (look.line != lines) continue;
        const bool marked = look.marker != Marker::none;
        svg_ += opened(one, "") + "<title>" + escaped(one.name) + "</title>\n";
        if (look.line && !marked && !one.low.empty()) svg_ += band(one, x_, y_);
        if (look.line) svg_ += line(one, look, x_, y_);
        if (marked) svg_ += points(one, look, x_, y_);
        svg_ += "</g>\n";
      }
    }
  }

  void legend() {
    svg_ += labels_;
    double y = y_.from + 56;
    for (const auto& row : rows_) {
      double x = x_.from;
      for (const auto& entry : row) {
        const SeriesLook look = look_of(*entry.series, overlaid());
        const double middle = x + 12, height = y - 4;
        svg_ += opened(*entry.series, " lg");
        if (look.line) {
          svg_ += fmt::format(
              "<path class=\"line\" d=\"M{:.1f} {:.1f}h24\" fill=\"none\" stroke-width=\"2\"{}/>",
              x, height, dash(look));
        }
        if (look.marker == Marker::dot) {
          svg_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.8\"/>", middle, height);
        }
        svg_ += marker(look, middle, height);
        text(x + 30, y, "start", group_of(*entry.series), " stroke=\"none\"");
        svg_ += "</g>\n";
        x += entry.width;
      }
      y += 20;
    }
  }

  const Plot& plot_;
  const SvgOptions& options_;
  SvgAxis x_, y_;
  std::vector<std::vector<Entry>> rows_;
  std::string svg_, labels_;
};

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

std::string standalone_svg(const std::string& svg) {
  const auto end = svg.find('>');
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + svg.substr(0, end + 1) +
         "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>" + svg.substr(end + 1);
}

SvgOptions print_size(double width_mm, double height_mm, const std::string& font, double size_pt) {
  const double px_per_mm = 12 / size_pt * 72 / 25.4;
  return {width_mm * px_per_mm, height_mm * px_per_mm, font, px_per_mm};
}

std::string svg_plot(const Plot& plot, const SvgOptions& options) {
  return SvgFigure(plot, options).drawn();
}

}  // namespace rigfit::apps
