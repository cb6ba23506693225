#include "apps/report/drawing/plot.h"

#include <fmt/compile.h>

#include "apps/report/drawing/html_text.h"

namespace rigfit::apps {

namespace {

// Colours: of words by origin, of series in figures by their number. Any two origins, and any two
// series, stay apart for readers with normal vision, deuteranopia and protanopia (distance in
// CIELAB of at least 20 under the matrices of Machado, Oliveira and Fernandes, IEEE Trans. Vis.
// Comput. Graph. 15 (2009) 1291). Contrast against the paper: words 4.5 : 1 (WCAG 2), series 3 : 1
// (WCAG 2.1, 1.4.11). The first four series have the hues of Okabe and Ito (Color Universal Design,
// 2008).
struct Colour {
  const char *on_light, *on_dark;  ///< "#rrggbb", on white and on #14181c
};

struct OriginLook {
  const char *name, *word;
  SeriesLook::Marker marker;
  Colour colour;
};
using Marker = SeriesLook::Marker;
/// By ident::Origin. A model's cross reaches out of a point that it lies on.
constexpr std::array<OriginLook, 5> kOrigins{
    {{"measured", "measured", Marker::circle, {"#0c54d6", "#8cbcf0"}},
     {"published test", "published", Marker::square, {"#128174", "#86efb8"}},
     {"published model", "published-model", Marker::square, {"#9a6b00", "#ffe14a"}},
     {"synthetic", "synthetic", Marker::diamond, {"#5c1a78", "#c06bff"}},
     {"rigfit model", "modelled", Marker::cross, {"#a31028", "#ff7043"}}}};
constexpr std::array<Colour, 6> kSeriesColours{{{"#0072b2", "#56b4e9"},
                                                {"#d55e00", "#ff8a3d"},
                                                {"#111111", "#f2f2f2"},
                                                {"#009e73", "#1fbf8f"},
                                                {"#7300e6", "#a855f7"},
                                                {"#6b2b00", "#fff04a"}}};

const OriginLook& look_by(Origin origin) { return kOrigins[static_cast<std::size_t>(origin)]; }

}  // namespace

const char* name_of(Origin origin) { return look_by(origin).name; }
const char* word_of(Origin origin) { return look_by(origin).word; }

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
  look.marker = series.x.size() > kManyPoints ? Marker::dot : look_by(series.origin).marker;
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
      for (const auto* column : {&series.y, &series.low, &series.high}) {
        text += ',';
        if (i < column->size()) cell((*column)[i]);
      }
      text += '\n';
    }
  }
  return text;
}

std::size_t palette_place(int number) {
  return static_cast<std::size_t>(number) % kSeriesColours.size();
}

const char* series_colour(int number) { return kSeriesColours[palette_place(number)].on_light; }

std::string palette_css() {
  std::string light, dark, classes;
  for (const auto& origin : kOrigins) {
    light += fmt::format("--{}:{};", origin.word, origin.colour.on_light);
    dark += fmt::format("--{}:{};", origin.word, origin.colour.on_dark);
    classes += fmt::format(".o-{0}{{color:var(--{0})}}", origin.word);
  }
  for (std::size_t k = 0; k < kSeriesColours.size(); ++k) {
    light += fmt::format("--s{}:{};", k, kSeriesColours[k].on_light);
    dark += fmt::format("--s{}:{};", k, kSeriesColours[k].on_dark);
    classes += fmt::format("svg .s{0}{{color:var(--s{0});stroke:var(--s{0});fill:var(--s{0})}}", k);
  }
  return fmt::format(
      ":root{{{0}}}\n@media (prefers-color-scheme:dark){{:root{{{1}}}}}\n@media "
      "print{{:root{{{0}}}}}\n{2}\n",
      light, dark, classes);
}

}  // namespace rigfit::apps
