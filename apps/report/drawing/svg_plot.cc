#include "apps/report/drawing/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "apps/report/drawing/html_text.h"
#include "apps/report/drawing/palette.h"
#include "apps/report/drawing/svg_series.h"

namespace rigfit::apps {
namespace {

constexpr double kPxPerMm = 96 / 25.4;
constexpr double kPxPerPt = 96.0 / 72;
constexpr double kCharacter = 6.6;  // px that a character of 12 px takes, on the mean

SvgAxis axis_of(const Plot& plot, bool x_axis) {
  SvgAxis axis;
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

/// Parts of a turn that cover [low, high].
std::vector<double> angle_ticks(double low, double high, int count) {
  double step = 30;
  for (const double next : {45.0, 90.0, 180.0, 360.0, 720.0, 1800.0, 3600.0, 18000.0}) {
    if ((high - low) / step <= count) break;
    step = next;
  }
  std::vector<double> ticks;
  for (double k = std::ceil(low / step); k * step <= high; ++k)
    ticks.push_back(k == 0 ? 0 : k * step);
  return ticks;
}

/// Tick values in as few digits as tell them apart.
std::vector<std::string> tick_labels(const SvgAxis& axis) {
  std::vector<std::string> labels;
  for (const double tick : axis.ticks) {
    double step = std::numeric_limits<double>::infinity();
    if (!axis.logarithmic && axis.ticks.size() > 1) step = axis.ticks[1] - axis.ticks[0];
    const int decimals = static_cast<int>(-std::floor(std::log10(step) + 1e-9));
    std::string label = std::isfinite(step) && decimals >= 0 && decimals < 7 && std::abs(tick) < 1e6
                            ? fmt::format("{:.{}f}", tick, decimals)
                            : fmt::format("{:g}", tick);
    if (label.starts_with('-')) label.replace(0, 1, "\u2212");
    labels.push_back(std::move(label));
  }
  return labels;
}

/// Characters of a UTF-8 text.
double length_of(const std::string& text) {
  return static_cast<double>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U;
  }));
}

/// One figure being laid out and drawn.
class SvgFigure {
 public:
  SvgFigure(const Plot& plot, const SvgOptions& options)
      : plot_(plot), options_(options), em_(options.font_size / 12) {
    x_ = axis_of(plot, true);
    y_ = axis_of(plot, false);
    if (plot.same_axes) {
      x_.low = y_.low = std::min(x_.low, y_.low);
      x_.high = y_.high = std::max(x_.high, y_.high);
    }
    lay_out();
  }

  std::string drawn() {
    open();
    grid();
    svg_ += fmt::format("<g clip-path=\"url(#clip-{})\">\n", escaped(plot_.id));
    marks();
    series();
    svg_ += "</g>\n";
    legend();
    return svg_ + "</svg>\n";
  }

 private:
  struct Entry {
    const PlotSeries* series = nullptr;
    std::string name;
    double width = 0;
  };

  void lay_out() {
    y_.ticks = plot_.angle
                   ? angle_ticks(y_.low, y_.high, 6)
                   : axis_ticks(y_.low, y_.high, ticks_along(options_.height, 62), y_.logarithmic);
    double longest = 6;
    for (const auto& label : tick_labels(y_)) longest = std::max(longest, length_of(label));
    const double left = em_ * (30 + kCharacter * longest), right = 16 * em_;
    const double top = (plot_.marks.empty() ? 12 : 26) * em_;
    // The legend stands below in rows; one entry a group.
    std::set<std::string> listed;
    double row_width = 0;
    rows_.emplace_back();
    for (const auto& one : plot_.series) {
      const std::string name = one.group.empty() ? one.name : one.group;
      if (!listed.insert(name).second) continue;
      const double width = em_ * (44 + kCharacter * length_of(name));
      if (row_width + width > options_.width - left - right && row_width > 0) {
        rows_.emplace_back();
        row_width = 0;
      }
      rows_.back().push_back({&one, name, width});
      row_width += width;
    }
    const double bottom = em_ * (52 + 20 * static_cast<double>(rows_.size()));
    x_.from = left;
    x_.to = options_.width - right;
    y_.from = options_.height - bottom;
    y_.to = top;
    if (plot_.same_axes) {  // as high as wide
      const double side = std::min(x_.to - x_.from, y_.from - y_.to);
      x_.to = x_.from + side;
      y_.to = y_.from - side;
    }
    x_.ticks = axis_ticks(x_.low, x_.high, ticks_along(options_.width, 86), x_.logarithmic);
    const auto whole = [](double value) { return value == std::round(value); };
    if (std::all_of(plot_.series.begin(), plot_.series.end(), [&](const PlotSeries& one) {
          return std::all_of(one.x.begin(), one.x.end(), whole);
        })) {
      std::erase_if(x_.ticks, [&](double tick) { return !whole(tick); });  // what is counted
    }
  }

