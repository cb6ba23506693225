// Options of a verb, described once: the command line, its help and manual, and the
// keywords, checks and docstrings of the Python function are walks over the same list.
//
//   std::vector<Option> options_of(AxialCommand& c) {
//     return {option("--mass", c.mass, "Hung mass, adapter and clamp included", "kg").required()
//                 .positive(), ...};
//   }
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace rigfit::describe {

/// Two rising frequencies, Hz.
using Band = std::optional<std::pair<double, double>>;

/// Where a value goes: a member of the verb's options, whose content is the default.
using Target = std::variant<bool*, int*, long*, std::uint64_t*, double*, std::optional<double>*,
                            std::string*, std::vector<double>*, std::vector<std::string>*, Band*>;

struct Option {
  std::string name;  ///< "--mass"; without dashes: stands by its place
  Target target;
  std::string meaning, unit;
  double lowest = -HUGE_VAL, highest = HUGE_VAL;  ///< allowed range of numbers
  bool above_lowest = false;                      ///< `lowest` itself is not allowed
  std::vector<std::string> words;                 ///< the only ones allowed; empty: any
  int numbers = 0;                                ///< how many; 0: any
  std::string value_name;                         ///< in help: "HZ"
  std::string heading;                            ///< in help; empty: the usual one
  std::vector<std::string> not_with, only_with;   ///< other options
  bool is_required = false;
  bool is_file = false, is_written = false;  ///< a file that is there, one to write
  std::vector<std::string>* told = nullptr;  ///< gets the name when the option is given

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
  /// "flag", "integer", "number", "text", "numbers" or "texts".
  [[nodiscard]] const char* kind() const;
};

using Options = std::vector<Option>;

/// Keys of a file as options of a command line: "mass_per_length" is "--mass-per-length". What they
/// need or exclude counts where it is an option too.
[[nodiscard]] Options as_command_line(Options keys);

template <class T>
[[nodiscard]] Option option(std::string name, T& member, std::string meaning,
                            std::string unit = "") {
  Option made;
  made.name = std::move(name), made.target = &member;
  made.meaning = std::move(meaning), made.unit = std::move(unit);
  if constexpr (std::is_same_v<T, Band>) made.numbers = 2, made.lowest = 0, made.unit = "Hz";
  return made;
}

/// "from 0 to 1": the numbers allowed; empty: any finite one.
[[nodiscard]] std::string range_text(const Option& option);

}  // namespace rigfit::describe
