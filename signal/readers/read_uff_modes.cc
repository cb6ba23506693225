#include "signal/readers/read_recording.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "signal/readers/uff58.h"

namespace rigfit::signal {
namespace {

constexpr int kNormalMode = 2, kComplexFirstOrder = 3, kComplexSecondOrder = 7;
// Frequencies from the two halves of a pair printed with six digits differ by less.
constexpr double kPrinted = 1e-5;
constexpr int kTranslations = 2, kTranslationsAndRotations = 3;

class UffModesReader {
 public:
  UffModesReader(std::string_view bytes, std::string file)
      : file_(std::move(file)), text_(bytes, file_) {}

  UffModes read() {
    while (const auto type = text_.next_dataset()) {
      const long line = text_.line_of(text_.head());
      if (*type == 15) read_points(false);
      if (*type == 2411) read_points(true);
      if (*type == 55) read_shape(line);
      if (*type == 164) read_units();
      if (*type == 2412 || *type == 2414) others_.insert(*type);
      if (!text_.skip_to_end()) {
        out_.remarks.push_back(fmt::format("the dataset in line {} has no end mark (-1)", line));
      }
    }
    return finished();
  }

 private:
  /// Refuses a line unless it is `good`.
  void require(bool good, std::string_view line, std::string problem,
               const char* remedy = "export the file again") const {
    if (!good) throw text_.error(trim_blanks(line), std::move(problem), remedy);
  }

  /// The numbers of a line, which may stand without blanks between them (E13.5), `whole` whole ones
  /// first.
  std::vector<double> numbers(std::string_view line, std::size_t whole, const char* what) const {
    std::vector<double> values;
    for (std::string_view rest = line; const auto value = text_.next_number(rest);) {
      require(!std::isnan(*value), line, "not a number");
      values.push_back(*value);
    }
    for (std::size_t k = 0; k < whole; ++k) {
      require(k < values.size() && values[k] == std::round(values[k]) && std::abs(values[k]) < 2e9,
              line, fmt::format("{} begins with {} whole number(s)", what, whole));
    }
    return values;
  }

  /// Dataset 15, or with the coordinates in lines of their own, 2411.
  void read_points(bool apart) {
    while (const auto line = text_.line()) {
      if (trim_blanks(*line).empty()) continue;
      std::vector<double> values = numbers(*line, 4, "a point");
      if (apart) values.resize(4);
      for (const double x : apart ? numbers(text_.needed_line(), 0, "") : std::vector<double>()) {
        values.push_back(x);
      }
      require(values.size() == 7, *line,
              fmt::format("a point has three coordinates, not {}", values.size() - 4));
      // The last one written counts.
      const int node = static_cast<int>(values[0]);
      out_.nodes[node] = {{values[4], values[5], values[6]}, static_cast<int>(values[2])};
    }
  }

  void read_units() {
    text_.needed_line();
    const std::string_view line = text_.needed_line();
    const std::vector<double> factors = numbers(line, 0, "");
    require(!factors.empty() && factors[0] > 0, line, "the factor of lengths must be positive");
    per_metre_ = factors[0];
  }

