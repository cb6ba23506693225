#include "apps/cli/named_numbers.h"

#include "apps/cli/exit_code.h"
#include "signal/readers/csv_fields.h"

namespace rigfit::apps {
namespace {

/// Parts between commas; at least one.
std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts{""};
  for (const char c : text) c == ',' ? void(parts.emplace_back()) : parts.back().push_back(c);
  return parts;
}

}  // namespace

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
