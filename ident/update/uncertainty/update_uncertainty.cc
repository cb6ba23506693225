#include "ident/update/uncertainty/update_uncertainty.h"

#include <gsl/gsl_cdf.h>

#include <Eigen/QR>

#include "ident/statistics/root.h"
#include "signal/numerics/factorisations.h"

namespace rigfit::ident {
namespace {

// R_0 t: what lines of FRFs that err together, under a window or by a model that is a little off,
// make of a variance over that of independent lines. With z_k the complex residual of line k,
// R_l = mean Re(conj(z_k) z_(k+l)) / 2 correlates each FRF with itself, and t = 1 + 2 sum_l R_l /
// R_0 up to the first R_l / R_0 that chance explains, 2 / sqrt(lines). Source: Bartlett, J. R.
// Stat. Soc. 98 (1935) 536. 0 without FRFs.
double correlated_variance(const std::vector<UpdateProblem::FrfRows>& all, const VectorXd& r) {
  std::size_t longest = 0, lines = 0;
  for (const auto& rows : all) {
    longest = std::max(longest, rows.line.size());
    lines += rows.line.size();
  }
  double R_0 = 0, sum = 0;
  for (std::size_t lag = 0; lag <= longest / 3; ++lag) {
    double R = 0, count = 0;
    for (const auto& rows : all) {
      if (rows.line.size() <= lag) continue;
      const auto pairs = static_cast<Index>(rows.line.size() - lag);
      count += static_cast<double>(pairs);
      R += r.segment(rows.first, 2 * pairs)
               .dot(r.segment(rows.first + 2 * static_cast<Index>(lag), 2 * pairs)) /
           2;
    }
    if (count > 0) R /= count;
    if (lag == 0) R_0 = R;
    if (lag > 0 && !(R / R_0 >= 2 / std::sqrt(2 * static_cast<double>(lines)))) break;
    sum += lag == 0 ? R : 2 * R;
  }
  return sum;
}

void state_variance_factor(const UpdateProblem& problem, const VectorXd& r, UpdateResult& result) {
  const double degrees = problem.degrees_of_freedom(r.size());
  const double reduced = degrees > 0 ? r.squaredNorm() / degrees : kNaN;
  // Stated uncertainties are trusted unless the scatter contradicts them; assumed ones are not.
  // A stated error of the model does not shrink because assumed ones were too large.
  const bool stated = problem.uncertainties_known();
  const double least = !stated && problem.options().model_relative_std == 0 ? 0 : 1;
  result.variance_factor = std::isfinite(reduced) ? std::max(reduced, least) : 1;
  bool from_scatter = !stated && result.variance_factor == reduced;
  const double correlated = correlated_variance(problem.frf_rows(), r);
  if (correlated > result.variance_factor) {
    result.variance_factor = correlated;
    from_scatter = std::isfinite(reduced);
  }
  result.coverage_factor = coverage_factor(0.95, from_scatter ? degrees : 0);
  if (!stated && !std::isfinite(reduced)) {
    result.message +=
        "State the frequencies' uncertainties: without more data than unknowns the assumed one "
        "determines all others; ";
  }
}

/// The larger of the covariances by modes and by states, each coordinate's variance for itself; of
/// the whitened residuals r and J of the problem. Zero with fewer than three clusters of a kind.
VectorXd clustered_variance(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                            const VectorXd& r, const MatrixXd& J) {
  const auto rows = problem.frequency_rows(matches);
  const MatrixXd bread = (J.transpose() * J).completeOrthogonalDecomposition().pseudoInverse();
  VectorXd largest = VectorXd::Zero(J.cols());
  const auto widen = [&](const auto& cluster_of) {
    std::map<std::pair<int, int>, VectorXd> scores;
    for (const auto& row : rows) {
      const VectorXd score = J.row(row.row).transpose() * r[row.row];
      const auto [at, first] = scores.try_emplace(cluster_of(matches[row.match]), score);
      if (!first) at->second += score;
    }
    const double count = static_cast<double>(scores.size());
    if (count < 3) return;
    MatrixXd meat = MatrixXd::Zero(J.cols(), J.cols());
    for (const auto& [name, score] : scores) meat += score * score.transpose();
    const MatrixXd covariance = bread * meat * bread * (count / (count - 1));
    largest = largest.cwiseMax(covariance.diagonal());
  };
  widen([](const auto& match) { return std::pair{static_cast<int>(match.plane), match.order}; });
  widen([](const auto& match) { return std::pair{match.state, 0}; });
  return largest;
}

}  // namespace

UpdateFit misfit_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                    const VectorXd& q) {
  UpdateFit fit;
  fit.stated = problem.uncertainties_known();
  VectorXd r;
  if (!problem.residuals(q, matches, r, nullptr)) return fit;
  fit.chi2 = r.squaredNorm();
  fit.degrees_of_freedom = problem.degrees_of_freedom(r.size());
  if (!(fit.degrees_of_freedom > 0)) return fit;
  fit.p_value = gsl_cdf_chisq_Q(fit.chi2, fit.degrees_of_freedom);
  return fit;
}

