#include "signal/modal/mode_warnings.h"

#include <gtest/gtest.h>

#include <complex>
#include <random>

#include "signal/numerics/numbers.h"

namespace rigfit::signal::mode_warnings_test {
namespace {
using Complex = std::complex<double>;
using Eigen::MatrixXcd;

/// One FRF that is 1 on 200 lines 0.1 Hz apart, and a mode at 10 Hz, 5 % damped: 11 lines.
struct Around {
  ModalBand band;
  FrfNoise noise;
  IdentifiedMode mode;

  Around() {
    band.frequency_hz = Eigen::VectorXd::LinSpaced(200, 0.1, 20);
    band.spacing_hz = 0.1;
    band.lines.H = MatrixXcd::Ones(200, 1);
    noise = noise_unknown(band.lines.H, 1, 0);
    mode.pole_rad_s = {-0.05 * 10 * kTwoPi, 10 * kTwoPi};
  }
  [[nodiscard]] double beyond(const MatrixXcd& misfit) const {
    return misfit_beyond_noise(band, noise, mode, misfit);
  }
};

// Four standard deviations of the correlation of 10 pairs are 0.9: chance of one in 30000.
TEST(MisfitBeyondNoise, TellsStructureFromNoiseByNeighbouringLines) {
  Around around;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 200; ++trial) {
    MatrixXcd noise(200, 1);
    for (Complex& value : noise.reshaped()) value = Complex(normal(random), normal(random));
    EXPECT_EQ(around.beyond(0.5 * noise), 0);
  }
  EXPECT_NEAR(around.beyond(MatrixXcd::Constant(200, 1, Complex(0.3, 0.4))), 0.5, 1e-9);
}

TEST(MisfitBeyondNoise, IsWhatErrorBarsDoNotExpect) {
  Around around;
  around.band.H_std = Eigen::MatrixXd::Constant(200, 1, 0.3);
  // Twice 0.3^2 is expected, 0.5^2 + 0.4^2 left: 0.41 - 0.18.
  EXPECT_NEAR(around.beyond(MatrixXcd::Constant(200, 1, Complex(0.5, 0.4))), std::sqrt(0.23), 1e-9);
  EXPECT_EQ(around.beyond(MatrixXcd::Constant(200, 1, Complex(0.3, 0.3))), 0);
}

}  // namespace
}  // namespace rigfit::signal::mode_warnings_test
