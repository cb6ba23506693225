#include "apps/report/drawing/plot.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "apps/report/drawing/html_text.h"

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

SeriesLook look_of(const PlotSeries& series, bool overlaid) {
  using Marker = SeriesLook::Marker;
  using Style = PlotSeries::Style;
  constexpr std::size_t kManyPoints = 150;  // as dots from here on
  SeriesLook look;
  look.line = series.style != Style::points;
  if (series.style == Style::dashed) {
    look.dash = "2 3";
  } else if (overlaid && series.origin == Origin::modelled) {
    look.dash = "7 3";
  } else if (series.origin == Origin::published_model) {
    look.dash = "9 3 2 3";
  }
  if (series.style == Style::line || series.style == Style::dashed) return look;
  if (series.x.size() > kManyPoints) {
    look.marker = Marker::dot;
    return look;
  }
  switch (series.origin) {
    case Origin::measured:
      look.marker = Marker::circle;
      break;
    case Origin::synthetic:
      look.marker = Marker::diamond;
      break;
    case Origin::published:
      look.marker = Marker::square;
      break;
    case Origin::published_model:
      look.marker = Marker::square;
      look.hollow = true;
      break;
    case Origin::modelled:  // reaches out of a point that it lies on
      look.marker = Marker::cross;
      break;
  }
  return look;
}

std::string plot_csv(const Plot& plot) {
  std::string text = fmt::format("series,origin,{},{},low,high\n", csv_quoted(plot.x_label),
                                 csv_quoted(plot.y_label));
  const auto out = std::back_inserter(text);
  const auto cell = [&](double value) {
    if (std::isfinite(value)) fmt::format_to(out, FMT_COMPILE("{}"), value);
  };
  for (const auto& series : plot.series) {
    const std::string head = fmt::format("{},{},", csv_quoted(series.name), word_of(series.origin));
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
