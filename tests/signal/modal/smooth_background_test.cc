#include "signal/modal/band_background.h"

#include "signal/numerics/numbers.h"
#include "signal/refinement/modal_basis.h"
#include "signal/refinement/modal_refine.h"
#include "tests/test.h"

namespace rigfit::signal::smooth_background_test {

/// Two accelerances with poles at 20 and 31 Hz, each line multiplied by 1 + e(f), e of echoes
/// within 30 ms of the hit on either side.
FrfLines disturbed(const VectorXcd& poles) {
  FrfLines data{.s = laplace_lines(VectorXd::LinSpaced(401, 5, 45), 0), .power = 2};
  MatrixXcd residues(2, 2);
  residues << Complex(0, -1), Complex(0, 0.7), Complex(0, -0.4), Complex(0, -0.9);
  const VectorXcd none = VectorXcd::Zero(2);
  data.H = synthesise(data.s, 2, poles, residues, none, none);
  VectorXcd factor = VectorXcd::Ones(data.s.size());
  for (const double delay : {-0.03, -0.011, 0.004, 0.017, 0.026}) {
    factor += 0.01 * (-delay * data.s.array()).exp().matrix();
  }
  data.H = factor.asDiagonal() * data.H;
  return data;
}

VectorXcd refined(const FrfLines& data, const VectorXcd& poles) {
  return refine_modes(data, noise_unknown(data.H, 1, 0), poles).poles;
}

// The disturbance moves the poles; the background spans it to 1 part in 1000, which leaves next to
// none of the movement.
TEST(SmoothBackground, PolesStayInPlaceUnderNoiseNearTheHit) {
  const VectorXcd poles =
      (VectorXcd(2) << Complex(-1, 20 * kTwoPi), Complex(-1, 31 * kTwoPi)).finished();
  FrfLines data = disturbed(poles);
  const double moved = (refined(data, poles) - poles).cwiseAbs().maxCoeff();
  data.background = smooth_background(data.s, data.power, 0.03);
  EXPECT_LT((refined(data, poles) - poles).cwiseAbs().maxCoeff(), 0.02 * moved);
}

TEST(SmoothBackground, NoneWithoutNoiseOrWhereItWouldTakeAQuarterOfTheLines) {
  const VectorXcd s = laplace_lines(VectorXd::LinSpaced(401, 5, 45), 0);
  EXPECT_EQ(smooth_background(s, 2, 0).size(), 0);
  EXPECT_EQ(smooth_background(s, 2, 1.3).size(), 0);
  const MatrixXcd terms = smooth_background(s, 2, 0.1);
  EXPECT_LT((terms.adjoint() * terms - MatrixXcd::Identity(terms.cols(), terms.cols())).norm(),
            1e-12 * 401);
}

}  // namespace rigfit::signal::smooth_background_test
