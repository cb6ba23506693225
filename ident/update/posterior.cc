#include "ident/update/posterior.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "ident/update/frf_correlation.h"
#include "ident/update/segments.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;

constexpr double kRankTolerance = 1e-8;

Likelihood without_errors(Likelihood likelihood) {
  likelihood.errors = {};
  return likelihood;
}

double degrees_of(const Likelihood& likelihood, Eigen::Index residuals) {
  return static_cast<double>(residuals - likelihood.size()) - likelihood.shared_residuals();
}

}  // namespace

UpdateFit misfit_of(const Likelihood& likelihood, const std::vector<UpdateMatch>& matches,
                    const Eigen::VectorXd& q) {
  UpdateFit fit;
  fit.stated = likelihood.stated();
  Eigen::VectorXd r;
  if (!without_errors(likelihood).residuals(q, matches, UpdateStage::full, r, nullptr)) return fit;
  fit.chi2 = r.squaredNorm();
  fit.degrees_of_freedom = degrees_of(likelihood, r.size());
  fit.correlated_lines = correlated_lines_of(likelihood, matches, r);
  if (!(fit.degrees_of_freedom > 0)) return fit;
  fit.p_value = gsl_cdf_chisq_Q(fit.chi2 / fit.correlated_lines,
                                fit.degrees_of_freedom / fit.correlated_lines);
  return fit;
}

