#include "signal/variation/combination_tones.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;

/// Of the sum's half bandwidth: agreement of poles.
constexpr double kAgrees = 0.25;
/// Of the weaker mode's peak: what is stronger is a mode.
constexpr double kWeak = 0.1;
/// The same for a pole under a mode's own peak, where the two share what noise and other misfit
/// leave.
constexpr double kWeakTwin = 0.3;

double peak_of(const IdentifiedMode& mode, int power) {
  return mode.shape.norm() * mode.participation.norm() / -mode.pole_rad_s.real() *
         std::pow(std::abs(mode.pole_rad_s), power);
}

}  // namespace

std::string combination_doubt(const ModalModel& model, std::size_t r, int power) {
  const Complex pole = model.modes[r].pole_rad_s;
  const double own = peak_of(model.modes[r], power);
  for (std::size_t a = 0; a < model.modes.size(); ++a) {
    if (a == r) continue;
    const Complex first = model.modes[a].pole_rad_s;
    const double peak = peak_of(model.modes[a], power);
    const double apart = std::abs(pole.imag() - first.imag());
    if (own < kWeakTwin * peak && pole.real() < 1.5 * first.real() && apart < -first.real()) {
      return fmt::format(
          "at the frequency of the mode at {:.5g} Hz, {:.1f} times as damped, its peak {:.2g} % of "
          "that: what a stiffness that changes with amplitude makes of one mode looks like this",
          model.modes[a].frequency_hz.value, pole.real() / first.real(), 100 * own / peak);
    }
    for (std::size_t b = 0; b <= a; ++b) {
      if (b == r || !(own < kWeak * std::min(peak, peak_of(model.modes[b], power)))) continue;
      const Complex second = model.modes[b].pole_rad_s;
      for (const Complex other : {second, std::conj(second)}) {
        const Complex sum = first + other;
        const bool agrees = std::abs(sum - pole) < -kAgrees * sum.real() ||
                            std::abs(std::conj(sum) - pole) < -kAgrees * sum.real();
        if (!agrees) continue;
        return fmt::format(
            "its frequency and decay rate are the {} of those of the modes at {:.5g} and {:.5g} "
            "Hz, its peak under {:.0f} % of theirs: a combination by a non-linear stiffness looks "
            "like this",
            other.imag() > 0 ? "sums" : "difference and sum", model.modes[b].frequency_hz.value,
            model.modes[a].frequency_hz.value, 100 * kWeak);
      }
    }
  }
  return {};
}

}  // namespace rigfit::signal
