// Files that are part of the program, embedded when it is built: what a report's page carries in
// itself and what `new` writes.
#pragma once

#include <string_view>

namespace rigfit::apps::assets {

extern const std::string_view report_css;
extern const std::string_view page_css;
extern const std::string_view page_js;
extern const std::string_view figures_js;
extern const std::string_view apps_readme;        ///< reference of keys, for `help`
extern const std::string_view new_campaign_toml;  ///< what `new` writes
extern const std::string_view new_cable_toml;
extern const std::string_view new_bending_csv;
extern const std::string_view new_frequencies_csv;

}  // namespace rigfit::apps::assets
