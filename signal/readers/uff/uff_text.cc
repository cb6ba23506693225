#include "signal/readers/uff/uff_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

#include "signal/numerics/numbers.h"
#include "signal/readers/csv/csv_fields.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

bool is_mark(std::string_view line) { return trim_blanks(line) == "-1"; }

}  // namespace

std::optional<int> UffText::next_dataset() {
  const auto start = mark(next_);
  if (!start) return std::nullopt;
  next_ = *start;
  // Two marks in a row: one dataset's end and the next one's beginning, or an end written twice.
  while (next_ < bytes_.size()) {
    const std::size_t end = line_end(bytes_, next_);
    head_ = {bytes_.substr(next_, end - next_), next_};
    next_ = next_line(bytes_, end);
    if (is_mark(head_.text)) continue;
    any_ = true;
    int type = 0;
    const auto number = trim_blanks(head_.text.substr(0, 6));
    const auto parsed = std::from_chars(number.data(), number.data() + number.size(), type);
    if (parsed.ec == std::errc() && type > 0) return type;
    throw error(head_.at, 1, number, "no dataset number behind the -1 mark",
                "export the file again; each dataset begins with a line of -1 and its number");
  }
  return std::nullopt;
}

std::optional<UffLine> UffText::line() {
  if (next_ >= bytes_.size()) return std::nullopt;
  const std::size_t end = line_end(bytes_, next_);
  const UffLine line{bytes_.substr(next_, end - next_), next_};
  if (is_mark(line.text)) return std::nullopt;
  next_ = next_line(bytes_, end);
  return line;
}

UffLine UffText::needed_line() {
  const auto found = line();
  if (found) return *found;
  throw error(std::min(next_, bytes_.size() - 1), 0, "",
              "the dataset of line " + std::to_string(line_of(head_.at)) + " breaks off",
              "copy or export the file again");
}

bool UffText::skip_to_end() {
  // Binary values behind a 58b that was not read are no lines; its header says how many.
  if (columns(head_.text, 0, 7) == "58b" &&
      next_ == next_line(bytes_, line_end(bytes_, head_.at))) {
    const double lines = number(head_, 19, 12), size = number(head_, 31, 12);
    for (double k = 0; k < std::min(lines, 1000.0); ++k) {
      if (!line()) break;
    }
    const auto left = static_cast<double>(bytes_.size() - next_);
    if (size > 0 && size <= left) next_ += static_cast<std::size_t>(size);
  }
  const auto end = mark(next_);
  next_ = end ? next_line(bytes_, line_end(bytes_, *end)) : bytes_.size();
  return end.has_value();
}

std::optional<std::size_t> UffText::mark(std::size_t from) const {
  for (std::size_t hit = bytes_.find("-1", from); hit != std::string_view::npos;
       hit = bytes_.find("-1", hit + 2)) {
    std::size_t start = hit;
    while (start > from && (bytes_[start - 1] == ' ' || bytes_[start - 1] == '\t')) --start;
    const bool begins = start <= from || bytes_[start - 1] == '\n' || bytes_[start - 1] == '\r';
    const std::size_t behind = std::min(bytes_.find_first_not_of(" \t", hit + 2), bytes_.size());
    if (begins && (behind == bytes_.size() || bytes_[behind] == '\n' || bytes_[behind] == '\r')) {
      return start;
    }
  }
  return std::nullopt;
}

long UffText::line_of(std::size_t at) const {
  if (at < counted_to_) counted_to_ = 0, counted_ = 1;
  while (true) {
    const std::size_t next = next_line(bytes_, line_end(bytes_, counted_to_));
    if (next > at || next >= bytes_.size()) return counted_;
    counted_to_ = next;
    ++counted_;
  }
}

RecordingError UffText::error(std::size_t at, long column, std::string_view value,
                              std::string problem, std::string remedy) const {
  return {{file_, line_of(at), column, "", to_utf8(value.substr(0, 60))},
          std::move(problem),
          std::move(remedy)};
}

std::string_view UffText::columns(std::string_view line, std::size_t from, std::size_t width) {
  return from >= line.size() ? std::string_view{} : trim_blanks(line.substr(from, width));
}

double UffText::number(const UffLine& line, std::size_t from, std::size_t width) const {
  const auto text = columns(line.text, from, width);
  double value = 0;
  if (text.empty() || (parse_whole_number(text, '.', value) && std::isfinite(value))) return value;
  throw error(line.at, static_cast<long>(from) + 1, text, "not a number",
              "this record has fixed columns; export the file again");
}

int UffText::integer(const UffLine& line, std::size_t from, std::size_t width, const char* problem,
                     int low, int high) const {
  const double value = number(line, from, width);
  if (value >= low && value <= high && value == std::floor(value)) return static_cast<int>(value);
  throw error(line.at, static_cast<long>(from) + 1, columns(line.text, from, width), problem,
              "this record has fixed columns; export the file again");
}

std::optional<double> UffText::next_number(std::size_t& at, std::size_t end) const {
  while (at < end && std::isspace(static_cast<unsigned char>(bytes_[at])) != 0) ++at;
  if (at >= end) return std::nullopt;
  const auto text = bytes_.substr(at, end - at);
  double value = 0;
  std::size_t length = parse_number(text, '.', value);
  const auto word = text.substr(0, std::min(text.find_first_of(" \t\n\r\v\f"), text.size()));
  if (length == 0 && is_missing_word(word)) {
    length = word.size();
    value = kNaN;
  }
  if (length == 0 || std::isinf(value)) {
    const std::size_t line = bytes_.substr(0, at).find_last_of("\r\n") + 1;
    throw error(at, static_cast<long>(at - line) + 1, word,
                length == 0 ? "not a number" : "a number too large for a double",
                "fix the value, or export the file again");
  }
  at += length;
  return value;
}

}  // namespace rigfit::signal
