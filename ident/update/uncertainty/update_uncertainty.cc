#include "ident/update/uncertainty/update_uncertainty.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "ident/update/uncertainty/shared_sources.h"
#include "ident/update/uncertainty/update_misfit.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;
// Residuals or frequencies of a problem; false when there is no model there.
using Changed = std::function<bool(const UpdateProblem&, Eigen::VectorXd&)>;

// `correlated`: what lines that err together make of a coordinate's variance, over that of
// independent lines with the stated uncertainties; 0: no such lines.
// `chi2`: with what the inputs explain.
void state_variance_factor(const UpdateProblem& problem, const UpdateOptions& options,
                           double correlated, double chi2, UpdateResult& result) {
  const double reduced = result.degrees_of_freedom > 0 ? chi2 / result.degrees_of_freedom : kNaN;
  // Stated uncertainties are trusted unless the scatter contradicts them; assumed ones are not.
  // Priors and a stated error of the model do not shrink because assumed ones were too large.
  const bool stated = problem.uncertainties_known();
  const bool may_shrink = !stated && problem.prior_count() == 0 && options.model_relative_std == 0;
  const double least = may_shrink ? 0 : 1;
  result.variance_factor = std::isfinite(reduced) ? std::max(reduced, least) : 1;
  bool from_scatter = !stated && result.variance_factor == reduced;
  if (correlated > result.variance_factor) {
    result.variance_factor = correlated;
    from_scatter = std::isfinite(reduced);
  }
  result.coverage_factor = coverage_factor(
      0.95, from_scatter ? result.degrees_of_freedom / result.fit.correlated_lines : 0);
  if (!stated && !std::isfinite(reduced)) {
    result.message +=
        "State the frequencies' uncertainties: without more data than unknowns the assumed one "
        "determines all others; ";
  }
}

// By coordinate: what each prior adds to its standard uncertainty, one a column.
Eigen::MatrixXd prior_parts(const UpdateProblem& problem, const Eigen::MatrixXd& J,
                            const Identifiability& known, const IdentifiabilityOptions& limits) {
  Eigen::MatrixXd parts(J.cols(), problem.prior_count());
  for (Eigen::Index i = 0; i < parts.cols(); ++i) {
    Eigen::VectorXd unit = Eigen::VectorXd::Zero(J.rows());
    unit[J.rows() - parts.cols() + i] = std::sqrt(limits.variance_factor);
    parts.col(i) = known.shift_by(J, unit, limits);
  }
  return parts;
}

void state_shifts(const UpdateProblem& problem, const UpdateOptions& options,
                  const std::vector<UpdateMatch>& matches, const Eigen::VectorXd& weights,
                  const Eigen::MatrixXd& J, const IdentifiabilityOptions& limits,
                  const Eigen::VectorXd& by_segments, UpdateResult& result) {
  const Eigen::Index known = by_segments.size() > 0 ? 1 : 0;
  const SharedChanges shared = shared_changes(problem, options.segment_uncertainty && known == 0,
                                              matches, result.coordinates);
  result.message += shared.message;
  result.shift_sources = shared.names;
  result.shifts.resize(problem.size(), known + shared.changes.cols());
  if (known > 0) {
    result.shift_sources.insert(result.shift_sources.begin(), "segments");
    result.shifts.col(0) = by_segments;
  }
  for (Eigen::Index k = 0; k < shared.changes.cols(); ++k) {
    result.shifts.col(known + k) =
        result.identifiability.shift_by(J, weights.cwiseProduct(shared.changes.col(k)), limits);
  }
}

// What the model's own error does to the coordinates.
struct ModelPart {
  Eigen::VectorXd widening;       // factors on the uncertainties, for errors that modes share
  Eigen::VectorXd data_variance;  // by the stated uncertainties alone; empty: no error of the model
};

ModelPart model_part(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                     const Eigen::VectorXd& r, const Eigen::MatrixXd& J,
                     const Eigen::VectorXd& scales, const std::vector<std::string>& names,
                     const UpdateResult& result) {
  ModelPart part{Eigen::VectorXd::Ones(J.cols()), {}};
  if (!(result.fit.model_std > 0)) return part;
  const Eigen::VectorXd clustered = clustered_variance(problem, matches, r, J);
  for (Eigen::Index i = 0; i < part.widening.size(); ++i) {
    const double own = result.identifiability.std[i];
    if (own > 0) part.widening[i] = std::sqrt(std::max(1.0, clustered[i] / (own * own)));
  }
  if (!result.fit.stated) return part;
  const UpdateProblem plain = problem.with_model_std(0);
  Eigen::MatrixXd stated = J;
  for (const auto& row : plain.frequency_rows(matches)) {
    const auto& match = matches[row.match];
    stated.row(row.row) *= problem.relative_std(match.state, match.measured) /
                           plain.relative_std(match.state, match.measured);
  }
  part.data_variance = identifiability(stated, scales, names).std.cwiseAbs2();
  for (double& variance : part.data_variance) {
    if (!std::isfinite(variance)) variance = std::numeric_limits<double>::max();
  }
  return part;
}

}  // namespace

