#include "signal/modal/pole_sweep.h"

#include <algorithm>
#include <cmath>

#include "signal/modal/pole_scan.h"
#include "signal/numerics/numbers.h"

namespace rigfit::signal {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

namespace {

/// Times fewer squares that one more overlapping mode must leave than poles of each group's own.
constexpr double kBetter = 6;
constexpr double kSame = 0.5;  // likeness (MAC) of one mode's shapes: more alike than not
constexpr int kGroupSteps = 8;
constexpr Complex kGone{0, -1e300};  // a pole that was taken out

VectorXcd without(const VectorXcd& poles, Index r) {
  VectorXcd rest(poles.size() - 1);
  rest << poles.head(r), poles.tail(rest.size() - r);
  return rest;
}

bool overlap(const ModalData& data, Complex p, Complex q) {
  return std::abs(p - q) < 2 * data.window - p.real() - q.real();
}

/// Resonances outside of the lines or too wide, and all but one of those that are the same, go.
VectorXcd distinct(const ModalData& data, const VectorXcd& poles, double max_damping) {
  std::vector<Complex> kept;
  for (const Complex p : poles) {
    const double f = p.imag() / kTwoPi, half = (data.window - p.real()) / kTwoPi;
    if (!(f > data.frequency_hz[0] && f < data.frequency_hz[data.frequency_hz.size() - 1]))
      continue;
    if (-p.real() > max_damping * std::abs(p) || half < 1e-2 * data.spacing_hz) continue;
    const bool known = std::any_of(kept.begin(), kept.end(), [&](Complex q) {
      return std::abs(p - q) < 0.1 * (data.window - std::max(p.real(), q.real()));
    });
    if (!known) kept.push_back(p);
  }
  return Eigen::Map<VectorXcd>(kept.data(), static_cast<Index>(kept.size()));
}

/// Squares that remain where one pole less is free in each group.
double squares_of_own_poles(const ModalData& data, const PoleWindow& window, const PoleFit& common,
                            const VectorXcd& poles) {
  double sum = 0;
  for (Index g = 0; g < data.groups(); ++g) {
    const Index first = data.begin[static_cast<std::size_t>(g)];
    const VectorXd weights = common.weights.segment(first, data.columns_of(g));
    sum += weights.dot(fit_poles(window, first, weights, poles, kGroupSteps).squares);
  }
  return sum;
}

/// Of a block's poles those that are no modes; none where all are.
std::vector<bool> no_modes(const ModalData& data, const PoleWindow& window, const PoleFit& fit,
                           const VectorXd& F) {
  const auto m = static_cast<std::size_t>(fit.poles.size());
  const double columns = static_cast<double>(fit.residues.cols());
  const double lines = data.lines_a_value();
  std::vector<bool> bad(m);
  const auto any = [&] { return std::find(bad.begin(), bad.end(), true) != bad.end(); };
  for (std::size_t r = 0; r < m; ++r) {
    bad[r] = chance_of(F[static_cast<Index>(r)] / kNoiseKnown, 2 * columns + 2,
                       2 * columns * fit.freedom / lines) >
             kNoiseChance * lines / static_cast<double>(data.frequency_hz.size());
  }
  if (any() || data.groups() < 3) return bad;
  for (std::size_t r = 0; r < m; ++r) {
    const GroupPoles own = poles_by_group(data, window, fit, static_cast<Index>(r));
    const auto sees = std::count(own.sees.begin(), own.sees.end(), true);
    const auto near = std::count(own.near.begin(), own.near.end(), true);
    bad[r] = static_cast<double>(near) < std::max(1.0, kShare * static_cast<double>(sees));
  }
  if (any()) return bad;
  std::vector<bool> over(m);
  for (std::size_t r = 0; r < m; ++r) {
    for (std::size_t q = 0; q < m; ++q) {
      over[r] = over[r] || (q != r && overlap(data, fit.poles[static_cast<Index>(r)],
                                              fit.poles[static_cast<Index>(q)]));
    }
  }
  for (std::size_t r = 0; r < m; ++r) {
    if (!over[r]) continue;
    const double own =
        squares_of_own_poles(data, window, fit, without(fit.poles, static_cast<Index>(r)));
    bad[r] = own < kBetter * fit.weights.dot(fit.squares);
  }
  // A pair of FRFs or a single one cannot tell shapes apart.
  if (any() || data.columns_of(0) * (data.hits ? 1 : data.groups()) < 3) return bad;
  const MatrixXcd shapes =
      (fit.residues * fit.weights.cwiseSqrt().asDiagonal()).rowwise().normalized();
  const MatrixXd alike = (shapes.conjugate() * shapes.transpose()).cwiseAbs2();
  for (std::size_t r = 0; r < m; ++r) {
    for (std::size_t q = 0; q < m; ++q) {
      const auto i = static_cast<Index>(r), j = static_cast<Index>(q);
      if (q != r && F[i] < F[j] && alike(i, j) > kSame &&
          overlap(data, fit.poles[i], fit.poles[j])) {
        bad[r] = true;
      }
    }
  }
  return bad;
}

}  // namespace

GroupPoles poles_by_group(const ModalData& data, const PoleWindow& window, const PoleFit& common,
                          Index r) {
  const PoleWindow one =
      common.poles.size() > 1 ? with_held(window, without(common.poles, r)) : window;
  const Complex p = common.poles[r];
  const double half = data.window - p.real();
  const double spacing = std::abs(window.s[1] - window.s[0]);
  const double lines = data.lines_a_value();
  const Index groups = data.groups();
  const CorrelatedNoise more = correlated_noise(data, one, p);
  GroupPoles own;
  own.pole.resize(groups);
  own.variance.resize(groups);
  own.residues.resize(window.Y.cols());
  const double peak = std::max(half, spacing);
  std::vector<Index> top;  // lines of its peak
  for (Index k = 0; k < window.s.size(); ++k) {
    if (std::abs(window.s[k].imag() - p.imag()) <= peak) top.push_back(k);
  }
  for (Index g = 0; g < groups; ++g) {
    const Index first = data.begin[static_cast<std::size_t>(g)], columns = data.columns_of(g);
    const VectorXd start = common.weights.segment(first, columns);
    PoleFit fit = fit_poles(one, first, start, VectorXcd::Constant(1, p), kGroupSteps);
    fit.freedom = common.freedom;
    // The group's own noise.
    const VectorXd v = (fit.squares / common.freedom).cwiseMax(1e-8 / start.maxCoeff());
    fit.weights = v.cwiseInverse();
    fit.normal(0, 0) =
        fit.schur(0, 0).real() * fit.residues.row(0).cwiseAbs2().dot(fit.weights.transpose());
    const double F = fit.residues.row(0).cwiseAbs2().dot(fit.weights.transpose()) /
                     fit.gram_inverse(0, 0).real() / static_cast<double>(columns + 1) /
                     more.of_size;
    const auto C = static_cast<double>(columns);
    own.pole[g] = fit.poles[0];
    own.residues.segment(first, columns) = fit.residues.row(0).transpose();
    own.variance[g] = 0.5 * more.of_pole / fit.normal(0, 0).real();
    const bool sees = own.variance[g] < half * half &&
                      chance_of(F, 2 * C + 2, 2 * C * common.freedom / lines) < kNoiseChance;
    own.sees.push_back(sees);
    own.near.push_back(sees && std::abs(fit.poles[0] - p) < half);
    const MatrixXcd X = resonances(one, fit.poles);
    double left = 0, all = 0;
    for (const Index k : top) {
      for (Index c = 0; c < columns; ++c) {
        const Complex mode = X(k, 0) * fit.residues(0, c);
        const Complex beyond = one.Y(k, first + c) - mode;
        own.size += fit.weights[c] * std::norm(mode);
        own.left += fit.weights[c] * std::norm(beyond);
        left += std::norm(beyond);
        all += std::norm(data.Y(window.first + k, first + c));
      }
    }
    own.misfit.push_back(all > 0 ? std::sqrt(left / all) : 0);
  }
  return own;
}

double shared_noise(const ModalData& data, const PoleWindow& window, const PoleFit& common) {
  MatrixXcd E = window.Y - resonances(window, common.poles) * common.residues;
  E *= common.weights.cwiseSqrt().asDiagonal();
  double sum = 0;
  for (Index g = 0; g < data.groups(); ++g) {
    const Index first = data.begin[static_cast<std::size_t>(g)], columns = data.columns_of(g);
    const auto own = E.middleCols(first, columns);
    const MatrixXcd R = own.adjoint() * own / common.freedom;
    const auto C = static_cast<double>(columns);
    const double by_chance = C * (C - 1) / common.freedom * data.lines_a_value();
    sum += std::max(1.0, (R.squaredNorm() - by_chance) / C);
  }
  return sum / static_cast<double>(data.groups());
}

VectorXcd sweep_poles(const ModalData& data, VectorXcd poles, double max_damping) {
  for (auto& block : blocks_of(data, poles)) {
    while (!block.empty()) {
      const PoleWindow window = window_of(data, data.Y, poles, block);
      const auto m = static_cast<Index>(block.size());
      VectorXcd own(m);
      for (Index r = 0; r < m; ++r) own[r] = poles[block[static_cast<std::size_t>(r)]];
      if (window.s.size() <= window.Q.cols() + 2 * m + 1) {
        for (const Index r : block) poles[r] = kGone;  // too few lines: out of the band
        break;
      }
      const PoleFit fit = fit_common_poles(window, own);
      const VectorXd F = gains(data, window, fit) / shared_noise(data, window, fit);
      for (Index r = 0; r < m; ++r) poles[block[static_cast<std::size_t>(r)]] = fit.poles[r];
      const std::vector<bool> bad = no_modes(data, window, fit, F);
      std::size_t worst = bad.size();
      for (std::size_t r = 0; r < bad.size(); ++r) {
        if (!bad[r]) continue;
        if (worst == bad.size() || F[static_cast<Index>(r)] < F[static_cast<Index>(worst)]) {
          worst = r;
        }
      }
      if (worst == bad.size()) break;
      poles[block[worst]] = kGone;  // beside no window any more
      block.erase(block.begin() + static_cast<std::ptrdiff_t>(worst));
    }
  }
  return distinct(data, poles, max_damping);
}

MatrixXcd residual_of(const ModalData& data, const VectorXcd& poles) {
  MatrixXcd R = data.Y;
  for (const auto& block : blocks_of(data, poles)) {
    const PoleWindow window = window_of(data, data.Y, poles, block);
    const auto m = static_cast<Index>(block.size());
    PoleFit fit;
    VectorXcd own(m);
    for (Index r = 0; r < m; ++r) own[r] = poles[block[static_cast<std::size_t>(r)]];
    fit = fit_common_poles(window, own);
    MatrixXcd each = fit.poles.replicate(1, data.groups());
    for (Index r = 0; r < m && data.groups() > 1; ++r) {
      const GroupPoles groups = poles_by_group(data, window, fit, r);
      for (Index g = 0; g < data.groups(); ++g) {
        if (groups.near[static_cast<std::size_t>(g)]) each(r, g) = groups.pole[g];
      }
    }
    for (Index g = 0; g < data.groups(); ++g) {
      const Index first = data.begin[static_cast<std::size_t>(g)], columns = data.columns_of(g);
      const PoleFit at = fit_poles(window, first, VectorXd::Ones(columns), each.col(g), 0);
      for (Index r = 0; r < m; ++r) {
        R.middleCols(first, columns).noalias() -=
            (data.s.array() - each(r, g)).inverse().matrix() * at.residues.row(r);
      }
    }
  }
  return R;
}

}  // namespace rigfit::signal
