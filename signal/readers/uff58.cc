#include "signal/readers/uff58.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <utility>

#include "signal/numerics/numbers.h"
#include "signal/readers/array_columns.h"
#include "signal/readers/csv_fields.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

constexpr Eigen::Index kValuesPerCall = Eigen::Index{1} << 18;  // values between calls
constexpr int kHeaderLines = 11;  // lines of text behind the dataset's number

bool is_mark(std::string_view line) { return trim_blanks(line) == "-1"; }

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

class Uff58Reader {
 public:
  Uff58Reader(std::string_view bytes, const std::string& file,
              const std::function<void(std::size_t)>& done_with)
      : text_(bytes, file), done_with_(done_with) {}

  Uff58File read() {
    while (const auto type = text_.next_dataset()) {
      if (*type == 58) {
        out_.functions.push_back(read_function());
        if (done_with_) done_with_(text_.next());
        continue;
      }
      out_.other_datasets.push_back(*type);
      text_.skip_to_end();
    }
    return std::move(out_);
  }

 private:
  MeasuredPoint point(std::string_view line, std::size_t from) const {
    return {text_field(line, from, 11), text_.integer(line, from + 11, 10),
            text_.integer(line, from + 21, 4)};
  }

  Uff58Axis axis(std::string_view line) const {
    // The exponents of units are not needed, but are whole numbers unless columns have slipped.
    for (const std::size_t from : {10U, 15U, 20U}) static_cast<void>(text_.integer(line, from, 5));
    return {text_.integer(line, 0, 10), text_field(line, 25, 21), text_field(line, 46, 21)};
  }

  Uff58 read_function() {
    Uff58 f;
    const std::string_view head = text_.head();
    f.line = text_.line_of(head);
    f.binary = head.size() > 6 && (head[6] == 'b' || head[6] == 'B');
    int byte_order = 1, text_lines = kHeaderLines;
    if (f.binary) {
      byte_order = text_.integer(head, 7, 6, "unknown byte order, 1 is little and 2 big", 1, 2);
      text_.integer(head, 13, 6, "floats other than IEEE 754 (2) are not read", 2, 2);
      text_lines =
          text_.integer(head, 19, 12, "dataset 58 has 11 lines of text", kHeaderLines, 1000);
    }
    for (auto& id : f.id) id = text_field(text_.needed_line(), 0, 80);
    add_remark(f.id[3], f.remark);
    add_remark(f.id[4], f.remark);
    const std::string_view dof = text_.needed_line(), form = text_.needed_line();
    f.function_type = text_.integer(dof, 0, 5);
    f.response = point(dof, 30);
    f.reference = point(dof, 55);
    const int data_type =
        text_.integer(form, 0, 10, "unknown kind of numbers, 2 and 4 are real, 5 and 6 complex",
                      text_.integer(form, 0, 10) == 2 ? 2 : 4, 6);
    const int count = text_.integer(form, 10, 10, "the function holds no values", 1);
    f.even = text_.integer(form, 20, 10, "unknown spacing of the abscissa", 0, 1) == 1;
    f.complex = data_type >= 5;
    f.single_precision = data_type == 2 || data_type == 5;
    f.abscissa_start = text_.number(form, 30, 13);
    f.abscissa_step = text_.number(form, 43, 13);
    f.abscissa_step_half_digit =
        0.5 * std::pow(10.0, -printed_decimals(UffText::columns(form, 43, 13), '.'));
    for (Uff58Axis* one : {&f.abscissa, &f.ordinate, &f.denominator}) {
      *one = axis(text_.needed_line());
    }
    for (int k = kHeaderLines - 1; k < text_lines; ++k) text_.needed_line();  // z, and remarks

    // Before any memory is taken: could the file hold that many numbers at all?
    const std::size_t left = text_.rest().size();
    const std::size_t least = f.binary ? (f.single_precision ? 4 : 8) : 2;
    if (least * static_cast<std::size_t>(count) > left + 2) {
      throw text_.error(UffText::columns(form, 10, 10),
                        "the file is too short for the values that this dataset states",
                        "copy or export the file again");
    }
    if (!f.even) f.x.resize(count);
    f.real.resize(count);
    if (f.complex) f.imag.resize(count);
    if (f.binary) {
      read_binary(f, byte_order == 2);
    } else {
      read_text(f);
    }
    if (!text_.skip_to_end()) remark(f, " has no end mark (-1)");
    return f;
  }

  void remark(const Uff58& f, const std::string& text) {
    out_.remarks.push_back(fmt::format("the dataset in line {}{}", f.line, text));
  }

