#include "ident/stiffness/stiffness_curve.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <Eigen/Cholesky>

#include "ident/statistics/uncertainty.h"
#include "signal/estimation/groups.h"

namespace rigfit::ident {
namespace {

constexpr const char* kByTension = "EI(T), tension within the bending tests";

}  // namespace

const char* name_of(StiffnessSource source) {
  constexpr std::array names{"none", "law", "weighted laws", "interpolation"};
  return names[static_cast<std::size_t>(source)];
}

StiffnessCurve::StiffnessCurve(std::vector<StiffnessPoint> points,
                               const StiffnessLawOptions& options)
    : points_(std::move(points)) {
  if (points_.empty()) return;
  std::ranges::stable_sort(points_, {}, &StiffnessPoint::tension_N);
  for (auto& point : points_) {
    if (!std::isfinite(point.std) && !std::isfinite(point.low) &&
        options.assumed_relative_std > 0) {
      point.std = options.assumed_relative_std * point.EI_Nm2;
    }
    shared_relative_std_ = std::max(shared_relative_std_, point.shared_relative_std);
  }
  if (points_.size() >= 2) laws_ = fit_stiffness_laws(points_, options);
  choose();
}

void StiffnessCurve::choose() {
  const auto interpolate = [&](const std::string& reason, double scale) {
    make_knots(scale);
    source_ = StiffnessSource::interpolation;
    sentence_ = knots_.size() == 1
                    ? fmt::format("EI is that of the one tension tested. {}", reason)
                    : fmt::format("EI is linear between {} tensions. {}", knots_.size(), reason);
  };
  if (laws_.laws.empty()) return interpolate("One point gives no law.", 1);
  double total = 0;
  for (const auto& law : laws_.laws) {
    const bool taken = law.converged && std::isfinite(law.akaike_weight) &&
                       law.covariance.size() > 0 && law.covariance.allFinite();
    weights_.push_back(taken ? law.akaike_weight : 0);
    total += weights_.back();
  }
  // The first is the best of those that AICc ranks.
  if (!(weights_.front() > 0) || !std::isfinite(laws_.laws.front().aicc)) {
    return interpolate(laws_.sentence, 1);
  }
  for (double& weight : weights_) weight /= total;
  const auto& best = laws_.laws.front();
  if (laws_.weighted && best.degrees_of_freedom > 0) {
    const double probability = gsl_cdf_chisq_Q(best.chi_squared, best.degrees_of_freedom);
    if (probability < 0.01) {
      return interpolate(
          fmt::format("No law passes through the points: chi-square of the best, {}, is {:.3g} on "
                      "{:g} degrees of freedom (probability {}).",
                      name_of(best.kind), best.chi_squared, best.degrees_of_freedom,
                      probability_text(probability)),
          std::sqrt(std::max(1.0, best.chi_squared / best.degrees_of_freedom)));
    }
  }
  if (laws_.decided) {
    weights_.assign(weights_.size(), 0), weights_.front() = 1;
    source_ = StiffnessSource::law;
    sentence_ = fmt::format("EI follows the {} law, {}. {}", name_of(best.kind), best.formula,
                            laws_.sentence);
    return;
  }
  source_ = StiffnessSource::weighted_laws;
  std::string list;
  for (std::size_t k = 0; k < weights_.size(); ++k) {
    if (weights_[k] < 0.005) continue;
    list += fmt::format("{}{} {:.0f} %", list.empty() ? "" : ", ", name_of(laws_.laws[k].kind),
                        100 * weights_[k]);
  }
  sentence_ =
      fmt::format("EI is the mean of the laws by Akaike weight ({}). {}", list, laws_.sentence);
}

void StiffnessCurve::make_knots(double scale) {
  const auto by_tension = change_by_tension(points_);
  for (std::size_t i = 0; i < points_.size();) {
    std::size_t k = i;
    bool known = true;
    std::vector<double> EI, variances;
    for (; k < points_.size() && points_[k].tension_N <= 1.05 * points_[i].tension_N; ++k) {
      const double own = own_std(points_[k]);
      known = known && own > 0;
      EI.push_back(points_[k].EI_Nm2), variances.push_back(own * own);
    }
    // Repeats that scatter more than they promise are known to their scatter.
    if (!known) variances.assign(EI.size(), 1e-12 * EI[0] * EI[0]);
    const auto mean = signal::mean_over_groups(EI, variances);
    Knot knot;
    knot.EI_Nm2 = mean.mean;
    for (std::size_t j = i; j < k; ++j) {
      knot.tension_N += mean.weights[j - i] * points_[j].tension_N;
      knot.by_tension += mean.weights[j - i] * by_tension[j];
    }
    knot.own_std = known || EI.size() > 1 ? std::sqrt(mean.variance) * scale : own_std(points_[i]);
    knots_.push_back(knot);
    i = k;
  }
}

double StiffnessCurve::clamped(double tension) const {
  return std::clamp(tension, 0.5 * lowest_tension_N(), 2 * highest_tension_N());
}

double StiffnessCurve::law_value(const FittedLaw& law, double tension) const {
  const double EI = predict(law, clamped(tension)).EI_Nm2;
  if (EI > 0) return EI;
  return predict(law, std::clamp(tension, lowest_tension_N(), highest_tension_N())).EI_Nm2;
}

double StiffnessCurve::knot_share(std::size_t k, double tension) const {
  const double T = knots_[k].tension_N;
  if (tension <= T) {
    if (k == 0) return 1;
    const double before = knots_[k - 1].tension_N;
    return std::max(0.0, (tension - before) / (T - before));
  }
  if (k + 1 == knots_.size()) return 1;
  const double after = knots_[k + 1].tension_N;
  return std::max(0.0, (after - tension) / (after - T));
}

double StiffnessCurve::value(double tension) const {
  double EI = 0;
  if (source_ != StiffnessSource::interpolation) {
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      if (weights_[k] > 0) EI += weights_[k] * law_value(laws_.laws[k], tension);
    }
    return EI;
  }
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    EI += knot_share(k, tension) * knots_[k].EI_Nm2;
  }
  return EI;
}

