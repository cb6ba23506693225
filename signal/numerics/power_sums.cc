#include "signal/numerics/power_sums.h"

#include <bit>

namespace rigfit::signal {

std::array<Complex, 3> power_sums(Complex q, Index n) {
  Complex s0 = 1, s1 = 0, s2 = 0, power = q;  // q^length
  const double per = 1.0 / static_cast<double>(n);
  Index length = 1;
  for (int bit = std::bit_width(static_cast<std::size_t>(n)) - 2; bit >= 0; --bit) {
    const double a = static_cast<double>(length) * per;
    s2 += power * (s2 + 2 * a * s1 + a * a * s0);
    s1 += power * (s1 + a * s0);
    s0 += power * s0;
    power *= power, length *= 2;
    if (((n >> bit) & 1) == 0) continue;
    const double t = static_cast<double>(length) * per;
    s0 += power, s1 += t * power, s2 += t * t * power;
    power *= q, ++length;
  }
  return {s0, s1, s2};
}

ArrayXcd powers(Complex exponent, Index count) {
  ArrayXcd z = ArrayXcd::Ones(count);
  for (Index have = 1; have < count; have *= 2) {
    const Index more = std::min(have, count - have);
    z.segment(have, more) = z.head(more) * std::exp(exponent * static_cast<double>(have));
  }
  return z;
}

}  // namespace rigfit::signal
