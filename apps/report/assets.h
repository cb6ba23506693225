// What a report's page carries in itself, embedded when the program is built.
#pragma once

#include <string_view>

namespace rigfit::apps::assets {

extern const std::string_view dygraph_js;  ///< dygraphs 2, MIT licence
extern const std::string_view dygraph_css;
extern const std::string_view report_css;
extern const std::string_view plots_js;
extern const std::string_view shapes_js;

}  // namespace rigfit::apps::assets
