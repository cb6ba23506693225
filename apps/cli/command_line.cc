#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "apps/cli/usage.h"

namespace rigfit::apps {
namespace {

// CLI11's own checks let NaN pass and name limits with 300 digits.
CLI::Validator number_check(const describe::Option& option) {
  std::string wanted = option.highest != HUGE_VAL ? "number " + range_text(option)
                       : option.above_lowest      ? "positive number"
                       : option.lowest == 0       ? "number from zero up"
                                                  : "finite number";
  for (const auto& word : option.words) wanted += " or " + word;
  return {[wanted, option](std::string& text) {
            // A word in place of a number is a number without end: a rigid frame.
            if (std::find(option.words.begin(), option.words.end(), text) != option.words.end()) {
              text = "inf";
              return std::string();
            }
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
        } else if constexpr (std::is_same_v<decltype(member), describe::Band*>) {
          const auto take = [member, name = option.name](const std::vector<double>& ends) {
            if (ends[0] < ends[1]) return void(member->emplace(ends[0], ends[1]));
            throw UsageError(name + " must rise: two frequencies in Hz, the lower one first");
          };
          return app.add_option_function<std::vector<double>>(option.name, take);
        } else {
          return app.add_option(option.name, *member);
        }
      },
      option.target);
  if (option.is_required) added->required();
  if (option.numbers > 0) added->expected(option.numbers);
  if (option.is_file) added->check(CLI::ExistingFile);
  if (const std::string kind = option.kind(); kind.starts_with("number") || kind == "integer") {
    added->transform(number_check(option));
  } else if (!option.words.empty()) {
    added->check(CLI::IsMember(option.words));
  }
  return added;
}

/// "--mass 2.2,0.001" stands for "--mass 2.2 --mass-std 0.001" where there is such an option.
std::vector<std::string> std_apart(const describe::Options& options,
                                   const std::vector<std::string>& arguments) {
  const auto number = [&](const std::string& name) {
    return std::any_of(options.begin(), options.end(), [&](const auto& option) {
      return option.name == name && option.kind() == std::string("number");
    });
  };
  std::vector<std::string> apart;
  std::string name;
  for (const auto& text : arguments) {
    const auto equals = text.find('='), comma = text.find(',');
    const bool option = text.starts_with("--");
    if (option) name = text.substr(0, equals);
    if (comma != std::string::npos && number(name) && number(name + "-std")) {
      apart.push_back(text.substr(0, comma));
      apart.push_back(name + "-std=" + text.substr(comma + 1));
    } else {
      apart.push_back(text);
    }
    if (!option) name.clear();  // what follows is another value
  }
  return apart;
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
    const auto apart = std_apart(verb.options, arguments);
    app.parse(std::vector<std::string>(apart.rbegin(), apart.rend()));
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
