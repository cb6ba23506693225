// A result's fields, described once beside its struct: key, how to get it, unit, label, meaning.
//
//   struct Length {
//     ...
//     static constexpr std::string_view title = "by length";  // of a list of them
//     static constexpr auto fields() {
//       using T = Length;
//       return std::tuple{
//           field("length_m", &T::length_m, "m", "length", "between the grips"),
//           field("EA_N", &T::EA_N, "N", "EA", "axial rigidity of this length alone")};
//     }
//   };
//
// JSON, its schema, tables of text and CSV, the report's tables and Python's repr are walks over
// `fields` (apps/describe). A field is a data member or any function of the struct: a nested struct
// that is described, a list, an estimate (value, std), an optional one. An empty label: for
// programs only; an empty key: for people only. The unit "%" is that of a ratio which people read
// in per cent; `digits` are those of a number that has no std of its own. A list leaves out rows
// for which a function `shown` of the struct is false.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

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

/// For programs only, with a name that says what it is.
template <class Get>
constexpr Field<Get> field(std::string_view key, Get get) {
  return {key, get, "", "", "", 6};
}

/// The fields of a described struct that `get` gives, as fields of this one.
template <class Get>
struct Part {
  Get get;
};
template <class Get>
constexpr Part<Get> part(Get get) {
  return {get};
}

template <class T>
concept described = requires {
  T::fields();
};
template <described T>
inline constexpr auto fields_of = T::fields();

/// Calls `f` with every field.
template <described T, class F>
constexpr void each_field(F&& f) {
  const auto take = [&](const auto& one) {
    if constexpr (requires { one.key; }) {
      f(one);
    } else {
      using Inner = std::remove_cvref_t<std::invoke_result_t<decltype(one.get), const T&>>;
      each_field<Inner>([&](const auto& inner) {
        f(field(
            inner.key, [&](const T& x) { return std::invoke(inner.get, std::invoke(one.get, x)); },
            inner.unit, inner.label, inner.meaning, inner.digits));
      });
    }
  };
  std::apply([&](const auto&... one) { (take(one), ...); }, fields_of<T>);
}

/// An estimate with the ends of its interval, of members that hold them apart. `one_sided`: only
/// `low` is known of the quantity.
struct Bounded {
  double value, std, low, high;
  bool one_sided = false;
};

/// The ends of an interval, [low, high]; `std` says to how many digits they are known.
struct Ends {
  double low, high, std = std::numeric_limits<double>::quiet_NaN();
};
/// The same, where an end may be open (not finite).
struct OpenEnds : Ends {};
template <class L, class H>
constexpr auto ends_of(L low, H high) {
  return [=](const auto& x) { return Ends{std::invoke(low, x), std::invoke(high, x)}; };
}
template <class I>
constexpr auto ends_of(I interval) {
  return [=](const auto& x) {
    const auto& i = std::invoke(interval, x);
    return Ends{i.low, i.high};
  };
}

/// Numbers by name, in JSON an object; people read shares of a whole, from half a percent on.
struct ByName {
  std::vector<std::pair<std::string, double>> all;
};

/// A member of a member.
template <class Outer, class Inner>
constexpr auto within(Outer outer, Inner inner) {
  return [=](const auto& x) { return std::invoke(inner, std::invoke(outer, x)); };
}

/// A field that is there only where `there` says so.
template <class There, class Get>
constexpr auto where(There there, Get get) {
  return [=](const auto& x) {
    using Value = std::remove_cvref_t<std::invoke_result_t<Get, decltype(x)>>;
    return std::invoke(there, x) ? std::optional<Value>(std::invoke(get, x)) : std::nullopt;
  };
}

/// A number that is there where it is above zero.
template <class Get>
constexpr auto positive(Get get) {
  return where([=](const auto& x) { return std::invoke(get, x) > 0; }, get);
}

}  // namespace rigfit::describe

namespace rigfit {
using describe::field;
}  // namespace rigfit
