#include "ident/stiffness/stiffness_law.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ident/statistics/uncertainty.h"
#include "ident/stiffness/law_choice.h"
#include "ident/stiffness/tension_spread.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;
constexpr int kMaxParameters = 3;
using Gradient = Eigen::Matrix<double, kMaxParameters, 1>;

// EI and its derivatives by a law's own parameters: (a, b), or (EImin, EImax, Th).
double evaluate(LawKind kind, double T, double T0, const double* p, Gradient& gradient) {
  gradient.setZero();
  switch (kind) {
    case LawKind::linear:
      gradient << 1, T, 0;
      return p[0] + p[1] * T;
    case LawKind::square_root:
      gradient << 1, std::sqrt(T), 0;
      return p[0] + p[1] * std::sqrt(T);
    case LawKind::power: {
      const double power = std::pow(T / T0, p[1]);
      gradient << power, p[0] * power * std::log(T / T0), 0;
      return p[0] * power;
    }
    case LawKind::saturating: {
      const double share = T / (T + p[2]);
      gradient << 1 - share, share, -(p[1] - p[0]) * T / ((T + p[2]) * (T + p[2]));
      return p[0] + (p[1] - p[0]) * share;
    }
  }
  return kNaN;
}

struct Weights {
  double below = 1, above = 1;  // one standard deviation of the point to either side
};

struct Data {
  std::vector<StiffnessPoint> points;
  std::vector<Weights> weights;
  Eigen::VectorXd by_tension;  // change of EI by the spread of tension, part of the weights
  double reference_tension = 1;
  bool weighted = false;
};

class LawCost : public ceres::CostFunction {
 public:
  LawCost(LawKind kind, const Data& data, int parameters) : kind_(kind), data_(data) {
    set_num_residuals(static_cast<int>(data.points.size()));
    mutable_parameter_block_sizes()->push_back(parameters);
  }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const int parameters = parameter_block_sizes()[0];
    Gradient gradient;
    for (std::size_t i = 0; i < data_.points.size(); ++i) {
      const auto& point = data_.points[i];
      const double EI =
          evaluate(kind_, point.tension_N, data_.reference_tension, blocks[0], gradient);
      const double difference = EI - point.EI_Nm2;
      const double sigma = difference > 0 ? data_.weights[i].above : data_.weights[i].below;
      residuals[i] = difference / sigma;
      if (!std::isfinite(residuals[i])) return false;
      if (jacobians != nullptr && jacobians[0] != nullptr) {
        for (int j = 0; j < parameters; ++j) {
          jacobians[0][static_cast<int>(i) * parameters + j] = gradient[j] / sigma;
        }
      }
    }
    return true;
  }

 private:
  LawKind kind_;
  const Data& data_;
};

Data prepare(const std::vector<StiffnessPoint>& points, const StiffnessLawOptions& options) {
  Data data;
  data.points = points;
  data.weighted = true;
  double log_sum = 0;
  for (const auto& point : points) {
    if (!(std::isfinite(point.tension_N) && point.tension_N > 0 && std::isfinite(point.EI_Nm2) &&
          point.EI_Nm2 > 0)) {
      throw std::invalid_argument("stiffness law: tension and EI of every point must be positive");
    }
    log_sum += std::log(point.tension_N);
    Weights weights;
    // What the points share is no weight between them.
    const double shared = std::min(0.999 * point.std, point.shared_relative_std * point.EI_Nm2);
    const double own = shared > 0 ? std::sqrt(1 - std::pow(shared / point.std, 2)) : 1;
    if (point.low < point.EI_Nm2 && point.EI_Nm2 < point.high) {
      weights.below = own * (point.EI_Nm2 - point.low) / 1.959964;
      weights.above = own * (point.high - point.EI_Nm2) / 1.959964;
    } else if (std::isfinite(point.std) && point.std > 0) {
      weights.below = weights.above = own * point.std;
    } else if (options.assumed_relative_std > 0) {
      weights.below = weights.above = options.assumed_relative_std * point.EI_Nm2;
    } else {
      data.weighted = false;
    }
    data.weights.push_back(weights);
  }
  data.reference_tension = std::exp(log_sum / static_cast<double>(points.size()));
  data.by_tension = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(points.size()));
  if (data.weighted) {
    const auto change = change_by_tension(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      data.by_tension[static_cast<Eigen::Index>(i)] = change[i];
      data.weights[i].below = std::hypot(data.weights[i].below, change[i]);
      data.weights[i].above = std::hypot(data.weights[i].above, change[i]);
    }
  }
  if (!data.weighted) {  // one without an interval: none can be compared, all by their value
    for (std::size_t i = 0; i < points.size(); ++i) {
      data.weights[i].below = data.weights[i].above = points[i].EI_Nm2;
    }
  }
  return data;
}