  void read_shape(long dataset_line) {
    for (int k = 0; k < 5; ++k) text_.needed_line();  // identification
    std::string_view line = text_.needed_line();
    const auto form = numbers(line, 6, "the sixth record of dataset 55");
    const double analysis = form[1], characteristic = form[2], data_type = form[4];
    const bool complex_mode = analysis == kComplexFirstOrder || analysis == kComplexSecondOrder;
    if (analysis != kNormalMode && !complex_mode) {
      ++left_out_["data that are no mode"];
      return;
    }
    const bool complex_values = data_type == 5 || data_type == 6;
    require(complex_values || data_type == 2 || data_type == 4, line, "unknown kind of numbers",
            "dataset 55 knows 2 and 4 (real), 5 and 6 (complex)");
    require(form[5] >= 1 && form[5] <= 1000, line, "unlikely number of values at each node");
    const auto values = static_cast<std::size_t>(form[5]);
    line = text_.needed_line();
    const auto about = numbers(line, 2, "the seventh record of dataset 55");
    require(about[1] >= 1 && about[1] <= 12, line, "unlikely numbers of parameters");
    std::vector<double> eigen;
    for (int k = 0; k < about[1]; k += 6) {
      line = text_.needed_line();
      for (const double value : numbers(line, 0, "")) eigen.push_back(value);
    }
    require(eigen.size() >= (complex_mode ? 2U : 1U), line,
            "a normal mode has a frequency, a complex one an eigenvalue of two parts");
    eigen.resize(std::max<std::size_t>(eigen.size(), 4));
    UffMode mode;
    mode.line = dataset_line;
    bool conjugate = false;  // the eigenvalue given is the conjugate of the mode's
    if (complex_mode) {
      const Complex pole(eigen[0], eigen[1]);
      mode.frequency_hz = std::abs(pole) / (2 * std::numbers::pi);
      if (mode.frequency_hz > 0) mode.damping_ratio = -pole.real() / std::abs(pole);
      conjugate = pole.imag() < 0;
    } else {
      mode.frequency_hz = eigen[0];
      mode.damping_ratio = eigen[2] != 0 ? eigen[2] : 0.5 * eigen[3];
    }
    require(std::isfinite(mode.frequency_hz), line, "a frequency too large for a double");
    if (mode.damping_ratio == 0) mode.damping_ratio = kNaN;
    const bool directed =
        (values == 3 && (characteristic == kTranslations || characteristic == 0)) ||
        (values == 6 && (characteristic == kTranslationsAndRotations || characteristic == 0));
    if (!directed) ++left_out_["shapes without directions (their frequencies are taken)"];
    const std::size_t step = complex_values ? 2 : 1;
    while (const auto at_line = text_.line()) {
      if (trim_blanks(*at_line).empty()) continue;
      const auto first = numbers(*at_line, 1, "the line of a node");
      require(first.size() == 1, *at_line, "a node's number stands alone in its line");
      const int node = static_cast<int>(first[0]);
      std::vector<double> at_node;
      while (at_node.size() < values * step) {
        line = text_.needed_line();
        const std::size_t had = at_node.size();
        for (const double value : numbers(line, 0, "")) at_node.push_back(value);
        require(at_node.size() > had && at_node.size() <= values * step, line,
                fmt::format("node {} has {} values, not {} as the dataset states", node,
                            at_node.size(), values * step));
      }
      if (!directed) continue;
      std::array<Complex, 3> translation;
      for (std::size_t k = 0; k < 3; ++k) {
        const double imaginary = complex_values ? at_node[step * k + 1] : 0.0;
        translation[k] = {at_node[step * k], conjugate ? -imaginary : imaginary};
      }
      mode.shape.emplace(node, translation);
    }
    if (mode.frequency_hz > 0) {
      (conjugate ? conjugates_ : out_.modes).push_back(std::move(mode));
    } else {
      ++left_out_["modes of no frequency"];
    }
  }

  UffModes finished() {
    for (auto& mode : conjugates_) {
      const bool twice = std::ranges::any_of(out_.modes, [&](const UffMode& m) {
        return std::abs(m.frequency_hz - mode.frequency_hz) < kPrinted * mode.frequency_hz;
      });
      if (!twice) out_.modes.push_back(std::move(mode));
    }
    for (const auto& [what, count] : left_out_) {
      out_.remarks.push_back(fmt::format("left out: {} {}", count, what));
    }
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
    for (auto& [number, node] : out_.nodes) {
      for (double& x : node.position_m) {
        x /= per_metre_;
        if (!std::isfinite(x)) {
          throw RecordingError({file_, 0, 0, "", std::to_string(per_metre_)},
                               "node " + std::to_string(number) + " lies beyond all bounds",
                               "fix the factor of lengths in dataset 164");
        }
      }
    }
    std::ranges::stable_sort(out_.modes, {}, &UffMode::frequency_hz);
    return std::move(out_);
  }

  const std::string file_;
  UffText text_;
  double per_metre_ = 1;
  std::map<std::string, int> left_out_;
  std::set<int> others_;             // datasets that are not read
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
