#include "signal/modal/pole_scan.h"

#include <algorithm>
#include <cmath>

#include "signal/modal/pole_fit.h"
#include "signal/numerics/factorisations.h"
#include "signal/numerics/numbers.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;

constexpr Index kColumns = 24;  // principal ones that are scanned: the work does not grow further

struct Candidate {
  double strength = 0, frequency_hz = 0, half_hz = 0, reach_hz = 0;
};

/// Residuals averaged over `factor` lines, and the noise's correlation then.
struct Level {
  ArrayXd frequency_hz;
  MatrixXcd R;
  ModalData data;  ///< correlation only
};

Level coarser(const Level& fine, Index factor) {
  Level level;
  const Index lines = fine.R.rows() / factor;
  level.frequency_hz = ArrayXd::Zero(lines);
  level.R = MatrixXcd::Zero(lines, fine.R.cols());
  for (Index k = 0; k < lines; ++k) {
    level.R.row(k) = fine.R.middleRows(k * factor, factor).colwise().mean();
    level.frequency_hz[k] = fine.frequency_hz.segment(k * factor, factor).mean();
  }
  level.data = fine.data;
  level.data.correlation_lines /= static_cast<double>(factor);
  level.data.lead *= static_cast<double>(factor);
  return level;
}

/// Unit resonance of half bandwidth `half` at line `at` of a window, without background.
VectorXcd matched(const MatrixXcd& P, double half, Index at) {
  const auto x = ArrayXd::LinSpaced(P.rows(), 0, static_cast<double>(P.rows() - 1));
  VectorXcd y = (Complex(half, 0) + Complex(0, 1) * (x - static_cast<double>(at)).cast<Complex>())
                    .inverse()
                    .matrix();
  y -= P * (P.adjoint() * y);
  return y.normalized();
}

/// Power that noise of variance 1 has along `y`, over that along an average direction.
double spread(const ModalData& data, const VectorXcd& y) {
  if (!(data.correlation_lines > 0)) return 1;
  double sum = y.squaredNorm();
  for (Index d = 1; d < y.size(); ++d) {
    sum += 2 * (data.line_correlation(d) * y.tail(y.size() - d).dot(y.head(y.size() - d))).real();
  }
  return std::max(1.0, sum);
}

/// F whose chance is `chance`.
double limit_of(double chance, double numerator, double denominator) {
  double low = 0, high = 2;
  while (chance_of(high, numerator, denominator) > chance && high < 1e12) high *= 2;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    (chance_of(middle, numerator, denominator) > chance ? low : high) = middle;
  }
  return high;
}

void scan_level(const Level& level, double half, Index tests, std::vector<Candidate>& found) {
  const Index K = level.R.rows(), C = level.R.cols();
  const Index n = std::min(static_cast<Index>(std::max(15 * half, 12.0)), (K - 1) / 2);
  const Index lines = 2 * n + 1;
  if (n < 5 || static_cast<double>(n) < 4 * half) return;
  if (half > 1 && 45 * half > static_cast<double>(K)) return;  // wider than two thirds of the lines
  const MatrixXcd P = smooth_basis(lines);
  const auto freedom = static_cast<double>(lines - P.cols() - 1);
  ArrayXd F = ArrayXd::Zero(K);
  const auto add = [&](Index first, Index at, Index count, const VectorXcd& y) {
    // Windows from `first` on, the resonance at their line `at`.
    MatrixXcd T(lines, P.cols() + 1);
    T << P, y;
    for (Index c = 0; c < C; ++c) {
      const Eigen::Map<const MatrixXcd, 0, Eigen::Stride<1, 1>> windows(
          level.R.col(c).data() + first, lines, count);
      const MatrixXcd parts = T.adjoint() * windows;
      double power = 0;
      for (Index k = 0; k < count; ++k) {
        if (k % 64 == 0) {  // anew: rounding beside high peaks does not add up
          power = level.R.col(c).segment(first + k, lines).squaredNorm();
        } else {
          power +=
              std::norm(level.R(first + k + lines - 1, c)) - std::norm(level.R(first + k - 1, c));
        }
        const double own = std::norm(parts(P.cols(), k));
        const double left = std::max(power - parts.col(k).squaredNorm(), 1e-12 * power + 1e-300);
        F[first + k + at] += own / left * freedom / static_cast<double>(C);
      }
    }
  };
  const VectorXcd centred = matched(P, half, n);
  add(0, n, K - 2 * n, centred);
  for (Index at = 0; at < n; ++at) {
    add(0, at, 1, matched(P, half, at));
    add(K - lines, lines - 1 - at, 1, matched(P, half, lines - 1 - at));
  }
  F /= spread(level.data, centred);
  const double independent = freedom / level.data.lines_a_value();
  const double limit =
      kNoiseKnown * limit_of(kNoiseChance / static_cast<double>(tests), 2 * static_cast<double>(C),
                             2 * static_cast<double>(C) * independent);
  const double spacing =
      (level.frequency_hz[K - 1] - level.frequency_hz[0]) / static_cast<double>(K - 1);
  for (Index k = 0; k < K; ++k) {
    if (F[k] < limit) continue;
    const Index from = std::max<Index>(0, k - 3), to = std::min(K - 1, k + 3);
    if (F[k] < F.segment(from, to - from + 1).maxCoeff()) continue;
    found.push_back(
        {F[k] / limit, level.frequency_hz[k], half * spacing, static_cast<double>(n) * spacing});
  }
}

}  // namespace

std::vector<Complex> scan_poles(const ModalData& data,
                                const Eigen::Ref<const MatrixXcd>& residual) {
  Level level{data.frequency_hz.array(), residual, {}};
  level.data.correlation_lines = data.correlation_lines;
  level.data.lead = data.lead;
  if (residual.cols() > kColumns) {
    const MatrixXcd vectors = hermitian_eigen(residual.adjoint() * residual).vectors;
    level.R = residual * vectors.rightCols(kColumns);
  }
  const double narrowest = 0.35 * data.window / kTwoPi / data.spacing_hz;  // lines
  std::vector<Candidate> found;
  const Index tests = 2 * residual.rows();
  double factor = 1;
  if (narrowest < 0.5) scan_level(level, 0.5, tests, found);
  while (level.R.rows() >= 12) {
    if (2 * factor > narrowest) scan_level(level, 2, tests, found);
    level = coarser(level, 4);
    factor *= 4;
  }
  std::sort(found.begin(), found.end(),
            [](const Candidate& a, const Candidate& b) { return a.strength > b.strength; });
  std::vector<Candidate> taken;
  std::vector<Complex> poles;
  for (const Candidate& one : found) {
    const bool near = std::any_of(taken.begin(), taken.end(), [&](const Candidate& other) {
      return std::abs(one.frequency_hz - other.frequency_hz) <
             0.5 * std::max(one.reach_hz, other.reach_hz);
    });
    if (near) continue;
    taken.push_back(one);
    poles.emplace_back(data.window - kTwoPi * one.half_hz, kTwoPi * one.frequency_hz);
  }
  return poles;
}

}  // namespace rigfit::signal
