#include "apps/report/drawing/palette.h"

#include <fmt/format.h>

#include "apps/report/drawing/plot.h"

namespace rigfit::apps {

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
