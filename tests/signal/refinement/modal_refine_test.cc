#include "signal/refinement/modal_refine.h"

#include "signal/refinement/modal_basis.h"
#include "signal/spectra/fft.h"
#include "tests/reference/ten_mode_truth.h"
#include "tests/test.h"

namespace rigfit::signal::modal_refine_test {

constexpr Index kLines = 600, kFrfs = 6;

/// Two close modes of the truth (312 and 318 Hz), with 437 Hz, 6 FRFs on 250..500 Hz.
struct Problem {
  VectorXd f = VectorXd::LinSpaced(kLines, 250, 500);
  VectorXcd poles;
  MatrixXcd residues, exact;
  double scale = 0;

  explicit Problem(double decay_rate = 0) : window(decay_rate) {
    const auto truth = testing::ten_mode_truth(kFrfs);
    poles = truth.poles().segment(4, 3);
    residues = truth.residues().middleCols(4, 3).transpose();
    const VectorXcd none = VectorXcd::Zero(kFrfs);
    exact = synthesise(laplace_lines(f, window), 2, poles, residues, none, none);
    scale = std::sqrt(exact.squaredNorm() / static_cast<double>(exact.size()));
  }
  double window = 0;

  /// Own noise of `relative` of the rms FRF, and a common factor of `common`.
  FrfLines noisy(double relative, double common, unsigned seed) const {
    Normal normal(seed);
    FrfLines data{laplace_lines(f, window), 2, exact, 1, {}};
    for (Index k = 0; k < kLines; ++k) {
      const Complex factor(1 + common * normal(), common * normal());
      for (Index c = 0; c < kFrfs; ++c) {
        data.H(k, c) = data.H(k, c) * factor + relative * scale * Complex(normal(), normal());
      }
    }
    return data;
  }
  FrfNoise noise(double relative, double common) const {
    FrfNoise known;
    known.line.setOnes(kLines);
    known.column.setConstant(kFrfs, relative * relative * scale * scale);
    known.common.setConstant(1, common * common);
    return known;
  }
  /// Poles off by a third of a half bandwidth.
  VectorXcd start() const {
    VectorXcd p = poles;
    for (Index r = 0; r < p.size(); ++r) p[r] += 0.33 * p[r].real() * Complex(r % 2 ? 1 : -1, 1);
    return p;
  }
};

TEST(ModalRefine, RecoversExactParameters) {
  for (const double window : {0.0, 4.0}) {
    const Problem problem(window);
    const auto fit = refine_modes(problem.noisy(0, 0, 1), problem.noise(1e-3, 0), problem.start());
    EXPECT_EQ(fit.end, StepsEnd::converged);
    EXPECT_LT(fit.iterations, 15);
    // A relative 1e-16 of H over conditions of 1e3 to 1e4, seen against poles of 2000 rad/s.
    EXPECT_TRUE(MatricesNear(fit.poles, problem.poles, 1e-7));
    EXPECT_TRUE(MatricesNear(fit.residues, problem.residues,
                             1e-7 * problem.residues.cwiseAbs().maxCoeff()));
  }
}

// Against a second fit of FRFs that err by 1e-3 of the noise's scatter: errors of first order are
// then all but a thousandth of them.
TEST(ModalRefine, PoleErrorsAreThoseOfASecondFit) {
  const Problem problem;
  const FrfLines data = problem.noisy(0, 0.05, 7);
  FrfLines other = data;
  const FrfLines exact = problem.noisy(0, 0, 1);
  const FrfNoise noise = problem.noise(1e-3, 0.05);
  PoleStepOptions options{.step_in_std = 1e-10};
  const auto fit = refine_modes(exact, noise, problem.start(), options);
  const MatrixXcd error = 1e-3 * (data.H - exact.H);
  other.H = exact.H + error;
  const auto second = refine_modes(other, noise, fit.poles, options);
  const MatrixXd by_frf = pole_errors(exact, noise, fit, error);
  ASSERT_EQ(by_frf.cols(), kFrfs);
  const VectorXd found = by_frf.rowwise().sum();
  const VectorXcd moved = second.poles - fit.poles;
  for (Index r = 0; r < 3; ++r) {
    // A cost known to 1e-16 of |H|^2 leaves poles off by 1e-8 half bandwidths of some 20 rad/s:
    // 1e-3 of these changes of some 1e-4 rad/s.
    EXPECT_NEAR(found[2 * r], moved[r].real(), 1e-2 * std::abs(moved[r])) << r;
    EXPECT_NEAR(found[2 * r + 1], moved[r].imag(), 1e-2 * std::abs(moved[r])) << r;
  }
}

/// How many intervals of 1.96 standard deviations hold the truth.
struct Held {
  int poles = 0, residues = 0, fits = 0;
  void add(const Problem& problem, const ModalRefineResult& fit, const ModalCovariance& known) {
    ++fits;
    for (Index r = 0; r < 3; ++r) {
      const Complex e = fit.poles[r] - problem.poles[r];
      poles += std::abs(e.real()) < 1.96 * std::sqrt(known.poles(2 * r, 2 * r));
      poles += std::abs(e.imag()) < 1.96 * std::sqrt(known.poles(2 * r + 1, 2 * r + 1));
      for (Index c = 0; c < kFrfs; ++c) {
        const Complex d = fit.residues(r, c) - problem.residues(r, c);
        residues += std::abs(d.real()) < 1.96 * known.residue_std_re(r, c);
        residues += std::abs(d.imag()) < 1.96 * known.residue_std_im(r, c);
      }
    }
  }
  void expect_95(double tolerance) const {
    EXPECT_NEAR(poles / (6.0 * fits), 0.95, tolerance);
    EXPECT_NEAR(residues / (6.0 * kFrfs * fits), 0.95, tolerance);
  }
};

// 95 % intervals of 6 pole parts and 36 residue parts over seeds, noise levels estimated from what
// the fit leaves. 60 seeds give 360 pole intervals (independent enough between modes): standard
// deviation of the coverage sqrt(0.95 * 0.05 / 360) = 1.15 %, four of them 4.6 %. Residues share
// poles and common noise: their 2160 intervals count as some 360 too.
TEST(ModalRefine, IntervalsCover) {
  for (const double common : {0.0, 0.003}) {
    const Problem problem;
    Held held;
    for (unsigned seed = 1; seed <= 60; ++seed) {
      const FrfLines data = problem.noisy(0.003, common, seed);
      FrfNoise noise = noise_unknown(data.H, 1, 0);
      ModalRefineResult fit = refine_modes(data, noise, problem.poles);
      for (int round = 0; round < 2; ++round) {
        const MatrixXcd model =
            synthesise(data.s, 2, fit.poles, fit.residues, fit.lower, fit.upper);
        noise = noise_from_residuals(model, data.H - model, fit.leverage, 1, 0);
        fit = refine_modes(data, noise, fit.poles);
      }
      ASSERT_EQ(fit.end, StepsEnd::converged) << seed;
      held.add(problem, fit, modal_covariance(data, noise, fit));
    }
    held.expect_95(0.046);
  }
}

// Noise as records under an exponential window have it: white in time from the beginning of the
// block on, the hit 0.3 s later. Where common noise rules, the weights of lines notch the
// resonances, and what estimates poles and residues reaches before the hit: without `lead` all of
// the poles' intervals held here. Tolerance as above.
TEST(ModalRefine, IntervalsCoverUnderAnExponentialWindow) {
  constexpr Index kSamples = 4096;
  constexpr double kRate = 2, kLead = 0.3, kOwn = 0.001, kCommon = 0.02;
  const Problem problem(kRate);
  const double spacing = problem.f[1] - problem.f[0], length = 1 / spacing;
  const auto first = static_cast<Index>(std::lround(problem.f[0] / spacing));
  RealFft fft(kSamples);
  VectorXd window(kSamples);
  for (Index j = 0; j < kSamples; ++j) {
    window[j] = std::exp(-kRate * length * static_cast<double>(j) / kSamples);
  }
  Normal normal(5);
  // Real and imaginary parts of variance 1, time counted from the hit.
  const auto noise_lines = [&] {
    for (Index j = 0; j < kSamples; ++j) fft.time()[j] = window[j] * normal();
    fft.forward();
    VectorXcd e = fft.spectrum().segment(first, kLines) * std::sqrt(2 / window.squaredNorm());
    for (Index k = 0; k < kLines; ++k) {
      e[k] *= std::polar(1.0, 2 * kPi * problem.f[k] * kLead);
    }
    return e;
  };
  Held held;
  for (int seed = 0; seed < 60; ++seed) {
    FrfLines data{laplace_lines(problem.f, kRate), 2, problem.exact, 1, {}};
    const VectorXcd factor = kCommon * noise_lines();
    for (Index c = 0; c < kFrfs; ++c) {
      data.H.col(c) += data.H.col(c).cwiseProduct(factor) + kOwn * problem.scale * noise_lines();
    }
    FrfNoise noise = problem.noise(kOwn, kCommon);
    noise.correlation_lines = kRate * length;
    noise.lead = kLead / length;
    const ModalRefineResult fit = refine_modes(data, noise, problem.poles);
    ASSERT_EQ(fit.end, StepsEnd::converged) << seed;
    held.add(problem, fit, modal_covariance(data, noise, fit));
  }
  held.expect_95(0.046);
}

TEST(ModalRefine, LeverageIsTheShareOfTheFreedomUsed) {
  const Problem problem;
  const FrfLines data = problem.noisy(0.003, 0, 4);
  const auto fit = refine_modes(data, problem.noise(0.003, 0), problem.poles);
  // Parameters: 10 real ones an FRF, and 6 poles' parts for 6 FRFs; of 2 parts a line.
  EXPECT_NEAR(2 * fit.leverage.sum(), 10 + 6.0 / kFrfs, 1e-6);
  EXPECT_GT(fit.leverage.minCoeff(), 0);
  EXPECT_LT(fit.leverage.maxCoeff(), 1);
}

TEST(ModalRefine, AModeThatIsNotThereIsNotSignificant) {
  const Problem problem;
  const FrfLines data = problem.noisy(0.003, 0.002, 6);
  const FrfNoise noise = problem.noise(0.003, 0.002);
  VectorXcd start(4);
  start << problem.poles, Complex(-8, 2 * kPi * 380);
  const auto fit = refine_modes(data, noise, start, {.max_iterations = 0});
  const auto covariance = modal_covariance(data, noise, fit);
  // 12 real residues: chi-squared of mean 12 and standard deviation 5.
  EXPECT_LT(covariance.significance[3], 12 + 4 * 5);
  EXPECT_GT(covariance.significance.head(3).minCoeff(), 1e4);
}

TEST(ModalBasis, RecoversResiduesAndResidualsOfEveryForm) {
  const auto truth = testing::ten_mode_truth(4);
  const VectorXd f = VectorXd::LinSpaced(1400, 1, 1400);
  for (const FrfForm form : {FrfForm::receptance, FrfForm::mobility, FrfForm::accelerance}) {
    for (const double window : {0.0, 3.0}) {
      const VectorXcd s = laplace_lines(f, window);
      const MatrixXcd residues = truth.residues().transpose();
      const double size = residues.cwiseAbs().maxCoeff();
      VectorXcd lower(4), upper(4);
      lower << -0.1, 0.2, Complex(-0.3, 0.01), 0;
      upper << 1e-8, Complex(2e-8, -1e-9), 0, -1e-8;
      const MatrixXcd H = synthesise(s, power_of_s(form), truth.poles(), residues, lower, upper);
      const ModalRefineResult found =
          refine_modes({s, power_of_s(form), H, 1, {}}, noise_unknown(H, 1, 0), truth.poles(),
                       {.max_iterations = 0});
      // Rounding of H, some 1e-16 of its largest value, over condition numbers below 1e4, squared
      // in a Gram matrix.
      EXPECT_TRUE(MatricesNear(found.residues, residues, 1e-8 * size)) << name_of(form);
      EXPECT_TRUE(MatricesNear(found.lower, lower, 1e-5));
      EXPECT_TRUE(MatricesNear(found.upper, upper, 1e-13));
    }
  }
}

TEST(ModalBasis, SynthesisIsTheTruthsAccelerance) {
  const auto truth = testing::ten_mode_truth(5);
  const VectorXd f = VectorXd::LinSpaced(500, 3, 1400);
  const MatrixXcd H =
      synthesise(laplace_lines(f, 2), 2, truth.poles(), truth.residues().transpose(),
                 VectorXcd::Zero(5), VectorXcd::Zero(5));
  const MatrixXcd exact = truth.accelerance(f, 2);
  EXPECT_TRUE(MatricesNear(H, exact, 1e-12 * exact.cwiseAbs().maxCoeff()));
}

}  // namespace rigfit::signal::modal_refine_test