StiffnessAtTension StiffnessCurve::at(double tension) const {
  if (empty()) throw std::invalid_argument("stiffness curve: no points");
  if (!(tension >= 0 && std::isfinite(tension))) {
    throw std::invalid_argument("stiffness curve: the tension must be finite and not negative");
  }
  StiffnessAtTension result;
  result.EI_Nm2 = value(tension);
  result.extrapolated = tension < lowest_tension_N() || tension > highest_tension_N();
  if (source_ == StiffnessSource::interpolation) {
    for (std::size_t k = 1; k < knots_.size(); ++k) {
      const auto &a = knots_[k - 1], &b = knots_[k];
      if (tension < a.tension_N || tension > b.tension_N) continue;
      result.slope_m2 = (b.EI_Nm2 - a.EI_Nm2) / (b.tension_N - a.tension_N);
      break;
    }
  } else {
    const double step = 1e-4 * highest_tension_N(), below = std::max(0.0, tension - step);
    result.slope_m2 = (value(tension + step) - value(below)) / (tension + step - below);
  }
  const std::array<double, 1> here{tension};
  const auto terms = uncertainty(here);
  double variance = terms.empty() ? kNaN : 0;
  for (const auto& term : terms) variance += term.change_Nm2[0] * term.change_Nm2[0];
  result.std = std::sqrt(variance);
  const double half = coverage_factor(0.95, 0) * result.std;
  result.low = std::isfinite(variance) ? std::max(0.0, result.EI_Nm2 - half) : kNaN;
  result.high = result.EI_Nm2 + half;
  return result;
}

std::vector<StiffnessTerm> StiffnessCurve::uncertainty(std::span<const double> tensions) const {
  std::vector<StiffnessTerm> terms;
  if (empty()) return terms;
  const auto n = static_cast<Index>(tensions.size());
  const auto each = [&](const auto& function) {
    VectorXd change(n);
    for (Index i = 0; i < n; ++i) change[i] = function(tensions[static_cast<std::size_t>(i)]);
    return change;
  };
  const auto add = [&](std::string name, VectorXd change) {
    if (change.cwiseAbs().maxCoeff() > 0) terms.push_back({std::move(name), std::move(change)});
  };
  if (n == 0) return terms;
  if (source_ == StiffnessSource::interpolation) {
    for (std::size_t k = 0; k < knots_.size(); ++k) {
      if (!std::isfinite(knots_[k].own_std)) return {};
      add(fmt::format("EI at {:g} N", knots_[k].tension_N),
          each([&](double T) { return knot_share(k, T) * knots_[k].own_std; }));
    }
    add(kByTension, each([&](double T) {
          double change = 0;
          for (std::size_t k = 0; k < knots_.size(); ++k) {
            change += knot_share(k, T) * knots_[k].by_tension;
          }
          return change;
        }));
  } else {
    for (std::size_t k = 0; k < laws_.laws.size(); ++k) {
      const auto& law = laws_.laws[k];
      const double weight = weights_[k];
      if (!(weight > 0.001)) continue;
      add(fmt::format("EI(T), choice of the {} law", name_of(law.kind)),
          each([&](double T) { return std::sqrt(weight) * (law_value(law, T) - value(T)); }));
      const double scale = std::sqrt(weight) * law.coverage_factor / coverage_factor(0.95, 0);
      const MatrixXd factor = law.covariance.llt().matrixL();
      for (Index j = 0; j < factor.cols(); ++j) {
        add(fmt::format("EI(T), {} law, term {}", name_of(law.kind), j + 1), each([&](double T) {
              return scale * predict(law, clamped(T)).by_parameter.dot(factor.col(j));
            }));
      }
    }
  }
  if (shared_relative_std_ > 0) {
    add("EI, shared by the bending tests",
        each([&](double T) { return shared_relative_std_ * value(T); }));
  }
  return terms;
}

}  // namespace rigfit::ident
