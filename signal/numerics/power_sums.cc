#include "signal/numerics/power_sums.h"

#include <algorithm>
#include <array>
#include <bit>

namespace rigfit::signal {

using Complex = std::complex<double>;
using Eigen::Index;

void power_sums(Complex q, Index n, std::span<Complex> sums) {
  static constexpr double binomial[5][5] = {
      {1, 0, 0, 0, 0}, {1, 1, 0, 0, 0}, {1, 2, 1, 0, 0}, {1, 3, 3, 1, 0}, {1, 4, 6, 4, 1}};
  const std::size_t order = sums.size();
  std::array<Complex, 5> s{}, next{};
  s[0] = 1;
  const double per = 1.0 / static_cast<double>(n);
  Complex power = q;  // q^length
  Index length = 1;
  for (int bit = std::bit_width(static_cast<std::size_t>(n)) - 2; bit >= 0; --bit) {
    const double a = static_cast<double>(length) * per;
    for (std::size_t k = 0; k < order; ++k) {
      Complex tail = s[k];
      double a_power = a;
      for (std::size_t i = k; i-- > 0;) {
        tail += binomial[k][i] * a_power * s[i];
        a_power *= a;
      }
      next[k] = s[k] + power * tail;
    }
    s = next;
    power *= power;
    length *= 2;
    if ((n >> bit) & 1) {
      const double t = static_cast<double>(length) * per;
      double t_power = 1;
      for (std::size_t k = 0; k < order; ++k) {
        s[k] += t_power * power;
        t_power *= t;
      }
      power *= q;
      ++length;
    }
  }
  std::copy_n(s.begin(), order, sums.begin());
}

Eigen::ArrayXcd powers(Complex exponent, Index count) {
  Eigen::ArrayXcd z = Eigen::ArrayXcd::Ones(count);
  for (Index have = 1; have < count; have *= 2) {
    const Index more = std::min(have, count - have);
    z.segment(have, more) = z.head(more) * std::exp(exponent * static_cast<double>(have));
  }
  return z;
}

}  // namespace rigfit::signal
