#include "apps/report/drawing/palette.h"

#include <fmt/format.h>

#include "apps/report/drawing/plot.h"

namespace rigfit::apps {

std::string colour_of(ident::Origin origin, int shade) {
  std::string base = "#000000";
  for (const auto& one : kPalette) {
    if (one.origin == origin) base = one.on_light;
  }
  if (shade == 0) return base;
  const int towards = shade == 1 ? 0x22 : 0xff;
  std::string mixed = "#";
  for (std::size_t i = 1; i < 7; i += 2) {
    const int part = std::stoi(base.substr(i, 2), nullptr, 16);
    mixed += fmt::format("{:02x}", (6 * part + 4 * towards + 5) / 10);
  }
  return mixed;
}

std::string palette_css() {
  std::string light, dark, shades;
  for (const auto& one : kPalette) {
    const char* word = word_of(one.origin);
    light += fmt::format("--{}:{};", word, one.on_light);
    dark += fmt::format("--{}:{};", word, one.on_dark);
    for (const auto& [number, other] : {std::pair{1, "ink"}, std::pair{2, "paper"}}) {
      shades += fmt::format(".o-{0}.v{1}{{color:color-mix(in srgb,var(--{0}) 60%,var(--{2}))}}\n",
                            word, number, other);
    }
  }
  return fmt::format(
      ":root{{{0}}}\n@media (prefers-color-scheme:dark){{:root{{{1}}}}}\n@media "
      "print{{:root{{{0}}}}}\n{2}",
      light, dark, shades);
}

}  // namespace rigfit::apps