std::vector<LawParameter> parameters_of(LawKind kind, const StiffnessLawOptions& options) {
  switch (kind) {
    case LawKind::linear:
      return {{"a", 0, kNaN, "N m2"}, {"b", 0, kNaN, "m2"}};
    case LawKind::square_root:
      return {{"a", 0, kNaN, "N m2"}, {"b", 0, kNaN, "N^0.5 m2"}};
    case LawKind::power:
      return {{"a", 0, kNaN, "N m2"}, {"b", 0, kNaN, "1"}};
    case LawKind::saturating: {
      const bool fixed = options.bounds.has_value();
      return {{"EI_min", fixed ? options.bounds->EI_min_Nm2 : 0, kNaN, "N m2", fixed},
              {"EI_max", fixed ? options.bounds->EI_max_Nm2 : 0, kNaN, "N m2", fixed},
              {"T_half", 0, kNaN, "N"}};
    }
  }
  return {};
}

// Starting values in closed form: linear regression in the law's own coordinates.
std::vector<std::vector<double>> starts(LawKind kind, const Data& data,
                                        const StiffnessLawOptions& options) {
  const auto n = static_cast<Eigen::Index>(data.points.size());
  Eigen::MatrixXd A(n, 2);
  Eigen::VectorXd y(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& point = data.points[static_cast<std::size_t>(i)];
    const double w = 1 / point.EI_Nm2;
    switch (kind) {
      case LawKind::linear:
      case LawKind::saturating:
        A.row(i) << w, w * point.tension_N;
        y[i] = w * point.EI_Nm2;
        break;
      case LawKind::square_root:
        A.row(i) << w, w * std::sqrt(point.tension_N);
        y[i] = w * point.EI_Nm2;
        break;
      case LawKind::power:
        A.row(i) << 1, std::log(point.tension_N / data.reference_tension);
        y[i] = std::log(point.EI_Nm2);
        break;
    }
  }
  const Eigen::Vector2d line = A.colPivHouseholderQr().solve(y);
  if (kind == LawKind::power) return {{std::exp(line[0]), line[1]}};
  if (kind != LawKind::saturating) return {{line[0], line[1]}};

  double smallest = data.points[0].EI_Nm2, largest = smallest, last = data.points[0].tension_N;
  for (const auto& point : data.points) {
    smallest = std::min(smallest, point.EI_Nm2);
    largest = std::max(largest, point.EI_Nm2);
    last = std::max(last, point.tension_N);
  }
  if (options.bounds) {
    const double low = options.bounds->EI_min_Nm2, high = options.bounds->EI_max_Nm2;
    const double share = std::clamp((largest - low) / (high - low), 1e-6, 1 - 1e-6);
    return {{low, high, last * (1 - share) / share}};
  }
  std::vector<std::vector<double>> several;
  for (double half : {0.1, 1.0, 10.0}) {
    const double T_half = half * last;
    const double top = 0.5 * smallest + (largest - 0.5 * smallest) * (last + T_half) / last;
    several.push_back({0.5 * smallest, top, T_half});
  }
  return several;
}

/// A term with its sign before it: "+ 0.04281", "- 0.2".
std::string added(double value) {
  return fmt::format("{} {:.5g}", value < 0 ? "-" : "+", std::abs(value));
}

/// EI in N m2, T in N.
std::string formula_of(const FittedLaw& law) {
  const auto value = [&](std::size_t i) { return law.parameters[i].value; };
  switch (law.kind) {
    case LawKind::linear:
      return fmt::format("EI = {:.5g} {} T", value(0), added(value(1)));
    case LawKind::square_root:
      return fmt::format("EI = {:.5g} {} sqrt(T)", value(0), added(value(1)));
    case LawKind::power:
      return fmt::format("EI = {:.5g} (T / {:.5g})^{:.4g}", value(0), law.reference_tension_N,
                         value(1));
    case LawKind::saturating:
      return fmt::format("EI = {:.5g} {} T / (T + {:.5g})", value(0), added(value(1) - value(0)),
                         value(2));
  }
  return {};
}

