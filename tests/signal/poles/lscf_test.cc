#include "signal/poles/lscf.h"

#include "tests/test.h"

namespace rigfit::signal::lscf_test {

constexpr double two_pi = 2 * kPi;

/// Rational functions of z of order (2 modes / inputs) exactly, on 129 lines from 50 Hz, 2 Hz
/// apart: the transform length is 256, hence z = exp(i 2 pi k / 256).
struct Rational {
  VectorXd frequency_hz = VectorXd::LinSpaced(129, 50, 306);
  VectorXcd poles;  ///< rad/s
  MatrixXcd H;
};

Complex z_of(Complex s) { return std::exp((s - Complex(0, two_pi * 50)) / 512.0); }

Rational rational(Index responses, Index inputs, unsigned seed) {
  Normal normal(seed);
  Rational truth;
  truth.poles.resize(4);
  truth.poles << Complex(-6, two_pi * 90), Complex(-10, two_pi * 140), Complex(-12, two_pi * 148),
      Complex(-8, two_pi * 250);
  truth.H.setZero(129, responses * inputs);
  for (Index r = 0; r < 4; ++r) {
    VectorXcd shape(responses), participation(inputs);
    for (Complex& x : shape) x = Complex(normal(), normal());
    for (Complex& x : participation) x = Complex(normal(), normal());
    const Complex zr = z_of(truth.poles[r]);
    for (Index k = 0; k < 129; ++k) {
      const Complex z = z_of(Complex(0, two_pi * truth.frequency_hz[k]));
      for (Index o = 0; o < responses; ++o) {
        for (Index i = 0; i < inputs; ++i) {
          const Complex residue = shape[o] * participation[i];
          truth.H(k, o * inputs + i) +=
              residue / (1.0 - z / zr) + std::conj(residue) / (1.0 - z / std::conj(zr));
        }
      }
    }
  }
  return truth;
}

VectorXcd poles_of_order(const LscfResult& result, int order) {
  std::vector<Complex> poles;
  for (const auto& pole : result.poles) {
    if (pole.order == order) poles.push_back(pole.pole_rad_s);
  }
  return Map<VectorXcd>(poles.data(), static_cast<Index>(poles.size()));
}

TEST(Lscf, RecoversRationalFunctionsOfTheirOwnOrder) {
  for (const Index inputs : {1, 2}) {
    const Rational truth = rational(3, inputs, 7);
    const int order = 8 / static_cast<int>(inputs);
    const LscfResult result =
        lscf(truth.frequency_hz, truth.H, inputs, {}, {}, {.max_order = order});
    // The normal equations square a condition of some 1e3, on top of the 1e-13 on their diagonal.
    EXPECT_TRUE(MatricesNear(poles_of_order(result, order), truth.poles, 1e-5)) << inputs;
    EXPECT_EQ(result.orders_solved, order);
  }
}

TEST(Lscf, AgreesWithLeastSquaresOnTheEquationsThemselves) {
  Rational truth = rational(3, 1, 3);
  Normal normal(1);
  for (Complex& x : truth.H.reshaped()) x += 0.02 * Complex(normal(), normal());
  VectorXd line_weight(129), column_weight(3);
  for (double& w : line_weight) w = 0.5 + std::abs(normal());
  column_weight << 1, 0.3, 2;
  const LscfResult result = lscf(truth.frequency_hz, truth.H, 1, line_weight, column_weight,
                                 {.max_order = 10, .max_damping_ratio = 1});

  // Unknowns: 3 x 11 numerator coefficients, a_1..a_10; a_0 = 1.
  MatrixXd A = MatrixXd::Zero(2 * 129 * 3, 43);
  VectorXd b(2 * 129 * 3);
  for (Index o = 0; o < 3; ++o) {
    for (Index k = 0; k < 129; ++k) {
      const double w = line_weight[k] * column_weight[o];
      const Index row = 2 * (o * 129 + k);
      for (Index n = 0; n <= 10; ++n) {
        const Complex z = w * std::pow(z_of(Complex(0, two_pi * truth.frequency_hz[k])), n);
        const Complex zh = -z * truth.H(k, o);
        A(row, o * 11 + n) = z.real();
        A(row + 1, o * 11 + n) = z.imag();
        if (n > 0) A(row, 32 + n) = zh.real(), A(row + 1, 32 + n) = zh.imag();
      }
      b[row] = w * truth.H(k, o).real();
      b[row + 1] = w * truth.H(k, o).imag();
    }
  }
  const VectorXd x = A.colPivHouseholderQr().solve(b);
  MatrixXd companion = MatrixXd::Zero(10, 10);
  companion.row(0) = -x.tail(10).transpose();
  companion.bottomLeftCorner(9, 9).setIdentity();
  const VectorXcd found = poles_of_order(result, 10);
  ASSERT_GE(found.size(), 4);
  const VectorXcd eigenvalues = companion.eigenvalues();
  for (const Complex& p : found) {
    const Complex y = 1.0 / z_of(p);
    EXPECT_LT((eigenvalues.array() - y).abs().minCoeff(), 1e-7);
  }
}

TEST(Lscf, LinesNeedNotBeUniform) {
  const Rational truth = rational(3, 1, 5);
  // Without every tenth line the sums are taken directly; a rational function does not mind.
  std::vector<Index> rows;
  for (Index k = 0; k < 129; ++k) {
    if (k % 10 != 3) rows.push_back(k);
  }
  VectorXd f(static_cast<Index>(rows.size()));
  MatrixXcd H(f.size(), 3);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    f[i] = truth.frequency_hz[rows[i]];
    H.row(static_cast<Index>(i)) = truth.H.row(rows[i]);
  }
  // Another period of z: the FRFs are not rational in the new z, but are followed to a hundredth of
  // a half bandwidth by twice the order.
  const VectorXcd poles = poles_of_order(lscf(f, H, 1, {}, {}, {.max_order = 20}), 20);
  for (const Complex& p : truth.poles) {
    EXPECT_LT((poles.array() - p).abs().minCoeff(), 0.01 * -p.real());
  }
}

TEST(Lscf, MarksStablePolesAndKeepsTheBand) {
  Rational truth = rational(3, 1, 9);
  Normal normal(2);
  for (Complex& x : truth.H.reshaped()) x += 1e-4 * Complex(normal(), normal());
  LscfOptions options{.max_order = 20};
  const LscfResult result = lscf(truth.frequency_hz, truth.H, 1, {}, {}, options);
  int stable = 0;
  for (const auto& pole : result.poles) {
    EXPECT_LT(pole.pole_rad_s.real(), 0);
    EXPECT_GT(pole.pole_rad_s.imag(), two_pi * 50);
    EXPECT_LT(pole.pole_rad_s.imag(), two_pi * 306);
    EXPECT_LE(pole.damping_ratio, options.max_damping_ratio);
    EXPECT_NEAR(pole.frequency_hz, std::abs(pole.pole_rad_s) / two_pi, 1e-9);
    stable += pole.order == 20 && pole.stable_damping;
  }
  EXPECT_EQ(stable, 4);
}

TEST(Lscf, FewLinesLimitTheOrder) {
  const Rational truth = rational(1, 1, 1);
  const LscfResult result = lscf(truth.frequency_hz.head(12), truth.H.topRows(12), 1, {}, {}, {});
  EXPECT_LT(result.orders_solved, 12);
  EXPECT_GT(result.orders_solved, 3);
  EXPECT_EQ(lscf(truth.frequency_hz.head(2), truth.H.topRows(2), 1).orders_solved, 0);
}

}  // namespace rigfit::signal::lscf_test
