#include "signal/estimation/pole_steps.h"

#include "tests/test.h"

#include <Eigen/QR>

namespace rigfit::signal {
namespace {

/// Sums of real exponentials c exp(p x): the imaginary parts of p are held.
struct Exponentials {
  VectorXd x, y;

  [[nodiscard]] PoleStage operator()(const VectorXcd& poles) const {
    const Index n = poles.size();
    MatrixXd B(x.size(), n);
    for (Index k = 0; k < n; ++k) B.col(k) = (poles[k].real() * x.array()).exp();
    const Eigen::HouseholderQR<MatrixXd> qr(B);
    const VectorXd c = qr.solve(y), left = y - B * c;
    const MatrixXd Q = qr.householderQ() * MatrixXd::Identity(x.size(), n);
    MatrixXd J = x.asDiagonal() * B * c.asDiagonal();
    J -= Q * (Q.transpose() * J);
    PoleStage stage;
    stage.poles = poles;
    stage.cost = left.squaredNorm();
    const auto real = Eigen::seqN(0, n, 2);
    stage.gradient.setZero(2 * n);
    stage.information.setZero(2 * n, 2 * n);
    stage.gradient(real) = J.transpose() * left;
    stage.information(real, real) = J.transpose() * J;
    stage.usable = true;
    return stage;
  }
};

// NIST, Statistical Reference Datasets, nonlinear regression, Lanczos3 ("lower difficulty"), from
// both of its starts, with the certified rates and residual sum of squares.
TEST(PoleSteps, ReachesTheCertifiedValuesOfLanczos3) {
  Exponentials model;
  model.x = VectorXd::LinSpaced(24, 0, 1.15);
  model.y.resize(24);
  model.y << 2.5134, 2.0443, 1.6684, 1.3664, 1.1232, 0.9269, 0.7679, 0.6389, 0.5338, 0.4479, 0.3776,
      0.3197, 0.2720, 0.2325, 0.1997, 0.1723, 0.1493, 0.1301, 0.1138, 0.1000, 0.0883, 0.0783,
      0.0698, 0.0624;
  const double rate[] = {9.5498101505e-01, 2.9515951832, 4.9863565084};
  PoleStepOptions options;
  options.max_iterations = 200;
  options.step_in_std = 1e-8;
  options.freedom = 24 - 6;
  options.rounding = 1e-28 * model.y.squaredNorm();
  for (const auto& start : {VectorXcd{{-0.3, -5.5, -7.6}}, VectorXcd{{-0.7, -4.2, -6.3}}}) {
    PoleStage stage = model(start);
    EXPECT_EQ(take_pole_steps(options, model, stage), StepsEnd::converged);
    EXPECT_NEAR(stage.cost, 1.6117193594e-08, 1e-15);
    for (Index k = 0; k < 3; ++k) {
      EXPECT_EQ(stage.poles[k].imag(), 0);
      EXPECT_NEAR(-stage.poles[k].real(), rate[k], 1e-7 * rate[k]) << k;
    }
  }
}

// One exponential without noise: exact, and on its way no step is longer than half of the pole's
// distance from where nothing decays, and none leaves the bounds.
TEST(PoleSteps, KeepToTheirReachAndBounds) {
  Exponentials model;
  model.x = VectorXd::LinSpaced(50, 0, 1);
  model.y = (-8 * model.x.array()).exp();
  PoleStepOptions options;
  options.rounding = 1e-28 * model.y.squaredNorm();
  std::vector<double> tried;
  const auto watched = [&](const VectorXcd& poles) {
    tried.push_back(poles[0].real());
    return model(poles);
  };
  PoleStage stage = watched(VectorXcd::Constant(1, -0.5));
  EXPECT_EQ(take_pole_steps(options, watched, stage), StepsEnd::converged);
  EXPECT_NEAR(stage.poles[0].real(), -8, 1e-6);
  ASSERT_GT(tried.size(), 4U);
  for (std::size_t k = 1; k < tried.size(); ++k) EXPECT_LE(tried[k] / tried[k - 1], 1.5 + 1e-12);

  options.fastest = -5;
  stage = model(VectorXcd::Constant(1, -0.5));
  EXPECT_EQ(take_pole_steps(options, model, stage), StepsEnd::converged);
  EXPECT_EQ(stage.poles[0].real(), -5);
}

TEST(PoleSteps, EqualPolesAreRankDeficient) {
  Exponentials model;
  model.x = VectorXd::LinSpaced(50, 0, 1);
  model.y = (-8 * model.x.array()).exp();
  PoleStage stage = model(VectorXcd{{-3, -3}});
  EXPECT_EQ(take_pole_steps(PoleStepOptions{}, model, stage), StepsEnd::rank_deficient);
}

// Complex derivatives of an analytic model as real ones: J'r and J'J of its stacked columns.
TEST(PoleSteps, AnalyticModelsStackTheirParts) {
  const MatrixXcd D{{Complex(1, 2), Complex(0, 1)}, {Complex(3, -1), Complex(2, 2)}};
  const VectorXcd r{{Complex(1, -1), Complex(0.5, 2)}};
  PoleStage stage;
  stage.set_analytic(D.adjoint() * r, D.adjoint() * D);
  MatrixXd J(4, 4);
  for (Index k = 0; k < 2; ++k) {
    const VectorXcd turned = Complex(0, 1) * D.col(k);
    J.col(2 * k) << D.col(k).real(), D.col(k).imag();
    J.col(2 * k + 1) << turned.real(), turned.imag();
  }
  VectorXd stacked(4);
  stacked << r.real(), r.imag();
  EXPECT_LT((stage.information - J.transpose() * J).norm(), 1e-12);
  EXPECT_LT((stage.gradient - J.transpose() * stacked).norm(), 1e-12);
}

}  // namespace
}  // namespace rigfit::signal
