#include "ident/tension/tension_formulas.h"

#include <cmath>

#include "ident/statistics/root.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;
constexpr double kHalfTurn = signal::kTwoPi / 2;

/// w of the header.
double beam_frequency(const CableFormulaInput& in) {
  return 2 * kHalfTurn * in.frequency_hz * in.span_m * in.span_m *
         std::sqrt(in.mass_per_length / in.EI_Nm2);
}

}  // namespace

double string_tension(const CableFormulaInput& in) {
  return 4 * in.mass_per_length * std::pow(in.frequency_hz * in.span_m / in.order, 2);
}

double pinned_beam_tension(const CableFormulaInput& in) {
  const double T = string_tension(in) - std::pow(in.order * kHalfTurn / in.span_m, 2) * in.EI_Nm2;
  return T > 0 ? T : kNaN;
}

double clamped_beam_tension(const CableFormulaInput& in) {
  if (!(in.EI_Nm2 > 0)) return string_tension(in);
  const double w = beam_frequency(in);
  // The beam's characteristic function over cosh a, a = w / b. b of order n lies between n pi (a
  // string) and (n + 1) pi, where sin b is 0 and cos b has turned.
  const double b =
      root_between(in.order * kHalfTurn, (in.order + 1) * kHalfTurn, 1e-14, [w](double x) {
        const double a = w / x;
        return 2 * w * (1 / std::cosh(a) - std::cos(x)) +
               (a * a - x * x) * std::tanh(a) * std::sin(x);
      });
  const double T = (w * w / (b * b) - b * b) * in.EI_Nm2 / (in.span_m * in.span_m);
  return T > 0 ? T : kNaN;
}

double zui_tension(const CableFormulaInput& in) {
  if (in.order != 1) return kNaN;
  const double ratio =
      std::sqrt(in.EI_Nm2 / (in.mass_per_length * std::pow(in.span_m, 4))) / in.frequency_hz;
  const double string = string_tension(in);
  // Each formula holds for a range of xi = L sqrt(T / EI); the one whose tension agrees with its
  // range is the one.
  const auto agrees = [&](double factor, double from, double to) {
    if (!(factor > 0)) return false;
    const double xi = in.EI_Nm2 > 0 ? in.span_m * std::sqrt(string * factor / in.EI_Nm2) : 1e300;
    return xi >= from && xi < to;
  };
  const double slender = 1 - 2.20 * ratio - 0.550 * ratio * ratio;
  const double middle = 0.865 - 11.6 * ratio * ratio, stocky = 0.828 - 10.5 * ratio * ratio;
  if (agrees(slender, 17, 1e301)) return string * slender;
  if (agrees(middle, 6, 17)) return string * middle;
  if (agrees(stocky, 0, 6)) return string * stocky;
  return kNaN;
}

}  // namespace rigfit::ident
