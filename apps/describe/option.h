// Options of a verb, described once: the command line, its help and manual, the keys of a campaign
// and the keywords and docstrings of the Python function are walks over the same list, and all of
// them fill it in the same way.
//
//   std::vector<Option> options_of(AxialCommand& c) {
//     return {option("--mass", c.mass, "Hung mass, adapter and clamp included", "kg").required()
//                 .positive(), ...};
//   }
#pragma once

#include <type_traits>

#include "apps/describe/json_of.h"

namespace rigfit::describe {

/// Two rising frequencies, Hz.
using Band = std::optional<std::pair<double, double>>;

enum class Kind { flag, integer, number, text, numbers, texts };
[[nodiscard]] const char* name_of(Kind kind);

// NOLINTNEXTLINE(bugprone-exception-escape): a move of JSON only asserts
struct Option {
  std::string name;  ///< "--mass"; without dashes: stands by its place
  Kind kind = Kind::text;
  std::function<void(const Json&)> set;  ///< puts a value where it goes; see `fill`
  Json initial;                          ///< what it is without the option, a number or a text
  std::string meaning, unit;
  double lowest = -HUGE_VAL, highest = HUGE_VAL;  ///< allowed range of numbers
  bool above_lowest = false;                      ///< `lowest` itself is not allowed
  std::vector<std::string> words;                 ///< the only ones allowed; empty: any
  int numbers = 0;                                ///< how many; 0: any
  bool rising = false;                            ///< the second of two numbers is larger
  std::string value_name;                         ///< in help: "HZ"
  std::string heading;                            ///< in help; empty: the usual one
  std::vector<std::string> not_with, only_with;   ///< other options
  bool is_required = false;
  bool is_file = false, is_written = false;  ///< a file that is there, one to write
  bool each_once = false;                    ///< no entry of a list twice

  Option required() { return is_required = true, std::move(*this); }
  Option positive() { return lowest = 0, above_lowest = true, std::move(*this); }
  Option from_zero() { return lowest = 0, std::move(*this); }
  Option within(double low, double high) { return lowest = low, highest = high, std::move(*this); }
  Option one_of(std::vector<std::string> allowed) {
    return words = std::move(allowed), std::move(*this);
  }
  Option count(int n) { return numbers = n, std::move(*this); }
  Option type(std::string shown) { return value_name = std::move(shown), std::move(*this); }
  Option group(std::string title) { return heading = std::move(title), std::move(*this); }
  Option writes() { return is_written = true, std::move(*this); }
  Option file() { return is_file = true, std::move(*this); }  ///< that is there to be read
  Option once() { return each_once = true, std::move(*this); }
  Option excludes(std::string other) {
    return not_with.push_back(std::move(other)), std::move(*this);
  }
  Option needs(std::string other) {
    return only_with.push_back(std::move(other)), std::move(*this);
  }

  /// "Hung mass, adapter and clamp included, kg".
  [[nodiscard]] std::string text() const {
    return meaning + (meaning.empty() || unit.empty() ? "" : ", ") + unit;
  }
  /// What holds without the option, in words; empty: nothing worth saying.
  [[nodiscard]] std::string default_text() const;
  /// "positive number", "whole number from 1 to 9".
  [[nodiscard]] std::string wanted() const;
  [[nodiscard]] bool is_list() const { return kind == Kind::numbers || kind == Kind::texts; }
  /// Takes a value, one alone for a list too. Returns why it cannot; empty: it has.
  [[nodiscard]] std::string fill(const Json& given) const;
};

using Options = std::vector<Option>;

/// What is wrong with the value of an option, or with its absence.
struct Misfit {
  std::string name, problem;
};
/// Fills all options from an object of values by their names. `has`: whether something else is
/// given that options need or exclude.
[[nodiscard]] std::optional<Misfit> fill(
    const Options& options, const Json& given,
    const std::function<bool(const std::string&)>& has = [](const auto&) { return false; });

/// "--mass-per-length" of "mass_per_length".
[[nodiscard]] std::string on_command_line(std::string name);

/// Keys of a file as options of a command line. What they need or exclude counts where it is an
/// option too.
[[nodiscard]] Options as_command_line(Options keys);

/// Into a flag, number, text, list of them, or an optional one; in place of an optional number a
/// word stands for one without end.
template <class T>
[[nodiscard]] Option option(std::string name, T& member, std::string meaning,
                            std::string unit = "") {
  using Value = typename Held<T>::type;
  Option made;
  made.name = std::move(name), made.meaning = std::move(meaning), made.unit = std::move(unit);
  if constexpr (std::is_same_v<T, Band>) {
    made.kind = Kind::numbers, made.numbers = 2, made.rising = true;
    made.lowest = 0, made.unit = "Hz";
  } else {
    made.kind = std::is_same_v<Value, bool>                  ? Kind::flag
                : std::is_integral_v<Value>                  ? Kind::integer
                : std::is_floating_point_v<Value>            ? Kind::number
                : std::is_same_v<Value, std::string>         ? Kind::text
                : std::is_same_v<Value, std::vector<double>> ? Kind::numbers
                                                             : Kind::texts;
  }
  if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) made.initial = member;
  made.set = [&member](const Json& given) {
    if constexpr (std::is_same_v<Value, double>) {
      member = given.is_string() ? HUGE_VAL : given.get<double>();
    } else {
      member = given.get<Value>();
    }
  };
  return made;
}

/// A text, or each of several, that `take` puts where it goes in another form.
[[nodiscard]] inline Option converted(std::string name,
                                      std::function<void(const std::string&)> take,
                                      std::string meaning, Kind kind = Kind::text) {
  std::string none;
  Option made = option(std::move(name), none, std::move(meaning));
  made.kind = kind;
  made.set = [take = std::move(take)](const Json& given) {
    for (const Json& text : given.is_array() ? given : Json::array({given})) take(text);
  };
  return made;
}

/// A band whose ends are members by themselves.
[[nodiscard]] inline Option band(std::string name, double& low, double& high, std::string meaning) {
  Band none;
  Option made = option(std::move(name), none, std::move(meaning));
  made.set = [&low, &high](const Json& ends) { low = ends[0], high = ends[1]; };
  return made;
}

/// A word for each value of an enumeration, or of no and yes, in their order; of an optional one
/// the first word leaves it open.
template <class T>
[[nodiscard]] Option choice(std::string name, T& member, std::vector<std::string> words,
                            std::string meaning) {
  using Value = typename Held<T>::type;
  Option made;
  made.name = std::move(name), made.meaning = std::move(meaning), made.words = words;
  constexpr bool optional = !std::is_same_v<T, Value>;
  if constexpr (optional) {
    made.initial = words[member ? static_cast<std::size_t>(*member) + 1 : 0];
  } else {
    made.initial = words[static_cast<std::size_t>(member)];
  }
  made.set = [&member, words = std::move(words)](const Json& word) {
    auto place = std::find(words.begin(), words.end(), word.get<std::string>()) - words.begin();
    if (optional && place == 0) {
      member = T();
    } else {
      member = static_cast<Value>(optional ? place - 1 : place);
    }
  };
  return made;
}

}  // namespace rigfit::describe

namespace rigfit::apps {
using describe::band, describe::choice, describe::converted, describe::option;
}  // namespace rigfit::apps
