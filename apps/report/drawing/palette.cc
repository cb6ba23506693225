#include "apps/report/drawing/palette.h"

#include <fmt/format.h>

#include <cmath>
#include <tuple>

#include "apps/report/drawing/plot.h"

namespace rigfit::apps {

std::string colour_of(ident::Origin origin, int shade) {
  std::string base = "#000000";
  for (const auto& one : kPalette) {
    if (one.origin == origin) base = one.on_light;
  }
  if (shade == 0) return base;
  constexpr std::array<int, 3> kInk{0x1d, 0x23, 0x28};
  const double share = shade == 1 ? kTowardsInk : kTowardsPaper;
  std::string mixed = "#";
  for (std::size_t k = 0; k < 3; ++k) {
    const int part = std::stoi(base.substr(1 + 2 * k, 2), nullptr, 16);
    mixed += fmt::format("{:02x}", std::lround(std::lerp(shade == 1 ? kInk[k] : 255, part, share)));
  }
  return mixed;
}

std::string palette_css() {
  std::string light, dark, shades;
  for (const auto& one : kPalette) {
    const char* word = word_of(one.origin);
    light += fmt::format("--{}:{};", word, one.on_light);
    dark += fmt::format("--{}:{};", word, one.on_dark);
    for (const auto& [number, share, other] :
         {std::tuple{1, kTowardsInk, "ink"}, std::tuple{2, kTowardsPaper, "paper"}}) {
      shades +=
          fmt::format(".o-{0}.v{1}{{color:color-mix(in srgb,var(--{0}) {2:g}%,var(--{3}))}}\n",
                      word, number, 100 * share, other);
    }
  }
  light += fmt::format("--towards-ink:{:g};--towards-paper:{:g};", kTowardsInk, kTowardsPaper);
  return fmt::format(
      ":root{{{0}}}\n@media (prefers-color-scheme:dark){{:root{{{1}}}}}\n@media "
      "print{{:root{{{0}}}}}\n{2}",
      light, dark, shades);
}

}  // namespace rigfit::apps
