// Time histories as data of the update: the scene's response to its own loads against the record.
// Derivatives by differences of responses: a linear response costs milliseconds.
#include <algorithm>
#include <cmath>
#include <limits>

#include "ident/update/problem/update_problem.h"
#include "model/response/response.h"

namespace rigfit::ident {
namespace {

// Rows x sensors of the history; empty when the model has no response.
Eigen::MatrixXd response_of(const model::Scene& scene, const MeasuredHistory& history,
                            double rate_factor) {
  model::ResponseOptions options;
  options.sampling.rate_hz = rate_factor * history.rate_hz;
  options.sampling.duration_s =
      static_cast<double>(history.samples.rows() - 1) / options.sampling.rate_hz;
  options.sampling.energy_samples = 0;
  options.axial = true;  // by need it may change from one set of parameters to the next
  options.records = history.records;
  options.records.resize(scene.loads.size());
  const auto result = model::simulate_response(scene, options);
  if (!result.completed || result.samples.rows() < history.samples.rows()) return {};
  Eigen::MatrixXd samples(history.samples.rows(), history.samples.cols());
  for (Eigen::Index c = 0; c < samples.cols(); ++c) {
    samples.col(c) =
        result.samples.col(static_cast<Eigen::Index>(history.sensors[static_cast<std::size_t>(c)]))
            .head(samples.rows());
  }
  return samples;
}

double rms_of(const Eigen::Ref<const Eigen::VectorXd>& y) {
  double squares = 0, count = 0;
  for (const double value : y) {
    if (std::isfinite(value)) squares += value * value, ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : 0;
}

// Of one sample.
double std_of_column(const MeasuredHistory& history, Eigen::Index column,
                     const UpdateOptions& options) {
  return history.std.size() > 0
             ? history.std[column]
             : options.assumed_history_relative_std * rms_of(history.samples.col(column));
}

}  // namespace

bool UpdateProblem::has_histories() const {
  return std::any_of(states_.begin(), states_.end(),
                     [](const auto& state) { return !state.histories.empty(); });
}

Eigen::Index UpdateProblem::history_samples() const {
  Eigen::Index count = 0;
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    if (!takes_part(s)) continue;
    for (const auto& history : states_[static_cast<std::size_t>(s)].histories) {
      count += history.samples.array().isFinite().count();
    }
  }
  return count;
}

bool UpdateProblem::history_residuals(int state, const Eigen::VectorXd& q, Eigen::Index& row,
                                      Eigen::VectorXd& r, Eigen::MatrixXd* jacobian) const {
  const auto& histories = states_[static_cast<std::size_t>(state)].histories;
  if (histories.empty()) return true;
  model::Scene scene;
  std::string failure;
  if (!fixed_scene(state, q, scene, failure)) return false;
  const double factor = measured_factor(state);
  for (const auto& history : histories) {
    ++shared_->evaluations;
    const Eigen::MatrixXd here = response_of(scene, history, factor);
    if (here.size() == 0) return false;
    std::vector<Eigen::MatrixXd> rates;
    if (jacobian != nullptr) {
      for (Eigen::Index j = 0; j < size(); ++j) {
        const auto& coordinate = coordinates_[static_cast<std::size_t>(j)];
        rates.emplace_back();
        if (coordinate.state >= 0 && coordinate.state != state) continue;
        // 1e-4: second differences 1e-8, rounding of a response 1e-12 over it.
        const double step = 1e-4;
        Eigen::VectorXd up = q, down = q;
        up[j] += step, down[j] -= step;
        model::Scene above, below;
        if (!fixed_scene(state, up, above, failure) || !fixed_scene(state, down, below, failure)) {
          return false;
        }
        const Eigen::MatrixXd high = response_of(above, history, factor),
                              low = response_of(below, history, factor);
        if (high.size() == 0 || low.size() == 0) return false;
        rates.back() = (high - low) / (2 * step);
      }
    }
    for (Eigen::Index c = 0; c < here.cols(); ++c) {
      const auto measured = history.samples.col(c);
      const double std = std_of_column(history, c, options_);
      if (!(std > 0)) return false;
      for (Eigen::Index i = 0; i < here.rows(); ++i) {
        if (!std::isfinite(measured[i])) continue;
        r[row] = (here(i, c) - measured[i]) / std;
        if (jacobian != nullptr) {
          for (Eigen::Index j = 0; j < size(); ++j) {
            const auto& rate = rates[static_cast<std::size_t>(j)];
            if (rate.size() > 0) (*jacobian)(row, j) = rate(i, c) / std;
          }
        }
        ++row;
      }
    }
  }
  return true;
}

double UpdateProblem::history_error(const Eigen::VectorXd& q) const {
  double misfit = 0, size = 0;
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    if (!takes_part(s)) continue;
    model::Scene scene;
    std::string failure;
    if (!fixed_scene(s, q, scene, failure)) return std::numeric_limits<double>::quiet_NaN();
    for (const auto& history : states_[static_cast<std::size_t>(s)].histories) {
      const Eigen::MatrixXd here = response_of(scene, history, measured_factor(s));
      if (here.size() == 0) return std::numeric_limits<double>::quiet_NaN();
      for (Eigen::Index k = 0; k < here.size(); ++k) {
        const double measured = history.samples(k);
        if (!std::isfinite(measured)) continue;
        misfit += (here(k) - measured) * (here(k) - measured);
        size += measured * measured;
      }
    }
  }
  return size > 0 ? std::sqrt(misfit / size) : std::numeric_limits<double>::quiet_NaN();
}

bool UpdateProblem::redraw_histories(const Eigen::VectorXd& q, double spread,
                                     const std::function<double()>& normal) {
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    auto& histories = states_[static_cast<std::size_t>(s)].histories;
    if (histories.empty()) continue;
    model::Scene scene;
    std::string failure;
    if (!fixed_scene(s, q, scene, failure)) return false;
    for (auto& history : histories) {
      const Eigen::MatrixXd here = response_of(scene, history, measured_factor(s));
      if (here.size() == 0) return false;
      // What was assumed of the record's own rms stays what it was.
      Eigen::VectorXd std(here.cols());
      for (Eigen::Index c = 0; c < here.cols(); ++c) std[c] = std_of_column(history, c, options_);
      history.std = std;
      for (Eigen::Index c = 0; c < here.cols(); ++c) {
        for (Eigen::Index i = 0; i < here.rows(); ++i) {
          if (!std::isfinite(history.samples(i, c))) continue;  // not recorded
          history.samples(i, c) = here(i, c) + spread * std[c] * normal();
        }
      }
    }
  }
  return true;
}

}  // namespace rigfit::ident