double model_std_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                    const VectorXd& q) {
  VectorXd r;
  MatrixXd J;
  if (!problem.residuals(q, matches, r, &J)) return 0;
  for (Index j = 0; j < problem.parameter_count(); ++j) {  // at its bound it stays there
    if (problem.coordinate_at(j).at_bound(q[j])) J.col(j).setZero();
  }
  VectorXd own = VectorXd::Zero(r.size());  // relative uncertainty; 0: no data
  for (const auto& rows : problem.frf_rows()) {
    for (std::size_t k = 0; k < rows.relative_std.size(); ++k) {
      own.segment<2>(rows.first + 2 * static_cast<Index>(k)).fill(rows.relative_std[k]);
    }
  }
  for (const auto& row : problem.frequency_rows(matches)) {
    if (problem.has_frfs()) break;
    const auto& match = matches[row.match];
    own[row.row] = problem.relative_std(match.state, match.measured);
  }
  const double dof = problem.degrees_of_freedom(r.size());
  const auto excess = [&](double log_tau) {
    VectorXd w = VectorXd::Ones(r.size());
    for (Index i = 0; i < r.size(); ++i) {
      if (own[i] > 0) w[i] = own[i] / std::hypot(own[i], std::exp(log_tau));
    }
    return signal::least_sum_squares(w.asDiagonal() * J, w.cwiseProduct(r)) - dof;
  };
  const double low = std::log(1e-9), high = 0;
  if (dof <= 0 || excess(low) <= 0 || excess(high) > 0) return 0;
  return std::exp(root_between(low, high, 1e-6, excess));
}

void state_uncertainty(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                       UpdateResult& result) {
  const Index n = problem.size(), count = problem.parameter_count();
  const VectorXd& q = result.coordinates;
  result.covariance = result.correlation = MatrixXd::Constant(count, count, kNaN);
  VectorXd r;
  MatrixXd J;
  if (!problem.residuals(q, matches, r, &J)) return;
  const Index data = r.size() - problem.prior_count();
  state_variance_factor(problem, r, result);
  // The factor is one of the data: priors are what they say.
  const double factor = std::sqrt(std::max(result.variance_factor, 1e-12));
  J.topRows(data) /= factor, r.head(data) /= factor;

  VectorXd scales = VectorXd::Ones(n);
  for (Index j = 0; j < n; ++j) {
    const auto& coordinate = problem.coordinate_at(j);
    if (j >= count) {
      scales[j] = 2 / kMaxRelativeStd;  // known to 1 by its prior: priors of inputs tell them
    } else if (!coordinate.logarithmic) {
      scales[j] = std::max(1.0, std::abs(q[j]));
    }
  }
  const auto names = problem.names();
  result.identifiability = identifiability(J, scales, names);
  const Identifiability& known = result.identifiability;
  for (const auto& open : known.open) result.open.push_back(open.message);
  VectorXd by(count);  // of the values, widened by errors of the model that modes share
  for (Index i = 0; i < count; ++i) {
    by[i] = problem.coordinate_at(i).derivative(q[i]);
  }
  const VectorXd unwidened = by;
  if (result.fit.model_std > 0) {
    const VectorXd clustered = clustered_variance(problem, matches, r, J);
    for (Index i = 0; i < count; ++i) {
      if (known.std[i] > 0) {
        by[i] *= std::sqrt(std::max(1.0, clustered[i] / (known.std[i] * known.std[i])));
      }
    }
  }
  J.middleRows(data, problem.prior_count() - (n - count)).setZero();
  const auto alone = identifiability(J, scales, names);

  result.covariance =
      by.asDiagonal() * known.covariance.topLeftCorner(count, count) * by.asDiagonal();
  for (Index i = 0; i < count; ++i) {
    auto& parameter = result.parameters[static_cast<std::size_t>(i)];
    parameter.identifiable = known.identifiable[static_cast<std::size_t>(i)];
    parameter.std = std::sqrt(result.covariance(i, i));
    parameter.std_from_data = std::abs(unwidened[i]) * alone.std[i];
    parameter.at_bound = problem.coordinate_at(i).at_bound(q[i]);
    if (!parameter.identifiable) continue;
    for (Index j = 0; j < count; ++j) {
      result.correlation(i, j) =
          result.covariance(i, j) / std::sqrt(result.covariance(i, i) * result.covariance(j, j));
    }
    // A prior's part: the covariance with what it is of, in its standard uncertainty.
    parameter.budget.push_back({"data", 0});
    double by_data = parameter.std * parameter.std;
    for (Index j = 0; j < n; ++j) {
      const double prior_std = problem.coordinate_at(j).prior_std;
      if (!(prior_std > 0) || !std::isfinite(known.covariance(i, j))) continue;
      const double change = unwidened[i] * known.covariance(i, j) / prior_std;
      by_data -= change * change;
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
    parameter.budget.front().std = std::sqrt(std::max(0.0, by_data));
  }
  state_prediction_uncertainty(problem, result, q, -1, result.pairs);
}

void state_prediction_uncertainty(const UpdateProblem& problem, const UpdateResult& result,
                                  const VectorXd& q, int held_out,
                                  std::vector<UpdatedPair>& pairs) {
  if (result.identifiability.directions.size() == 0) return;
  const std::vector<UpdateMatch> matches(pairs.begin(), pairs.end());
  int state = -1;
  UpdateStateModes modelled;
  for (auto& pair : pairs) {
    if (pair.cross_plane) continue;
    if (pair.state != state) {
      state = pair.state;
      modelled = problem.modes(state, q, true, &matches);
    }
    const auto* mode = modelled.find(pair.plane, pair.order);
    if (mode == nullptr) continue;
    VectorXd gradient = mode->dlog_frequency;
    for (Index j = 0; j < gradient.size() && held_out >= 0; ++j) {
      const auto& coordinate = problem.coordinate_at(j);
      if (coordinate.state == held_out && !(coordinate.prior_std > 0)) gradient[j] = 0;
    }
    const double relative = result.identifiability.std_of(gradient);
    // Less is what rounding leaves of a sensitivity that is none.
    pair.model_std_hz = relative > 1e-7 ? pair.model_hz * relative : 0;
  }
}

}  // namespace rigfit::ident
