// The project's own least squares (variable projection) beside Ceres on the same sums of squares:
// all parameters at once, automatic derivatives, no elimination. Both must end at the same minimum.
#include <ceres/ceres.h>

#include "signal/refinement/modal_basis.h"
#include "signal/refinement/modal_refine.h"
#include "signal/sinusoids/damped_sinusoids.h"
#include "tests/test.h"

namespace rigfit::signal::against_ceres_test {

double minimised(ceres::Problem& problem) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 100;
  options.function_tolerance = options.parameter_tolerance = options.gradient_tolerance = 1e-15;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.BriefReport();
  return 2 * summary.final_cost;
}

/// One sample of two decays on an offset and a drift; p: a, w, Re C, Im C of each, c0, c1.
struct Sample {
  double j, share, y;
  template <typename T>
  bool operator()(const T* p, T* residual) const {
    T model = p[8] + p[9] * share;
    for (int m = 0; m < 2; ++m, p += 4) {
      model += exp(-p[0] * j) * (p[2] * cos(p[1] * j) - p[3] * sin(p[1] * j));
    }
    residual[0] = y - model;
    return true;
  }
};

TEST(AgainstCeres, DampedSinusoidsEndAtTheSameMinimum) {
  constexpr Index kSamples = 800;
  const std::array<Complex, 2> poles{Complex(-0.004, 0.31), Complex(-0.006, 0.33)};
  const std::array<Complex, 2> amplitudes{Complex(1, 0.5), Complex(-0.4, 0.3)};
  Normal normal(5);
  VectorXd y(kSamples);
  for (Index k = 0; k < kSamples; ++k) {
    y[k] = 0.2 + 0.1 * static_cast<double>(k) / kSamples + 0.05 * normal();
    for (std::size_t m = 0; m < 2; ++m) {
      y[k] += (amplitudes[m] * std::exp(poles[m] * static_cast<double>(k))).real();
    }
  }
  const auto fit = fit_damped_sinusoids(y, poles, {.step_in_std = 1e-3});
  ASSERT_EQ(fit.end, StepsEnd::converged);

  std::array<double, 10> p{};
  for (std::size_t m = 0; m < 2; ++m) {
    p[4 * m] = -poles[m].real(), p[4 * m + 1] = poles[m].imag();
    p[4 * m + 2] = amplitudes[m].real(), p[4 * m + 3] = amplitudes[m].imag();
  }
  ceres::Problem problem;
  for (Index k = 0; k < kSamples; ++k) {
    const auto j = static_cast<double>(k);
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Sample, 1, 10>(new Sample{j, j / kSamples, y[k]}), nullptr,
        p.data());
  }
  const double sum = minimised(problem);
  // A step of 1e-3 standard uncertainties is where it stops: 1e-6 of the variance in the sum.
  const double variance = sum / static_cast<double>(fit.degrees);
  EXPECT_NEAR(fit.residual_sum_squares, sum, 1e-5 * variance);
  for (std::size_t m = 0; m < 2; ++m) {
    const auto at = static_cast<Index>(4 * m);
    const auto std_of = [&](Index k) { return std::sqrt(variance * fit.unit_covariance(k, k)); };
    EXPECT_NEAR(fit.poles[m].real(), -p[4 * m], 1e-3 * std_of(at + 2));
    EXPECT_NEAR(fit.poles[m].imag(), p[4 * m + 1], 1e-3 * std_of(at + 3));
    EXPECT_NEAR(fit.amplitudes[m].real(), p[4 * m + 2], 1e-3 * std_of(at));
    EXPECT_NEAR(fit.amplitudes[m].imag(), p[4 * m + 3], 1e-3 * std_of(at + 1));
  }
}

constexpr int kModes = 3, kFrfs = 2, kLinear = 2 * kFrfs * (kModes + 2);

