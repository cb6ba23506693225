// FRFs as data of the update: residuals in their logarithm, which leads from far away, and for
// noisy lines of the last fits in their difference.
//
// The logarithm of a line with a relative noise s has a variance of s^2 (1 + s^2 + 8/3 s^4 + ...)
// and tails that no normal law has; judged by |H| as measured, lines of s = 0.4 and 0.5 come out 24
// and 62 % above their chi-square, and leaving out those that seem noisier than 0.5 keeps the ones
// that noise made large. Near the answer H - H_measured over the stated uncertainty is exactly
// normal for every line, so that none has to be left out; lines of s < 0.1, whose logarithm agrees
// with that to 1 %, stay as they are.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "ident/update/problem/update_problem.h"
#include "model/frfs/frf_sensitivities.h"

namespace rigfit::ident {
namespace {

// FRFs of one test share their lines: solved once for all of them, which follow each other.
bool solved_together(const MeasuredFrf& a, const MeasuredFrf& b) {
  return a.decay_rate_1_s == b.decay_rate_1_s && a.frequency_hz == b.frequency_hz;
}

constexpr double kRateStep = 1e-7;  // relative: a resonance is wider than 1e-4 of its frequency

model::FrfSensitivities frfs_at(const model::Scene& scene, const Eigen::VectorXd& lines,
                                const std::vector<std::string>& names, double decay_rate_1_s) {
  if (!names.empty()) {
    return model::synthesize_frf_sensitivities(scene, lines, names, {}, decay_rate_1_s);
  }
  model::FrfSensitivities plain;
  plain.frfs = model::synthesize_frfs(scene, lines, {}, decay_rate_1_s);
  return plain;
}

}  // namespace

double lines_per_independent(double decay_rate_1_s, double line_spacing_hz) {
  const double half = 0.5 * decay_rate_1_s / line_spacing_hz;
  return half > 1e-6 && std::isfinite(half) ? half / std::tanh(half) : 1;
}

UpdateProblem::FrfRows UpdateProblem::rows_of(int state, const MeasuredFrf& frf) const {
  constexpr double kNoisy = 0.1;
  FrfRows rows{.state = state, .load = frf.load, .frf = &frf};
  for (Eigen::Index k = 0; k < frf.H.size(); ++k) {
    const double size = std::abs(frf.H[k]);
    if (!(size > 0) || !std::isfinite(size)) continue;
    double own = options_.assumed_frf_relative_std;
    if (frf.std.size() > 0) {
      own = frf.std[k] / size;
      if (!std::isfinite(own)) continue;
    }
    const bool difference = variant_.frf_differences && frf.std.size() > 0 && own > kNoisy;
    if (!difference && own > options_.frf_max_relative_std) continue;
    if (!difference)
      own *= std::sqrt(1 + own * own);  // std of ln(1 + n), n complex noise, parts' variance own^2
    const double relative =
        std::hypot(own, options_.frf_model_relative_std, variant_.frf_model_std);
    if (!(relative > 0)) continue;  // exact lines have no weight beside others
    rows.line.push_back(k);
    rows.frequency_hz.push_back(frf.frequency_hz[k]);
    rows.difference.push_back(difference ? 1 : 0);
    rows.relative_std.push_back(relative * std::sqrt(frf.lines_per_independent));
  }
  return rows;
}

std::vector<UpdateProblem::FrfRows> UpdateProblem::rows_of(int state) const {
  std::vector<FrfRows> all;
  Eigen::Index row = 0;
  for (const auto& frf : states_[static_cast<std::size_t>(state)].frfs) {
    all.push_back(rows_of(state, frf));
    all.back().first = row;
    row += 2 * static_cast<Eigen::Index>(all.back().line.size());
  }
  return all;
}

std::vector<UpdateProblem::FrfRows> UpdateProblem::frf_rows(
    const std::vector<UpdateMatch>& matches) const {
  Eigen::Index row = residual_count(matches) - priors_ - 2 * frf_lines();
  std::vector<FrfRows> all;
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    if (!takes_part(s)) continue;
    for (auto& rows : rows_of(s)) {
      rows.first = row;
      row += 2 * static_cast<Eigen::Index>(rows.line.size());
      all.push_back(std::move(rows));
    }
  }
  return all;
}

Eigen::Index UpdateProblem::frf_lines() const {
  std::size_t count = 0;
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    if (!takes_part(s)) continue;
    for (const auto& rows : rows_of(s)) count += rows.line.size();
  }
  return static_cast<Eigen::Index>(count);
}

