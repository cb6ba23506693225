// Colours of figures by origin: one list for SVG, page and script. Any two stay apart for readers
// with normal vision, deuteranopia and protanopia (distance in CIELAB of at least 20 under the
// matrices of Machado, Oliveira and Fernandes, IEEE Trans. Vis. Comput. Graph. 15 (2009) 1291), and
// each has a contrast of 4.5 : 1 against its paper (WCAG 2, text).
#pragma once

#include <array>
#include <string>

#include "ident/campaign/single_tests/origin.h"

namespace rigfit::apps {

struct OriginColour {
  ident::Origin origin = ident::Origin::measured;
  const char* on_light = "";  ///< "#rrggbb", on white
  const char* on_dark = "";   ///< on kDarkPaper
};
inline constexpr const char* kDarkPaper = "#14181c";

inline constexpr std::array<OriginColour, 5> kPalette{
    {{ident::Origin::measured, "#0c54d6", "#8cbcf0"},
     {ident::Origin::published, "#128174", "#86efb8"},
     {ident::Origin::published_model, "#9a6b00", "#ffe14a"},
     {ident::Origin::synthetic, "#5c1a78", "#c06bff"},
     {ident::Origin::modelled, "#a31028", "#ff7043"}}};

/// Shares of the origin's colour in its two shades: the rest is ink or paper. As light as a shade
/// may be with a contrast of 3 : 1 against its paper (WCAG 2.1, 1.4.11).
inline constexpr double kTowardsInk = 0.7, kTowardsPaper = 0.75;

/// On white, "#rrggbb"; `shade` as in SeriesLook.
[[nodiscard]] std::string colour_of(ident::Origin origin, int shade = 0);

/// Style sheet with a custom property per origin (--measured ...), for light and dark screens and
/// for print.
[[nodiscard]] std::string palette_css();

}  // namespace rigfit::apps
