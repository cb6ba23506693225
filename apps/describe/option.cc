#include "apps/describe/option.h"

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>

namespace rigfit::describe {

std::string Option::default_text() const {
  return std::visit(
      [&](auto* member) -> std::string {
        using Value = std::remove_pointer_t<decltype(member)>;
        if constexpr (std::is_same_v<Value, std::string>) {
          return *member;
        } else if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>) {
          const auto value = static_cast<double>(*member);
          const bool meant = value != 0 && value >= lowest && value <= highest;
          return meant ? fmt::format("{:g}", value) : "";
        } else {
          return "";
        }
      },
      target);
}

Options as_command_line(Options keys) {
  const auto rename = [](std::string& name) {
    std::replace(name.begin(), name.end(), '_', '-');
    name.insert(0, "--");
  };
  std::vector<std::string> names;
  for (auto& key : keys) {
    rename(key.name);
    names.push_back(key.name);
  }
  const auto unknown = [&](const std::string& name) {
    return std::find(names.begin(), names.end(), name) == names.end();
  };
  for (auto& key : keys) {
    for (auto* others : {&key.not_with, &key.only_with}) {
      for (auto& other : *others) rename(other);
      std::erase_if(*others, unknown);
    }
  }
  return keys;
}

const char* Option::kind() const {
  constexpr const char* kKinds[] = {"flag",   "integer", "integer", "integer", "number",
                                    "number", "text",    "numbers", "texts",   "numbers"};
  return kKinds[target.index()];
}

std::string range_text(const Option& option) {
  if (option.lowest == -HUGE_VAL) return "";
  if (option.highest != HUGE_VAL)
    return fmt::format("from {:g} to {:g}", option.lowest, option.highest);
  return option.above_lowest ? "above zero" : "from zero up";
}

}  // namespace rigfit::describe
