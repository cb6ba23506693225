#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/csv/csv_layout.h"
#include "signal/readers/uff/uff58.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

constexpr Eigen::Index kValuesPerCall = Eigen::Index{1} << 18;  // values between calls
constexpr int kHeaderLines = 11;  // lines of text behind the dataset's number

/// Fixed columns `from` .. `from + width` of a record, without blanks.
std::string_view columns(std::string_view line, std::size_t from, std::size_t width) {
  return from >= line.size() ? std::string_view{} : trim_blanks(line.substr(from, width));
}

std::string text_field(std::string_view line, std::size_t from, std::size_t width) {
  const std::string text(trim_blanks(to_utf8(columns(line, from, width))));
  return text == "NONE" || text == "None" || text == "none" ? "" : text;
}

class Uff58Reader {
 public:
  Uff58Reader(std::string_view bytes, const std::string& file,
              const std::function<void(std::size_t)>& done_with)
      : bytes_(bytes), file_(file), done_with_(done_with) {}

  Uff58File read() {
    Uff58File out;
    bool any = false;
    while (const auto start = next_mark(at_)) {
      std::size_t at = after_line(*start);
      // Two marks in a row: the end of one dataset was already taken, or is written twice.
      const auto number = trim_blanks(line_at(at).substr(0, 6));
      if (number == "-1") {
        at_ = at;
        continue;
      }
      if (number.empty() && at >= bytes_.size()) break;
      any = true;
      at_ = at;
      int type = 0;
      const auto parsed = std::from_chars(number.data(), number.data() + number.size(), type);
      if (parsed.ec != std::errc() || type <= 0) {
        throw error(at, 1, number, "no dataset number behind the -1 mark",
                    "export the file again; each dataset begins with a line of -1 and its number");
      }
      if (type == 58) {
        out.functions.push_back(read_function(out));
        if (done_with_) done_with_(at_);
      } else {
        out.other_datasets.push_back(type);
        const auto end = next_mark(after_line(at));
        if (!end) {
          out.remarks.push_back("dataset " + std::to_string(type) + " has no end mark (-1)");
          break;
        }
        at_ = after_line(*end);
      }
    }
    if (!any) {
      throw RecordingError({file_, 1, 1, "", ""}, "holds no dataset",
                           "export it as UFF 58 once more");
    }
    return out;
  }

 private:
  [[nodiscard]] std::string_view line_at(std::size_t at) const {
    return bytes_.substr(std::min(at, bytes_.size()), line_end(bytes_, at) - at);
  }
  [[nodiscard]] std::size_t after_line(std::size_t at) const {
    return next_line(bytes_, line_end(bytes_, at));
  }

  /// 1-based; lines behind binary values are counted as their bytes have it.
  [[nodiscard]] long line_of(std::size_t at) const {
    if (at < counted_to_) counted_to_ = 0, counted_ = 1;
    while (true) {
      const std::size_t next = next_line(bytes_, line_end(bytes_, counted_to_));
      if (next > at || next >= bytes_.size()) return counted_;
      counted_to_ = next;
      ++counted_;
    }
  }

  RecordingError error(std::size_t at, long column, std::string_view value, std::string problem,
                       std::string remedy) const {
    return {{file_, line_of(at), column, "", to_utf8(value.substr(0, 60))},
            std::move(problem),
            std::move(remedy)};
  }

  /// Offset of the next line that holds "-1" and nothing else, at or behind the line start `from`.
  [[nodiscard]] std::optional<std::size_t> next_mark(std::size_t from) const {
    for (std::size_t hit = bytes_.find("-1", from); hit != std::string_view::npos;
         hit = bytes_.find("-1", hit + 2)) {
      std::size_t start = hit;
      while (start > from && (bytes_[start - 1] == ' ' || bytes_[start - 1] == '\t')) --start;
      if (start > from && bytes_[start - 1] != '\n' && bytes_[start - 1] != '\r') continue;
      std::size_t behind = hit + 2;
      while (behind < bytes_.size() && (bytes_[behind] == ' ' || bytes_[behind] == '\t')) ++behind;
      if (behind < bytes_.size() && bytes_[behind] != '\n' && bytes_[behind] != '\r') continue;
      return start;
    }
    return std::nullopt;
  }

