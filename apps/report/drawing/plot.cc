#include "apps/report/drawing/plot.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>

namespace rigfit::apps {

const char* name_of(Origin origin) {
  switch (origin) {
    case Origin::measured:
      return "measured";
    case Origin::published:
      return "published test";
    case Origin::published_model:
      return "published model";
    case Origin::synthetic:
      return "synthetic";
    case Origin::modelled:
      return "rigfit model";
  }
  return "";
}

const char* word_of(Origin origin) {
  switch (origin) {
    case Origin::measured:
      return "measured";
    case Origin::published:
      return "published";
    case Origin::published_model:
      return "published-model";
    case Origin::synthetic:
      return "synthetic";
    case Origin::modelled:
      return "modelled";
  }
  return "";
}

SeriesLook look_of(const PlotSeries& series) {
  using Marker = SeriesLook::Marker;
  constexpr std::size_t kManyPoints = 150;  // as dots from here on
  constexpr std::size_t kManyNodes = 400;   // of a line: dashes would be lost in its wiggles
  SeriesLook look;
  const auto variant = static_cast<std::size_t>(series.variant);
  look.shade = static_cast<int>(variant % 3);
  look.line = series.style != PlotSeries::Style::points;
  if (series.style == PlotSeries::Style::dashed) {
    look.dash = {6, 4};
  } else if (look.line && series.x.size() <= kManyNodes) {
    const std::array<std::vector<double>, 4> dashes{{{}, {9, 3}, {2, 3}, {9, 3, 2, 3}}};
    look.dash = dashes[variant % dashes.size()];
  }
  if (series.style != PlotSeries::Style::points &&
      series.style != PlotSeries::Style::line_and_points) {
    return look;
  }
  if (series.x.size() > kManyPoints) {
    look.marker = Marker::dot;
  } else if (series.origin == Origin::modelled) {  // reaches out of a point that it lies on
    const std::array<Marker, 4> markers{Marker::plus, Marker::cross, Marker::circle,
                                        Marker::diamond};
    look.marker = markers[variant % markers.size()];
    look.hollow = true;
  } else if (series.origin == Origin::published_model) {
    const std::array<Marker, 4> markers{Marker::square, Marker::diamond, Marker::triangle,
                                        Marker::circle};
    look.marker = markers[variant % markers.size()];
    look.hollow = true;
  } else {
    const std::array<Marker, 4> markers{Marker::circle, Marker::square, Marker::triangle,
                                        Marker::diamond};
    look.marker = markers[variant % markers.size()];
    look.hollow = variant % 2 == 1;
  }
  return look;
}

const char* word_of(SeriesLook::Marker marker) {
  using Marker = SeriesLook::Marker;
  switch (marker) {
    case Marker::none:
      return "none";
    case Marker::dot:
      return "dot";
    case Marker::circle:
      return "circle";
    case Marker::square:
      return "square";
    case Marker::triangle:
      return "triangle";
    case Marker::diamond:
      return "diamond";
    case Marker::plus:
      return "plus";
    case Marker::cross:
      return "cross";
  }
  return "";
}

std::string plot_csv(const Plot& plot) {
  const auto quoted = [](const std::string& text) {
    std::string result = "\"";
    for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
    return result + "\"";
  };
  std::string text =
      fmt::format("series,origin,{},{},low,high\n", quoted(plot.x_label), quoted(plot.y_label));
  const auto out = std::back_inserter(text);
  const auto cell = [&](double value) {
    if (std::isfinite(value)) fmt::format_to(out, FMT_COMPILE("{}"), value);
  };
  for (const auto& series : plot.series) {
    const std::string head = fmt::format("{},{},", quoted(series.name), word_of(series.origin));
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      text += head;
      cell(series.x[i]);
      text += ',';
      cell(series.y[i]);
      text += ',';
      if (i < series.low.size()) cell(series.low[i]);
      text += ',';
      if (i < series.high.size()) cell(series.high[i]);
      text += '\n';
    }
  }
  return text;
}

}  // namespace rigfit::apps
