#include "tests/reference/defective_frfs.h"
#include "tests/normal.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <utility>

namespace rigfit::testing {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::VectorXcd;

constexpr int kFixedNode = 1000;  // above the points' numbers

/// Transform of R p^2 exp(p t) + conj from the end of the record on, at s = i w + window.
VectorXcd after_the_record(const VectorXcd& s, Complex pole, Complex residue,
                           const DefectiveFrfOptions& options) {
  const double end = options.record_s - options.before_hit_s;
  // exp(-i w end) = exp(i w before_hit) at the lines of a record.
  const VectorXcd turn = (Complex(0, options.before_hit_s) * s.imag().array()).exp();
  VectorXcd sum = VectorXcd::Zero(s.size());
  for (const auto& [p, R] :
       {std::pair(pole, residue), std::pair(std::conj(pole), std::conj(residue))}) {
    const Complex left = R * p * p * std::exp((p - options.window_decay_1_s) * end);
    sum.array() += left * turn.array() / (s.array() - p);
  }
  return sum;
}

}  // namespace

signal::FrfSet defective_frfs(const DefectiveFrfOptions& options) {
  rigfit::testing::Normal normal(options.seed);
  signal::FrfSet set{.form = signal::FrfForm::accelerance};
  const Index lines =
      static_cast<Index>((options.high_hz - options.low_hz) / options.spacing_hz) + 1;
  set.frequency_hz = Eigen::VectorXd::LinSpaced(
      lines, options.low_hz, options.low_hz + options.spacing_hz * static_cast<double>(lines - 1));
  set.exponential_decay_rate_1_s = options.window_decay_1_s;
  VectorXcd s = Complex(0, 2 * std::numbers::pi) * set.frequency_hz.cast<Complex>();
  s.array() += options.window_decay_1_s;
  const auto fixed = static_cast<Index>(options.fixed.size());
  set.H.resize(lines, options.points * fixed);
  const Index modes = options.frequency_hz.size();
  for (Index c = 0; c < options.points; ++c) {
    const double x = (static_cast<double>(c) + 0.63) / (static_cast<double>(options.points) + 0.37);
    const double place =
        options.points > 1 ? static_cast<double>(c) / static_cast<double>(options.points - 1) - 0.5
                           : 0;
    const double size_of_hit = 1 + 0.3 * normal();
    std::vector<VectorXcd> sum(options.fixed.size(), VectorXcd::Zero(lines)), cut_off = sum;
    for (Index r = 0; r < modes; ++r) {
      const double zeta = options.damping_ratio,
                   number = std::numbers::pi * static_cast<double>(r + 1);
      const double shift = options.drift * place + options.scatter * normal();
      const double w = 2 * std::numbers::pi * options.frequency_hz[r] * (1 + 2 * zeta * shift);
      const double size = std::sin(number * x);
      const Complex pole(-zeta * w, w * std::sqrt(1 - zeta * zeta));
      const VectorXcd part = (s.array() - pole).inverse();
      for (std::size_t e = 0; e < sum.size(); ++e) {
        const double own = std::sin(number * options.fixed[e]);
        const Complex residue = size * own / Complex(0, 2 * pole.imag());
        if (options.record_s > 0) cut_off[e] += after_the_record(s, pole, residue, options);
        sum[e] +=
            residue * part + std::conj(residue) * (s.array() - std::conj(pole)).inverse().matrix();
      }
    }
    if (options.points_are_inputs) set.hit_impulse.push_back({size_of_hit});
    for (Index e = 0; e < fixed; ++e) {
      const auto k = static_cast<std::size_t>(e);
      set.H.col(options.points_are_inputs ? e * options.points + c : c * fixed + e) =
          s.cwiseProduct(s).cwiseProduct(sum[k]) - cut_off[k];
    }
  }
  const double rms = std::sqrt(set.H.squaredNorm() / static_cast<double>(set.H.size()));
  for (Index k = 0; k < lines; ++k) {
    const Complex common(options.common * normal(), options.common * normal());
    for (Index c = 0; c < set.H.cols(); ++c) {
      set.H(k, c) =
          set.H(k, c) * (1.0 + common) + options.noise * rms * Complex(normal(), normal());
    }
  }
  for (Index c = 0; c < options.points; ++c) {
    signal::MeasuredPoint point{"p" + std::to_string(c + 1), static_cast<int>(c + 1), 3};
    (options.points_are_inputs ? set.inputs : set.responses).push_back(point);
  }
  for (int e = 0; e < static_cast<int>(fixed); ++e) {
    const std::string name = e == 0 ? "fixed" : "fixed " + std::to_string(e + 1);
    (options.points_are_inputs ? set.responses : set.inputs).push_back({name, kFixedNode + e, 3});
  }
  return set;
}

}  // namespace rigfit::testing