  int integer(std::size_t line_at_offset, std::string_view line, std::size_t from,
              std::size_t width) const {
    const auto text = columns(line, from, width);
    if (text.empty()) return 0;
    int value = 0;
    const char* first = text.data();
    if (*first == '+') ++first;
    const auto parsed = std::from_chars(first, text.data() + text.size(), value);
    if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size()) {
      throw error(line_at_offset, static_cast<long>(from) + 1, text, "not a whole number",
                  "this record of dataset 58 has fixed columns; export the file again");
    }
    return value;
  }

  double number(std::size_t line_at_offset, std::string_view line, std::size_t from,
                std::size_t width) const {
    const auto text = columns(line, from, width);
    if (text.empty()) return 0;
    double value = 0;
    if (!parse_whole_number(text, '.', value) || !std::isfinite(value)) {
      throw error(line_at_offset, static_cast<long>(from) + 1, text, "not a number",
                  "this record of dataset 58 has fixed columns; export the file again");
    }
    return value;
  }

  Uff58Axis axis(std::size_t at) const {
    const auto line = line_at(at);
    Uff58Axis out;
    out.data_type = integer(at, line, 0, 10);
    for (std::size_t k = 0; k < 3; ++k) out.exponents[k] = integer(at, line, 10 + 5 * k, 5);
    out.label = text_field(line, 25, 21);
    out.unit = text_field(line, 46, 21);
    return out;
  }

  Uff58 read_function(Uff58File& file) {
    Uff58 f;
    const std::size_t first = at_;
    f.line = line_of(first);
    const auto head = line_at(first);
    int byte_order = 1, float_format = 2, text_lines = kHeaderLines;
    std::int64_t stated_bytes = 0;
    if (head.size() > 6 && (head[6] == 'b' || head[6] == 'B')) {
      f.binary = true;
      byte_order = integer(first, head, 7, 6);
      float_format = integer(first, head, 13, 6);
      text_lines = integer(first, head, 19, 12);
      const auto stated = columns(head, 31, 12);
      std::from_chars(stated.data(), stated.data() + stated.size(), stated_bytes);
      if (byte_order != 1 && byte_order != 2) {
        throw error(first, 8, columns(head, 7, 6), "unknown byte order",
                    "use 1 (little) or 2 (big)");
      }
      if (float_format != 2) {
        throw error(first, 14, columns(head, 13, 6), "floats other than IEEE 754 are not read",
                    "export with IEEE floats (2), or as text");
      }
      if (text_lines < kHeaderLines || text_lines > 1000) {
        throw error(first, 20, columns(head, 19, 12), "dataset 58 has 11 lines of text",
                    "export the file again");
      }
    }
    std::array<std::size_t, kHeaderLines> at{};
    std::size_t next = after_line(first);
    for (std::size_t k = 0; k < at.size(); ++k) {
      if (next >= bytes_.size()) {
        throw error(first, 0, "", "the dataset breaks off inside its header",
                    "copy or export the file again");
      }
      at[k] = next;
      next = after_line(next);
    }
    for (int k = kHeaderLines; k < text_lines; ++k) next = after_line(next);
    for (std::size_t k = 0; k < 5; ++k) f.id[k] = text_field(line_at(at[k]), 0, 80);

    const auto dof = line_at(at[5]);
    f.function_type = integer(at[5], dof, 0, 5);
    f.response = {text_field(dof, 30, 11), integer(at[5], dof, 41, 10), integer(at[5], dof, 51, 4)};
    f.reference = {text_field(dof, 55, 11), integer(at[5], dof, 66, 10),
                   integer(at[5], dof, 76, 4)};

    const auto form = line_at(at[6]);
    const int data_type = integer(at[6], form, 0, 10);
    const int count = integer(at[6], form, 10, 10);
    const int spacing = integer(at[6], form, 20, 10);
    if (data_type != 2 && data_type != 4 && data_type != 5 && data_type != 6) {
      throw error(at[6], 1, columns(form, 0, 10), "unknown kind of numbers",
                  "dataset 58 knows 2 and 4 (real), 5 and 6 (complex)");
    }
    if (count < 1) {
      throw error(at[6], 11, columns(form, 10, 10), "the function holds no values",
                  "record or export it again");
    }
    if (spacing != 0 && spacing != 1) {
      throw error(at[6], 21, columns(form, 20, 10), "unknown spacing of the abscissa",
                  "use 0 (uneven) or 1 (even)");
    }
    f.complex = data_type >= 5;
    f.single_precision = data_type == 2 || data_type == 5;
    f.even = spacing == 1;
    f.abscissa_start = number(at[6], form, 30, 13);
    f.abscissa_step = number(at[6], form, 43, 13);
    f.abscissa_step_half_digit =
        0.5 * std::pow(10.0, -printed_decimals(columns(form, 43, 13), '.'));
    f.abscissa = axis(at[7]);
    f.ordinate = axis(at[8]);
    f.denominator = axis(at[9]);
    f.z = axis(at[10]);

    const std::size_t per_point = (f.complex ? 2U : 1U) + (f.even ? 0U : 1U);
    const std::size_t left = bytes_.size() - std::min(next, bytes_.size());
    const auto n = static_cast<std::size_t>(count);
    // Before any memory is taken: could the file hold that many numbers at all?
    const std::size_t least = f.binary ? (f.single_precision ? 4 : 8) * n : 2 * n;
    if (least > left + 2) {
      throw error(at[6], 11, columns(form, 10, 10),
                  "the file is too short for the values that this dataset states",
                  "copy or export the file again");
    }
    if (!f.even) f.x.resize(count);
    f.real.resize(count);
    if (f.complex) f.imag.resize(count);
    if (f.binary) {
      read_binary(f, next, byte_order == 2,
                  static_cast<std::size_t>(std::max<std::int64_t>(0, stated_bytes)), file);
    } else {
      read_text(f, next, per_point, file);
    }
    return f;
  }

  /// Whether the dataset's end mark (or the file's end) follows at `at`, behind blanks.
  [[nodiscard]] bool ends_at(std::size_t at) const {
    if (at > bytes_.size()) return false;
    while (at < bytes_.size() && std::isspace(static_cast<unsigned char>(bytes_[at]))) ++at;
    if (at == bytes_.size()) return true;
    return bytes_.substr(at, 2) == "-1" &&
           (at + 2 == bytes_.size() || std::isspace(static_cast<unsigned char>(bytes_[at + 2])));
  }

  void read_binary(Uff58& f, std::size_t from, bool big, std::size_t stated, Uff58File& file) {
    const auto n = static_cast<std::size_t>(f.real.size());
    const std::size_t width = f.single_precision ? 4 : 8;
    const std::size_t values = f.complex ? 2 : 1;
    std::size_t x_width = f.even ? 0 : width;
    std::size_t total = n * (values * width + x_width);
    // An uneven abscissa of double-precision values is written in double precision by some, in
    // single by others (as 2(E13.5,E20.12) has it); some state a wrong number of bytes. What the
    // end mark follows is right.
    if (!f.even && !f.single_precision &&
        (!ends_at(from + total) || from + total > bytes_.size())) {
      const std::size_t narrow = n * (values * width + 4);
      if (from + narrow <= bytes_.size() && ends_at(from + narrow)) x_width = 4, total = narrow;
    }
    if (from + total > bytes_.size()) {
      throw error(from, 0, "", "the file breaks off inside the binary values of this dataset",
                  "copy or export the file again");
    }
    if (stated != 0 && stated != total) {
      file.remarks.push_back("the dataset in line " + std::to_string(f.line) + " states " +
                             std::to_string(stated) + " bytes of values and holds " +
                             std::to_string(total));
    }
    const char* p = bytes_.data() + from;
    const auto take = [&](std::size_t size) {
      double value = 0;
      if (size == 4) {
        std::uint32_t bits = 0;
        std::memcpy(&bits, p, 4);
        if (big != (std::endian::native == std::endian::big)) bits = __builtin_bswap32(bits);
        value = static_cast<double>(std::bit_cast<float>(bits));
      } else {
        std::uint64_t bits = 0;
        std::memcpy(&bits, p, 8);
        if (big != (std::endian::native == std::endian::big)) bits = __builtin_bswap64(bits);
        value = std::bit_cast<double>(bits);
      }
      p += size;
      return value;
    };
    for (std::size_t k = 0; k < n; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      if (!f.even) f.x[row] = take(x_width);
      f.real[row] = take(width);
      if (f.complex) f.imag[row] = take(width);
    }
    const std::size_t end = from + total;
    if (!ends_at(end)) {
      throw error(from, 0, "", "no end mark (-1) behind the binary values of this dataset",
                  "the number of values or their precision is stated wrongly; export it again");
    }
    finish(f, next_mark(skip_blanks(end)), end, file);
  }

  [[nodiscard]] std::size_t skip_blanks(std::size_t at) const {
    while (at < bytes_.size() && std::isspace(static_cast<unsigned char>(bytes_[at]))) ++at;
    return at;
  }

  void read_text(Uff58& f, std::size_t from, std::size_t per_point, Uff58File& file) {
    const auto mark = next_mark(from);
    const std::size_t block_end = mark.value_or(bytes_.size());
    // The parser needs a character behind the last number: the mark's line, or a copy's end.
    std::string copy;
    const char* p = bytes_.data() + from;
    const char* end = bytes_.data() + block_end;
    if (!mark) {
      copy.assign(bytes_.substr(from));
      copy += '\n';
      p = copy.data();
      end = copy.data() + copy.size();
    }
    const char* const begin = p;
    const auto n = f.real.size();
    const auto offset = [&](const char* q) { return from + static_cast<std::size_t>(q - begin); };
    for (Eigen::Index k = 0; k < n; ++k) {
      if (done_with_ && k % kValuesPerCall == kValuesPerCall - 1) done_with_(offset(p));
      for (std::size_t part = 0; part < per_point; ++part) {
        while (p < end && std::isspace(static_cast<unsigned char>(*p))) ++p;
        double value = 0;
        const char* q = p < end ? parse_number(p, end, '.', value) : nullptr;
        if (q == nullptr || q > end) {
          if (p >= end) {
            throw error(std::min(offset(p), bytes_.size() - 1), 0, "",
                        "the dataset ends after " + std::to_string(k) + " of " + std::to_string(n) +
                            " values",
                        "copy or export the file again");
          }
          const char* word_end = p;
          while (word_end < end && !std::isspace(static_cast<unsigned char>(*word_end))) ++word_end;
          const std::string_view word(p, static_cast<std::size_t>(word_end - p));
          if (!is_missing_word(word)) throw bad_value(offset(p), word, "not a number");
          value = std::numeric_limits<double>::quiet_NaN();
          q = word_end;
        } else if (std::isinf(value)) {
          throw bad_value(offset(p), std::string_view(p, static_cast<std::size_t>(q - p)),
                          "a number too large for a double");
        }
        p = q;
        if (!f.even && part == 0) {
          f.x[k] = value;
        } else if (f.complex && part + 1 == per_point) {
          f.imag[k] = value;
        } else {
          f.real[k] = value;
        }
      }
    }
    while (p < end && std::isspace(static_cast<unsigned char>(*p))) ++p;
    if (p < end) {
      file.remarks.push_back("the dataset in line " + std::to_string(f.line) +
                             " holds more values than the " + std::to_string(n) +
                             " it states; the rest is left out");
    }
    finish(f, mark, bytes_.size(), file);
  }

  RecordingError bad_value(std::size_t at, std::string_view word, const char* problem) const {
    std::size_t start = at;
    while (start > 0 && bytes_[start - 1] != '\n' && bytes_[start - 1] != '\r') --start;
    return error(at, static_cast<long>(at - start) + 1, word, problem,
                 "fix the value, or export the file again");
  }

  void finish(const Uff58& f, std::optional<std::size_t> mark, std::size_t end, Uff58File& file) {
    if (mark) {
      at_ = after_line(*mark);
    } else {
      at_ = end;
      file.remarks.push_back("the dataset in line " + std::to_string(f.line) +
                             " has no end mark (-1)");
    }
  }

  std::string_view bytes_;
  const std::string& file_;
  const std::function<void(std::size_t)>& done_with_;
  std::size_t at_ = 0;
  mutable std::size_t counted_to_ = 0;  // start of line `counted_`
  mutable long counted_ = 1;
};

}  // namespace