  /// How many ticks have room, so many px of 12 px text apart.
  [[nodiscard]] int ticks_along(double length, double apart) const {
    return std::clamp(static_cast<int>(length / (apart * em_)), 2, 12);
  }

  void open() {
    const auto& o = options_;
    if (o.standalone) svg_ += "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    const std::string size = o.in_mm
                                 ? fmt::format("width=\"{:g}mm\" height=\"{:g}mm\"",
                                               o.width / kPxPerMm, o.height / kPxPerMm)
                                 : fmt::format("width=\"{:g}\" height=\"{:g}\"", o.width, o.height);
    svg_ += fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:g} {:g}\" {} role=\"img\" "
        "font-family=\"{}\" font-size=\"{:g}\">\n<title>{}</title>\n<desc>{}</desc>\n",
        o.width, o.height, size, escaped(o.font), o.font_size, escaped(plot_.title),
        escaped(plot_.caption));
    if (o.standalone) svg_ += "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
    svg_ += fmt::format(
        "<clipPath id=\"clip-{}\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
        "height=\"{:.1f}\"/></clipPath>\n",
        escaped(plot_.id), x_.from, y_.to, x_.to - x_.from, y_.from - y_.to);
  }

  void text(double x, double y, const char* anchor, const std::string& words,
            const char* more = "") {
    svg_ += fmt::format(
        "<text class=\"t\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" "
        "fill=\"#222\"{}>{}</text>\n",
        x, y, anchor, more, escaped(words));
  }

  /// Faint lines within the decades of a logarithmic axis.
  template <class Line>
  static void within_decades(const SvgAxis& axis, Line line) {
    if (!axis.logarithmic || axis.high / axis.low > 1e6) return;
    for (int e = static_cast<int>(std::floor(std::log10(axis.low))); std::pow(10, e) <= axis.high;
         ++e) {
      for (int m = 2; m < 10; ++m) {
        const double value = m * std::pow(10, e);
        if (value > axis.low && value < axis.high) line(axis.at(value));
      }
    }
  }

  void grid() {
    std::string minor;
    within_decades(
        x_, [&](double at) { minor += fmt::format("M{:.1f} {:.1f}V{:.1f}", at, y_.from, y_.to); });
    within_decades(
        y_, [&](double at) { minor += fmt::format("M{:.1f} {:.1f}H{:.1f}", x_.from, at, x_.to); });
    if (!minor.empty()) {
      svg_ += fmt::format("<path class=\"grid minor\" d=\"{}\" fill=\"none\" stroke=\"#eee\"/>\n",
                          minor);
    }
    const auto x_labels = tick_labels(x_), y_labels = tick_labels(y_);
    for (std::size_t i = 0; i < x_.ticks.size(); ++i) {
      const double at = x_.at(x_.ticks[i]);
      svg_ += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}V{:.1f}\" stroke=\"#ddd\"/>", at,
                          y_.from, y_.to);
      text(at, y_.from + 17 * em_, "middle", x_labels[i]);
    }
    for (std::size_t i = 0; i < y_.ticks.size(); ++i) {
      const double at = y_.at(y_.ticks[i]);
      svg_ += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"#ddd\"/>",
                          x_.from, at, x_.to);
      text(x_.from - 7 * em_, at + 4 * em_, "end", y_labels[i]);
    }
    svg_ += fmt::format(
        "<rect class=\"frame\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
        "fill=\"none\" "
        "stroke=\"#888\"/>\n",
        x_.from, y_.to, x_.to - x_.from, y_.from - y_.to);
    text(0.5 * (x_.from + x_.to), y_.from + 36 * em_, "middle", plot_.x_label);
    svg_ += fmt::format(
        "<text class=\"t\" transform=\"translate({:.1f} {:.1f}) rotate(-90)\" "
        "text-anchor=\"middle\" "
        "fill=\"#222\">{}</text>\n",
        16 * em_, 0.5 * (y_.from + y_.to), escaped(plot_.y_label));
  }

  void marks() {
    std::string labels;
    double last = -1e9;
    for (const auto& mark : plot_.marks) {
      if (!x_.shows(mark.x) || mark.x < x_.low || mark.x > x_.high) continue;
      const double at = x_.at(mark.x);
      svg_ += fmt::format(
          "<path class=\"o-{} line\" d=\"M{:.1f} {:.1f}V{:.1f}\" fill=\"none\" stroke=\"{}\" "
          "stroke-opacity=\"0.55\"{}/>\n",
          word_of(mark.origin), at, y_.from, y_.to, colour_of(mark.origin),
          mark.doubtful ? " stroke-dasharray=\"3 3\"" : "");
      const double half = 0.5 * em_ * kCharacter * length_of(mark.label);
      if (at - half < last) continue;  // no room beside the one before
      last = at + half + 4 * em_;
      labels += fmt::format(
          "<text class=\"o-{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" fill=\"{}\" "
          "font-size=\"{:g}\">{}</text>\n",
          word_of(mark.origin),
          std::clamp(at, x_.from + half, std::max(x_.from + half, x_.to - half)), y_.to - 6 * em_,
          colour_of(mark.origin), 0.9 * options_.font_size, escaped(mark.label));
    }
    labels_ = std::move(labels);
  }

  void series() {
    const bool overlaid = std::any_of(
        plot_.series.begin(), plot_.series.end(),
        [](const auto& one) { return look_of(one).line && one.origin == Origin::modelled; });
    for (const bool lines : {true, false}) {
      for (const auto& one : plot_.series) {
        if (look_of(one).line != lines) continue;
        SvgSeriesOptions how;
        // Inside a page whole pixels do for what is dense; a figure for a paper has tenths.
        how.digits = options_.standalone || one.x.size() <= kDenseSeries ? 1 : 0;
        how.beneath = overlaid && one.origin != Origin::modelled && look_of(one).shade != 2;
        how.scale = em_;
        draw_series(svg_, one, x_, y_, how);
      }
    }
  }

  void legend() {
    svg_ += labels_;
    double y = y_.from + 56 * em_;
    for (const auto& row : rows_) {
      double x = x_.from;
      for (const auto& entry : row) {
        svg_ += legend_key(*entry.series, x, y - 4 * em_, em_);
        text(x + 30 * em_, y, "start", entry.name);
        x += entry.width;
      }
      y += 20 * em_;
    }
  }

  const Plot& plot_;
  const SvgOptions& options_;
  double em_;  ///< size of the font against 12 px
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
  if (end == std::string::npos) return svg;
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + svg.substr(0, end + 1) +
         "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>" + svg.substr(end + 1);
}

