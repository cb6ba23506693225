// A result's fields, described once beside its struct: key, how to get it, unit, label, meaning.
//
//   template <>
//   struct rigfit::describe::Described<Length> {
//     static constexpr std::string_view title = "by length";
//     static constexpr auto fields = std::tuple{
//         field("length_m", &Length::length_m, "m", "length", "between the grips"),
//         field("EA_N", &Length::EA_N, "N", "EA", "axial rigidity of this length alone")};
//   };
//
// JSON, its schema, tables of text and CSV, the report's tables and Python's repr are walks over
// `fields` (apps/describe); a new field is written in the struct and here. A field is a data member
// or any function of the struct: a nested struct that is described, a list, an estimate (value,
// std), an optional one. An empty label: for programs only; an empty key: for people only. The
// unit "%" is that of a ratio which people read in per cent; `digits` are those of a number that
// has no std of its own. A list leaves out rows for which a function `shown` of the description is
// false.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string_view>
#include <tuple>
#include <type_traits>

namespace rigfit::describe {

template <class Get>
struct Field {
  std::string_view key;
  Get get;
  std::string_view unit, label, meaning;
  int digits;
};

template <class Get>
constexpr Field<Get> field(std::string_view key, Get get, std::string_view unit,
                           std::string_view label, std::string_view meaning, int digits = 6) {
  return {key, get, unit, label, meaning, digits};
}

/// Specialised beside each struct: `title` of a list of them, `fields`.
template <class T>
struct Described;

template <class T>
concept described = requires {
  Described<T>::fields;
};

/// Calls `f` with every field.
template <described T, class F>
constexpr void each_field(F&& f) {
  std::apply([&](const auto&... one) { (f(one), ...); }, Described<T>::fields);
}

/// An estimate with the ends of its interval, of members that hold them apart. `one_sided`: only
/// `low` is known of the quantity.
struct Bounded {
  double value, std, low, high;
  bool one_sided = false;
};

template <class E, class L, class H>
constexpr auto bounded(E estimate, L low, H high) {
  return [=](const auto& x) {
    const auto& e = std::invoke(estimate, x);
    return Bounded{e.value, e.std, std::invoke(low, x), std::invoke(high, x)};
  };
}

/// The ends of an interval, [low, high]; `std` says to how many digits they are known.
struct Ends {
  double low, high, std = std::numeric_limits<double>::quiet_NaN();
};
/// The same, where an end may be open (not finite).
struct OpenEnds : Ends {};
template <class I>
constexpr auto ends_of(I interval) {
  return [=](const auto& x) {
    const auto& i = std::invoke(interval, x);
    return Ends{i.low, i.high};
  };
}

/// A field that is there only where `there` says so.
template <class There, class Get>
constexpr auto where(There there, Get get) {
  return [=](const auto& x) {
    using Value = std::remove_cvref_t<std::invoke_result_t<Get, decltype(x)>>;
    return std::invoke(there, x) ? std::optional<Value>(std::invoke(get, x)) : std::nullopt;
  };
}

}  // namespace rigfit::describe