double model_std_of(const Likelihood& likelihood, const std::vector<UpdateMatch>& matches,
                    const Eigen::VectorXd& q) {
  const Likelihood plain = without_errors(likelihood);
  Eigen::VectorXd r;
  if (!plain.residuals(q, matches, UpdateStage::full, r, nullptr)) return 0;
  double rest = r.squaredNorm();
  std::vector<std::pair<double, double>> errors;  // squared error, squared uncertainty
  const auto add = [&](Eigen::Index row, double std) {
    errors.emplace_back(std::pow(r[row] * std, 2), std * std);
    rest -= r[row] * r[row];
  };
  if (plain.has_frfs()) {
    for (const auto& rows : plain.frf_rows(matches)) {
      for (Eigen::Index i = 0; i < 2 * rows.lines(); ++i) {
        add(rows.first + i, rows.relative_std[static_cast<std::size_t>(i / 2)]);
      }
    }
  } else {
    for (const auto& row : plain.frequency_rows(matches, UpdateStage::full)) {
      const auto& match = matches[row.match];
      add(row.row, plain.relative_std(match.state, match.measured));
    }
  }
  const double dof = degrees_of(plain, r.size());
  const auto chi2 = [&](double tau) {
    double sum = rest;
    for (const auto& [e2, s2] : errors) sum += e2 / (s2 + tau * tau);
    return sum;
  };
  double low = 1e-9, high = 1;
  if (errors.empty() || dof <= 0 || chi2(0) <= dof || chi2(high) > dof) return 0;
  for (int k = 0; k < 60; ++k) {
    const double middle = std::sqrt(low * high);
    (chi2(middle) > dof ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

Eigen::VectorXd huber_weights(const Likelihood& likelihood, const Eigen::VectorXd& r) {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(r.size());
  for (Eigen::Index i = 0; i < r.size() - likelihood.priors(); ++i) {
    weights[i] = std::min(
        1.0, std::sqrt(likelihood.options().huber_threshold / std::max(std::abs(r[i]), 1e-300)));
  }
  return weights;
}

namespace {

// `correlated`: what lines that err together make of a coordinate's variance, over that of
// independent lines with the stated uncertainties; 0: no such lines.
void state_variance_factor(const Likelihood& likelihood, double correlated, UpdateResult& result) {
  const double reduced =
      result.degrees_of_freedom > 0 ? result.chi_squared / result.degrees_of_freedom : kNaN;
  // Stated uncertainties are trusted unless the scatter contradicts them; assumed ones are not.
  // Priors and a stated error of the model do not shrink because assumed ones were too large.
  const bool stated = likelihood.stated();
  const bool may_shrink =
      !stated && likelihood.priors() == 0 && likelihood.options().model_relative_std == 0;
  result.variance_factor = std::isfinite(reduced) ? std::max(reduced, may_shrink ? 0.0 : 1.0) : 1;
  bool from_scatter = !stated && result.variance_factor == reduced;
  if (correlated > result.variance_factor) {
    result.variance_factor = correlated;
    from_scatter = std::isfinite(reduced);
  }
  result.coverage_factor = coverage_factor(
      0.95, from_scatter ? result.degrees_of_freedom / result.fit.correlated_lines : 0);
  if (!stated && !std::isfinite(reduced)) {
    result.message +=
        "no more data than unknowns: uncertainties rest on the assumed one of the "
        "frequencies; ";
  }
}

// Variances of the parameters by errors that modes or states share; 0 with too few groups.
Eigen::VectorXd clustered_variance(const Likelihood& likelihood,
                                   const std::vector<UpdateMatch>& matches,
                                   const Eigen::VectorXd& r, const Eigen::MatrixXd& J) {
  using Scores = std::map<std::pair<int, int>, Eigen::VectorXd>;
  Scores by_mode, by_state;
  for (const auto& row : likelihood.frequency_rows(matches, UpdateStage::full)) {
    const auto& match = matches[row.match];
    const auto add = [&](Scores& scores, std::pair<int, int> group) {
      scores.try_emplace(group, Eigen::VectorXd::Zero(J.cols())).first->second +=
          J.row(row.row).transpose() * r[row.row];
    };
    add(by_mode, {static_cast<int>(match.plane), match.order});
    add(by_state, {match.state, 0});
  }
  const Eigen::MatrixXd bread =
      (J.transpose() * J).completeOrthogonalDecomposition().pseudoInverse();
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(J.cols());
  for (const Scores* scores : {&by_mode, &by_state}) {
    const double count = static_cast<double>(scores->size());
    if (count < 3) continue;
    Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(J.cols(), J.cols());
    for (const auto& [group, score] : *scores) meat += score * score.transpose();
    largest = largest.cwiseMax((bread * meat * bread).diagonal() * (count / (count - 1)));
  }
  return largest;
}

// The Jacobian taken apart, data rows over their standard deviations.
struct Linear {
  Eigen::VectorXd r;                              // data rows
  Eigen::MatrixXd parameters, nuisances, priors;  // data rows; the parameters' priors
  Eigen::MatrixXd U;
  Eigen::VectorXd less;

  void integrate_out() {
    if (nuisances.cols() == 0) return;
    const Eigen::BDCSVD<Eigen::MatrixXd> svd(nuisances, Eigen::ComputeThinU);
    U = svd.matrixU();
    less = (1 - (1 + svd.singularValues().array().square()).rsqrt()).matrix();
  }
  // Columns of data rows times (I + N N')^(-1/2), zeros below in the priors' rows.
  [[nodiscard]] Eigen::MatrixXd white(const Eigen::MatrixXd& columns) const {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(columns.rows() + priors.rows(), columns.cols());
    all.topRows(columns.rows()) = columns;
    if (U.size() > 0) {
      all.topRows(columns.rows()) -= U * (less.asDiagonal() * (U.transpose() * columns));
    }
    return all;
  }
  [[nodiscard]] Eigen::MatrixXd jacobian() const {
    Eigen::MatrixXd all = white(parameters);
    all.bottomRows(priors.rows()) = priors;
    return all;
  }
  // By parameter and nuisance together, with all priors.
  [[nodiscard]] Eigen::MatrixXd joint() const {
    const Eigen::Index k = nuisances.cols(), d = parameters.rows(), n = parameters.cols();
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(d + priors.rows() + k, n + k);
    all.topRows(d) << parameters, nuisances;
    all.block(d, 0, priors.rows(), n) = priors;
    all.bottomRightCorner(k, k).setIdentity();
    return all;
  }
};

// Variances of the parameters by the stated uncertainties alone, without the model's error.
Eigen::VectorXd noise_variance(const Likelihood& likelihood,
                               const std::vector<UpdateMatch>& matches, const Linear& linear,
                               const Eigen::VectorXd& scales,
                               const std::vector<std::string>& names) {
  const Likelihood plain = without_errors(likelihood);
  Eigen::MatrixXd stated(linear.parameters.rows() + linear.priors.rows(), scales.size());
  stated << linear.parameters, linear.priors;
  for (const auto& row : plain.frequency_rows(matches, UpdateStage::full)) {
    const auto& match = matches[row.match];
    stated.row(row.row) *= likelihood.relative_std(match.state, match.measured) /
                           plain.relative_std(match.state, match.measured);
  }
  Eigen::VectorXd variance = identifiability(stated, scales, names).std.cwiseAbs2();
  for (double& one : variance) one = std::isfinite(one) ? one : std::numeric_limits<double>::max();
  return variance;
}

}  // namespace

void state_uncertainty(const Likelihood& likelihood, const std::vector<UpdateMatch>& matches,
                       UpdateResult& result, const Eigen::VectorXd& by_segments) {
  const Eigen::Index n = likelihood.parameters();
  const Eigen::VectorXd& q = result.coordinates;
  result.covariance = result.correlation = Eigen::MatrixXd::Constant(n, n, kNaN);
  result.by_segments = {};
  Eigen::VectorXd r;
  Eigen::MatrixXd J;
  if (!likelihood.residuals(q, matches, UpdateStage::full, r, &J)) return;
  const Eigen::VectorXd weights = huber_weights(likelihood, r);
  r = r.cwiseProduct(weights).eval();
  J = (weights.asDiagonal() * J).eval();
  result.chi_squared = r.squaredNorm();
  result.degrees_of_freedom = degrees_of(likelihood, r.size());
  state_variance_factor(likelihood, correlated_variance_factor(likelihood, matches, r, J), result);

  const double scale = 1 / std::sqrt(std::max(result.variance_factor, 1e-12));
  const Eigen::Index data = r.size() - likelihood.priors(), nuisances = likelihood.size() - n;
  Linear linear{scale * r.head(data),
                scale * J.topLeftCorner(data, n),
                scale * J.topRightCorner(data, nuisances),
                J.block(data, 0, likelihood.priors() - nuisances, n),
                {},
                {}};
  const std::vector<std::string> names = likelihood.names();
  linear.integrate_out();
  Eigen::VectorXd scales = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(names.size()));
  for (Eigen::Index j = 0; j < n; ++j) {
    const bool logarithmic = likelihood.coordinates()[static_cast<std::size_t>(j)].logarithmic;
    if (!logarithmic) scales[j] = std::max(1.0, std::abs(q[j]));
  }
  const std::vector<std::string> own(names.begin(), names.begin() + n);
  IdentifiabilityOptions limits;
  limits.relative_rank_tolerance = kRankTolerance;
  const Eigen::MatrixXd white = linear.jacobian();
  result.identifiability = identifiability(white, scales.head(n), own, limits);
  result.joint = identifiability(linear.joint(), scales, names, limits);
  const Identifiability& known = result.identifiability;
  // Segments are no coordinate of the fit: they move its estimate.
  Eigen::VectorXd change;
  result.by_segments = by_segments;
  if (by_segments.size() == 0 && likelihood.options().segment_uncertainty) {
    if (!change_by_segments(likelihood, matches, q, change)) {
      result.message += "what the segments cost is not known: no model with twice as many; ";
    } else if (change.norm() > 0) {
      const Eigen::MatrixXd joint = linear.joint();
      Eigen::VectorXd padded = Eigen::VectorXd::Zero(joint.rows());
      padded.head(data) = scale * weights.cwiseProduct(change).head(data);
      result.by_segments = result.joint.shift_by(joint, padded, limits);
    }
  }
  const auto alone = identifiability(linear.parameters, scales.head(n), own, limits);
  for (const auto& open : known.open) result.open.push_back(open.message);

  // What each prior and each nuisance moves the coordinates by.
  struct Source {
    std::string name;
    Eigen::VectorXd shift;
    bool prior;
  };
  std::vector<Source> sources;
  for (Eigen::Index j = 0, row = data; j < n; ++j) {
    if (!(likelihood.coordinates()[static_cast<std::size_t>(j)].prior_std > 0)) continue;
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(white.rows(), row++);
    sources.push_back({"prior of " + own[static_cast<std::size_t>(j)],
                       known.shift_by(white, unit, limits), true});
  }
  if (result.by_segments.size() > 0) {
    sources.push_back({"segments", result.by_segments.head(n), false});
  }
  const Eigen::MatrixXd columns = linear.white(linear.nuisances);
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    sources.push_back({names[static_cast<std::size_t>(n + k)],
                       known.shift_by(white, columns.col(k), limits), false});
  }

  Eigen::VectorXd widening = Eigen::VectorXd::Ones(n), noise;
  if (result.fit.model_std > 0) {
    Eigen::VectorXd padded = Eigen::VectorXd::Zero(white.rows());
    padded.head(data) = linear.r;
    const Eigen::VectorXd clustered = clustered_variance(likelihood, matches, padded, white);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double variance = known.std[i] * known.std[i];
      if (variance > 0) widening[i] = std::sqrt(std::max(1.0, clustered[i] / variance));
    }
    if (result.fit.stated) noise = noise_variance(likelihood, matches, linear, scales.head(n), own);
  }
  Eigen::VectorXd by(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    by[i] = likelihood.coordinates()[static_cast<std::size_t>(i)].derivative(q[i]);
  }
  Eigen::MatrixXd covariance = widening.asDiagonal() * known.covariance * widening.asDiagonal();
  if (result.by_segments.size() > 0) {
    covariance += result.by_segments.head(n) * result.by_segments.head(n).transpose();
  }
  result.covariance = by.asDiagonal() * covariance * by.asDiagonal();
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& coordinate = likelihood.coordinates()[static_cast<std::size_t>(i)];
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
    double by_data = known.std[i] * known.std[i];
    for (const auto& source : sources) {
      if (source.name != "segments") by_data -= source.shift[i] * source.shift[i];
    }
    by_data = std::max(by_data, 0.0);
    const double by_noise = noise.size() > 0 ? std::min(by_data, noise[i]) : by_data;
    parameter.budget.push_back({"data", std::abs(by[i]) * std::sqrt(by_noise)});
    if (noise.size() > 0) {
      const double widened = known.std[i] * known.std[i] * (std::pow(widening[i], 2) - 1);
      parameter.budget.push_back(
          {"model", std::abs(by[i]) * std::sqrt(by_data - by_noise + widened)});
    }
    for (const auto& source : sources) {
      const double moved = by[i] * source.shift[i];
      if (source.name == "segments") parameter.segment_shift = moved;
      if (parameter.budget.back().source == source.name) {  // a source of several columns
        auto& term = parameter.budget.back();
        term.std = std::hypot(term.std, moved);
        term.change = kNaN;
      } else {
        parameter.budget.push_back({source.name, std::abs(moved), source.prior ? kNaN : moved});
      }
    }
  }
  state_prediction_uncertainty(likelihood, result, q, -1, result.pairs);
}