Eigen::VectorXd huber_weights(const UpdateProblem& problem, const UpdateOptions& options,
                              const Eigen::VectorXd& r) {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(r.size());
  for (Eigen::Index i = 0; i < r.size() - problem.prior_count(); ++i) {
    weights[i] =
        std::min(1.0, std::sqrt(options.huber_threshold / std::max(std::abs(r[i]), 1e-300)));
  }
  return weights;
}

void state_uncertainty(const UpdateProblem& problem, const UpdateOptions& options,
                       const std::vector<UpdateMatch>& matches, UpdateResult& result,
                       const Eigen::VectorXd& by_segments) {
  const Eigen::Index n = problem.size();
  const Eigen::VectorXd& q = result.coordinates;
  result.covariance = result.correlation = Eigen::MatrixXd::Constant(n, n, kNaN);
  Eigen::VectorXd r;
  Eigen::MatrixXd J;
  if (!problem.residuals(q, matches, r, &J)) return;
  const Eigen::VectorXd weights = huber_weights(problem, options, r);
  r = r.cwiseProduct(weights).eval();
  J = weights.asDiagonal() * J;
  result.chi_squared = r.squaredNorm();
  result.degrees_of_freedom = static_cast<double>(r.size() - n) - problem.shared_residuals();
  double chi2 = result.chi_squared;
  if (result.fit.by_inputs > 0) {
    chi2 = std::min(chi2, chi2_with_inputs(problem, matches, q).value_or(chi2));
  }
  state_variance_factor(problem, options, correlated_variance_factor(problem, matches, q, r, J),
                        chi2, result);

  Eigen::VectorXd scales = Eigen::VectorXd::Ones(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    if (!problem.coordinates()[static_cast<std::size_t>(j)].logarithmic) {
      scales[j] = std::max(1.0, std::abs(q[j]));
    }
  }
  IdentifiabilityOptions limits;
  limits.relative_rank_tolerance = kRankTolerance;
  limits.variance_factor = std::max(result.variance_factor, 1e-12);
  const auto names = problem.names();
  result.identifiability = identifiability(J, scales, names, limits);
  const Identifiability& known = result.identifiability;
  const auto alone =
      identifiability(J.topRows(r.size() - problem.prior_count()), scales, names, limits);
  for (const auto& open : known.open) result.open.push_back(open.message);
  state_shifts(problem, options, matches, weights, J, limits, by_segments, result);
  const Eigen::MatrixXd priors = prior_parts(problem, J, known, limits);
  std::vector<std::string> prior_names;
  for (std::size_t j = 0; j < names.size(); ++j) {
    if (problem.coordinates()[j].prior_std > 0) prior_names.push_back("prior of " + names[j]);
  }

  Eigen::VectorXd by(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    by[i] = problem.coordinates()[static_cast<std::size_t>(i)].derivative(q[i]);
  }
  // The covariance of a problem with sources contains the part of the inputs.
  Eigen::MatrixXd outside = result.shifts * result.shifts.transpose();
  Eigen::VectorXd inside = Eigen::VectorXd::Zero(n);
  if (problem.has_sources()) {
    const bool segments =
        !result.shift_sources.empty() && result.shift_sources.front() == "segments";
    const auto inputs = result.shifts.rightCols(result.shifts.cols() - (segments ? 1 : 0));
    inside = inputs.rowwise().squaredNorm();
    outside -= inputs * inputs.transpose();
  }
  const ModelPart model = model_part(problem, matches, r, J, scales, names, result);
  result.covariance =
      by.asDiagonal() *
      (model.widening.asDiagonal() * known.covariance * model.widening.asDiagonal() + outside) *
      by.asDiagonal();
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(i)];
    auto& parameter = result.parameters[static_cast<std::size_t>(i)];
    parameter.identifiable = known.identifiable[static_cast<std::size_t>(i)];
    parameter.std = std::sqrt(result.covariance(i, i));
    parameter.std_from_data = std::abs(by[i]) * alone.std[i];
    parameter.at_bound = q[i] <= coordinate.low + 1e-9 || q[i] >= coordinate.high - 1e-9;
    if (!parameter.identifiable) continue;
    for (Eigen::Index j = 0; j < n; ++j) {
      result.correlation(i, j) =
          result.covariance(i, j) / std::sqrt(result.covariance(i, i) * result.covariance(j, j));
    }
    const double by_data = known.std[i] * known.std[i] -
                           (priors.cols() > 0 ? priors.row(i).squaredNorm() : 0) - inside[i];
    const double by_noise = model.data_variance.size() > 0
                                ? std::min(std::max(by_data, 0.0), model.data_variance[i])
                                : std::max(by_data, 0.0);
    parameter.budget.push_back({"data", std::abs(by[i]) * std::sqrt(by_noise)});
    if (model.data_variance.size() > 0) {
      const double widened = known.std[i] * known.std[i] * (std::pow(model.widening[i], 2) - 1);
      parameter.budget.push_back(
          {"model", std::abs(by[i]) * std::sqrt(std::max(by_data, 0.0) - by_noise + widened)});
    }
    for (Eigen::Index k = 0; k < priors.cols(); ++k) {
      parameter.budget.push_back(
          {prior_names[static_cast<std::size_t>(k)], std::abs(by[i] * priors(i, k))});
    }
    for (Eigen::Index k = 0; k < result.shifts.cols(); ++k) {
      const auto& source = result.shift_sources[static_cast<std::size_t>(k)];
      const double by_source = std::abs(by[i] * result.shifts(i, k));
      if (parameter.budget.back().source == source) {  // a source of several columns
        parameter.budget.back().std = std::hypot(parameter.budget.back().std, by_source);
        parameter.budget.back().change = kNaN;
      } else {
        parameter.budget.push_back({source, by_source, by[i] * result.shifts(i, k)});
      }
      if (k == 0 && options.segment_uncertainty && source == "segments") {
        parameter.segment_shift = by[i] * result.shifts(i, k);
      }
    }
  }
  state_prediction_uncertainty(problem, options, result, q, -1, result.pairs);
}

