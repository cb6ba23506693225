#include "signal/readers/uff/read_uff_modes.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "signal/numerics/numbers.h"
#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/csv/csv_layout.h"
#include "signal/readers/files/mapped_file.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

constexpr int kNormalMode = 2, kComplexFirstOrder = 3, kComplexSecondOrder = 7;
// Frequencies from the two halves of a pair printed with six digits differ by less.
constexpr double kPrinted = 1e-5;
constexpr int kScalar = 1, kTranslations = 2, kTranslationsAndRotations = 3;

class UffModesReader {
 public:
  UffModesReader(std::string_view bytes, std::string file)
      : bytes_(bytes), file_(std::move(file)) {}

  UffModes read() {
    while (seek_mark()) {
      take_line();
      // Two marks in a row: one dataset's end and the next one's beginning, or an end written
      // twice.
      while (line_ && is_mark(*line_)) take_line();
      if (!line_) break;
      dataset_line_ = number_;
      int type = 0;
      std::string_view word = trim_blanks(line_->substr(0, 6));
      const auto parsed = std::from_chars(word.data(), word.data() + word.size(), type);
      if (parsed.ec != std::errc() || type <= 0) {
        throw error(1, word, "no dataset number behind the -1 mark",
                    "export the file again; each dataset begins with a line of -1 and its number");
      }
      any_ = true;
      switch (type) {
        case 15:
          read_points();
          break;
        case 55:
          read_shape();
          break;
        case 58:
          skip_binary();
          break;
        case 164:
          read_units();
          break;
        case 2411:
          read_double_points();
          break;
        case 2412:
        case 2414:
          others_.insert(type);
          break;
        default:
          break;
      }
      skip_to_end();
    }
    return finished();
  }

 private:
  static bool is_mark(std::string_view line) { return trim_blanks(line) == "-1"; }

  RecordingError error(long column, std::string_view value, std::string problem,
                       std::string remedy) const {
    return {{file_, number_, column, "", to_utf8(value.substr(0, 60))},
            std::move(problem),
            std::move(remedy)};
  }

  /// The next line into `line_`; nothing at the end of the file.
  void take_line() {
    if (next_ >= bytes_.size()) {
      line_.reset();
      return;
    }
    const std::size_t end = line_end(bytes_, next_);
    line_ = bytes_.substr(next_, end - next_);
    next_ = next_line(bytes_, end);
    ++number_;
  }

  bool seek_mark() {
    do take_line();
    while (line_ && !is_mark(*line_));
    return line_.has_value();
  }

  void skip_to_end() {
    while (line_ && !is_mark(*line_)) take_line();
    if (!line_) {
      out_.remarks.push_back("the dataset in line " + std::to_string(dataset_line_) +
                             " has no end mark (-1)");
    }
  }

  /// A line that belongs to the dataset, or an error.
  std::string_view inner_line() {
    take_line();
    if (!line_ || is_mark(*line_)) {
      throw error(0, "", "the dataset of line " + std::to_string(dataset_line_) + " breaks off",
                  "copy or export the file again");
    }
    return *line_;
  }

  /// Words of a line with the column that each begins at, from 1.
  struct Word {
    std::string_view text;
    long column;
  };
  static std::vector<Word> words(std::string_view line) {
    std::vector<Word> list;
    for (std::size_t k = 0; k < line.size();) {
      while (k < line.size() && std::isspace(static_cast<unsigned char>(line[k]))) ++k;
      const std::size_t from = k;
      while (k < line.size() && !std::isspace(static_cast<unsigned char>(line[k]))) ++k;
      if (k > from) list.push_back({line.substr(from, k - from), static_cast<long>(from) + 1});
    }
    return list;
  }

  int integer(const Word& word) const {
    int value = 0;
    const char* first = word.text.data();
    const char* last = first + word.text.size();
    if (*first == '+') ++first;
    const auto parsed = std::from_chars(first, last, value);
    if (parsed.ec != std::errc() || parsed.ptr != last) {
      throw error(word.column, word.text, "not a whole number",
                  "fix the value, or export the file again");
    }
    return value;
  }

