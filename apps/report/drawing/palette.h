// Colours: of words by origin, of series in figures by their number. Any two origins, and any two
// series, stay apart for readers with normal vision, deuteranopia and protanopia (distance in
// CIELAB of at least 20 under the matrices of Machado, Oliveira and Fernandes, IEEE Trans. Vis.
// Comput. Graph. 15 (2009) 1291). Contrast against the paper: words 4.5 : 1 (WCAG 2), series 3 : 1
// (WCAG 2.1, 1.4.11). The first four series have the hues of Okabe and Ito (Color Universal Design,
// 2008).
#pragma once

#include <array>
#include <string>

#include "ident/campaign/single_tests/test_recording.h"

namespace rigfit::apps {

struct Colour {
  const char* on_light = "";  ///< "#rrggbb", on white
  const char* on_dark = "";   ///< on kDarkPaper
};
inline constexpr const char* kDarkPaper = "#14181c";

/// By ident::Origin: measured, published, published model, synthetic, modelled.
inline constexpr std::array<Colour, 5> kOriginColours{{{"#0c54d6", "#8cbcf0"},
                                                       {"#128174", "#86efb8"},
                                                       {"#9a6b00", "#ffe14a"},
                                                       {"#5c1a78", "#c06bff"},
                                                       {"#a31028", "#ff7043"}}};
inline constexpr std::array<Colour, 6> kSeriesColours{{{"#0072b2", "#56b4e9"},
                                                       {"#d55e00", "#ff8a3d"},
                                                       {"#111111", "#f2f2f2"},
                                                       {"#009e73", "#1fbf8f"},
                                                       {"#7300e6", "#a855f7"},
                                                       {"#6b2b00", "#fff04a"}}};

/// On white; numbers beyond the list begin again.
[[nodiscard]] const char* series_colour(int number);

/// Style sheet with a custom property per origin (--measured ...) and classes .s0 .s1 ... for
/// series, for light and dark screens and for print.
[[nodiscard]] std::string palette_css();

}  // namespace rigfit::apps
