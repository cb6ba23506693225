#include "signal/readers/uff/uff58.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <utility>

#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/uff/uff_text.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

constexpr Eigen::Index kValuesPerCall = Eigen::Index{1} << 18;  // values between calls
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

class Uff58Reader {
 public:
  Uff58Reader(std::string_view bytes, const std::string& file,
              const std::function<void(std::size_t)>& done_with)
      : bytes_(bytes), text_(bytes, file), done_with_(done_with) {}

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
  Uff58Point point(const UffLine& line, std::size_t from) const {
    return {text_field(line.text, from, 11), text_.integer(line, from + 11, 10),
            text_.integer(line, from + 21, 4)};
  }

  Uff58Axis axis(const UffLine& line) const {
    // The exponents of units are not needed, but are whole numbers unless columns have slipped.
    for (const std::size_t from : {10U, 15U, 20U}) static_cast<void>(text_.integer(line, from, 5));
    return {text_.integer(line, 0, 10), text_field(line.text, 25, 21),
            text_field(line.text, 46, 21)};
  }

  Uff58 read_function() {
    Uff58 f;
    const UffLine head = text_.head();
    f.line = text_.line_of(head.at);
    f.binary = head.text.size() > 6 && (head.text[6] == 'b' || head.text[6] == 'B');
    int byte_order = 1, text_lines = kHeaderLines;
    if (f.binary) {
      byte_order = text_.integer(head, 7, 6, "unknown byte order, 1 is little and 2 big", 1, 2);
      text_.integer(head, 13, 6, "floats other than IEEE 754 (2) are not read", 2, 2);
      text_lines =
          text_.integer(head, 19, 12, "dataset 58 has 11 lines of text", kHeaderLines, 1000);
    }
    for (auto& id : f.id) id = text_field(text_.needed_line().text, 0, 80);
    add_remark(f.id[3], f.remark);
    add_remark(f.id[4], f.remark);
    const UffLine dof = text_.needed_line(), form = text_.needed_line();
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
        0.5 * std::pow(10.0, -printed_decimals(UffText::columns(form.text, 43, 13), '.'));
    for (Uff58Axis* one : {&f.abscissa, &f.ordinate, &f.denominator}) {
      *one = axis(text_.needed_line());
    }
    for (int k = kHeaderLines - 1; k < text_lines; ++k) text_.needed_line();  // z, and remarks

    // Before any memory is taken: could the file hold that many numbers at all?
    const std::size_t left = bytes_.size() - std::min(text_.next(), bytes_.size());
    const std::size_t least = f.binary ? (f.single_precision ? 4 : 8) : 2;
    if (least * static_cast<std::size_t>(count) > left + 2) {
      throw text_.error(form.at, 11, UffText::columns(form.text, 10, 10),
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
    const std::size_t from = text_.next(), width = f.single_precision ? 4 : 8;
    const std::size_t values = (f.complex ? 2 : 1) + (f.even ? 0 : 1);
    const std::size_t total = static_cast<std::size_t>(f.real.size()) * width * values;
    if (from + total > bytes_.size()) {
      throw text_.error(from, 0, "", "the file breaks off inside the binary values of this dataset",
                        "copy or export the file again");
    }
    const char* p = bytes_.data() + from;
    const auto take = [&] {
      std::array<char, 8> bytes{};
      std::memcpy(bytes.data(), p, width);
      p += width;
      if (big != (std::endian::native == std::endian::big)) {
        std::reverse(bytes.data(), bytes.data() + width);
      }
      if (width == 8) return std::bit_cast<double>(bytes);
      float value = 0;
      std::memcpy(&value, bytes.data(), 4);
      return static_cast<double>(value);
    };
    for (Eigen::Index row = 0; row < f.real.size(); ++row) {
      if (!f.even) f.x[row] = take();
      f.real[row] = take();
      if (f.complex) f.imag[row] = take();
    }
    text_.go_to(from + total);
    while (const auto line = text_.line()) {
      if (trim_blanks(line->text).empty()) continue;
      throw text_.error(
          from, 0, "", "no end mark (-1) behind the binary values of this dataset",
          "the number of values or their precision is stated wrongly; export it again");
    }
  }

  void read_text(Uff58& f) {
    std::size_t at = text_.next();
    const std::size_t end = text_.mark(at).value_or(bytes_.size());
    const auto take = [&](Eigen::Index k) {
      if (const auto value = text_.next_number(at, end)) return *value;
      throw text_.error(std::min(at, bytes_.size() - 1), 0, "",
                        fmt::format("the dataset ends after {} of {} values", k, f.real.size()),
                        "copy or export the file again");
    };
    for (Eigen::Index k = 0; k < f.real.size(); ++k) {
      if (done_with_ && k % kValuesPerCall == kValuesPerCall - 1) done_with_(at);
      if (!f.even) f.x[k] = take(k);
      f.real[k] = take(k);
      if (f.complex) f.imag[k] = take(k);
    }
    if (text_.next_number(at, end)) {
      remark(f, fmt::format(" holds more values than the {} it states; the rest is left out",
                            f.real.size()));
    }
  }

  std::string_view bytes_;
  UffText text_;
  const std::function<void(std::size_t)>& done_with_;
  Uff58File out_;
};

constexpr std::pair<int, Quantity> kDataTypes[] = {
    {3, Quantity::strain},        {5, Quantity::temperature}, {8, Quantity::displacement},
    {13, Quantity::force},        {9, Quantity::force},       {11, Quantity::velocity},
    {12, Quantity::acceleration}, {15, Quantity::pressure},   {17, Quantity::time}};

}  // namespace

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
