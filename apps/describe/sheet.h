// Described results as people read them: lines of labels and values, tables of lists. What is
// printed or put on a page starts from a Sheet; building it is the only part that knows the type.
#pragma once

#include <ostream>

#include "apps/describe/json_of.h"

namespace rigfit::describe {

struct Table {
  std::string title;
  std::vector<std::string> heads;  ///< "EA, N"
  std::vector<bool> numeric;       ///< columns that are aligned at the right
  std::vector<std::vector<std::string>> rows;
};

struct Sheet {
  struct Line {
    std::string label, text;
  };
  std::vector<Line> lines;
  std::vector<Table> tables;  ///< in the order of the fields; none for an empty list
};

/// In which people read what is held in SI: a ratio in per cent, a compliance in µm/N.
struct ShownUnit {
  std::string_view name;
  double per_si = 1;
};
[[nodiscard]] ShownUnit shown_unit(std::string_view unit);

// Digits that are known: two of the standard uncertainty, and the value to the same place, both
// without exponents where that stays readable.

/// Whether `std` says how far the value is known: 1e-8 of it and less is the rounding of a
/// computation, to which nothing is measured.
[[nodiscard]] bool is_known_to(double value, double std);

/// "205190" for 205188 known to 340; six digits where `std` says nothing; "-" for NaN.
[[nodiscard]] std::string value_digits(double value, double std);

/// Two digits: "340", "0.0041", "0.00000077"; "0" for zero, "-" for what is not finite.
[[nodiscard]] std::string std_digits(double std);

[[nodiscard]] std::string number_text(double value, std::string_view unit, int digits);
/// "205190 +- 340"; the value alone where no std is known.
[[nodiscard]] std::string estimate_text(double value, double std, std::string_view unit);
/// With the interval: "205190 +- 340 N (95 %: 204330 to 206040)".
[[nodiscard]] std::string interval_text(const Bounded& x, std::string_view unit);
/// "204330 to 206040".
[[nodiscard]] std::string ends_text(const Ends& x, std::string_view unit);
/// "cable 99 %, beam 1 %".
[[nodiscard]] std::string shares_text(const ByName& shares);
/// "EA, N".
[[nodiscard]] std::string head_text(std::string_view label, std::string_view unit);

void print(std::ostream& out, const Table& table);
void print(std::ostream& out, const Sheet& sheet);

/// Whether a value stands in one cell.
template <class M>
inline constexpr bool single = !described<M> && !list<M> && !matrix<M>;

/// In a table the unit stands in the head, else behind the value.
template <class M>
[[nodiscard]] std::string text_of(const M& x, std::string_view unit, int digits, bool in_table) {
  const auto with_unit = [&](const std::string& text) {
    return in_table || unit.empty() || text == "-"
               ? text
               : text + " " + std::string(shown_unit(unit).name);
  };
  if constexpr (requires { x.one_sided; }) {
    return in_table ? estimate_text(x.value, x.std, unit)
                    : interval_text({x.value, x.std, x.low, x.high, x.one_sided}, unit);
  } else if constexpr (std::is_same_v<M, OpenEnds>) {
    const auto end = [&](double x_end) {
      return std::isfinite(x_end) ? value_digits(x_end, x.std) : std::string("open");
    };
    return end(x.low) + " .. " + end(x.high);
  } else if constexpr (std::is_same_v<M, Ends>) {
    return with_unit(ends_text(x, unit));
  } else if constexpr (estimate<M>) {
    return with_unit(estimate_text(x.value, x.std, unit));
  } else if constexpr (std::is_same_v<M, bool>) {
    return x ? "yes" : "no";
  } else if constexpr (std::is_same_v<M, ByName>) {
    return shares_text(x);
  } else if constexpr (std::is_floating_point_v<M>) {
    return !in_table && !(std::isfinite(x)) ? "not applicable"
                                            : with_unit(number_text(x, unit, digits));
  } else if constexpr (std::is_arithmetic_v<M>) {
    return with_unit(std::to_string(x));
  } else if constexpr (named<M>) {
    return std::string(name_of(x));
  } else if constexpr (std::is_constructible_v<std::string, const M&>) {
    return std::string(x);
  } else {
    return "";  // for programs only
  }
}

template <described T>
[[nodiscard]] Table table_of(std::vector<T> rows) {
  if constexpr (requires(const T& row) { T::shown(row); }) {
    std::erase_if(rows, [](const T& row) { return !T::shown(row); });
  }
  Table table;
  if constexpr (requires { T::title; }) table.title = T::title;
  table.rows.resize(rows.size());
  each_field<T>([&](const auto& f) {
    if (f.label.empty()) return;
    using Value = std::remove_cvref_t<std::invoke_result_t<decltype(f.get), const T&>>;
    using Cell = typename Held<Value>::type;
    if constexpr (single<Cell>) {
      table.heads.push_back(head_text(f.label, f.unit));
      table.numeric.push_back(estimate<Cell> ||
                              (std::is_arithmetic_v<Cell> && !std::is_same_v<Cell, bool>));
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto& value = std::invoke(f.get, rows[i]);
        if constexpr (std::is_same_v<Cell, Value>) {
          table.rows[i].push_back(text_of(value, f.unit, f.digits, true));
        } else {
          table.rows[i].push_back(value ? text_of(*value, f.unit, f.digits, true) : "-");
        }
      }
    }
  });
  return table;
}

template <described T>
[[nodiscard]] Sheet sheet_of(const T& result) {
  Sheet sheet;
  each_field<T>([&](const auto& f) {
    if (f.label.empty()) return;
    const auto add = [&](const auto& value) {
      using Value = std::remove_cvref_t<decltype(value)>;
      if constexpr (single<Value>) {
        sheet.lines.push_back({std::string(f.label), text_of(value, f.unit, f.digits, false)});
      } else if constexpr (list<Value>) {
        if constexpr (described<typename Value::value_type>) {
          Table table = table_of(value);
          if (!table.rows.empty()) sheet.tables.push_back(std::move(table));
        }
      } else {
        const Sheet inner = sheet_of(value);
        sheet.lines.insert(sheet.lines.end(), inner.lines.begin(), inner.lines.end());
        sheet.tables.insert(sheet.tables.end(), inner.tables.begin(), inner.tables.end());
      }
    };
    const auto& value = std::invoke(f.get, result);
    if constexpr (requires { value.has_value(); }) {
      if (value) add(*value);
    } else {
      add(value);
    }
  });
  return sheet;
}

}  // namespace rigfit::describe