double UpdateProblem::shared_residuals() const {
  double shared = 0;
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    if (!takes_part(s)) continue;
    for (const auto& rows : rows_of(s)) {
      shared +=
          2 * static_cast<double>(rows.line.size()) * (1 - 1 / rows.frf->lines_per_independent);
    }
  }
  return shared;
}

bool UpdateProblem::frf_residuals(int state, const Eigen::VectorXd& q, Eigen::Index& row,
                                  Eigen::VectorXd& r, Eigen::MatrixXd* jacobian) const {
  const auto all = rows_of(state);
  if (all.empty()) return true;
  model::Scene scene;
  std::string failure;
  if (!fixed_scene(state, q, scene, failure)) return false;
  const auto [targets, owner] = jacobian != nullptr ? targets_of(state) : Targets{};
  std::vector<std::pair<Eigen::Index, double>> rates;
  if (jacobian != nullptr) rates = rate_changes(state);
  const double rate = measured_factor(state, q);
  const MeasuredFrf* solved_for = nullptr;
  model::FrfSensitivities solved, beside;  // beside: at a slightly higher sample rate
  for (const auto& rows : all) {
    const MeasuredFrf& frf = *rows.frf;
    if (solved_for == nullptr || !solved_together(frf, *solved_for)) {
      solved_for = &frf;
      const Eigen::VectorXd lines_hz = rate * frf.frequency_hz;
      solved = frfs_at(scene, lines_hz, targets, frf.decay_rate_1_s);
      if (solved.frfs.equilibrium.status != model::EquilibriumStatus::converged) return false;
      if (!rates.empty()) {
        beside = frfs_at(scene, (1 + kRateStep) * lines_hz, {}, frf.decay_rate_1_s);
        if (beside.frfs.H.size() != solved.frfs.H.size()) return false;
      }
    }
    const auto sensor = static_cast<Eigen::Index>(frf.sensor);
    const auto load = static_cast<Eigen::Index>(frf.load);
    for (std::size_t i = 0; i < rows.line.size(); ++i) {
      const auto k = static_cast<std::size_t>(rows.line[i]);
      const std::complex<double> H = solved.frfs.H[k](sensor, load);
      const std::complex<double> measured = frf.H[rows.line[i]];
      const bool difference = rows.difference[i] != 0;
      const std::complex<double> off = difference ? H / measured - 1.0 : std::log(H / measured);
      const double std = rows.relative_std[i];
      r[row] = off.real() / std;
      r[row + 1] = off.imag() / std;
      if (jacobian != nullptr) {
        const auto add = [&](Eigen::Index j, std::complex<double> change) {
          const std::complex<double> slope = change / (difference ? measured : H);
          (*jacobian)(row, j) += slope.real() / std;
          (*jacobian)(row + 1, j) += slope.imag() / std;
        };
        for (std::size_t t = 0; t < targets.size(); ++t) {
          const auto [j, factor] = owner[t];
          const auto& coordinate = coordinates_[static_cast<std::size_t>(j)];
          add(j, factor * coordinate.derivative(q[j]) * solved.rate[t][k](sensor, load));
        }
        for (const auto& [j, change] : rates) {
          add(j, (beside.frfs.H[k](sensor, load) - H) * change / (rate * kRateStep));
        }
      }
      row += 2;
    }
  }
  return true;
}

double UpdateProblem::rms_log_frf_error(const Eigen::VectorXd& q, int only) const {
  if (variant_.frf_differences) {
    return with(&UpdateVariant::frf_differences, false).rms_log_frf_error(q, only);
  }
  double squares = 0;
  Eigen::Index count = 0;
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    if (only >= 0 ? s != only : !takes_part(s)) continue;
    const auto all = rows_of(s);
    Eigen::Index lines = 0;
    for (const auto& rows : all) lines += static_cast<Eigen::Index>(rows.line.size());
    if (lines == 0) continue;
    Eigen::VectorXd r = Eigen::VectorXd::Zero(2 * lines);
    Eigen::Index row = 0;
    if (!frf_residuals(s, q, row, r, nullptr)) return std::numeric_limits<double>::quiet_NaN();
    row = 0;
    for (const auto& rows : all) {
      for (const double relative : rows.relative_std) {
        squares += r.segment(row, 2).squaredNorm() * relative * relative;
        row += 2;
      }
    }
    count += lines;
  }
  return count > 0 ? std::sqrt(squares / static_cast<double>(count))
                   : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace rigfit::ident
