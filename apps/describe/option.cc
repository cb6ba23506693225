#include "apps/describe/option.h"

#include "document/toml_table.h"

namespace rigfit::describe {
namespace {

/// Why one value cannot be taken; empty: it can.
std::string misfit_of(const Option& option, const Json& value) {
  const bool text = option.kind == Kind::text || option.kind == Kind::texts;
  const bool word = value.is_string() && std::count(option.words.begin(), option.words.end(),
                                                    value.get<std::string>()) > 0;
  if (word || (option.kind == Kind::flag && value.is_boolean())) return "";
  if (text && value.is_string()) {
    if (option.words.empty()) return "";
    const auto nearest = document::nearest_word(value, option.words);
    return fmt::format("\"{}\" is none of {}{}", value.get<std::string>(), option.wanted(),
                       nearest ? "; did you mean \"" + *nearest + "\"?" : "");
  }
  if (value.is_number() && !text && option.kind != Kind::flag) {
    const double x = value.get<double>();
    const bool whole = option.kind != Kind::integer || value.is_number_integer();
    const bool high_enough = option.above_lowest ? x > option.lowest : x >= option.lowest;
    if (whole && std::isfinite(x) && high_enough && x <= option.highest) return "";
  }
  const std::string shown = value.is_number()
                                ? fmt::format("{}", value.get<double>())
                                : value.dump(-1, ' ', false, Json::error_handler_t::replace);
  return shown + " is no " + option.wanted();
}

}  // namespace

const char* name_of(Kind kind) {
  constexpr const char* kNames[] = {"flag", "integer", "number", "text", "numbers", "texts"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::string Option::default_text() const {
  if (initial.is_string()) return initial;
  const double value = initial.is_number() ? initial.get<double>() : 0;
  return value != 0 && value >= lowest && value <= highest ? fmt::format("{:g}", value) : "";
}

std::string Option::wanted() const {
  if (kind == Kind::flag) return "true or false";
  if (kind == Kind::text || kind == Kind::texts) {
    return words.empty() ? "text" : fmt::format("{}", fmt::join(words, ", "));
  }
  std::string text = kind == Kind::integer ? "whole " : "";
  text += std::isfinite(highest) ? fmt::format("number from {:g} to {:g}", lowest, highest)
          : above_lowest         ? "positive number"
          : lowest == 0          ? "number from zero up"
                                 : "finite number";
  return words.empty() ? text : fmt::format("{} or {}", text, fmt::join(words, " or "));
}

std::string Option::fill(const Json& given) const {
  const Json list = given.is_array() ? given : Json::array({given});
  if (is_list() && list.empty()) return "is empty: name one or more";
  if (numbers > 0 && list.size() != static_cast<std::size_t>(numbers)) {
    return fmt::format("must be {} numbers", numbers);
  }
  if (!is_list() && given.is_array()) return fmt::format("is a list, and no {}", wanted());
  for (const Json& one : list) {
    if (auto misfit = misfit_of(*this, one); !misfit.empty()) return misfit;
    if (each_once && std::count(list.begin(), list.end(), one) > 1) {
      return fmt::format("\"{}\" is given twice: name each once", one.get<std::string>());
    }
  }
  if (rising && !(list[0] < list[1])) {
    return "must rise: two frequencies in Hz, the lower one first";
  }
  set(is_list() ? list : given);
  return "";
}

std::optional<Misfit> fill(const Options& options, const Json& given,
                           const std::function<bool(const std::string&)>& has) {
  const auto there = [&](const std::string& name) { return given.contains(name) || has(name); };
  for (const auto& option : options) {
    if (!given.contains(option.name)) {
      if (option.is_required) return Misfit{option.name, "is missing: give " + option.text()};
      continue;
    }
    for (const auto& other : option.not_with) {
      if (there(other))
        return Misfit{option.name, "is given beside " + other + "; keep one of them"};
    }
    for (const auto& other : option.only_with) {
      if (!there(other)) return Misfit{option.name, "is given without " + other + ": add it"};
    }
    if (auto problem = option.fill(given[option.name]); !problem.empty()) {
      return Misfit{option.name, std::move(problem)};
    }
  }
  return std::nullopt;
}

std::string on_command_line(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return "--" + name;
}

Options as_command_line(Options keys) {
  for (auto& key : keys) key.name = on_command_line(key.name);
  for (auto& key : keys) {
    for (auto* others : {&key.not_with, &key.only_with}) {
      for (auto& other : *others) other = on_command_line(other);
      std::erase_if(*others, [&](const std::string& name) {
        return std::ranges::find(keys, name, &Option::name) == keys.end();
      });
    }
  }
  return keys;
}

}  // namespace rigfit::describe
