#include "signal/modes/modal_model.h"

#include "tests/test.h"

namespace rigfit::signal::mac_test {

TEST(Mac, ProportionalShapesAreOneAndOrthogonalOnesZero) {
  VectorXcd a(3), b(3);
  a << Complex(1, 2), Complex(0, -1), 3;
  EXPECT_NEAR(mac(a, Complex(0.3, -7) * a), 1, 1e-14);
  b << Complex(0, 1), Complex(-2, -1), 0;  // a^H b = (1 - 2i) i + i (-2 - i) = 3 - i
  EXPECT_NEAR(mac(a, b), 10.0 / (15 * 6), 1e-15);
  EXPECT_EQ(mac(a, VectorXcd::Zero(3)), 0);
  // Residues in SI of stiff structures: squares underflow.
  EXPECT_NEAR(mac(1e-200 * a, 1e-180 * a), 1, 1e-14);
}

TEST(Mac, PhaseCollinearityOfRealAndTravellingShapes) {
  VectorXcd real(4), travelling(4);
  real << 1, -2, 0.5, 3;
  travelling << 1, Complex(0, 1), -1, Complex(0, -1);
  EXPECT_NEAR(modal_phase_collinearity(std::polar(2.0, 0.7) * real), 1, 1e-14);
  EXPECT_NEAR(modal_phase_collinearity(travelling), 0, 1e-14);
  // The definition by the 2 x 2 scatter.
  VectorXcd shape(3);
  shape << Complex(1, 0.2), Complex(-2, 0.3), Complex(0.5, -0.4);
  const double xx = shape.real().squaredNorm(), yy = shape.imag().squaredNorm();
  const double xy = shape.real().dot(shape.imag());
  EXPECT_NEAR(modal_phase_collinearity(shape),
              ((xx - yy) * (xx - yy) + 4 * xy * xy) / ((xx + yy) * (xx + yy)), 1e-14);
}

}  // namespace rigfit::signal::mac_test
