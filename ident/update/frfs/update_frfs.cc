// FRFs as data of the update: residuals in their logarithm, which leads from far away, and for
// noisy lines of the last fits in their difference.
//
// The logarithm of a line with a relative noise s has a variance of s^2 (1 + s^2 + 8/3 s^4 + ...)
// and tails that no normal law has; judged by |H| as measured, lines of s = 0.4 and 0.5 come out 24
// and 62 % above their chi-square, and leaving out those that seem noisier than 0.5 keeps the ones
// that noise made large. Near the answer H - H_measured over the stated uncertainty is exactly
// normal for every line, so that none has to be left out; lines of s < 0.1, whose logarithm agrees
// with that to 1 %, stay as they are.

#include "ident/update/problem/update_problem.h"
#include "model/frfs/frf_synthesis.h"

namespace rigfit::ident {
namespace {

// FRFs of one test share their lines: solved once for all of them, which follow each other.
bool solved_together(const MeasuredFrf& a, const MeasuredFrf& b) {
  return a.decay_rate_1_s == b.decay_rate_1_s && a.frequency_hz.size() == b.frequency_hz.size() &&
         a.frequency_hz == b.frequency_hz;
}

const double kRateStep = std::sqrt(std::numeric_limits<double>::epsilon());

model::FrfSensitivities frfs_at(const model::Scene& scene, const VectorXd& lines,
                                const std::vector<model::ParameterAccess>& parameters,
                                double decay_rate_1_s) {
  if (!parameters.empty()) {
    return model::synthesize_frf_sensitivities(scene, lines, parameters, {}, decay_rate_1_s);
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
  constexpr double kNoisy = 0.1, kAssumed = 0.05;  // assumed: it only sets the weight
  constexpr double kLargest = 0.5;                 // beyond, a logarithm has no information
  FrfRows rows{.state = state, .frf = &frf};
  for (Index k = 0; k < frf.H.size(); ++k) {
    const double size = std::abs(frf.H[k]);
    if (!(size > 0) || !std::isfinite(size)) continue;
    double own = kAssumed;
    if (frf.std.size() > 0) {
      own = frf.std[k] / size;
      if (!std::isfinite(own)) continue;
    }
    const bool difference = variant_.frf_differences && frf.std.size() > 0 && own > kNoisy;
    if (!difference && own > kLargest) continue;
    if (!difference)
      own *= std::sqrt(1 + own * own);  // std of ln(1 + n), n complex noise, parts' variance own^2
    const double relative = std::hypot(own, variant_.frf_model_std);
    if (!(relative > 0)) continue;  // exact lines have no weight beside others
    rows.line.push_back(k);
    rows.difference.push_back(difference ? 1 : 0);
    rows.relative_std.push_back(relative * std::sqrt(frf.lines_per_independent));
  }
  return rows;
}

std::vector<UpdateProblem::FrfRows> UpdateProblem::frf_rows() const {
  std::vector<FrfRows> all;
  Index row = 0;
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    if (!takes_part(s)) continue;
    for (const auto& frf : state_at(s).frfs) {
      all.push_back(rows_of(s, frf));
      all.back().first = row;
      row += 2 * static_cast<Index>(all.back().line.size());
    }
  }
  return all;
}

Index UpdateProblem::frf_lines() const {
  std::size_t count = 0;
  for (const auto& rows : frf_rows()) count += rows.line.size();
  return static_cast<Index>(count);
}

double UpdateProblem::degrees_of_freedom(Index residuals) const {
  double shared = 0;
  for (const auto& rows : frf_rows()) {
    shared += 2 * static_cast<double>(rows.line.size()) * (1 - 1 / rows.frf->lines_per_independent);
  }
  return static_cast<double>(residuals - size()) - shared;
}

bool UpdateProblem::frf_residuals(const VectorXd& q, const std::vector<FrfRows>& all, VectorXd& r,
                                  MatrixXd* jacobian) const {
  const FrfRows* last = nullptr;
  Targets targets;
  std::vector<std::pair<Index, double>> rates;
  model::Scene scene;
  model::FrfSensitivities solved, beside;  // beside: at a slightly higher sample rate
  for (const auto& rows : all) {
    const MeasuredFrf& frf = *rows.frf;
    const double rate = measured_factor(rows.state, q);
    const bool same_state = last != nullptr && last->state == rows.state;
    if (!same_state) {
      std::string failure;
      if (!fixed_scene(rows.state, q, scene, failure)) return false;
      if (jacobian != nullptr) {
        targets = targets_together(rows.state, scene), rates = rate_changes(rows.state);
      }
    }
    if (!same_state || !solved_together(frf, *last->frf)) {
      const VectorXd lines_hz = rate * frf.frequency_hz;
      solved = frfs_at(scene, lines_hz, targets.access, frf.decay_rate_1_s);
      if (solved.frfs.equilibrium.status != model::EquilibriumStatus::converged) return false;
      if (!rates.empty()) {
        beside = frfs_at(scene, (1 + kRateStep) * lines_hz, {}, frf.decay_rate_1_s);
        if (beside.frfs.H.size() != solved.frfs.H.size()) return false;
      }
    }
    last = &rows;
    const auto sensor = static_cast<Index>(frf.sensor);
    const auto load = static_cast<Index>(frf.load);
    for (std::size_t i = 0; i < rows.line.size(); ++i) {
      const auto k = static_cast<std::size_t>(rows.line[i]);
      const Index row = rows.first + 2 * static_cast<Index>(i);
      const std::complex<double> H = solved.frfs.H[k](sensor, load);
      const std::complex<double> measured = frf.H[rows.line[i]];
      const bool difference = rows.difference[i] != 0;
      const std::complex<double> off = difference ? H / measured - 1.0 : std::log(H / measured);
      const double std = rows.relative_std[i];
      r[row] = off.real() / std;
      r[row + 1] = off.imag() / std;
      if (jacobian == nullptr) continue;
      const auto add = [&](Index j, std::complex<double> change) {
        const std::complex<double> slope = change / (difference ? measured : H);
        (*jacobian)(row, j) += slope.real() / std;
        (*jacobian)(row + 1, j) += slope.imag() / std;
      };
      for (std::size_t t = 0; t < targets.access.size(); ++t) {
        const auto [j, factor] = targets.owner[t];
        const auto& coordinate = coordinate_at(j);
        add(j, factor * coordinate.derivative(q[j]) * solved.rate[t][k](sensor, load));
      }
      for (const auto& [j, change] : rates) {
        add(j, (beside.frfs.H[k](sensor, load) - H) * change / (rate * kRateStep));
      }
    }
  }
  return true;
}

double UpdateProblem::rms_log_frf_error(const VectorXd& q) const {
  const UpdateProblem logarithms = with(&UpdateVariant::frf_differences, false);
  const auto all = logarithms.frf_rows();
  double squares = 0, count = 0;
  for (const auto& rows : all) count += static_cast<double>(rows.line.size());
  VectorXd r(static_cast<Index>(2 * count));
  if (!logarithms.frf_residuals(q, all, r, nullptr)) return kNaN;
  for (const auto& rows : all) {
    for (std::size_t i = 0; i < rows.line.size(); ++i) {
      squares += r.segment<2>(rows.first + 2 * static_cast<Index>(i)).squaredNorm() *
                 std::pow(rows.relative_std[i], 2);
    }
  }
  return std::sqrt(squares / count);  // NaN without lines
}

}  // namespace rigfit::ident