/// One line of two accelerances. Poles: real, imaginary parts; then, FRF by FRF, real and imaginary
/// parts of the residues, of the lower and of the upper residual.
struct Line {
  double w, scale;
  std::array<Complex, kFrfs> H;
  template <typename T>
  bool operator()(const T* pole, const T* linear, T* residual) const {
    for (int c = 0; c < kFrfs; ++c, linear += 2 * (kModes + 2)) {
      T re(0), im(0);
      for (int r = 0; r < kModes; ++r) {
        const T a = linear[2 * r], b = linear[2 * r + 1], x = -pole[2 * r];
        // R / (s - p) and conj(R) / (s - conj(p)), s = i w.
        for (const int sign : {1, -1}) {
          const T beside = w - static_cast<double>(sign) * pole[2 * r + 1],
                  own = static_cast<double>(sign) * b;
          const T size = x * x + beside * beside;
          re += (a * x + own * beside) / size;
          im += (own * x - a * beside) / size;
        }
      }
      const T* rest = linear + 2 * kModes;
      residual[2 * c] = (H[c].real() + w * w * (re + rest[2]) - rest[0]) * scale;
      residual[2 * c + 1] = (H[c].imag() + w * w * (im + rest[3]) - rest[1]) * scale;
    }
    return true;
  }
};

TEST(AgainstCeres, ModesEndAtTheSameMinimum) {
  constexpr Index kLines = 400;
  const VectorXd f = VectorXd::LinSpaced(kLines, 20, 60);
  const VectorXcd s = laplace_lines(f, 0);
  VectorXcd poles(kModes);
  poles << Complex(-2, 180), Complex(-2.5, 190), Complex(-3, 300);
  MatrixXcd residues(kModes, kFrfs);
  residues << Complex(0, -2e-3), Complex(0, 1e-3), Complex(1e-4, -1e-3), Complex(0, -2e-3),
      Complex(0, 1e-3), Complex(2e-4, 3e-3);
  const VectorXcd none = VectorXcd::Zero(kFrfs);
  FrfLines data{s, 2, synthesise(s, 2, poles, residues, none, none), 1, {}};
  const double rms = std::sqrt(data.H.squaredNorm() / static_cast<double>(data.H.size()));
  Normal normal(9);
  for (Complex& h : data.H.reshaped()) h += 0.05 * rms * Complex(normal(), normal());
  FrfNoise noise;
  noise.line.setOnes(kLines);
  noise.column.setConstant(kFrfs, 0.0025 * rms * rms);
  noise.common.setZero(1);
  const auto fit = refine_modes(data, noise, poles);
  ASSERT_EQ(fit.end, StepsEnd::converged);

  std::array<double, 2 * kModes> pole{};
  std::array<double, kLinear> linear{};
  for (int r = 0; r < kModes; ++r) {
    pole[2 * r] = poles[r].real(), pole[2 * r + 1] = poles[r].imag();
    for (int c = 0; c < kFrfs; ++c) {
      const auto at = static_cast<std::size_t>(2 * (c * (kModes + 2) + r));
      linear[at] = residues(r, c).real(), linear[at + 1] = residues(r, c).imag();
    }
  }
  ceres::Problem problem;
  for (Index k = 0; k < kLines; ++k) {
    auto* line = new Line{s[k].imag(), 1 / (0.05 * rms), {data.H(k, 0), data.H(k, 1)}};
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Line, 2 * kFrfs, 2 * kModes, kLinear>(line), nullptr,
        pole.data(), linear.data());
  }
  const double sum = minimised(problem);
  const auto ours = (data.H - fitted_frfs(data, fit)).squaredNorm() / (0.0025 * rms * rms);
  // In units of the noise: a step of 1e-3 standard uncertainties is 1e-6 of the sum's unit.
  EXPECT_NEAR(ours, sum, 1e-4);
  ceres::Covariance covariance({});
  const std::vector<std::pair<const double*, const double*>> blocks{{pole.data(), pole.data()}};
  ASSERT_TRUE(covariance.Compute(blocks, &problem));
  Eigen::Matrix<double, 2 * kModes, 2 * kModes, Eigen::RowMajor> C;
  ASSERT_TRUE(covariance.GetCovarianceBlock(pole.data(), pole.data(), C.data()));
  // Both leave out second derivatives times residuals; ours takes the derivatives at its own end.
  EXPECT_TRUE(
      MatricesNear(modal_covariance(data, noise, fit).poles, C, 1e-3 * C.cwiseAbs().maxCoeff()));
  for (int r = 0; r < kModes; ++r) {
    EXPECT_NEAR(fit.poles[r].real(), pole[2 * r], 2e-3 * std::sqrt(C(2 * r, 2 * r)));
    EXPECT_NEAR(fit.poles[r].imag(), pole[2 * r + 1], 2e-3 * std::sqrt(C(2 * r + 1, 2 * r + 1)));
  }
}

}  // namespace rigfit::signal::against_ceres_test
