#include "signal/readers/csv/csv_comma.h"

#include <algorithm>
#include <cctype>

#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/files/number_text.h"

namespace rigfit::signal {
namespace {

/// "12", "-3", "+05"; no decimal point, no exponent.
bool is_whole(std::string_view text) {
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  return !text.empty() && text.size() < 16 && std::all_of(text.begin(), text.end(), [](char c) {
    return std::isdigit(static_cast<unsigned char>(c)) != 0;
  });
}

bool is_signed(std::string_view text) { return text.front() == '-' || text.front() == '+'; }

/// What is found behind the commas that would be decimal signs.
struct Behind {
  bool leading_zero = false;  ///< "05", or "-0" in front: no column of whole numbers is so written
  bool negative = false;      ///< no decimals are
  bool blank = false;         ///< "1, 5": a blank behind a decimal sign is not written
  bool stripped = true;       ///< no field of several digits ends with 0
  std::size_t shortest = 99, longest = 0;
};

/// The first column counts or rises in equal steps.
bool counts(const std::vector<std::vector<std::string_view>>& rows) {
  if (rows.size() < 3) return false;
  double before = 0, step = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    double value = 0;
    if (!parse_whole_number(rows[k][0], '.', value)) return false;
    if (k == 1) step = value - before;
    if (k > 0 && (value - before != step || !(step > 0))) return false;
    before = value;
  }
  return true;
}

}  // namespace

CommaMeaning comma_meaning(const std::vector<std::string_view>& lines, std::string_view titles) {
  std::vector<CsvField> fields;
  std::vector<std::vector<std::string_view>> rows;
  Behind behind;
  for (const auto line : lines) {
    split_fields(line, {',', '.'}, fields);
    while (!fields.empty() && fields.back().text.empty()) fields.pop_back();
    if (fields.size() < 2 || fields.size() % 2 != 0) return CommaMeaning::separator;
    std::vector<std::string_view> row;
    for (const auto& field : fields) {
      if (field.quoted || !is_whole(field.text)) return CommaMeaning::separator;
      row.push_back(field.text);
    }
    if (!rows.empty() && row.size() != rows.front().size()) return CommaMeaning::separator;
    for (std::size_t c = 0; c + 1 < row.size(); c += 2) {
      const auto whole = row[c], part = row[c + 1];
      behind.negative |= is_signed(part);
      behind.leading_zero |= (part.size() > 1 && part.front() == '0') || whole == "-0";
      behind.blank |= part.data()[-1] != ',';
      behind.stripped &= part.size() == 1 || part.back() != '0';
      behind.shortest = std::min(behind.shortest, part.size());
      behind.longest = std::max(behind.longest, part.size());
    }
    rows.push_back(std::move(row));
  }
  if (rows.empty() || behind.negative || behind.blank) return CommaMeaning::separator;
  const std::size_t columns = rows.front().size();
  if (!titles.empty()) {
    split_fields(titles, {',', '.'}, fields);
    while (!fields.empty() && fields.back().text.empty()) fields.pop_back();
    if (fields.size() == columns) return CommaMeaning::separator;
  }
  const bool one = columns == 2;
  if (behind.leading_zero) return one ? CommaMeaning::decimal : CommaMeaning::both;
  if (one && !titles.empty() && fields.size() == 1) {
    double value = 0;
    if (!parse_whole_number(fields.front().text, '.', value)) return CommaMeaning::decimal;
  }
  if (!one || counts(rows)) return CommaMeaning::separator;
  // Decimals of different numbers of digits, one of them ending with 0, are none.
  if (behind.shortest != behind.longest && !behind.stripped) return CommaMeaning::separator;
  return CommaMeaning::undecided;
}

}  // namespace rigfit::signal
