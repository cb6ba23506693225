#include "ident/bending/bending_equation.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_qrng.h>

#include <memory>

#include "signal/estimation/robust.h"

namespace rigfit::ident {
namespace {

// D in tanh(x) / x = 1 / (1 + x^2 / D): D = 3 + x^2 / (5 + x^2 / (7 + ...)). Nine levels leave less
// than 1e-17 at x = 1: each level k divides the remainder by about (2 k + 1)^2 / x^2.
double lambert_denominator(double x) {
  double denominator = 21;
  for (int odd = 19; odd >= 3; odd -= 2) denominator = odd + x * x / denominator;
  return denominator;
}

// 12 F(lambda) / lambda^2, which is 1 at zero: what P takes off a beam's compliance.
double tension_factor(double lambda) {
  if (lambda < 2) return 3 / (lambert_denominator(lambda / 2) + lambda * lambda / 4);
  return 12 * bending_ratio(lambda) / lambda / lambda;
}

// d F / d ln(lambda) = tanh(x)/x - 1 + tanh^2 x = tanh^2 x - F, x = lambda/2; for large x rather
// tanh(x)/x - 1/cosh^2 x. Neither cancels more than a factor of two.
double bending_ratio_log_derivative(double lambda) {
  if (lambda < 2) {
    const double tanh = std::tanh(lambda / 2);
    return tanh * tanh - bending_ratio(lambda);
  }
  const double decay = std::exp(-lambda);
  return bending_ratio_complement(lambda) - 4 * decay / ((1 + decay) * (1 + decay));
}

bool positive_finite(double value) { return std::isfinite(value) && value > 0; }

// `turning`: relative change of the compliance by one standard uncertainty of the clamps.
std::vector<double> draws_of(const ComplianceMeasurement& measured, double turning) {
  constexpr int kDraws = 4096;
  const std::unique_ptr<gsl_qrng, void (*)(gsl_qrng*)> points(gsl_qrng_alloc(gsl_qrng_sobol, 4),
                                                              gsl_qrng_free);
  std::vector<double> draws(kDraws);
  for (double& draw : draws) {
    std::array<double, 4> u;
    gsl_qrng_get(points.get(), u.data());
    const double slope_score = measured.degrees_of_freedom > 0
                                   ? gsl_cdf_tdist_Pinv(u[0], measured.degrees_of_freedom)
                                   : gsl_cdf_ugaussian_Pinv(u[0]);
    const double clamps = std::exp(-turning * gsl_cdf_ugaussian_Pinv(u[3]));
    draw = EI_of_compliance(
        clamps * (measured.compliance_m_N.value + measured.compliance_m_N.std * slope_score),
        measured.tension_N.value + measured.tension_N.std * gsl_cdf_ugaussian_Pinv(u[1]),
        measured.span_m.value + measured.span_m.std * gsl_cdf_ugaussian_Pinv(u[2]), measured.ends);
  }
  return draws;
}

}  // namespace

const char* name_of(BeamEnds ends) {
  constexpr std::array names{"tensioned", "clamped", "pinned", "cantilever"};
  return names[static_cast<std::size_t>(ends)];
}

double bending_ratio(double lambda) {
  if (lambda < 2) {
    const double square = lambda * lambda / 4;
    return square / (lambert_denominator(lambda / 2) + square);
  }
  return 1 - bending_ratio_complement(lambda);
}

double bending_ratio_complement(double lambda) {
  if (lambda < 2) {
    const double denominator = lambert_denominator(lambda / 2);
    return denominator / (denominator + lambda * lambda / 4);
  }
  // tanh(lambda/2) = (1 - e^-lambda) / (1 + e^-lambda)
  return -std::expm1(-lambda) / (1 + std::exp(-lambda)) * 2 / lambda;
}

double lambda_from_bending_ratio(double ratio) {
  if (!(ratio > 0 && ratio < 1)) {
    throw std::invalid_argument("the ratio 4 P d / (Q l) must lie between 0 and 1");
  }
  // F < lambda^2 / 12 and 1 - F < 2 / lambda hold for every lambda. The small-lambda end is a
  // straight line of slope 2 through `low`, the other of slope 1.
  double low = 0.5 * std::log(12 * ratio), high = std::log(2 / (1 - ratio) + 2);
  const double log_odds = std::log(ratio) - std::log1p(-ratio);
  double x = std::clamp(ratio < 0.5 ? low + 0.1 * ratio : std::log(2 / (1 - ratio)), low, high);
  for (int i = 0; i < 100; ++i) {  // bisection alone would need some 60
    const double lambda = std::exp(x);
    const double F = bending_ratio(lambda), rest = bending_ratio_complement(lambda);
    const double off = std::log(F) - std::log(rest) - log_odds;
    (off < 0 ? low : high) = x;
    double next = x - off * F * rest / bending_ratio_log_derivative(lambda);
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const double step = std::abs(next - x);
    x = next;
    if (step <= 1e-8) break;  // the next one would be of the order of its square: below rounding
  }
  return std::exp(x);
}

double midspan_compliance(double EI_Nm2, double tension_N, double span_m) {
  if (!positive_finite(EI_Nm2) || !positive_finite(span_m) || !std::isfinite(tension_N) ||
      tension_N < 0) {
    throw std::invalid_argument(
        "mid-span compliance: EI and span must be positive, the tension not negative");
  }
  const double lambda = span_m / 2 * std::sqrt(tension_N / EI_Nm2);
  return span_m * span_m * span_m / (192 * EI_Nm2) * tension_factor(lambda);
}

double EI_of_compliance(double compliance, double tension, double span, BeamEnds ends) {
  if (!(span > 0)) return 0;
  if (!(compliance > 0)) return std::numeric_limits<double>::infinity();
  if (ends != BeamEnds::tensioned || !(tension > 0)) {
    // With tension the limit for tension zero.
    const double c = ends == BeamEnds::pinned ? 48 : ends == BeamEnds::cantilever ? 3 : 192;
    return span * span * span / (c * compliance);
  }
  const double ratio = 4 * tension * compliance / span;
  if (ratio >= 1) return 0;
  const double lambda = lambda_from_bending_ratio(ratio);
  return tension * span * span / (4 * lambda * lambda);
}

double clamp_compliance(double EI_Nm2, double tension_N, double span_m, BeamEnds ends) {
  if (ends == BeamEnds::pinned) return 0;
  if (ends == BeamEnds::cantilever) return 3 * EI_Nm2 / span_m;
  const double lambda = span_m / 2 * std::sqrt(tension_N / EI_Nm2);
  if (!(lambda > 1e-4)) return 6 * EI_Nm2 / span_m;
  const double tanh = std::tanh(lambda / 2);
  return 2 * EI_Nm2 * tanh * tanh / (span_m * bending_ratio(lambda));
}

StiffnessFromBending stiffness_from_compliance(const ComplianceMeasurement& measured) {
  StiffnessFromBending result;
  const double slope = measured.compliance_m_N.value, span = measured.span_m.value,
               tension = measured.ends == BeamEnds::tensioned ? measured.tension_N.value : 0;
  if (!positive_finite(slope) || !positive_finite(span) || !std::isfinite(tension) || tension < 0) {
    result.status = BendingStatus::not_positive;
    result.reason = fmt::format(
        "Check signs and zero of the channels: the slope d/Q ({:.4g} m/N) and the span ({:.4g} m) "
        "must be positive and the tension ({:.4g} N) not negative",
        slope, span, tension);
    return result;
  }
  result.ratio = 4 * tension * slope / span;
  const bool interval = std::isfinite(measured.compliance_m_N.std) &&
                        std::isfinite(measured.tension_N.std) && std::isfinite(measured.span_m.std);
  std::vector<double> draws;
  const auto draw = [&](double turning) {
    if (!interval) return;
    draws = draws_of(measured, turning);
    result.low = signal::quantile(draws, 0.025);
    result.high = signal::quantile(draws, 0.975);
  };
  if (result.ratio >= 1) {
    draw(0);
    result.status = BendingStatus::string_like;
    result.reason = fmt::format(
        "Check the span, the calibration of tension and load, and slip in the clamps: 4 P d / "
        "(Q l) = {:.5f} is not below 1, so the cable is as soft as a string without bending "
        "stiffness and these data hold no EI{}",
        result.ratio,
        interval && result.high > 0 && std::isfinite(result.high)
            ? fmt::format(" (97.5 % of what the uncertainties allow lies below {:.3g} N m2)",
                          result.high)
            : std::string());
    return result;
  }

  double k = 1;  // 2 F / (dF / d ln lambda)
  if (result.ratio > 0) {
    result.lambda = lambda_from_bending_ratio(result.ratio);
    k = 2 * result.ratio / bending_ratio_log_derivative(result.lambda);
  } else {
    result.lambda = 0;
  }
  result.EI_Nm2.value = EI_of_compliance(slope, tension, span, measured.ends);
  result.log_sensitivity_compliance = -k;
  result.log_sensitivity_tension = 1 - k;
  result.log_sensitivity_span = 2 + k;
  result.status = BendingStatus::solved;
  const double clamp = measured.clamp_stiffness_Nm_rad;
  draw(clamp > 0 ? clamp_compliance(result.EI_Nm2.value, tension, span, measured.ends) / clamp : 0);
  if (!interval) return result;

  result.EI_Nm2.std =
      0.5 * (signal::quantile(draws, 0.841344746) - signal::quantile(draws, 0.158655254));
  if (!std::isfinite(result.high)) {
    result.status = BendingStatus::not_positive;
    result.reason = fmt::format(
        "Load further, or average more loadings: the slope d/Q = {:.4g} +- {:.2g} m/N is not "
        "known to be positive, so EI has no upper bound",
        slope, measured.compliance_m_N.std);
    result.EI_Nm2.std = kNaN;
    result.high = kNaN;
  } else if (result.low <= 0) {
    result.status = BendingStatus::upper_bound_only;
    result.low = 0;
    result.reason = fmt::format(
        "Shorten the span or lower the tension: 4 P d / (Q l) = {:.5f} is too near to 1 for its "
        "uncertainty, a string without bending stiffness is within the 95 % interval, and only "
        "EI < {:.3g} N m2 can be said",
        result.ratio, result.high);
  }
  return result;
}

}  // namespace rigfit::ident
