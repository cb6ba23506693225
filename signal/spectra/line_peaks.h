// Peaks of a spectrum as it is given line by line: where to look, not an identification.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace rigfit::signal {

struct LinePeak {
  double frequency_hz = 0;  ///< vertex of the parabola through the logarithms of three lines
  double value = 0;         ///< value of the highest line
};

/// Local maxima that stand at least 6 dB above the lowest line on either side before a higher one,
/// and above twice the spectrum's median; the `most` strongest, by rising frequency. `magnitude`:
/// not negative, as long as `frequency_hz`, which rises.
[[nodiscard]] std::vector<LinePeak> line_peaks(
    const Eigen::Ref<const Eigen::VectorXd>& frequency_hz,
    const Eigen::Ref<const Eigen::VectorXd>& magnitude, std::size_t most = 12);

}  // namespace rigfit::signal
