#include "signal/decay/decay_warnings.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "signal/sinusoids/decay_search.h"
#include "signal/sinusoids/residual_noise.h"

namespace rigfit::signal {

using Eigen::Index;

bool leaves_company(const LineSpectrum& residual, std::complex<double> pole, double false_alarm) {
  const double f = pole.imag() / (2 * std::numbers::pi), n = static_cast<double>(residual.samples);
  const double reach = 2 / n - pole.real() / std::numbers::pi;
  DecaySearchOptions beside;
  beside.damped = false, beside.candidates = 1;
  beside.lowest = std::max(0.0, f - reach), beside.highest = std::min(0.5, f + reach);
  beside.energy_over_noise = detection_threshold(residual.samples, false_alarm);
  return !search_lines(residual, beside).empty();
}

void doubt_of(DecayMode& mode, const Eigen::VectorXd& alone, const Eigen::VectorXd& residual,
              Index order, double false_alarm) {
  // A mode that explains most of what is there is no noise; its residual's colour is its own.
  if (order == 0 || mode.r_squared > 0.8) return;
  const double without = prediction_error(alone, order), with = prediction_error(residual, order);
  if (!(with > 0)) return;
  const auto n = static_cast<double>(alone.size());
  const double gain = n * std::log(without / with);
  // exp(threshold / 2) is the number of cells over the false alarm.
  const double chance = std::exp(-0.5 * detection_threshold(alone.size(), false_alarm));
  const double needed = gsl_cdf_chisq_Qinv(chance, 4);
  if (gain > needed) return;
  mode.doubtful = true;
  mode.doubt = fmt::format(
      "noise of the colour of the residual would show as much at {:.4g} Hz (evidence {:.2g} of "
      "what "
      "is asked for)",
      mode.damped_frequency_hz.value, std::max(0.0, gain) / needed);
}

}  // namespace rigfit::signal
