// Elements and attributes of XML by their names without namespace prefixes: "x:row" is "row".
#pragma once

#include <pugixml.hpp>
#include <string>
#include <string_view>

namespace rigfit::signal {

inline bool has_local_name(std::string_view name, std::string_view local) {
  return name == local || (name.ends_with(local) && name[name.size() - local.size() - 1] == ':');
}

inline pugi::xml_node local_child(const pugi::xml_node& node, std::string_view name) {
  return node.find_child([&](const auto& one) { return has_local_name(one.name(), name); });
}

/// A string with its runs of fonts put together; readings above characters (rPh) are left out.
inline std::string string_of(const pugi::xml_node& item) {
  std::string text;
  for (const auto& one : item.children()) {
    if (has_local_name(one.name(), "t")) text += one.text().get();
    if (has_local_name(one.name(), "r")) text += local_child(one, "t").text().get();
  }
  return text;
}

}  // namespace rigfit::signal
