#include "apps/describe/option.h"

#include <fmt/format.h>

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

const char* Option::kind() const {
  constexpr const char* kKinds[] = {"flag",   "integer", "integer", "integer", "number",
                                    "number", "text",    "numbers", "texts"};
  return kKinds[target.index()];
}

std::string range_text(const Option& option) {
  if (option.lowest == -HUGE_VAL) return "";
  if (option.highest != HUGE_VAL)
    return fmt::format("from {:g} to {:g}", option.lowest, option.highest);
  return option.above_lowest ? "above zero" : "from zero up";
}

}  // namespace rigfit::describe
