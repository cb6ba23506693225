
#include <CLI/CLI.hpp>

#include "apps/cli/verb.h"
#include "signal/readers/csv_fields.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {
using describe::Kind;
using describe::Option;

/// The number that a text is, else the text.
Json number_or_text(const std::string& text) {
  std::int64_t whole = 0;
  double x = 0;
  if (CLI::detail::lexical_cast(text, whole)) return whole;
  if (CLI::detail::lexical_cast(text, x) && std::isfinite(x)) return x;
  return text;
}

/// Takes what is given for an option. "--mass 2.2,0.001" stands for "--mass 2.2 --mass-std 0.001"
/// where there is such an option.
void take(const Verb& verb, const Option& option, CLI::results_t texts, Json& given) {
  if (option.kind == Kind::text || option.kind == Kind::texts) {
    given[option.name] = option.is_list() ? Json(texts) : Json(texts[0]);
    return;
  }
  const std::string std_name = option.name + "-std";
  const auto comma = texts[0].find(',');
  const bool has_std =
      std::ranges::find(verb.options, std_name, &Option::name) != verb.options.end();
  if (option.kind == Kind::number && has_std && comma != std::string::npos) {
    given[std_name] = number_or_text(texts[0].substr(comma + 1));
    texts[0].resize(comma);
  }
  Json numbers = Json::array();
  for (const auto& text : texts) numbers.push_back(number_or_text(text));
  given[option.name] = option.is_list() ? std::move(numbers) : std::move(numbers[0]);
}

/// Refuses outputs that have no folder or lie in one file. Devices and pipes may take several.
void check_outputs(const Verb& verb, const Json& given) {
  std::map<fs::path, std::string> taken;
  for (const auto& option : verb.options) {
    if (!option.is_written || !given.contains(option.name)) continue;
    const std::string file = given[option.name];
    if (file.empty() || file == "-") continue;
    std::error_code fault, none;
    const auto path = fs::weakly_canonical(fs::absolute(file), fault);
    const auto kind = fs::status(file, none).type();
    const bool folder = kind == fs::file_type::directory;
    const bool circle = fault == std::errc::too_many_symbolic_link_levels;
    if (folder || !fs::is_directory(path.parent_path(), none)) {
      throw OutputError(fmt::format("cannot write {}: {}; name another file", file,
                                    circle ? fault.message()
                                    : folder
                                        ? "it is a folder"
                                        : "there is no folder " + path.parent_path().string()));
    }
    if (kind != fs::file_type::not_found && kind != fs::file_type::regular) continue;
    if (const auto [at, is_new] = taken.emplace(path, option.name); !is_new) {
      throw UsageError(at->second + " and " + option.name + " name one file, " + file +
                       "; give each its own");
    }
  }
}

/// Parts between commas; at least one.
std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts{""};
  for (const char c : text) c == ',' ? void(parts.emplace_back()) : parts.back().push_back(c);
  return parts;
}

}  // namespace

void parse_options(const Verb& verb, const std::vector<std::string>& arguments) {
  CLI::App app;
  app.set_help_flag();
  Json given = Json::object();
  for (const auto& option : verb.options) {
    if (option.kind == Kind::flag) {
      app.add_flag_callback(option.name, [&] { given[option.name] = true; });
      continue;
    }
    auto* const added = app.add_option(option.name, [&](const CLI::results_t& texts) {
      take(verb, option, texts, given);
      return true;
    });
    if (option.is_list()) {
      added->expected(option.numbers > 0 ? option.numbers : CLI::detail::expected_max_vector_size);
    }
    if (option.is_required) added->required();
    if (option.is_file) added->check(CLI::ExistingFile);
  }
  const std::string usage = "\nrigfit help " + verb.name;
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::ParseError& error) {
    const auto known = names_of(verb.options);
    for (const auto& text : arguments) {
      if (text.size() < 3 || !text.starts_with("--")) continue;
      const std::string name = text.substr(0, text.find('='));
      if (std::ranges::find(known, name) != known.end()) continue;
      throw UsageError(fmt::format("rigfit {} has no option {}{}{} lists its options.", verb.name,
                                   name, did_you_mean(name, known), usage));
    }
    throw UsageError(error.what() + usage + " says how it is used.");
  }
  if (const auto misfit = describe::fill(verb.options, given)) {
    throw UsageError(
        fmt::format("{}: {}{} says how it is used.", misfit->name, misfit->problem, usage));
  }
  check_outputs(verb, given);
}

std::pair<std::string, std::string> named_text(const std::string& option, const std::string& text,
                                               const std::string& form, bool may_be_empty) {
  const auto equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0 || (!may_be_empty && text.ends_with('='))) {
    throw UsageError(fmt::format("{}: write {}, not \"{}\"", option, form, text));
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

NamedNumbers named_numbers(const std::string& option, const std::string& text,
                           const std::string& form, std::size_t fewest, std::size_t most,
                           bool percent) {
  const std::string wanted = form + " with a positive number at its end";
  const auto [name, list] = named_text(option, text, wanted);
  NamedNumbers found{name, {}};
  bool good = true;
  for (std::string part : parts_of(list)) {
    if (percent && part.ends_with('%')) part.pop_back(), found.relative = true;
    double number = 0;
    good = good && signal::parse_whole_number(part, '.', number) && std::isfinite(number);
    found.numbers.push_back(found.relative ? number / 100 : number);
  }
  const auto count = found.numbers.size();
  good = good && count >= fewest && count <= most && (!found.relative || count == 1);
  if (!good || !(found.numbers.back() > 0)) {
    throw UsageError(fmt::format("{}: write {}, not \"{}\"", option, wanted, text));
  }
  return found;
}

SignedNames signed_names(const std::string& option, const std::string& text) {
  SignedNames found;
  for (auto& name : parts_of(text)) {
    found.signs.push_back(name.starts_with('-') ? -1 : 1);
    if (name.starts_with('-')) name.erase(0, 1);
    if (name.empty()) throw UsageError(fmt::format("{}: an empty name in \"{}\"", option, text));
    found.names.push_back(std::move(name));
  }
  return found;
}

}  // namespace rigfit::apps
