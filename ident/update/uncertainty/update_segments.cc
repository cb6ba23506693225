#include "ident/update/uncertainty/update_segments.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ident/update/uncertainty/shared_sources.h"

namespace rigfit::ident {
namespace {

// Remaining shift of a parameter over its standard uncertainty from all else that is small enough.
constexpr double kSmall = 0.2;

constexpr int kMost = 8;  // times the segments at first

bool leaves_segments(const model::Member& member) { return member.segments == 0; }

}  // namespace

UpdateProblem UpdateProblem::with_auto_segments(int segments) const {
  UpdateProblem other = *this;
  other.options_.auto_segments = segments;
  return other;
}

bool UpdateProblem::has_auto_segments() const {
  return std::any_of(states_.begin(), states_.end(), [](const auto& state) {
    const auto& members = state.scene.members;
    return std::any_of(members.begin(), members.end(), leaves_segments);
  });
}

bool UpdateProblem::has_given_segments() const {
  return std::any_of(states_.begin(), states_.end(), [](const auto& state) {
    const auto& members = state.scene.members;
    return !std::all_of(members.begin(), members.end(), leaves_segments);
  });
}

UpdateProblem UpdateProblem::with_segment_errors() const {
  UpdateProblem other = *this;
  other.mode_errors_.reset();
  return other;
}

UpdateProblem UpdateProblem::with_segment_errors_off(const Eigen::VectorXd& q) const {
  UpdateProblem other = with_segment_errors();
  auto errors = std::make_shared<ModeErrors>(states_.size());
  for (std::size_t s = 0; s < states_.size(); ++s) {
    const auto& members = states_[s].scene.members;
    if (states_[s].measured.empty() || states_[s].modes_lead_only ||
        std::none_of(members.begin(), members.end(), leaves_segments)) {
      continue;
    }
    const int state = static_cast<int>(s);
    const auto here = other.modes(state, q, false);
    const int now = options_.auto_segments;
    const auto twice = other.with_auto_segments(2 * now).modes(state, q, false);
    const auto four = other.with_auto_segments(4 * now).modes(state, q, false);
    if (!here.failure.empty() || !twice.failure.empty() || !four.failure.empty()) continue;
    for (const auto& mode : here.modes) {
      const auto *two = twice.find(mode.plane, mode.order),
                 *last = four.find(mode.plane, mode.order);
      if (two == nullptr || last == nullptr) continue;
      const double f1 = std::log(mode.frequency_hz), f2 = std::log(two->frequency_hz),
                   f4 = std::log(last->frequency_hz);
      const double first = f2 - f1, second = f4 - f2;
      if (std::abs(second) > std::abs(first)) continue;  // no limit is in sight
      // Romberg's table: second order taken out, then fourth.
      const double once = f2 + first / 3, again = f4 + second / 3;
      if (first / second >= 3) {
        const double limit = again + (again - once) / 15;
        (*errors)[s].push_back(
            {mode.plane, mode.order, f1 - limit, f2 - again, std::abs(again - limit)});
      } else {  // slower than second order, or about to turn: the last step may all be missing
        (*errors)[s].push_back(
            {mode.plane, mode.order, f1 - again, f2 - again - second, std::abs(second)});
      }
    }
  }
  other.mode_errors_ = std::move(errors);
  return other;
}

bool UpdateProblem::takes_errors_off() const {
  return mode_errors_ && std::any_of(mode_errors_->begin(), mode_errors_->end(),
                                     [](const auto& errors) { return !errors.empty(); });
}

const UpdateProblem::ModeError* UpdateProblem::find(const std::vector<ModeError>& errors,
                                                    model::ModePlane plane, int order) {
  for (const auto& error : errors) {
    if (error.plane == plane && error.order == order) return &error;
  }
  return nullptr;
}

void UpdateProblem::take_errors_off(int state, std::vector<UpdateModelMode>& modes) const {
  if (!mode_errors_ || (segment_factor_ != 1 && segment_factor_ != 2)) return;
  for (auto& mode : modes) {
    const auto* error =
        find((*mode_errors_)[static_cast<std::size_t>(state)], mode.plane, mode.order);
    if (error == nullptr) continue;
    mode.frequency_hz *= std::exp(-(segment_factor_ == 1 ? error->here : error->twice));
  }
}

double UpdateProblem::left_over_accuracy(const std::vector<UpdateMatch>& matches) const {
  double largest = 0;
  if (!mode_errors_) return largest;
  for (const auto& match : matches) {
    const auto s = static_cast<std::size_t>(match.state);
    const auto* error = find((*mode_errors_)[s], match.plane, match.order);
    if (error == nullptr || match.cross_plane) continue;
    largest = std::max(largest, error->left / states_[s].scene.accuracy);
  }
  return largest;
}

UpdateProblem take_segments_off(const UpdateProblem& problem, const UpdateOptions& options,
                                UpdateSolution& answer, int passes) {
  UpdateProblem settled = problem;
  if (!options.segment_uncertainty) return settled;
  for (int pass = 0; pass < passes; ++pass) {
    UpdateProblem trial = problem.with_segment_errors_off(answer.q);
    if (!trial.takes_errors_off()) break;
    Eigen::VectorXd q = answer.q;
    double cost = 0;
    if (!minimise(trial, answer.matches.matches, UpdateStage::full, options, q, cost)) break;
    answer.q = std::move(q);
    settled = std::move(trial);
  }
  return settled;
}

double segment_excess(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                      const UpdateResult& result) {
  double excess = 0;
  for (const auto& parameter : result.parameters) {
    if (!parameter.identifiable || !std::isfinite(parameter.segment_shift)) continue;
    const double all = parameter.std * parameter.std,
                 own = parameter.segment_shift * parameter.segment_shift;
    const double small = kSmall * std::sqrt(std::max(all - own, 1e-6 * own));
    if (own > 0) excess = std::max(excess, std::sqrt(own) / small);
  }
  if (!problem.has_frfs()) return excess;
  Eigen::VectorXd change;
  const auto residuals = [&](const UpdateProblem& moved, Eigen::VectorXd& r) {
    return moved.residuals(result.coordinates, matches, UpdateStage::full, r, nullptr);
  };
  if (!change_by_segments(problem, residuals, change)) return excess;
  const double verdict = kSmall * std::sqrt(2 * std::max(1.0, result.degrees_of_freedom));
  return std::max(excess, std::sqrt(change.squaredNorm() / verdict));
}

int auto_segments_needed(const UpdateProblem& problem, const UpdateOptions& options,
                         const std::vector<UpdateMatch>& matches, const UpdateResult& result,
                         int now) {
  if (!options.segment_uncertainty || !problem.has_auto_segments()) return now;
  const double excess =
      std::max(problem.left_over_accuracy(matches), segment_excess(problem, matches, result));
  if (!(excess > 1)) return now;
  // Second order; a tenth more, as that is no law.
  const double wanted = 1.1 * now * std::sqrt(std::min(excess, 100.0));
  return std::min(static_cast<int>(std::ceil(wanted)), kMost * options.auto_segments);
}

UpdateProblem as_solved(const UpdateProblem& problem, const UpdateOptions& options,
                        const UpdateResult& solution, const Eigen::VectorXd& q) {
  const UpdateProblem same =
      problem.with_auto_segments(solution.auto_segments).with_model_std(solution.fit.model_std);
  return options.segment_uncertainty ? same.with_segment_errors_off(q) : same;
}

}  // namespace rigfit::ident