  void read_binary(Uff58& f, bool big) {
    const std::string_view from = text_.rest();
    const std::size_t width = f.single_precision ? 4 : 8;
    const std::size_t values = (f.complex ? 2 : 1) + (f.even ? 0 : 1);
    const std::size_t total = static_cast<std::size_t>(f.real.size()) * width * values;
    if (total > from.size()) {
      throw text_.error(from.substr(0, 0),
                        "the file breaks off inside the binary values of this dataset",
                        "copy or export the file again");
    }
    const Eigen::MatrixXd numbers = matrix_of({'f', width, is_swapped(big)}, from.data(),
                                              static_cast<Eigen::Index>(values), f.real.size());
    const Eigen::Index real = f.even ? 0 : 1;
    if (!f.even) f.x = numbers.row(0);
    f.real = numbers.row(real);
    if (f.complex) f.imag = numbers.row(real + 1);
    text_.skip(total);
    while (const auto line = text_.line()) {
      if (trim_blanks(*line).empty()) continue;
      throw text_.error(
          from.substr(0, 0), "no end mark (-1) behind the binary values of this dataset",
          "the number of values or their precision is stated wrongly; export it again");
    }
  }

  void read_text(Uff58& f) {
    std::string_view rest = text_.rest();
    const std::size_t begin = text_.next(), end = text_.mark(begin).value_or(begin + rest.size());
    rest = rest.substr(0, end - begin);
    const auto take = [&](Eigen::Index k) {
      if (const auto value = text_.next_number(rest)) return *value;
      throw text_.error(rest,
                        fmt::format("the dataset ends after {} of {} values", k, f.real.size()),
                        "copy or export the file again");
    };
    for (Eigen::Index k = 0; k < f.real.size(); ++k) {
      if (done_with_ && k % kValuesPerCall == kValuesPerCall - 1) done_with_(end - rest.size());
      if (!f.even) f.x[k] = take(k);
      f.real[k] = take(k);
      if (f.complex) f.imag[k] = take(k);
    }
    if (rest.empty() && end == begin + text_.rest().size()) throw text_.broken_off(rest);
    if (text_.next_number(rest)) {
      remark(f, fmt::format(" holds more values than the {} it states; the rest is left out",
                            f.real.size()));
    }
  }

  UffText text_;
  const std::function<void(std::size_t)>& done_with_;
  Uff58File out_;
};

constexpr std::pair<int, Quantity> kDataTypes[] = {
    {3, Quantity::strain},        {5, Quantity::temperature}, {8, Quantity::displacement},
    {13, Quantity::force},        {9, Quantity::force},       {11, Quantity::velocity},
    {12, Quantity::acceleration}, {15, Quantity::pressure},   {17, Quantity::time}};

}  // namespace

std::optional<int> UffText::next_dataset() {
  const auto start = mark(next_);
  if (!start) return std::nullopt;
  next_ = *start;
  // Two marks in a row: one dataset's end and the next one's beginning, or an
  // end written twice.
  while (next_ < bytes_.size()) {
    const std::size_t end = line_end(bytes_, next_);
    const auto text = bytes_.substr(next_, end - next_);
    next_ = next_line(bytes_, end);
    if (is_mark(text)) continue;
    head_ = text;
    int type = 0;
    const auto number = trim_blanks(head_.substr(0, 6));
    const auto parsed = std::from_chars(number.data(), number.data() + number.size(), type);
    if (parsed.ec == std::errc() && type > 0) return type;
    throw error(number, "no dataset number behind the -1 mark",
                "export the file again; each dataset begins with a line of -1 "
                "and its number");
  }
  return std::nullopt;
}

std::optional<std::string_view> UffText::line() {
  if (next_ >= bytes_.size()) return std::nullopt;
  const std::size_t end = line_end(bytes_, next_);
  const auto line = bytes_.substr(next_, end - next_);
  if (is_mark(line)) return std::nullopt;
  if (end == bytes_.size()) throw broken_off(line);
  next_ = next_line(bytes_, end);
  return line;
}

std::string_view UffText::needed_line() {
  if (const auto found = line()) return *found;
  throw broken_off(bytes_.substr(next_, 0));
}

bool UffText::skip_to_end() {
  // Binary values behind a 58b that was not read are no lines; its header says
  // how many.
  const auto head_end = static_cast<std::size_t>(head_.data() - bytes_.data()) + head_.size();
  if (columns(head_, 0, 7) == "58b" && next_ == next_line(bytes_, head_end)) {
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

long UffText::line_of(std::string_view part) const {
  const auto at = static_cast<std::size_t>(part.data() - bytes_.data());
  if (at < counted_to_) counted_to_ = 0, counted_ = 1;
  while (true) {
    const std::size_t next = next_line(bytes_, line_end(bytes_, counted_to_));
    if (next > at || next >= bytes_.size()) return counted_;
    counted_to_ = next;
    ++counted_;
  }
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

Uff58File read_uff58(std::string_view bytes, const std::string& file,
                     const std::function<void(std::size_t)>& done_with) {
  return Uff58Reader(bytes, file, done_with).read();
}

double Uff58::noted(const std::string& key, double fallback) const {
  const auto entry = remark.find(key);
  double value = 0;
  return entry != remark.end() && parse_whole_number(entry->second, '.', value) &&
                 std::isfinite(value)
             ? value
             : fallback;
}

}  // namespace rigfit::signal
