// HTML to PDF by a Chromium that is installed: the page as its print style sheet lays it out.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace rigfit::apps {

/// Path of a Chromium, Chrome or Edge on PATH; empty: none.
[[nodiscard]] std::string find_browser();

/// What to say where none is found.
inline constexpr std::string_view kNoBrowser =
    "no Chromium, Chrome or Edge is on PATH: no PDF is written. Install one (Debian: apt install "
    "chromium), or open report.html in any browser and print it";

/// Prints `page` to `pdf`, whole or not at all. Gives the reason where it failed, else nothing.
/// Takes two minutes at most.
[[nodiscard]] std::string print_pdf(const std::string& browser, const std::filesystem::path& page,
                                    const std::filesystem::path& pdf);

}  // namespace rigfit::apps