FittedLaw fit(LawKind kind, const Data& data, const StiffnessLawOptions& options) {
  FittedLaw law;
  law.kind = kind;
  law.parameters = parameters_of(kind, options);
  law.reference_tension_N = kind == LawKind::power ? data.reference_tension : 1;
  law.common_relative_std = options.common_relative_std;
  for (const auto& point : data.points) {
    law.common_relative_std = std::max(law.common_relative_std, point.shared_relative_std);
  }
  const int size = static_cast<int>(law.parameters.size());
  std::vector<int> fixed;
  std::vector<int> free;
  for (int j = 0; j < size; ++j) {
    (law.parameters[static_cast<std::size_t>(j)].fixed ? fixed : free).push_back(j);
  }

  double best_cost = std::numeric_limits<double>::infinity();
  std::vector<double> best;
  for (auto start : starts(kind, data, options)) {
    ceres::Problem problem;
    problem.AddResidualBlock(new LawCost(kind, data, size), nullptr, start.data());
    if (!fixed.empty()) {
      problem.SetManifold(start.data(), new ceres::SubsetManifold(size, fixed));
    }
    if (kind == LawKind::saturating) {
      problem.SetParameterLowerBound(start.data(), 2, 1e-6 * data.reference_tension);
      problem.SetParameterUpperBound(start.data(), 2, 1e6 * data.reference_tension);
      if (fixed.empty()) problem.SetParameterLowerBound(start.data(), 0, 0);
    }
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_QR;
    solver.logging_type = ceres::SILENT;
    solver.max_num_iterations = 500;
    solver.function_tolerance = solver.parameter_tolerance = 1e-13;
    solver.gradient_tolerance = 1e-14;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (summary.IsSolutionUsable() && summary.final_cost < best_cost) {
      best_cost = summary.final_cost;
      best = start;
      law.converged = summary.termination_type == ceres::CONVERGENCE;
    }
  }
  if (best.empty()) {
    law.message = "the fit did not start";
    return law;
  }
  if (!law.converged) law.message = "the fit had not settled after 500 iterations";

  const auto n = static_cast<Eigen::Index>(data.points.size());
  const auto p = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd jacobian(n, p);
  Eigen::VectorXd sigmas(n);
  Gradient gradient;
  double squares = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto& point = data.points[k];
    const double EI =
        evaluate(kind, point.tension_N, data.reference_tension, best.data(), gradient);
    const double sigma = EI > point.EI_Nm2 ? data.weights[k].above : data.weights[k].below;
    sigmas[i] = sigma;
    for (Eigen::Index j = 0; j < p; ++j) {
      jacobian(i, j) = gradient[free[static_cast<std::size_t>(j)]] / sigma;
    }
    squares += std::pow(EI / point.EI_Nm2 - 1, 2);
  }
  law.chi_squared = 2 * best_cost;
  law.degrees_of_freedom = static_cast<double>(n - p);
  law.rms_relative_error = std::sqrt(squares / static_cast<double>(n));

  // Weights that promise less scatter than there is are corrected by it (Birge ratio); fewer
  // points than would show the scatter are left as they are.
  const double reduced =
      law.degrees_of_freedom > 0 ? law.chi_squared / law.degrees_of_freedom : kNaN;
  double variance = 1;
  if (!data.weighted) {
    variance = reduced;
  } else if (reduced > 1) {
    variance = reduced;
  }
  const bool from_scatter = !data.weighted || variance > 1;
  law.coverage_factor = coverage_factor(0.95, from_scatter ? law.degrees_of_freedom : 0);

  std::vector<std::string> names;
  Eigen::VectorXd scales(p);
  for (Eigen::Index j = 0; j < p; ++j) {
    const auto k = static_cast<std::size_t>(free[static_cast<std::size_t>(j)]);
    names.push_back(law.parameters[k].name);
    scales[j] = std::max(std::abs(best[k]), 1e-12);
  }
  for (std::size_t j = 0; j < law.parameters.size(); ++j) law.parameters[j].value = best[j];
  law.covariance = Eigen::MatrixXd::Constant(p, p, kNaN);
  if (std::isfinite(variance)) {
    // An offset or slope near zero has no relative uncertainty; what is asked is that the law's
    // own parameters are not hopelessly confounded.
    const double limit = kind == LawKind::saturating ? 1 : 1e6;
    const auto known =
        identifiability(jacobian, scales, names,
                        {.max_relative_std = limit, .variance_factor = std::max(variance, 1e-300)});
    law.covariance = known.covariance;
    Eigen::VectorXd std = known.std;
    if (law.covariance.allFinite() && !data.by_tension.isZero(0)) {
      const auto effect =
          abscissa_effect(known.covariance, variance, jacobian, sigmas, data.by_tension);
      law.by_tension = effect.by_tension, law.covariance = effect.covariance;
      std = effect.covariance.diagonal().cwiseSqrt();
    }
    for (Eigen::Index j = 0; j < p; ++j) {
      const auto k = static_cast<std::size_t>(free[static_cast<std::size_t>(j)]);
      law.parameters[k].std = std[j];
    }
    for (const auto& open : known.open) {
      law.message += (law.message.empty() ? "" : "; ") + open.message;
    }
  } else {
    law.message += std::string(law.message.empty() ? "" : "; ") +
                   "as many parameters as points: no uncertainty";
  }
  for (auto& parameter : law.parameters) {
    if (parameter.fixed) parameter.std = 0;
  }
  law.formula = formula_of(law);

  double mean_relative = 0;
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const double sigma = 0.5 * (data.weights[i].below + data.weights[i].above);
    mean_relative += std::pow(sigma / data.points[i].EI_Nm2, 2);
  }
  law.scatter_relative_std = std::sqrt(mean_relative / static_cast<double>(n) * variance);

  const double k = static_cast<double>(p) + (data.weighted ? 0 : 1);
  const double count = static_cast<double>(n);
  if (count > k + 1) {
    const double misfit = data.weighted
                              ? law.chi_squared
                              : count * std::log(std::max(law.chi_squared, 1e-300) / count);
    law.aicc = misfit + 2 * k + 2 * k * (k + 1) / (count - k - 1);
  }
  return law;
}

}  // namespace

