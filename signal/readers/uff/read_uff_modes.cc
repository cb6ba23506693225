#include "signal/readers/uff/read_uff_modes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>

#include "signal/numerics/numbers.h"
#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/files/mapped_file.h"
#include "signal/readers/uff/uff_text.h"
#include "signal/recording/recording_error.h"

namespace rigfit::signal {
namespace {

constexpr int kNormalMode = 2, kComplexFirstOrder = 3, kComplexSecondOrder = 7;
// Frequencies from the two halves of a pair printed with six digits differ by less.
constexpr double kPrinted = 1e-5;
constexpr int kTranslations = 2, kTranslationsAndRotations = 3;

class UffModesReader {
 public:
  UffModesReader(std::string_view bytes, std::string file)
      : bytes_(bytes), file_(std::move(file)), text_(bytes, file_) {}

  UffModes read() {
    while (const auto type = text_.next_dataset()) {
      const long line = text_.line_of(text_.head().at);
      if (*type == 15) read_points(false);
      if (*type == 2411) read_points(true);
      if (*type == 55) read_shape(line);
      if (*type == 58) skip_binary();
      if (*type == 164) read_units();
      if (*type == 2412 || *type == 2414) others_.insert(*type);
      if (!text_.skip_to_end()) {
        out_.remarks.push_back(fmt::format("the dataset in line {} has no end mark (-1)", line));
      }
    }
    return finished();
  }

 private:
  RecordingError error(const UffLine& line, std::string problem, std::string remedy) const {
    return text_.error(line.at, 0, trim_blanks(line.text), std::move(problem), std::move(remedy));
  }

  /// The whole numbers among the first of a line.
  template <std::size_t count>
  std::array<int, count> integers(const UffLine& line, const char* what) const {
    std::vector<double> values;
    append_numbers(line, values);
    std::array<int, count> result{};
    for (std::size_t k = 0; k < count; ++k) {
      if (k >= values.size() || values[k] != std::round(values[k]) || std::abs(values[k]) > 2e9) {
        throw error(
            line,
            fmt::format("{} begins with {} whole number{}", what, count, count > 1 ? "s" : ""),
            "export the file again");
      }
      result[k] = static_cast<int>(values[k]);
    }
    return result;
  }

  /// Appends the numbers of a line, which may stand without blanks between them (E13.5).
  void append_numbers(const UffLine& line, std::vector<double>& values) const {
    std::size_t at = line.at;
    while (const auto value = text_.next_number(at, line.at + line.text.size())) {
      if (std::isnan(*value)) {
        throw error(line, "not a number", "fix the value, or export the file again");
      }
      values.push_back(*value);
    }
  }

  /// Binary values behind a 58b are no lines; what its header says of them is passed over.
  void skip_binary() {
    const UffLine head = text_.head();
    if (head.text.size() < 43 || (head.text[6] != 'b' && head.text[6] != 'B')) return;
    const auto field = [&](std::size_t from) {
      std::int64_t value = 0;
      const auto word = UffText::columns(head.text, from, 12);
      std::from_chars(word.data(), word.data() + word.size(), value);
      return static_cast<std::size_t>(std::max<std::int64_t>(value, 0));
    };
    for (std::size_t k = std::min<std::size_t>(field(19), 1000); k > 0; --k) {
      if (!text_.line()) return;
    }
    const std::size_t behind = text_.next() + field(31);
    if (behind <= bytes_.size()) text_.go_to(behind);
  }

  /// Dataset 15, or with the coordinates in lines of their own, 2411.
  void read_points(bool apart) {
    while (const auto line = text_.line()) {
      if (trim_blanks(line->text).empty()) continue;
      const auto whole = integers<4>(*line, "a point");
      std::vector<double> values;
      append_numbers(*line, values);
      if (apart) append_numbers(text_.needed_line(), values);
      if (values.size() != 7) {
        throw error(*line, fmt::format("a point has three coordinates, not {}", values.size() - 4),
                    "export the points again");
      }
      // The last one written counts.
      points_[whole[0]] = {whole[0], {values[4], values[5], values[6]}, whole[2]};
    }
  }

  void read_units() {
    text_.needed_line();
    const UffLine line = text_.needed_line();
    std::vector<double> factors;
    append_numbers(line, factors);
    if (factors.empty() || !(factors[0] > 0)) {
      throw error(line, "the factor of lengths must be positive", "export dataset 164 again");
    }
    per_metre_ = factors[0];
  }

