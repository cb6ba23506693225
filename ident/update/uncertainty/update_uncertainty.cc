#include "ident/update/uncertainty/update_uncertainty.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "ident/update/uncertainty/frf_correlation.h"
#include "ident/update/uncertainty/update_misfit.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;

// `correlated`: what lines that err together make of a coordinate's variance, over that of
// independent lines with the stated uncertainties; 0: no such lines.
void state_variance_factor(const UpdateProblem& problem, const UpdateOptions& options,
                           double correlated, UpdateResult& result) {
  const double reduced =
      result.degrees_of_freedom > 0 ? result.chi_squared / result.degrees_of_freedom : kNaN;
  // Stated uncertainties are trusted unless the scatter contradicts them; assumed ones are not.
  // A stated error of the model does not shrink because assumed ones were too large.
  const bool stated = problem.uncertainties_known();
  const bool may_shrink = !stated && options.model_relative_std == 0;
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

// By coordinate: its covariance with what each prior is of, in the prior's standard uncertainty,
// one a column.
Eigen::MatrixXd prior_parts(const UpdateProblem& problem, const Eigen::MatrixXd& J,
                            const Identifiability& known, const IdentifiabilityOptions& limits) {
  Eigen::MatrixXd parts(J.cols(), problem.prior_count());
  for (Eigen::Index i = 0; i < parts.cols(); ++i) {
    parts.col(i) =
        known.shift_by(J, -Eigen::VectorXd::Unit(J.rows(), J.rows() - parts.cols() + i), limits);
  }
  return parts;
}

// How far the error of the segments moves the coordinates; `weights`: of the residuals.
void state_segments(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                    const Eigen::VectorXd& weights, const Eigen::MatrixXd& J,
                    const IdentifiabilityOptions& limits, UpdateResult& result) {
  Eigen::VectorXd change;
  const auto residuals = [&](const UpdateProblem& moved, Eigen::VectorXd& r) {
    return moved.residuals(result.coordinates, matches, r, nullptr);
  };
  if (change_by_segments(problem, residuals, change)) {
    result.by_segments = result.identifiability.shift_by(J, weights.cwiseProduct(change), limits);
  } else {
    result.message += "the error of the segments is unknown, as twice as many gave no model; ";
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
  stated.topRows(J.rows() - problem.prior_count()) *= std::sqrt(result.variance_factor);
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

Eigen::VectorXd residual_weights(const UpdateProblem& problem, const UpdateOptions& options,
                                 const Eigen::VectorXd& r, double variance_factor) {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(r.size());
  for (Eigen::Index i = 0; i < r.size() - problem.prior_count(); ++i) {
    weights[i] =
        std::min(1.0, std::sqrt(options.huber_threshold / std::max(std::abs(r[i]), 1e-300))) /
        std::sqrt(std::max(variance_factor, 1e-12));
  }
  return weights;
}

void state_uncertainty(const UpdateProblem& problem, const UpdateOptions& options,
                       const std::vector<UpdateMatch>& matches, UpdateResult& result,
                       const Eigen::VectorXd& by_segments) {
  const Eigen::Index n = problem.size(), count = problem.parameter_count();
  const Eigen::VectorXd& q = result.coordinates;
  result.covariance = result.correlation = Eigen::MatrixXd::Constant(count, count, kNaN);
  Eigen::VectorXd plain_r;
  Eigen::MatrixXd plain_J;
  if (!problem.residuals(q, matches, plain_r, &plain_J)) return;
  Eigen::VectorXd weights = residual_weights(problem, options, plain_r, 1);
  Eigen::VectorXd r = plain_r.cwiseProduct(weights);
  Eigen::MatrixXd J = weights.asDiagonal() * plain_J;
  result.chi_squared = r.squaredNorm();
  result.degrees_of_freedom = static_cast<double>(r.size() - n) - problem.shared_residuals();
  state_variance_factor(problem, options, correlated_variance_factor(problem, matches, r, J),
                        result);
  // The factor is one of the data: priors are what they say.
  weights = residual_weights(problem, options, plain_r, result.variance_factor);
  r = plain_r.cwiseProduct(weights);
  J = weights.asDiagonal() * plain_J;

  Eigen::VectorXd scales = Eigen::VectorXd::Ones(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    constexpr double kTold = 10;  // priors of inputs always tell them
    const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
    if (j >= count) {
      scales[j] = kTold;
    } else if (!coordinate.logarithmic) {
      scales[j] = std::max(1.0, std::abs(q[j]));
    }
  }
  IdentifiabilityOptions limits;
  limits.relative_rank_tolerance = kRankTolerance;
  const auto names = problem.names();
  result.identifiability = identifiability(J, scales, names, limits);
  const Identifiability& known = result.identifiability;
  const Eigen::Index own_priors = problem.prior_count() - (n - count);
  if (n > count) {  // rank and condition are those of the parameters
    result.identifiability.rank -= static_cast<int>(n - count);
    const Eigen::MatrixXd own = known.covariance.topLeftCorner(count, count);
    if (own.allFinite()) {
      const Eigen::MatrixXd by = scales.head(count).cwiseInverse().asDiagonal();
      const auto values =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(by * own * by).eigenvalues();
      result.identifiability.condition =
          std::sqrt(values.maxCoeff() /
                    std::max(values.minCoeff(), 1e-300));  // what rounding leaves may be 0
    }
  }
  Eigen::MatrixXd data = J;
  data.middleRows(r.size() - problem.prior_count(), own_priors).setZero();
  const auto alone = identifiability(data, scales, names, limits);
  for (const auto& open : known.open) result.open.push_back(open.message);
  result.by_segments = by_segments;
  if (options.segment_uncertainty && by_segments.size() == 0) {
    state_segments(problem, matches, weights, J, limits, result);
  }
  const Eigen::MatrixXd priors = prior_parts(problem, J, known, limits);

  Eigen::VectorXd by(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    by[i] = problem.coordinates()[static_cast<std::size_t>(i)].derivative(q[i]);
  }
  Eigen::VectorXd segments = Eigen::VectorXd::Zero(count);
  if (result.by_segments.size() > 0) segments = result.by_segments.head(count);
  const ModelPart model = model_part(problem, matches, r, J, scales, names, result);
  const Eigen::VectorXd widening = model.widening.head(count);
  result.covariance = by.asDiagonal() *
                      (widening.asDiagonal() * known.covariance.topLeftCorner(count, count) *
                           widening.asDiagonal() +
                       Eigen::MatrixXd(segments * segments.transpose())) *
                      by.asDiagonal();
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(i)];
    auto& parameter = result.parameters[static_cast<std::size_t>(i)];
    parameter.identifiable = known.identifiable[static_cast<std::size_t>(i)];
    parameter.std = std::sqrt(result.covariance(i, i));
    parameter.std_from_data = std::abs(by[i]) * alone.std[i];
    parameter.at_bound = q[i] <= coordinate.low + 1e-9 || q[i] >= coordinate.high - 1e-9;
    if (!parameter.identifiable) continue;
    for (Eigen::Index j = 0; j < count; ++j) {
      result.correlation(i, j) =
          result.covariance(i, j) / std::sqrt(result.covariance(i, i) * result.covariance(j, j));
    }
    const double by_data = std::max(0.0, known.std[i] * known.std[i] - priors.row(i).squaredNorm());
    const double by_noise =
        model.data_variance.size() > 0 ? std::min(by_data, model.data_variance[i]) : by_data;
    parameter.budget.push_back({"data", std::abs(by[i]) * std::sqrt(by_noise)});
    if (model.data_variance.size() > 0) {
      const double widened = known.std[i] * known.std[i] * (std::pow(widening[i], 2) - 1);
      parameter.budget.push_back(
          {"model", std::abs(by[i]) * std::sqrt(by_data - by_noise + widened)});
    }
    if (result.by_segments.size() > 0) {
      const double shift = by[i] * segments[i];
      parameter.budget.push_back({"segments", std::abs(shift), shift});
      if (options.segment_uncertainty) parameter.segment_shift = shift;
    }
    Eigen::Index column = 0;
    for (Eigen::Index j = 0; j < n; ++j) {
      if (!(problem.coordinates()[static_cast<std::size_t>(j)].prior_std > 0)) continue;
      const double change = by[i] * priors(i, column++);
      const auto& name = names[static_cast<std::size_t>(j)];
      if (j < count) {
        parameter.budget.push_back({"prior of " + name, std::abs(change)});
      } else if (parameter.budget.back().source == name) {  // a source of several coordinates
        parameter.budget.back().std = std::hypot(parameter.budget.back().std, change);
        parameter.budget.back().change = kNaN;
      } else {
        parameter.budget.push_back({name, std::abs(change), change});
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
    const auto log_frequencies = [&](const UpdateProblem& moved, Eigen::VectorXd& logs) {
      const auto modelled = moved.modes(state, q, false, &matches);
      logs.resize(static_cast<Eigen::Index>(matches.size()));
      for (std::size_t i = 0; i < matches.size(); ++i) {
        const auto* mode = modelled.find(matches[i].plane, matches[i].order);
        if (mode == nullptr) return false;
        logs[static_cast<Eigen::Index>(i)] = std::log(mode->frequency_hz);
      }
      return true;
    };
    // The segments' own effect on these frequencies, beside that by the fitted values.
    const bool shifted = result.by_segments.size() > 0;
    Eigen::VectorXd by_segments = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(matches.size()));
    if (shifted && options.segment_uncertainty &&
        !change_by_segments(problem, log_frequencies, by_segments)) {
      continue;
    }
    const auto modelled = problem.modes(state, q, true, &matches);
    for (std::size_t i = 0; i < matches.size(); ++i) {
      const auto* mode = modelled.find(matches[i].plane, matches[i].order);
      if (mode == nullptr) continue;
      Eigen::VectorXd gradient = mode->dlog_frequency;
      for (Eigen::Index j = 0; j < gradient.size(); ++j) {
        const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
        if (coordinate.state == held_out && held_out >= 0 && !(coordinate.prior_std > 0)) {
          gradient[j] = 0;
        }
      }
      double shift = by_segments[static_cast<Eigen::Index>(i)];
      if (shifted) shift += result.by_segments.dot(gradient);
      here[i]->model_std_hz =
          here[i]->model_hz * std::hypot(result.identifiability.std_of(gradient), shift);
    }
  }
}

}  // namespace rigfit::ident