const char* name_of(LawKind kind) {
  switch (kind) {
    case LawKind::linear:
      return "linear";
    case LawKind::square_root:
      return "square root";
    case LawKind::power:
      return "power";
    case LawKind::saturating:
      return "saturating";
  }
  return "linear";
}

namespace {

// EI of a law and its derivatives by the free parameters.
double evaluate(const FittedLaw& law, double tension_N, Eigen::VectorXd& by) {
  if (!(std::isfinite(tension_N) && tension_N > 0)) {
    throw std::invalid_argument("stiffness law: the tension must be positive");
  }
  double values[kMaxParameters] = {0, 0, 0};
  std::vector<int> free;
  for (std::size_t j = 0; j < law.parameters.size(); ++j) {
    values[j] = law.parameters[j].value;
    if (!law.parameters[j].fixed) free.push_back(static_cast<int>(j));
  }
  Gradient gradient;
  const double EI = evaluate(law.kind, tension_N, law.reference_tension_N, values, gradient);
  by = gradient(free);
  return EI;
}

}  // namespace

Eigen::VectorXd law_gradient(const FittedLaw& law, double tension_N) {
  Eigen::VectorXd by;
  evaluate(law, tension_N, by);
  return by;
}

StiffnessPrediction predict(const FittedLaw& law, double tension_N) {
  StiffnessPrediction prediction;
  Eigen::VectorXd by;
  prediction.EI_Nm2 = evaluate(law, tension_N, by);
  const double own = law.covariance.rows() == by.size() ? by.dot(law.covariance * by) : kNaN;
  // The spread of tension is no estimate from the scatter: 1.96 of it, not Student's factor.
  const double tension = law.by_tension.size() == by.size() ? by.dot(law.by_tension) : 0;
  const double common = law.common_relative_std * prediction.EI_Nm2;
  const double scatter = law.scatter_relative_std * prediction.EI_Nm2;
  prediction.std = std::sqrt(own + common * common);
  const double rest =
      (own > tension * tension ? own - tension * tension : 0 * own) + common * common;
  const double half = std::hypot(law.coverage_factor * std::sqrt(rest), 1.959964 * tension);
  const double test_half =
      std::hypot(law.coverage_factor * std::sqrt(rest + scatter * scatter), 1.959964 * tension);
  prediction.low = prediction.EI_Nm2 - half;
  prediction.high = prediction.EI_Nm2 + half;
  prediction.test_low = prediction.EI_Nm2 - test_half;
  prediction.test_high = prediction.EI_Nm2 + test_half;
  return prediction;
}

StiffnessLaws fit_stiffness_laws(const std::vector<StiffnessPoint>& points,
                                 const StiffnessLawOptions& options) {
  if (points.size() < 2) throw std::invalid_argument("stiffness law: two points at least");
  const Data data = prepare(points, options);
  StiffnessLaws result;
  result.weighted = data.weighted;
  std::vector<std::string> left_out;
  for (LawKind kind : options.laws) {
    std::size_t free = 0;
    for (const auto& parameter : parameters_of(kind, options)) free += !parameter.fixed;
    if (free > points.size()) {
      left_out.push_back(name_of(kind));
    } else {
      result.laws.push_back(fit(kind, data, options));
    }
  }
  rank_laws(result, points.size(), left_out);
  return result;
}

}  // namespace rigfit::ident
