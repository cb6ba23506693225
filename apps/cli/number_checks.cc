#include "apps/cli/number_checks.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <string>

namespace rigfit::apps {
namespace {

CLI::Validator number_check(const std::string& description, const std::string& wanted,
                            const std::function<bool(double)>& good) {
  return {[wanted, good](std::string& text) {
            double value = 0;
            const bool read = CLI::detail::lexical_cast(text, value);
            return read && std::isfinite(value) && good(value)
                       ? std::string()
                       : fmt::format("\"{}\" is no {}", text, wanted);
          },
          description};
}

}  // namespace

CLI::Validator positive_number() {
  return number_check("POSITIVE", "positive number", [](double x) { return x > 0; });
}

CLI::Validator not_negative_number() {
  return number_check("NONNEGATIVE", "number from zero up", [](double x) { return x >= 0; });
}

CLI::Validator number_within(double low, double high) {
  return number_check(fmt::format("FLOAT in [{:g} - {:g}]", low, high),
                      fmt::format("number from {:g} to {:g}", low, high),
                      [low, high](double x) { return x >= low && x <= high; });
}

}  // namespace rigfit::apps
