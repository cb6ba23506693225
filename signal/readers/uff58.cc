// The lines of universal files, and what the numbers of dataset 58 stand for.
#include "signal/readers/uff58.h"

#include <charconv>
#include <iterator>

#include "signal/readers/csv_fields.h"

namespace rigfit::signal {
namespace {

bool is_mark(std::string_view line) { return trim_blanks(line) == "-1"; }

constexpr std::pair<int, Quantity> kDataTypes[] = {
    {3, Quantity::strain},        {5, Quantity::temperature}, {8, Quantity::displacement},
    {13, Quantity::force},        {9, Quantity::force},       {11, Quantity::velocity},
    {12, Quantity::acceleration}, {15, Quantity::pressure},   {17, Quantity::time}};

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

const char* uff58_function_name(int type) {
  constexpr const char* kNames[] = {"general function",
                                    "time response",
                                    "auto spectrum",
                                    "cross spectrum",
                                    "frequency response function",
                                    "transmissibility",
                                    "coherence",
                                    "auto correlation",
                                    "cross correlation",
                                    "power spectral density",
                                    "energy spectral density",
                                    "probability density",
                                    "spectrum"};
  return type >= 0 && type < std::ssize(kNames) ? kNames[type] : "function of another type";
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
