#include "apps/report/drawing/plot.h"

#include <fmt/compile.h>

#include "apps/report/drawing/html_text.h"
#include "apps/report/drawing/palette.h"

namespace rigfit::apps {

namespace {

struct OriginWords {
  const char *name, *word;
  SeriesLook::Marker marker;
};
using Marker = SeriesLook::Marker;
/// By ident::Origin. A model's cross reaches out of a point that it lies on.
constexpr std::array<OriginWords, 5> kOrigins{
    {{"measured", "measured", Marker::circle},
     {"published test", "published", Marker::square},
     {"published model", "published-model", Marker::square},
     {"synthetic", "synthetic", Marker::diamond},
     {"rigfit model", "modelled", Marker::cross}}};

const OriginWords& words_of(Origin origin) { return kOrigins[static_cast<std::size_t>(origin)]; }

}  // namespace

const char* name_of(Origin origin) { return words_of(origin).name; }
const char* word_of(Origin origin) { return words_of(origin).word; }

SeriesLook look_of(const PlotSeries& series, bool overlaid) {
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
  look.marker = series.x.size() > kManyPoints ? Marker::dot : words_of(series.origin).marker;
  look.hollow = look.marker != Marker::dot && series.origin == Origin::published_model;
  return look;
}

PlotSeries& Plot::named(const std::string& name, Origin origin, PlotSeries::Style style) {
  const auto at = std::ranges::find(series, name, &PlotSeries::name);
  if (at != series.end()) return *at;
  return series.emplace_back(PlotSeries{name, origin, static_cast<int>(series.size()), style});
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

const char* series_colour(int number) {
  return kSeriesColours[static_cast<std::size_t>(number) % kSeriesColours.size()].on_light;
}

std::string palette_css() {
  std::string light, dark, series;
  for (const Origin origin : {Origin::measured, Origin::published, Origin::published_model,
                              Origin::synthetic, Origin::modelled}) {
    const Colour& colour = kOriginColours[static_cast<std::size_t>(origin)];
    light += fmt::format("--{}:{};", word_of(origin), colour.on_light);
    dark += fmt::format("--{}:{};", word_of(origin), colour.on_dark);
  }
  for (std::size_t k = 0; k < kSeriesColours.size(); ++k) {
    light += fmt::format("--s{}:{};", k, kSeriesColours[k].on_light);
    dark += fmt::format("--s{}:{};", k, kSeriesColours[k].on_dark);
    series += fmt::format("svg .s{0}{{color:var(--s{0});stroke:var(--s{0});fill:var(--s{0})}}", k);
  }
  return fmt::format(
      ":root{{{0}}}\n@media (prefers-color-scheme:dark){{:root{{{1}}}}}\n@media "
      "print{{:root{{{0}}}}}\n{2}\n",
      light, dark, series);
}

}  // namespace rigfit::apps
