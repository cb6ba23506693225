// A root of a continuous function between two points where its sign differs.
//
// Chandrupatla's method (inverse quadratic interpolation where it is safe, bisection elsewhere):
// T. R. Chandrupatla, Advances in Engineering Software 28 (1997) 145-149. Never leaves the bracket,
// never takes more than a few times the steps of bisection.
#pragma once

#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace rigfit::model {

/// f(low) and f(high) must not have the same sign (either may be zero). To the last bit or two.
template <typename Function>
[[nodiscard]] double bracketed_root(Function&& f, double low, double high) {
  double b = low, a = high, fb = f(b), fa = f(a);
  if (fb == 0) return b;
  if (fa == 0) return a;
  assert(std::signbit(fa) != std::signbit(fb));
  double t = 0.5;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const double x = a + t * (b - a);
    const double fx = f(x);
    double c = b, fc = fb;
    if (std::signbit(fx) == std::signbit(fa)) {
      c = a, fc = fa;
    } else {
      b = a, fb = fa;
    }
    a = x, fa = fx;
    const double best = std::abs(fa) < std::abs(fb) ? a : b;
    if (fa == 0) return a;
    const double width = std::abs(b - a);
    const double tolerance = 2 * std::numeric_limits<double>::epsilon() * std::abs(best) + 1e-300;
    if (width <= 2 * tolerance) return best;
    const double xi = (a - b) / (c - b), phi = (fa - fb) / (fc - fb);
    if (phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi) {
      t = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb);
    } else {
      t = 0.5;
    }
    const double margin = tolerance / width;
    t = std::fmin(1 - margin, std::fmax(margin, t));
  }
  return std::abs(fa) < std::abs(fb) ? a : b;
}

}  // namespace rigfit::model