void state_prediction_uncertainty(const UpdateProblem& problem, const UpdateOptions& options,
                                  const UpdateResult& result, const Eigen::VectorXd& q,
                                  int held_out, std::vector<UpdatedPair>& pairs) {
  if (result.identifiability.directions.size() == 0) return;
  std::vector<int> states;
  for (const auto& pair : pairs) {
    if (states.empty() || states.back() != pair.state) states.push_back(pair.state);
  }
  for (const int state : states) {
    std::vector<UpdateMatch> matches;
    std::vector<UpdatedPair*> here;
    for (auto& pair : pairs) {
      if (pair.state != state || pair.cross_plane) continue;
      matches.push_back({pair.state, pair.measured, pair.plane, pair.order, pair.mac, false});
      here.push_back(&pair);
    }
    const Changed log_frequencies = [&](const UpdateProblem& moved, Eigen::VectorXd& logs) {
      const auto modelled = moved.modes(state, q, false, &matches);
      logs.resize(static_cast<Eigen::Index>(matches.size()));
      for (std::size_t i = 0; i < matches.size(); ++i) {
        const auto* mode = modelled.find(matches[i].plane, matches[i].order);
        if (mode == nullptr) return false;
        logs[static_cast<Eigen::Index>(i)] = std::log(mode->frequency_hz);
      }
      return true;
    };
    // The shared sources' own effect on these frequencies, beside that by the fitted values.
    Eigen::MatrixXd own =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(matches.size()), result.shifts.cols());
    bool complete = true;
    for (Eigen::Index k = 0; k < own.cols(); ++k) {
      const auto& source = result.shift_sources[static_cast<std::size_t>(k)];
      Eigen::VectorXd change;
      bool found = false;
      if (k == 0 && options.segment_uncertainty && source == "segments") {
        found = change_by_segments(problem, log_frequencies, change);
      } else {
        found =
            true;  // the place of hits, which is not among the inputs of a prediction: no effect
        change = Eigen::VectorXd::Zero(own.rows());
        for (Eigen::Index i = 0; i < problem.inputs_off().size(); ++i) {
          if (problem.inputs()[static_cast<std::size_t>(i)].name != source) continue;
          found = change_by_input(problem, i, log_frequencies, change);
          break;
        }
      }
      complete = complete && found;
      if (found) own.col(k) = change;
    }
    const auto modelled = problem.modes(state, q, true, &matches);
    for (std::size_t i = 0; i < matches.size() && complete; ++i) {
      const auto* mode = modelled.find(matches[i].plane, matches[i].order);
      if (mode == nullptr) continue;
      Eigen::VectorXd gradient = mode->dlog_frequency;
      for (Eigen::Index j = 0; j < gradient.size(); ++j) {
        const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
        if (coordinate.state == held_out && held_out >= 0 && !(coordinate.prior_std > 0)) {
          gradient[j] = 0;
        }
      }
      const double by_parameters = result.identifiability.std_of(gradient);
      Eigen::VectorXd shared = own.row(static_cast<Eigen::Index>(i));
      shared += result.shifts.transpose() * gradient;
      here[i]->model_std_hz = here[i]->model_hz * std::hypot(by_parameters, shared.norm());
    }
  }
}

}  // namespace rigfit::ident