  void read_shape(long dataset_line) {
    for (int k = 0; k < 5; ++k) text_.needed_line();  // identification
    const UffLine form_line = text_.needed_line();
    const auto form = integers<6>(form_line, "the sixth record of dataset 55");
    const int analysis = form[1], characteristic = form[2], data_type = form[4], values = form[5];
    const bool complex_mode = analysis == kComplexFirstOrder || analysis == kComplexSecondOrder;
    if (analysis != kNormalMode && !complex_mode) {
      ++not_modes_;
      return;
    }
    const bool complex_values = data_type == 5 || data_type == 6;
    if (!complex_values && data_type != 2 && data_type != 4) {
      throw error(form_line, "unknown kind of numbers",
                  "dataset 55 knows 2 and 4 (real), 5 and 6 (complex)");
    }
    if (values < 1 || values > 1000) {
      throw error(form_line, "unlikely number of values at each node",
                  "shapes have 3 (translations) or 6 (with rotations)");
    }
    UffLine line = text_.needed_line();
    const auto about = integers<2>(line, "the seventh record of dataset 55");
    if (about[0] < 0 || about[0] > 6 || about[1] < 1 || about[1] > 12) {
      throw error(line, "unlikely numbers of parameters",
                  "the seventh record begins with the numbers of whole and of real parameters "
                  "(2 and 4 or 6 for modes)");
    }
    std::vector<double> eigen;
    for (int k = 0; k < (about[1] + 5) / 6; ++k) {
      line = text_.needed_line();
      append_numbers(line, eigen);
    }
    if (eigen.size() < (complex_mode ? 2U : 1U)) {
      throw error(line,
                  complex_mode ? "an eigenvalue has a real and an imaginary part"
                               : "a normal mode has a frequency",
                  "export dataset 55 again");
    }
    UffMode mode;
    mode.line = dataset_line;
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
      throw error(line, "a frequency too large for a double",
                  "fix the value, or export the file again");
    }
    if (mode.damping_ratio == 0) mode.damping_ratio = kNaN;
    const bool directed = (characteristic == kTranslations && values == 3) ||
                          (characteristic == kTranslationsAndRotations && values == 6) ||
                          (characteristic == 0 && (values == 3 || values == 6));
    if (!directed) ++undirected_;
    read_values(static_cast<std::size_t>(values), complex_values, conjugate,
                directed ? &mode : nullptr);
    if (!(mode.frequency_hz > 0)) {
      ++still_;
      return;
    }
    (conjugate ? conjugates_ : out_.modes).push_back(std::move(mode));
  }

  /// The values at each node; `mode` null: they have no directions and are passed over.
  void read_values(std::size_t values, bool complex_values, bool conjugate, UffMode* mode) {
    const std::size_t each = values * (complex_values ? 2 : 1);
    while (auto line = text_.line()) {
      if (trim_blanks(line->text).empty()) continue;
      UffNodeShape node;
      node.node = integers<1>(*line, "the line of a node")[0];
      if (trim_blanks(line->text).find_first_of(" \t") != std::string_view::npos) {
        throw error(*line, "a node's number stands alone in its line",
                    "the values follow in the next lines; export the file again");
      }
      std::vector<double> at_node;
      while (at_node.size() < each) {
        line = text_.needed_line();
        const std::size_t had = at_node.size();
        append_numbers(*line, at_node);
        if (at_node.size() > had && at_node.size() <= each) continue;
        throw error(*line,
                    fmt::format("node {} has {} values, not {} as the dataset states", node.node,
                                at_node.size(), each),
                    "export the file again");
      }
      if (mode == nullptr) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        node.translation[k] = complex_values
                                  ? std::complex<double>(at_node[2 * k], at_node[2 * k + 1])
                                  : std::complex<double>(at_node[k]);
        if (conjugate) node.translation[k] = std::conj(node.translation[k]);
      }
      mode->shape.push_back(node);
    }
  }

  UffModes finished() {
    const auto say = [&](int count, const char* one, const char* many) {
      if (count > 0) out_.remarks.push_back(fmt::format("{} {}", count, count == 1 ? one : many));
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
    say(undirected_, "shape without directions was left out (its frequency is taken)",
        "shapes without directions were left out (their frequencies are taken)");
    const std::string others = fmt::format("{}", fmt::join(others_, ", "));
    if (!others.empty()) out_.remarks.push_back("datasets that are not read: " + others);
    if (out_.modes.empty()) {
      throw RecordingError(
          {file_, 1, 1, "", ""},
          text_.any() ? "holds no mode (dataset 55, analysis type 2, 3 or 7)" +
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
  const std::string file_;
  UffText text_;
  double per_metre_ = 1;
  int not_modes_ = 0, still_ = 0, undirected_ = 0;
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
