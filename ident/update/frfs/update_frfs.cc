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

UpdateProblem::FrfLines UpdateProblem::lines_of(const MeasuredFrf& frf) const {
  constexpr double kNoisy = 0.1;
  FrfLines lines;
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
    lines.line.push_back(k);
    lines.difference.push_back(difference ? 1 : 0);
    lines.relative_std.push_back(relative * std::sqrt(frf.lines_per_independent));
  }
  return lines;
}

Eigen::Index UpdateProblem::frf_lines() const {
  Eigen::Index count = 0;
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    if (!takes_part(s)) continue;
    for (const auto& frf : states_[static_cast<std::size_t>(s)].frfs) {
      count += static_cast<Eigen::Index>(lines_of(frf).line.size());
    }
  }
  return count;
}

double UpdateProblem::shared_residuals() const {
  double shared = 0;
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    if (!takes_part(s)) continue;
    for (const auto& frf : states_[static_cast<std::size_t>(s)].frfs) {
      shared +=
          2 * static_cast<double>(lines_of(frf).line.size()) * (1 - 1 / frf.lines_per_independent);
    }
  }
  return shared;
}

bool UpdateProblem::frf_residuals(int state, const Eigen::VectorXd& q, Eigen::Index& row,
                                  Eigen::VectorXd& r, Eigen::MatrixXd* jacobian) const {
  const auto& frfs = states_[static_cast<std::size_t>(state)].frfs;
  if (frfs.empty()) return true;
  model::Scene scene;
  std::string failure;
  if (!fixed_scene(state, q, scene, failure)) return false;
  const auto [targets, owner] = jacobian != nullptr ? targets_of(state) : Targets{};
  std::vector<std::pair<Eigen::Index, double>> rates;
  if (jacobian != nullptr) rates = rate_changes(state);
  for (std::size_t f = 0; f < frfs.size(); ++f) {
    // FRFs of one test share their lines: solved once for all of them.
    bool before = false;
    for (std::size_t g = 0; g < f; ++g) before = before || solved_together(frfs[g], frfs[f]);
    if (before) continue;
    ++shared_->evaluations;
    const double rate = measured_factor(state, q);
    const Eigen::VectorXd lines_hz = rate * frfs[f].frequency_hz;
    const auto solved = frfs_at(scene, lines_hz, targets, frfs[f].decay_rate_1_s);
    if (solved.frfs.equilibrium.status != model::EquilibriumStatus::converged) return false;
    model::FrfSensitivities beside;  // at a slightly higher sample rate
    if (!rates.empty()) {
      beside = frfs_at(scene, (1 + kRateStep) * lines_hz, {}, frfs[f].decay_rate_1_s);
      if (beside.frfs.H.size() != solved.frfs.H.size()) return false;
    }
    for (std::size_t g = f; g < frfs.size(); ++g) {
      const MeasuredFrf& frf = frfs[g];
      if (g != f && !solved_together(frf, frfs[f])) continue;
      const FrfLines lines = lines_of(frf);
      const auto sensor = static_cast<Eigen::Index>(frf.sensor);
      const auto load = static_cast<Eigen::Index>(frf.load);
      for (std::size_t i = 0; i < lines.line.size(); ++i) {
        const auto k = static_cast<std::size_t>(lines.line[i]);
        const std::complex<double> H = solved.frfs.H[k](sensor, load);
        const std::complex<double> measured = frf.H[lines.line[i]];
        const bool difference = lines.difference[i] != 0;
        const std::complex<double> off = difference ? H / measured - 1.0 : std::log(H / measured);
        const double std = lines.relative_std[i];
        r[row] = off.real() / std;
        r[row + 1] = off.imag() / std;
        if (jacobian != nullptr) {
          for (std::size_t t = 0; t < targets.size(); ++t) {
            const auto [j, factor] = owner[t];
            const double by = factor * coordinates_[static_cast<std::size_t>(j)].derivative(q[j]);
            const std::complex<double> slope =
                by * solved.rate[t][k](sensor, load) / (difference ? measured : H);
            (*jacobian)(row, j) += slope.real() / std;
            (*jacobian)(row + 1, j) += slope.imag() / std;
          }
          for (const auto& [j, change] : rates) {
            const std::complex<double> slope = (beside.frfs.H[k](sensor, load) - H) * change /
                                               (rate * kRateStep * (difference ? measured : H));
            (*jacobian)(row, j) += slope.real() / std;
            (*jacobian)(row + 1, j) += slope.imag() / std;
          }
        }
        row += 2;
      }
    }
  }
  return true;
}

std::vector<UpdateProblem::FrfRows> UpdateProblem::frf_rows_of(int state) const {
  std::vector<FrfRows> all;
  const auto& frfs = states_[static_cast<std::size_t>(state)].frfs;
  std::vector<bool> done(frfs.size(), false);
  for (std::size_t f = 0; f < frfs.size(); ++f) {
    for (std::size_t g = f; g < frfs.size(); ++g) {
      if (done[g] || !solved_together(frfs[g], frfs[f])) continue;
      done[g] = true;
      const FrfLines lines = lines_of(frfs[g]);
      std::vector<double> frequency_hz;
      frequency_hz.reserve(lines.line.size());
      for (const auto line : lines.line) frequency_hz.push_back(frfs[g].frequency_hz[line]);
      all.push_back({0, lines.relative_std, g, state, frfs[g].load, std::move(frequency_hz)});
    }
  }
  return all;
}

std::vector<UpdateProblem::FrfRows> UpdateProblem::frf_rows(
    const std::vector<UpdateMatch>& matches) const {
  Eigen::Index row = residual_count(matches) - priors_ - 2 * frf_lines();
  std::vector<FrfRows> all;
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    if (!takes_part(s)) continue;
    for (auto& rows : frf_rows_of(s)) {
      rows.first = row;
      row += 2 * static_cast<Eigen::Index>(rows.relative_std.size());
      all.push_back(std::move(rows));
    }
  }
  return all;
}

double UpdateProblem::rms_log_frf_error(const Eigen::VectorXd& q, int only) const {
  if (variant_.frf_differences) {
    return with(&UpdateVariant::frf_differences, false).rms_log_frf_error(q, only);
  }
  double squares = 0;
  Eigen::Index count = 0;
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    if (only >= 0 ? s != only : !takes_part(s)) continue;
    Eigen::Index lines = 0;
    const auto all = frf_rows_of(s);
    for (const auto& rows : all) lines += static_cast<Eigen::Index>(rows.relative_std.size());
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
