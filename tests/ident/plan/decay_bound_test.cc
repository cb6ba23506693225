#include "ident/plan/plan_candidates.h"

#include "signal/sinusoids/damped_sinusoids.h"
#include "tests/test.h"

namespace rigfit::ident::decay_bound_test {

// 16 s^2 a^3 / (fs |C|^2) of a decay that is over, 24 s^2 / (fs |C|^2 T^3) of a steady tone.
// exp(-2 a T) T^2 = 1e-15 and 1.2 a T = 1e-6 are what the limits leave out.
TEST(DecayBound, LimitsOfLongRecordsAndOfNoDamping) {
  const double a = 2, rate = 500, ratio = 30;
  const auto over = decay_information(ratio, a, 10, rate);
  EXPECT_NEAR(over.pole * 16 * a * a * a / (rate * ratio * ratio), 1, 1e-12);
  EXPECT_NEAR(over.energy / (rate * ratio * ratio / (4 * a)), 1, 1e-12);
  for (const double rate_of_decay : {0.0, 1e-7}) {
    const auto steady = decay_information(ratio, rate_of_decay, 8, rate);
    EXPECT_NEAR(steady.pole * 24 / (rate * ratio * ratio * 512), 1, 2e-6);
  }
}

// The covariance of the maximum-likelihood fit of one decay is the bound, but for terms at twice
// its frequency, of the order 1 / (w T) = 1 / 250.
TEST(DecayBound, IsTheCovarianceOfAFittedDecay) {
  const double rate = 200, T = 4, a = 0.9, omega = 2 * kPi * 10, amplitude = 3;
  const Complex pole = Complex(-a, omega) / rate;
  Eigen::VectorXd y(static_cast<Index>(rate * T));
  for (Index j = 0; j < y.size(); ++j) {
    y[j] = amplitude * std::exp(pole * static_cast<double>(j)).real();
  }
  const auto fit = signal::fit_damped_sinusoids(y, std::vector{pole}, {.background_terms = 0});
  ASSERT_EQ(fit.unit_covariance.rows(), 4);
  const double variance = 1 / decay_information(amplitude, a, T, rate).pole;
  EXPECT_NEAR(fit.unit_covariance(2, 2) * rate * rate / variance, 1, 0.01);
  EXPECT_NEAR(fit.unit_covariance(3, 3) * rate * rate / variance, 1, 0.01);
}

// Simpson's rule with 2000 intervals errs by (w h)^4 < 1e-9 here.
TEST(DecayBound, TheImpulseOfAHalfSineIsItsFourierTransform) {
  const double peak = 20, duration = 0.003;
  for (const double omega : {1.0, 500.0, kPi / duration, 2500.0}) {
    Complex sum = 0;
    const int n = 2000;
    for (int k = 0; k <= n; ++k) {
      const double t = duration * k / n, weight = k == 0 || k == n ? 1 : k % 2 == 1 ? 4 : 2;
      sum += weight * peak * std::sin(kPi * t / duration) * std::polar(1.0, -omega * t);
    }
    EXPECT_NEAR(half_sine_impulse(peak, duration, omega), std::abs(sum) * duration / (3 * n), 1e-9)
        << omega;
  }
}

}  // namespace rigfit::ident::decay_bound_test