  std::vector<int> integers(std::size_t least, const char* what) {
    const auto line = inner_line();
    std::vector<int> values;
    for (const Word& word : words(line)) values.push_back(integer(word));
    if (values.size() < least) {
      throw error(0, trim_blanks(line),
                  std::string(what) + " needs " + std::to_string(least) + " whole numbers",
                  "export the file again");
    }
    return values;
  }

  /// Appends the numbers of a line, which may stand without blanks between them (E13.5).
  void append_numbers(std::string_view line, std::size_t from, std::vector<double>& values) {
    // The parser needs a character behind the last number.
    copy_.assign(line.substr(std::min(from, line.size())));
    copy_ += '\n';
    const char* const begin = copy_.data();
    const char* const end = begin + copy_.size();
    for (const char* p = begin;;) {
      while (p < end && std::isspace(static_cast<unsigned char>(*p))) ++p;
      if (p >= end) return;
      double value = 0;
      const char* q = parse_number(p, end, '.', value);
      if (q == nullptr || !std::isfinite(value)) {
        const char* word_end = p;
        while (word_end < end && !std::isspace(static_cast<unsigned char>(*word_end))) ++word_end;
        throw error(static_cast<long>(from) + static_cast<long>(p - begin) + 1,
                    std::string_view(p, static_cast<std::size_t>(word_end - p)),
                    q == nullptr ? "not a number" : "a number too large for a double",
                    "fix the value, or export the file again");
      }
      values.push_back(value);
      p = q;
    }
  }

  /// `count` numbers over as many lines as they take.
  std::vector<double> numbers(std::size_t count) {
    std::vector<double> values;
    while (values.size() < count) {
      const auto line = inner_line();
      const std::size_t had = values.size();
      append_numbers(line, 0, values);
      if (values.size() == had) {
        throw error(0, "", "an empty line among the values", "copy or export the file again");
      }
    }
    return values;
  }

  /// Binary values behind a 58b are no lines; what its header says of them is passed over.
  void skip_binary() {
    const std::string_view head = *line_;
    if (head.size() < 43 || (head[6] != 'b' && head[6] != 'B')) return;
    std::int64_t text_lines = 0, bytes = 0;
    const auto field = [&](std::size_t from, std::int64_t& value) {
      const auto word = trim_blanks(head.substr(from, 12));
      std::from_chars(word.data(), word.data() + word.size(), value);
    };
    field(19, text_lines);
    field(31, bytes);
    for (std::int64_t k = 0; k < std::min<std::int64_t>(text_lines, 1000); ++k) {
      take_line();
      if (!line_) return;
    }
    if (bytes <= 0 || static_cast<std::size_t>(bytes) > bytes_.size() - next_) return;
    const auto values = bytes_.substr(next_, static_cast<std::size_t>(bytes));
    number_ += static_cast<long>(std::count(values.begin(), values.end(), '\n'));
    next_ += static_cast<std::size_t>(bytes);
    take_line();
  }

  void read_points() {
    for (take_line(); line_ && !is_mark(*line_); take_line()) {
      const auto list = words(*line_);
      if (list.empty()) continue;
      if (list.size() < 4) {
        throw error(0, trim_blanks(*line_), "a point has four whole numbers and three coordinates",
                    "export dataset 15 again");
      }
      UffNode node;
      node.node = integer(list[0]);
      node.displacement_system = integer(list[2]);
      integer(list[3]);
      std::vector<double> xyz;
      append_numbers(*line_, static_cast<std::size_t>(list[3].column - 1) + list[3].text.size(),
                     xyz);
      add_point(node, xyz);
    }
  }

  void read_double_points() {
    for (take_line(); line_ && !is_mark(*line_); take_line()) {
      const auto list = words(*line_);
      if (list.empty()) continue;
      if (list.size() < 3) {
        throw error(0, trim_blanks(*line_), "a point has four whole numbers, then its coordinates",
                    "export dataset 2411 again");
      }
      UffNode node;
      node.node = integer(list[0]);
      node.displacement_system = integer(list[2]);
      std::vector<double> xyz;
      append_numbers(inner_line(), 0, xyz);
      add_point(node, xyz);
    }
  }

