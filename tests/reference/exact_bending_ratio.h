// The bending equation's F(lambda) (ident/bending/bending_equation.h) with a mantissa of 64 bits:
// what the library's is compared with.
//
//   F = 1 - 2 tanh(lambda / 2) / lambda = (x cosh x - sinh x) / (x cosh x),   x = lambda / 2
//
// the numerator by its power series sum x^(2k+1) 2k / (2k+1)!, whose terms are all positive.
#pragma once

#include <cmath>

namespace rigfit::apps {

inline long double exact_bending_ratio(long double lambda) {
  const long double x = lambda / 2;
  if (x > 25) return 1 - 1 / x;  // 1 - tanh x < 4e-22
  long double term = x, numerator = 0;
  for (int k = 1; k < 200; ++k) {
    term *= x * x / ((2.0L * k) * (2.0L * k + 1));
    numerator += term * 2 * k;
  }
  return numerator / (x * std::cosh(x));
}

}  // namespace rigfit::apps