Identifiability knowledge_by_cost(const Likelihood& likelihood,
                                  const std::vector<UpdateMatch>& matches,
                                  const UpdateResult& result) {
  Eigen::VectorXd r;
  Eigen::MatrixXd J;
  if (!likelihood.residuals(result.coordinates, matches, UpdateStage::full, r, &J)) return {};
  J = (huber_weights(likelihood, r).asDiagonal() * J).eval();
  IdentifiabilityOptions limits;
  limits.relative_rank_tolerance = kRankTolerance;
  limits.variance_factor = std::max(result.variance_factor, 1e-12);
  return identifiability(J, result.joint.scales.head(likelihood.size()), likelihood.names(),
                         limits);
}

void state_prediction_uncertainty(const Likelihood& likelihood, const UpdateResult& result,
                                  const Eigen::VectorXd& q, int held_out,
                                  std::vector<UpdatedPair>& pairs) {
  const Eigen::Index n = likelihood.parameters();
  if (result.joint.directions.size() == 0) return;
  for (std::size_t first = 0, end = 0; first < pairs.size(); first = end) {  // ordered by state
    const int state = pairs[first].state;
    std::vector<UpdateMatch> matches;
    for (end = first; end < pairs.size() && pairs[end].state == state; ++end) {
      const auto& pair = pairs[end];
      if (!pair.cross_plane) matches.push_back({state, pair.measured, pair.plane, pair.order, 0});
    }
    const auto modelled = likelihood.modes(state, q, true, &matches);
    Likelihood twice = likelihood;
    twice.mesh.factor = 2;
    const bool segments = result.by_segments.size() > 0;
    const auto finer = segments && has_given_segments(likelihood, state)
                           ? twice.modes(state, q, false, &matches)
                           : UpdateStateModes{};
    for (std::size_t k = first; k < end; ++k) {
      auto& pair = pairs[k];
      const auto* mode = modelled.find(pair.plane, pair.order);
      if (mode == nullptr || pair.cross_plane) continue;
      Eigen::VectorXd gradient = mode->dlog_frequency;
      for (Eigen::Index j = 0; j < n; ++j) {
        const auto& coordinate = likelihood.coordinates()[static_cast<std::size_t>(j)];
        const bool open = coordinate.state == held_out && held_out >= 0;
        if (open && !(coordinate.prior_std > 0)) gradient[j] = 0;
      }
      double by_segments = segments ? gradient.dot(result.by_segments) : 0;
      if (const auto* fine = finer.find(pair.plane, pair.order); fine != nullptr) {
        by_segments += kOfHalving * std::log(mode->frequency_hz / fine->frequency_hz);
      }
      const double std = std::hypot(result.joint.std_of(gradient), by_segments);
      pair.model_std_hz = pair.model_hz * std;
    }
  }
}

}  // namespace rigfit::ident