SvgOptions print_size(double width_mm, double height_mm, const std::string& font, double size_pt) {
  SvgOptions options;
  options.width = width_mm * kPxPerMm;
  options.height = height_mm * kPxPerMm;
  options.font = font;
  options.font_size = size_pt * kPxPerPt;
  options.in_mm = true;
  return options;
}

std::string svg_plot(const Plot& plot, const SvgOptions& options) {
  return SvgFigure(plot, options).drawn();
}

std::string svg_sheet(const std::string& title, const std::vector<SvgPanel>& panels, double& width,
                      double& height) {
  constexpr double kTitle = 30, kGap = 14;
  width = height = 0;
  for (const auto& panel : panels) {
    width = std::max(width, panel.width);
    height += kTitle + panel.height + kGap;
  }
  std::string svg = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
      "viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" height=\"{1:g}\" font-family=\"sans-serif\" "
      "font-size=\"12\">\n<title>{2}</title>\n<rect width=\"100%\" height=\"100%\" "
      "fill=\"#fff\"/>\n",
      width, height, escaped(title));
  double y = 0;
  for (const auto& panel : panels) {
    svg += fmt::format(
        "<text x=\"12\" y=\"{:g}\" font-size=\"14\" font-weight=\"bold\" fill=\"#222\">{}</text>\n"
        "<g transform=\"translate(0 {:g})\">\n{}</g>\n",
        y + 20, escaped(panel.title), y + kTitle, panel.svg);
    y += kTitle + panel.height + kGap;
  }
  return svg + "</svg>\n";
}

}  // namespace rigfit::apps
