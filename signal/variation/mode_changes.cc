#include "signal/variation/mode_changes.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

using Complex = std::complex<double>;

void set_frequency_and_damping(IdentifiedMode& mode, double frequency_hz, double damping_ratio,
                               double window) {
  mode.frequency_hz.value = frequency_hz;
  mode.damping_ratio.value = damping_ratio;
  const double omega = kTwoPi * frequency_hz;
  mode.pole_rad_s = Complex(-damping_ratio * omega,
                            omega * std::sqrt(std::max(0.0, 1 - damping_ratio * damping_ratio)));
  const Complex measured = mode.pole_rad_s - window;
  mode.damping_ratio_with_window = -measured.real() / std::abs(measured);
}

void set_std(Estimate& value, Eigen::Index row, double std, Eigen::MatrixXd& covariance) {
  if (covariance.rows() > row && value.std > 0) {
    covariance.row(row) *= std / value.std;
    covariance.col(row) *= std / value.std;
  }
  value.std = std;
}

void add_doubt(IdentifiedMode& mode, const std::string& reason) {
  mode.doubtful = true;
  mode.doubt += (mode.doubt.empty() ? "" : "; ") + reason;
}

}  // namespace rigfit::signal
