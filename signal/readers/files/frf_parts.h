// FRFs as files hold them, one function from an input to a response each, and the set they make.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "signal/recording/recording.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

struct FrfUnit {
  double factor = 1;  ///< to SI
  FrfForm form = FrfForm::unknown;
  std::string unit;  ///< SI, such as "(m/s^2)/N"
};

/// "(m/s^2)/N" or "g/N", parted at a slash before a force. Empty: there is none.
[[nodiscard]] std::optional<FrfUnit> parse_frf_unit(const std::string& text);

/// One FRF, in SI.
struct FrfPart {
  MeasuredPoint response, input;
  FrfForm form = FrfForm::unknown;
  Eigen::VectorXd frequency_hz;
  Eigen::VectorXcd H;
  Eigen::VectorXd coherence, H_std;  ///< of as many lines; empty: not known
  std::string file;                  ///< for messages
  long line = 0;
};

/// Whether two functions have the same frequencies, but for printing (1e-6 of the last).
[[nodiscard]] bool same_lines(const Eigen::VectorXd& a, const Eigen::VectorXd& b);

/// Frequencies, points, values, coherence and standard deviation of one FRF at least. A first or
/// last line without numbers is left out with a note (0 Hz in mobility, a file cut short). Throws
/// RecordingError where frequencies do not rise or differ, forms differ, an FRF between two of the
/// points is absent or there twice, and for values that are no numbers.
[[nodiscard]] FrfSet set_of_parts(const std::vector<FrfPart>& parts);

}  // namespace rigfit::signal
