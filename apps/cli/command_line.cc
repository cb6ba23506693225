#include "apps/cli/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "apps/cli/usage.h"

namespace rigfit::apps {
namespace {

// CLI11's own checks let NaN pass and name limits with 300 digits.
CLI::Validator number_check(const describe::Option& option) {
  const std::string wanted = option.highest != HUGE_VAL ? "number " + range_text(option)
                             : option.above_lowest      ? "positive number"
                             : option.lowest == 0       ? "number from zero up"
                                                        : "finite number";
  return {[wanted, option](std::string& text) {
            double x = 0;
            const bool read = CLI::detail::lexical_cast(text, x) && std::isfinite(x);
            const bool within = x <= option.highest &&
                                (option.above_lowest ? x > option.lowest : x >= option.lowest);
            return read && within ? std::string() : fmt::format("\"{}\" is no {}", text, wanted);
          },
          ""};
}

CLI::Option* add(CLI::App& app, const describe::Option& option) {
  CLI::Option* const added = std::visit(
      [&](auto* member) {
        if constexpr (std::is_same_v<decltype(member), bool*>) {
          return app.add_flag(option.name, *member);
        } else {
          return app.add_option(option.name, *member);
        }
      },
      option.target);
  if (option.is_required) added->required();
  if (option.numbers > 0) added->expected(option.numbers);
  if (!option.words.empty()) added->check(CLI::IsMember(option.words));
  if (option.is_file) added->check(CLI::ExistingFile);
  if (option.kind() == std::string("number") || option.kind() == std::string("numbers") ||
      option.kind() == std::string("integer")) {
    added->check(number_check(option));
  }
  return added;
}

}  // namespace

void parse_options(const Verb& verb, const std::vector<std::string>& arguments) {
  CLI::App app;
  app.set_help_flag();
  std::vector<CLI::Option*> added;
  for (const auto& option : verb.options) added.push_back(add(app, option));
  for (std::size_t k = 0; k < added.size(); ++k) {
    for (const auto& other : verb.options[k].not_with) added[k]->excludes(other);
    for (const auto& other : verb.options[k].only_with) added[k]->needs(app.get_option(other));
  }
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::ParseError& error) {
    const auto known = names_of(verb.options);
    for (const auto& text : arguments) {
      if (text.size() < 3 || !text.starts_with("--")) continue;
      const std::string name = text.substr(0, text.find('='));
      if (std::find(known.begin(), known.end(), name) != known.end()) continue;
      throw UsageError(
          fmt::format("rigfit {} has no option {}{}\nrigfit help {} lists its options.", verb.name,
                      name, did_you_mean(name, known), verb.name));
    }
    throw UsageError(
        fmt::format("{}\nrigfit help {} says how it is used.", error.what(), verb.name));
  }
  for (std::size_t k = 0; k < added.size(); ++k) {
    if (verb.options[k].told != nullptr && added[k]->count() > 0) {
      verb.options[k].told->push_back(verb.options[k].name);
    }
  }
}

}  // namespace rigfit::apps
