#include "apps/describe/sheet.h"

namespace rigfit::describe {
namespace {

/// Decimals (negative: tens, hundreds) of the second digit of `std`: of 0.0996, which is 0.10, two.
int decimals_of_std(double std) {
  return 1 - static_cast<int>(std::floor(std::log10(std * (1 + 0.5e-2))));
}

std::string to_place(double value, int decimals) {
  const double unit = decimals < 0 ? std::pow(10.0, -decimals) : 1;
  const double rounded = decimals < 0 ? std::round(value / unit) * unit : value;
  const std::string text = fmt::format("{:.{}f}", rounded, std::max(0, decimals));
  const bool minus_zero = text.starts_with('-') && text.find_first_not_of("-0.") == text.npos;
  return minus_zero ? text.substr(1) : text;
}

/// Cells that show nothing: no number, or a share that rounds to none.
bool blank(const std::string& cell) { return cell.empty() || cell == "-"; }

std::string padded(const std::string& text, std::size_t width, bool right) {
  return right ? fmt::format("{:>{}}", text, width) : fmt::format("{:<{}}", text, width);
}

}  // namespace

bool is_known_to(double value, double std) {
  return std::isfinite(value) && std::isfinite(std) && std > 1e-8 * std::abs(value);
}

std::string value_digits(double value, double std) {
  if (!std::isfinite(value)) return "-";
  if (!is_known_to(value, std)) return fmt::format("{:.6g}", value);
  const int decimals = decimals_of_std(std);
  if (decimals <= 10 && std::abs(value) < 1e9 && std < 1e9) return to_place(value, decimals);
  // So small or large that digits would be counted: an exponent, to the same place.
  const double larger = std::max(std::abs(value), std);
  const int first = static_cast<int>(std::floor(std::log10(larger)));
  return fmt::format("{:.{}e}", value, std::clamp(first + decimals, 1, 15));
}

std::string std_digits(double std) {
  if (!std::isfinite(std)) return "-";
  if (!(std > 0)) return "0";
  const int decimals = decimals_of_std(std);
  return decimals <= 10 && std < 1e9 ? to_place(std, decimals) : fmt::format("{:.1e}", std);
}

ShownUnit shown_unit(std::string_view unit) {
  if (unit == "%") return {"%", 100};
  if (unit == "m/N") return {"µm/N", 1e6};
  if (unit == "Pa") return {"GPa", 1e-9};
  return {unit, 1};
}

std::string number_text(double value, std::string_view unit, int digits) {
  if (!std::isfinite(value)) return "-";
  value *= shown_unit(unit).per_si;
  // Digits before the point are those after rounding: 99.7 with two digits is 100.
  const double rounded = std::abs(value) * (1 + 0.5 * std::pow(10.0, -digits));
  const int exponent = value == 0 ? 0 : static_cast<int>(std::floor(std::log10(rounded)));
  if (exponent < digits || exponent >= 9) return fmt::format("{:.{}g}", value, digits);
  const double place = std::pow(10.0, exponent + 1 - digits);
  return fmt::format("{:.0f}", std::round(value / place) * place);
}

std::string estimate_text(double value, double std, std::string_view unit) {
  const double scale = shown_unit(unit).per_si;
  const std::string text = value_digits(scale * value, scale * std);
  return is_known_to(value, std) ? text + " +- " + std_digits(scale * std) : text;
}

std::string interval_text(const Bounded& x, std::string_view unit) {
  const double scale = shown_unit(unit).per_si;
  const std::string behind = unit.empty() ? "" : " " + std::string(shown_unit(unit).name);
  if (x.one_sided) {
    return fmt::format(
        "{}{} or more (95 %), {}", value_digits(scale * x.low, 1e-3 * scale * x.low), behind,
        std::isfinite(x.high) ? fmt::format("at most {:.3g}{}", scale * x.high, behind)
                              : "no upper bound");
  }
  std::string text = estimate_text(x.value, x.std, unit);
  if (text != "-") text += behind;
  if (!std::isfinite(x.low) || !std::isfinite(x.high)) return text;
  return fmt::format("{} (95 %: {} to {})", text, value_digits(scale * x.low, scale * x.std),
                     value_digits(scale * x.high, scale * x.std));
}

std::string ends_text(const Ends& x, std::string_view unit) {
  if (!std::isfinite(x.low) || !std::isfinite(x.high)) return "-";
  const double scale = shown_unit(unit).per_si;
  return value_digits(scale * x.low, scale * x.std) + " to " +
         value_digits(scale * x.high, scale * x.std);
}

std::string shares_text(const ByName& shares) {
  std::string text;
  for (const auto& [name, share] : shares.all) {
    if (!(share >= 0.005)) continue;
    text += fmt::format("{}{} {:.0f} %", text.empty() ? "" : ", ", name, 100 * share);
  }
  return text;
}

std::string head_text(std::string_view label, std::string_view unit) {
  return unit.empty() ? std::string(label) : fmt::format("{}, {}", label, shown_unit(unit).name);
}

void print(std::ostream& out, const Table& table) {
  std::vector<std::size_t> widths(table.heads.size());  // 0: nothing to show
  for (std::size_t c = 0; c < widths.size(); ++c) {
    if (std::ranges::all_of(table.rows, [&](const auto& row) { return blank(row[c]); })) continue;
    widths[c] = table.heads[c].size();
    for (const auto& row : table.rows) widths[c] = std::max(widths[c], row[c].size());
  }
  const auto line = [&](const std::vector<std::string>& cells) {
    std::string text;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (widths[c] > 0)
        text += (text.empty() ? "" : "  ") + padded(cells[c], widths[c], table.numeric[c]);
    }
    while (text.ends_with(' ')) text.pop_back();
    out << text << '\n';
  };
  if (!table.title.empty()) out << table.title << '\n';
  line(table.heads);
  for (const auto& row : table.rows) line(row);
}

void print(std::ostream& out, const Sheet& sheet) {
  std::size_t width = 0;
  for (const auto& line : sheet.lines) width = std::max(width, line.label.size());
  for (const auto& line : sheet.lines) {
    out << padded(line.label, width, false) << "  " << line.text << '\n';
  }
  for (const auto& table : sheet.tables) {
    if (!sheet.lines.empty() || &table != &sheet.tables.front()) out << '\n';
    print(out, table);
  }
}

}  // namespace rigfit::describe