  void add_point(UffNode node, const std::vector<double>& xyz) {
    if (xyz.size() != 3) {
      throw error(0, trim_blanks(*line_),
                  "a point has three coordinates, not " + std::to_string(xyz.size()),
                  "export the points again");
    }
    std::copy(xyz.begin(), xyz.end(), node.position_m.begin());
    points_[node.node] = node;  // the last one written counts
  }

  void read_units() {
    inner_line();
    std::vector<double> factors;
    append_numbers(inner_line(), 0, factors);
    if (factors.empty() || !(factors[0] > 0)) {
      throw error(0, trim_blanks(*line_), "the factor of lengths must be positive",
                  "export dataset 164 again");
    }
    per_metre_ = factors[0];
  }

  void read_shape() {
    const long at = number_;
    for (int k = 0; k < 5; ++k) inner_line();  // identification
    const auto form = integers(6, "the sixth record of dataset 55");
    const int analysis = form[1], characteristic = form[2], data_type = form[4], values = form[5];
    const bool complex_mode = analysis == kComplexFirstOrder || analysis == kComplexSecondOrder;
    if (analysis != kNormalMode && !complex_mode) {
      ++not_modes_;
      return;
    }
    const bool complex_values = data_type == 5 || data_type == 6;
    if (!complex_values && data_type != 2 && data_type != 4) {
      throw error(0, std::to_string(data_type), "unknown kind of numbers",
                  "dataset 55 knows 2 and 4 (real), 5 and 6 (complex)");
    }
    if (values < 1 || values > 1000) {
      throw error(0, std::to_string(values), "unlikely number of values at each node",
                  "shapes have 3 (translations) or 6 (with rotations)");
    }
    const auto about = integers(2, "the seventh record of dataset 55");
    if (about[0] < 0 || about[1] < 1 || about[1] > 12) {
      throw error(0, trim_blanks(*line_), "unlikely numbers of parameters",
                  "the seventh record begins with the numbers of whole and of real parameters "
                  "(2 and 4 or 6 for modes)");
    }
    if (about[0] > 6 && about.size() <= 8) integers(1, "the seventh record's second line");
    std::vector<double> eigen;
    for (int k = 0; k < (about[1] + 5) / 6; ++k) append_numbers(inner_line(), 0, eigen);
    if (eigen.empty() || (complex_mode && eigen.size() < 2)) {
      throw error(0, trim_blanks(*line_),
                  complex_mode ? "an eigenvalue has a real and an imaginary part"
                               : "a normal mode has a frequency",
                  "export dataset 55 again");
    }
    UffMode mode;
    mode.line = at;
    bool conjugate = false;  // the eigenvalue given is the conjugate of the mode's
    if (analysis == kNormalMode) {
      mode.frequency_hz = eigen[0];
      if (eigen.size() > 2) mode.damping_ratio = eigen[2];
      if (mode.damping_ratio == 0 && eigen.size() > 3) mode.damping_ratio = 0.5 * eigen[3];
    } else {
      const std::complex<double> pole(eigen[0], eigen[1]);
      mode.frequency_hz = std::abs(pole) / (2 * std::numbers::pi);
      if (mode.frequency_hz > 0) mode.damping_ratio = -pole.real() / std::abs(pole);
      conjugate = pole.imag() < 0;
    }
    if (!std::isfinite(mode.frequency_hz)) {
      throw error(0, trim_blanks(*line_), "a frequency too large for a double",
                  "fix the value, or export the file again");
    }
    if (mode.damping_ratio == 0) mode.damping_ratio = kNaN;
    const bool directed = (characteristic == kTranslations && values == 3) ||
                          (characteristic == kTranslationsAndRotations && values == 6) ||
                          (characteristic == 0 && (values == 3 || values == 6));
    if (!directed) ++(characteristic == kScalar ? scalars_ : undirected_);
    const std::size_t each = static_cast<std::size_t>(values) * (complex_values ? 2 : 1);
    for (take_line(); line_ && !is_mark(*line_); take_line()) {
      const auto list = words(*line_);
      if (list.empty()) continue;
      UffNodeShape node;
      node.node = integer(list[0]);
      if (list.size() > 1) {
        throw error(list[1].column, list[1].text, "a node's number stands alone in its line",
                    "the values follow in the next lines; export the file again");
      }
      const auto at_node = numbers(each);
      if (at_node.size() > each) {
        throw error(0, trim_blanks(*line_),
                    "node " + std::to_string(node.node) + " has " + std::to_string(at_node.size()) +
                        " values, not " + std::to_string(each) + " as the dataset states",
                    "export the file again");
      }
      if (!directed) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        node.translation[k] = complex_values
                                  ? std::complex<double>(at_node[2 * k], at_node[2 * k + 1])
                                  : std::complex<double>(at_node[k]);
        if (conjugate) node.translation[k] = std::conj(node.translation[k]);
      }
      mode.shape.push_back(node);
    }
    if (!(mode.frequency_hz > 0)) {
      ++still_;
      return;
    }
    (conjugate ? conjugates_ : out_.modes).push_back(std::move(mode));
  }

  UffModes finished() {
    const auto say = [&](int count, const char* one, const char* many) {
      if (count > 0) {
        out_.remarks.push_back(std::to_string(count) + " " + (count == 1 ? one : many));
      }
    };
    say(not_modes_, "dataset 55 is no mode and was left out",
        "datasets 55 are no modes and were left out");
    for (auto& mode : conjugates_) {
      const bool twice = std::any_of(out_.modes.begin(), out_.modes.end(), [&](const UffMode& m) {
        return std::abs(m.frequency_hz - mode.frequency_hz) < kPrinted * mode.frequency_hz;
      });
      if (!twice) out_.modes.push_back(std::move(mode));
    }
    say(still_, "mode of no frequency was left out", "modes of no frequency were left out");
    say(scalars_ + undirected_, "shape without directions was left out (its frequency is taken)",
        "shapes without directions were left out (their frequencies are taken)");
    std::string others;
    for (const int type : others_) others += (others.empty() ? "" : ", ") + std::to_string(type);
    if (!others.empty()) out_.remarks.push_back("datasets that are not read: " + others);
    if (out_.modes.empty()) {
      throw RecordingError(
          {file_, 1, 1, "", ""},
          any_ ? "holds no mode (dataset 55, analysis type 2, 3 or 7)" +
                     (others.empty() ? "" : " but datasets " + others)
               : "holds no dataset",
          "export the mode shapes as UFF 55; FRFs (UFF 58) are taken by rigfit modal and --frf");
    }
    for (auto& [number, node] : points_) {
      for (double& x : node.position_m) {
        x /= per_metre_;
        if (!std::isfinite(x)) {
          throw RecordingError({file_, 0, 0, "", std::to_string(per_metre_)},
                               "node " + std::to_string(number) + " lies beyond all bounds",
                               "fix the factor of lengths in dataset 164");
        }
      }
      out_.nodes.push_back(node);
    }
    std::stable_sort(out_.modes.begin(), out_.modes.end(),
                     [](const auto& l, const auto& r) { return l.frequency_hz < r.frequency_hz; });
    return std::move(out_);
  }

  std::string_view bytes_;
  std::string file_, copy_;
  std::size_t next_ = 0;  // offset of the line after `line_`
  long number_ = 0;       // of `line_`, from 1
  std::optional<std::string_view> line_;
  long dataset_line_ = 0;
  bool any_ = false;
  double per_metre_ = 1;
  int not_modes_ = 0, still_ = 0, scalars_ = 0, undirected_ = 0;
  std::set<int> others_;  // datasets that are not read
  std::map<int, UffNode> points_;
  std::vector<UffMode> conjugates_;  // conjugates of modes given at negative frequency
  UffModes out_;
};

}  // namespace

UffModes read_uff_modes(std::string_view bytes, const std::filesystem::path& path) {
  return UffModesReader(bytes, path.string()).read();
}

UffModes read_uff_modes(const std::filesystem::path& path) {
  const MappedFile file(path);
  return read_uff_modes(file.bytes(), path);
}

}  // namespace rigfit::signal