const char* uff58_function_name(int type) {
  static constexpr std::array<const char*, 13> kNames = {"general function",
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
  return type >= 0 && type < static_cast<int>(kNames.size())
             ? kNames[static_cast<std::size_t>(type)]
             : "function of another type";
}

std::string uff58_direction(int direction) {
  static constexpr const char* kAxes[] = {"", "X", "Y", "Z", "RX", "RY", "RZ"};
  if (direction == 0 || std::abs(direction) > 6) return "";
  return std::string(direction > 0 ? "+" : "-") + kAxes[std::abs(direction)];
}

namespace {

constexpr std::pair<int, Quantity> kDataTypes[] = {
    {3, Quantity::strain},        {5, Quantity::temperature}, {8, Quantity::displacement},
    {13, Quantity::force},        {9, Quantity::force},       {11, Quantity::velocity},
    {12, Quantity::acceleration}, {15, Quantity::pressure},   {17, Quantity::time}};

}  // namespace

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

std::map<std::string, std::string> parse_uff58_remark(std::string_view line) {
  std::map<std::string, std::string> out;
  constexpr std::string_view kMark = "rigfit ";
  if (line.substr(0, kMark.size()) != kMark) return out;
  line.remove_prefix(kMark.size());
  while (!line.empty()) {
    const std::size_t end = std::min(line.find(' '), line.size());
    const auto word = line.substr(0, end);
    const std::size_t sign = word.find('=');
    if (sign != std::string_view::npos) {
      out.emplace(std::string(word.substr(0, sign)), std::string(word.substr(sign + 1)));
    }
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return out;
}

double remark_number(const std::map<std::string, std::string>& remark, const std::string& key,
                     double fallback) {
  const auto entry = remark.find(key);
  double value = 0;
  if (entry == remark.end() || !parse_whole_number(entry->second, '.', value) ||
      !std::isfinite(value)) {
    return fallback;
  }
  return value;
}

}  // namespace rigfit::signal
