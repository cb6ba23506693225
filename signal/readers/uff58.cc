#include "signal/readers/uff58.h"

#include <fmt/format.h>

#include <charconv>
#include <iterator>

#include "signal/readers/csv_table.h"

namespace rigfit::signal {
namespace {

bool is_mark(std::string_view line) { return trim_blanks(line) == "-1"; }

constexpr std::pair<int, Quantity> kDataTypes[] = {
    {3, Quantity::strain},        {5, Quantity::temperature}, {8, Quantity::displacement},
    {13, Quantity::force},        {9, Quantity::force},       {11, Quantity::velocity},
    {12, Quantity::acceleration}, {15, Quantity::pressure},   {17, Quantity::time}};

constexpr int kHeaderLines = 11;  // lines of text behind the dataset's number

std::string text_field(std::string_view line, std::size_t from, std::size_t width) {
  const std::string text(trim_blanks(to_utf8(UffText::columns(line, from, width))));
  return text == "NONE" || text == "None" || text == "none" ? "" : text;
}

void add_remark(std::string_view line, std::map<std::string, std::string>& remark) {
  if (!line.starts_with("rigfit ")) return;
  std::vector<CsvField> words;
  split_fields(line.substr(7), {' ', '.'}, words);
  for (const auto& word : words) {
    const std::size_t sign = std::min(word.text.find('='), word.text.size() - 1);
    remark.emplace(word.text.substr(0, sign), word.text.substr(sign + 1));
  }
}

MeasuredPoint point(const UffText& text, std::string_view line, std::size_t from) {
  return {text_field(line, from, 11), text.integer(line, from + 11, 10),
          text.integer(line, from + 21, 4)};
}

Uff58Axis axis(const UffText& text, std::string_view line) {
  // The exponents of units are not needed, but are whole numbers unless columns have slipped.
  for (const std::size_t from : {10U, 15U, 20U}) static_cast<void>(text.integer(line, from, 5));
  return {text.integer(line, 0, 10), text_field(line, 25, 21), text_field(line, 46, 21)};
}

/// Numbers of a sample in a column.
MatrixXd binary_numbers(UffText& text, bool single, bool big, Index values, Index count) {
  const std::string_view from = text.rest();
  const std::size_t width = single ? 4 : 8;
  const std::size_t total = static_cast<std::size_t>(values * count) * width;
  if (total > from.size()) {
    throw text.error(from.substr(0, 0),
                     "the file breaks off inside the binary values of this dataset",
                     "copy or export the file again");
  }
  text.skip(total);
  while (const auto line = text.line()) {
    if (trim_blanks(*line).empty()) continue;
    throw text.error(from.substr(0, 0), "no end mark (-1) behind the binary values of this dataset",
                     "the number of values or their precision is stated wrongly; export it again");
  }
  return matrix_of({'f', width, is_swapped(big)}, from.data(), values, count);
}

MatrixXd text_numbers(const UffText& text, Index values, Index count) {
  std::string_view rest = text.rest();
  const auto mark = UffText::mark(rest);
  if (mark) rest.remove_suffix(mark->size());
  MatrixXd numbers(values, count);
  for (Index k = 0; k < numbers.size(); ++k) {
    const auto value = text.next_number(rest);
    if (!value) {
      throw text.error(rest,
                       fmt::format("the dataset ends after {} of {} values", k / values, count),
                       "copy or export the file again");
    }
    numbers.data()[k] = *value;
  }
  if (rest.empty() && !mark) throw text.broken_off(rest);
  // Zeros that fill the last line are no values.
  for (int fill = 0; const auto more = text.next_number(rest); ++fill) {
    if (*more == 0 && fill < 5) continue;
    throw text.error(rest, fmt::format("the dataset holds more than {} values", count),
                     "export the file again");
  }
  return numbers;
}

Uff58 read_function(UffText& text) {
  Uff58 f;
  const std::string_view head = text.head();
  f.line = text.line_of(head);
  f.binary = head.size() > 6 && (head[6] == 'b' || head[6] == 'B');
  int byte_order = 1, text_lines = kHeaderLines;
  if (f.binary) {
    byte_order = text.integer(head, 7, 6, "unknown byte order, 1 is little and 2 big", 1, 2);
    text.integer(head, 13, 6, "floats other than IEEE 754 (2) are not read", 2, 2);
    text_lines = text.integer(head, 19, 12, "dataset 58 has 11 lines of text", kHeaderLines, 1000);
  }
  for (auto& id : f.id) id = text_field(text.needed_line(), 0, 80);
  add_remark(f.id[3], f.remark);
  add_remark(f.id[4], f.remark);
  const std::string_view dof = text.needed_line(), form = text.needed_line();
  f.function_type = text.integer(dof, 0, 5);
  f.response = point(text, dof, 30);
  f.reference = point(text, dof, 55);
  const int data_type =
      text.integer(form, 0, 10, "unknown kind of numbers, 2 and 4 are real, 5 and 6 complex",
                   text.integer(form, 0, 10) == 2 ? 2 : 4, 6);
  const int count = text.integer(form, 10, 10, "the function holds no values", 1);
  f.even = text.integer(form, 20, 10, "unknown spacing of the abscissa", 0, 1) == 1;
  f.complex = data_type >= 5;
  f.single_precision = data_type == 2 || data_type == 5;
  f.abscissa_start = text.number(form, 30, 13);
  f.abscissa_step = text.number(form, 43, 13);
  f.abscissa_step_half_digit =
      0.5 * std::pow(10.0, -printed_decimals(UffText::columns(form, 43, 13), '.'));
  for (Uff58Axis* one : {&f.abscissa, &f.ordinate, &f.denominator}) {
    *one = axis(text, text.needed_line());
  }
  for (int k = kHeaderLines - 1; k < text_lines; ++k) text.needed_line();  // z, and remarks

  // Before any memory is taken: could the file hold that many numbers at all?
  const std::size_t left = text.rest().size();
  const std::size_t least = f.binary ? (f.single_precision ? 4 : 8) : 2;
  if (least * static_cast<std::size_t>(count) > left + 2) {
    throw text.error(UffText::columns(form, 10, 10),
                     "the file is too short for the values that this dataset states",
                     "copy or export the file again");
  }
  const Index real = f.even ? 0 : 1;
  const Index values = real + (f.complex ? 2 : 1);
  const MatrixXd numbers =
      f.binary ? binary_numbers(text, f.single_precision, byte_order == 2, values, count)
               : text_numbers(text, values, count);
  if (!f.even) f.x = numbers.row(0);
  f.real = numbers.row(real);
  if (f.complex) f.imag = numbers.row(real + 1);
  return f;
}

}  // namespace

std::optional<int> UffText::next_dataset() {
  const auto start = mark(rest_);
  if (!start) return std::nullopt;
  rest_ = *start;
  // Two marks in a row: one dataset's end and the next one's beginning, or an end written twice.
  while (!rest_.empty()) {
    const auto text = take_line(rest_);
    if (is_mark(text)) continue;
    head_ = text;
    int type = 0;
    const auto number = trim_blanks(head_.substr(0, 6));
    const auto parsed = std::from_chars(number.data(), number.data() + number.size(), type);
    if (parsed.ec == std::errc() && type > 0) return type;
    throw error(number, "no dataset number behind the -1 mark",
                "export the file again; each dataset begins with a line of -1 and its number");
  }
  return std::nullopt;
}

std::optional<std::string_view> UffText::line() {
  auto after = rest_;
  const auto line = take_line(after);
  if (rest_.empty() || is_mark(line)) return std::nullopt;
  if (line.size() == rest_.size()) throw broken_off(line);
  rest_ = after;
  return line;
}

std::string_view UffText::needed_line() {
  if (const auto found = line()) return *found;
  throw broken_off(rest_.substr(0, 0));
}

bool UffText::skip_to_end() {
  // Binary values behind a 58b that was not read are no lines; its header says how many.
  auto behind = bytes_.substr(static_cast<std::size_t>(head_.data() - bytes_.data()));
  take_line(behind);
  if (columns(head_, 0, 7) == "58b" && behind.size() == rest_.size()) {
    const double lines = number(head_, 19, 12), size = number(head_, 31, 12);
    for (double k = 0; k < std::min(lines, 1000.0); ++k) {
      if (!line()) break;
    }
    if (size > 0 && size <= static_cast<double>(rest_.size())) skip(static_cast<std::size_t>(size));
  }
  const auto end = mark(rest_);
  rest_ = end.value_or(bytes_.substr(bytes_.size()));
  take_line(rest_);
  return end.has_value();
}

std::optional<std::string_view> UffText::mark(std::string_view lines) {
  for (std::size_t hit = lines.find("-1"); hit != lines.npos; hit = lines.find("-1", hit + 2)) {
    const std::size_t start = lines.substr(0, hit).find_last_not_of(" \t") + 1;
    const bool begins = start == 0 || lines[start - 1] == '\n' || lines[start - 1] == '\r';
    const std::size_t behind = std::min(lines.find_first_not_of(" \t", hit + 2), lines.size());
    if (begins && (behind == lines.size() || lines[behind] == '\n' || lines[behind] == '\r')) {
      return lines.substr(start);
    }
  }
  return std::nullopt;
}

long UffText::line_of(std::string_view part) const {
  const auto at = static_cast<std::size_t>(part.data() - bytes_.data());
  if (at < counted_to_) counted_to_ = 0, counted_ = 1;
  counted_ += line_number(bytes_.substr(counted_to_), at - counted_to_) - 1;
  counted_to_ = at;
  return counted_;
}

RecordingError UffText::broken_off(std::string_view at) const {
  return error(at, "the dataset of line " + std::to_string(line_of(head_)) + " breaks off",
               "copy or export the file again");
}

RecordingError UffText::error(std::string_view value, std::string problem,
                              std::string remedy) const {
  return text_error(bytes_, file_, value, std::move(problem), std::move(remedy));
}

std::string_view UffText::columns(std::string_view line, std::size_t from, std::size_t width) {
  return trim_blanks(line.substr(std::min(from, line.size()), width));
}

double UffText::number(std::string_view line, std::size_t from, std::size_t width) const {
  const auto text = columns(line, from, width);
  double value = 0;
  if (text.empty() || (parse_whole_number(text, '.', value) && std::isfinite(value))) return value;
  throw error(text, "not a number", "this record has fixed columns; export the file again");
}

int UffText::integer(std::string_view line, std::size_t from, std::size_t width,
                     const char* problem, int low, int high) const {
  const double value = number(line, from, width);
  if (value >= low && value <= high && value == std::floor(value)) return static_cast<int>(value);
  throw error(columns(line, from, width), problem,
              "this record has fixed columns; export the file again");
}

std::optional<double> UffText::next_number(std::string_view& rest) const {
  constexpr const char* kBlanks = " \t\n\r\v\f";
  rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
  if (rest.empty()) return std::nullopt;
  double value = 0;
  std::size_t length = parse_number(rest, '.', value);
  const auto word = rest.substr(0, rest.find_first_of(kBlanks));
  if (length == 0 && is_missing_word(word)) {
    length = word.size();
    value = kNaN;
  }
  if (length == 0 || std::isinf(value)) {
    throw error(word, length == 0 ? "not a number" : "a number too large for a double",
                "fix the value, or export the file again");
  }
  rest.remove_prefix(length);
  return value;
}

std::vector<Uff58> read_uff58(std::string_view bytes, const std::string& file,
                              const std::function<void(std::size_t)>& done_with) {
  UffText text(bytes, file);
  std::vector<Uff58> functions;
  while (const auto type = text.next_dataset()) {
    if (*type == 58) functions.push_back(read_function(text));
    if (*type == 58 && done_with) done_with(bytes.size() - text.rest().size());
    text.skip_to_end();
  }
  return functions;
}

double Uff58::noted(const std::string& key, double fallback) const {
  const auto entry = remark.find(key);
  double value = 0;
  return entry != remark.end() && parse_whole_number(entry->second, '.', value) &&
                 std::isfinite(value)
             ? value
             : fallback;
}

int uff58_direction(const std::array<double, 3>& axis) {
  const double length = std::hypot(axis[0], axis[1], axis[2]);
  for (int k = 0; k < 3; ++k) {
    const double along = axis[static_cast<std::size_t>(k)];
    if (length > 0 && std::abs(along) > 0.999 * length) return along > 0 ? k + 1 : -k - 1;
  }
  return 0;
}

std::string uff58_direction(int direction) {
  static constexpr const char* kAxes[] = {"", "X", "Y", "Z", "RX", "RY", "RZ"};
  if (direction == 0 || std::abs(direction) > 6) return "";
  return std::string(direction > 0 ? "+" : "-") + kAxes[std::abs(direction)];
}

Quantity uff58_quantity(int data_type) {
  for (const auto& [type, quantity] : kDataTypes) {
    if (type == data_type) return quantity;
  }
  return Quantity::unknown;
}

int uff58_data_type(Quantity quantity) {
  for (const auto& [type, of] : kDataTypes) {
    if (of == quantity && of != Quantity::time) return type;
  }
  return 1;
}

}  // namespace rigfit::signal
