#include "ident/stiffness/stiffness_law.h"

#include <ceres/ceres.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gsl/gsl_fit.h>

#include "ident/statistics/uncertainty.h"

namespace rigfit::ident {
namespace {

using Bounds = std::optional<StiffnessBounds>;

struct Data {
  std::vector<StiffnessPoint> points;
  VectorXd sigma;                // std of each point by itself
  VectorXd change;               // change of EI by one std of where the tests' tension lies
  double reference_tension = 1;  // geometric mean
  bool weighted = true;
};

/// A term with its sign before it: "+ 0.04281", "- 0.2".
std::string added(double value) {
  return fmt::format("{} {:.5g}", value < 0 ? "-" : "+", std::abs(value));
}

/// EI by a law's own parameters p: (a, b), or (EImin, EImax, Th). Scalar: double or ceres::Jet.
template <class S>
S stiffness(LawKind kind, double T, double T0, const S* p) {
  using std::pow;
  if (kind == LawKind::saturating) return p[0] + (p[1] - p[0]) * T / (T + p[2]);
  if (kind == LawKind::power) return p[0] * pow(T / T0, p[1]);
  return p[0] + p[1] * (kind == LawKind::linear ? T : std::sqrt(T));
}

/// EI in N m2, T in N.
std::string formula_of(LawKind kind, double T0, const std::vector<double>& p) {
  switch (kind) {
    case LawKind::linear:
      return fmt::format("EI = {:.5g} {} T", p[0], added(p[1]));
    case LawKind::square_root:
      return fmt::format("EI = {:.5g} {} sqrt(T)", p[0], added(p[1]));
    case LawKind::power:
      return fmt::format("EI = {:.5g} (T / {:.5g})^{:.4g}", p[0], T0, p[1]);
    case LawKind::saturating:
      break;
  }
  return fmt::format("EI = {:.5g} {} T / (T + {:.5g})", p[0], added(p[1] - p[0]), p[2]);
}

/// Where the search begins; all but the saturating law are found from a level line.
std::vector<std::vector<double>> starts(LawKind kind, const Data& data, const Bounds& bounds) {
  if (kind != LawKind::saturating) return {{data.points.front().EI_Nm2, 0}};
  const auto [least, most] = std::ranges::minmax(data.points, {}, &StiffnessPoint::EI_Nm2);
  const double smallest = least.EI_Nm2, largest = most.EI_Nm2;
  const double last = std::ranges::max(data.points, {}, &StiffnessPoint::tension_N).tension_N;
  if (bounds) {
    const double low = bounds->EI_min_Nm2, high = bounds->EI_max_Nm2;
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

std::vector<LawParameter> parameters_of(LawKind kind, const Bounds& bounds) {
  if (kind != LawKind::saturating) {
    constexpr std::array units{"m2", "N^0.5 m2", "1"};
    return {{"a", 0, kNaN, "N m2"}, {"b", 0, kNaN, units[static_cast<std::size_t>(kind)]}};
  }
  const auto [low, high] = bounds.value_or(StiffnessBounds());
  const bool fixed = bounds.has_value();
  const double std = fixed ? 0 : kNaN;
  return {{"EI_min", low, std, "N m2", fixed},
          {"EI_max", high, std, "N m2", fixed},
          {"T_half", 0, kNaN, "N"}};
}

// Points, then where the tension lies within the tests, a standard normal of all together.
struct LawResiduals {
  LawKind kind;
  const Data& data;

  template <class S>
  bool operator()(S const* const* x, S* residuals) const {
    using std::isfinite;
    for (std::size_t i = 0; i < data.points.size(); ++i) {
      const auto& point = data.points[i];
      const auto k = static_cast<Index>(i);
      const S EI = stiffness(kind, point.tension_N, data.reference_tension, x[0]);
      residuals[i] = (EI + data.change[k] * x[1][0] - point.EI_Nm2) / data.sigma[k];
      if (!isfinite(residuals[i])) return false;
    }
    residuals[data.points.size()] = x[1][0];
    return true;
  }
};

Data prepare(const std::vector<StiffnessPoint>& points, const StiffnessLawOptions& options) {
  Data data;
  data.points = points;
  const auto n = static_cast<Index>(points.size());
  double log_tensions = 0;
  data.sigma.resize(n), data.change = VectorXd::Zero(n);
  for (Index i = 0; i < n; ++i) {
    const auto& point = points[static_cast<std::size_t>(i)];
    if (!(std::isfinite(point.tension_N) && point.tension_N > 0 && std::isfinite(point.EI_Nm2) &&
          point.EI_Nm2 > 0)) {
      throw std::invalid_argument("stiffness law: tension and EI of every point must be positive");
    }
    const double own = own_std(point);
    data.sigma[i] = own > 0 ? own : options.assumed_relative_std * point.EI_Nm2;
    data.weighted &= data.sigma[i] > 0;
    log_tensions += std::log(point.tension_N);
  }
  data.reference_tension = std::exp(log_tensions / static_cast<double>(n));
  if (data.weighted) {
    const auto change = change_by_tension(points);
    data.change = Map<const VectorXd>(change.data(), n);
  } else {  // one without an interval: none can be compared, all by their value
    for (Index i = 0; i < n; ++i) {
      data.sigma[i] = points[static_cast<std::size_t>(i)].EI_Nm2;
    }
  }
  return data;
}

FittedLaw fit(LawKind kind, const Data& data, const StiffnessLawOptions& options) {
  FittedLaw law;
  law.kind = kind;
  law.parameters = parameters_of(kind, options.bounds);
  law.reference_tension_N = kind == LawKind::power ? data.reference_tension : 1;
  for (const auto& point : data.points) {
    law.common_relative_std = std::max(law.common_relative_std, point.shared_relative_std);
  }
  const int size = static_cast<int>(law.parameters.size());
  std::vector<int> fixed, free;
  for (int j = 0; j < size; ++j) {
    (law.parameters[static_cast<std::size_t>(j)].fixed ? fixed : free).push_back(j);
  }
  ceres::DynamicAutoDiffCostFunction<LawResiduals> cost(new LawResiduals{kind, data});
  cost.AddParameterBlock(size);
  cost.AddParameterBlock(1);
  cost.SetNumResiduals(static_cast<int>(data.points.size()) + 1);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.logging_type = ceres::SILENT;
  solver.max_num_iterations = 500;
  solver.function_tolerance = solver.parameter_tolerance = 1e-13;
  solver.gradient_tolerance = 1e-14;
  ceres::Problem::Options kept;
  kept.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  double best_cost = std::numeric_limits<double>::infinity(), best_place = 0;
  std::vector<double> best;
  for (auto start : starts(kind, data, options.bounds)) {
    ceres::Problem problem(kept);
    double place = 0;
    problem.AddResidualBlock(&cost, nullptr, start.data(), &place);
    if (!fixed.empty()) {
      problem.SetManifold(start.data(), new ceres::SubsetManifold(size, fixed));
    }
    if (kind == LawKind::saturating) {
      problem.SetParameterLowerBound(start.data(), 2, 1e-6 * data.reference_tension);
      problem.SetParameterUpperBound(start.data(), 2, 1e6 * data.reference_tension);
      if (fixed.empty()) problem.SetParameterLowerBound(start.data(), 0, 0);
    }
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (!summary.IsSolutionUsable() || !(summary.final_cost < best_cost)) continue;
    best_cost = summary.final_cost, best = start, best_place = place;
    law.converged = summary.termination_type == ceres::CONVERGENCE;
  }
  const auto remark = [&law](const std::string& text) {
    law.message += (law.message.empty() ? "" : "; ") + text;
  };
  if (best.empty()) {
    remark("the fit did not start");
    return law;
  }
  if (!law.converged) remark("the fit had not settled after 500 iterations");
  for (std::size_t j = 0; j < law.parameters.size(); ++j) law.parameters[j].value = best[j];
  law.formula = formula_of(kind, law.reference_tension_N, best);

  // Free parameters, then where the tension lies within the tests.
  const auto n = static_cast<Index>(data.points.size());
  const auto p = static_cast<Index>(free.size());
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  VectorXd residuals(n + 1), by_place(n + 1);
  RowMajor by_law(n + 1, size);
  const double* const at[] = {best.data(), &best_place};
  double* by[] = {by_law.data(), by_place.data()};
  (void)cost.Evaluate(at, residuals.data(), by);
  MatrixXd jacobian(n + 1, p + 1);
  jacobian << by_law(Eigen::all, free), by_place;

  double squares = 0;
  for (Index i = 0; i < n; ++i) {
    const double EI = data.points[static_cast<std::size_t>(i)].EI_Nm2;
    const double misfit = residuals[i] * data.sigma[i] - data.change[i] * best_place;
    squares += misfit * misfit / (EI * EI);
  }
  const auto count = static_cast<double>(n);
  law.chi_squared = 2 * best_cost;
  law.degrees_of_freedom = static_cast<double>(n - p);
  law.rms_relative_error = std::sqrt(squares / count);

  // Weights that promise less scatter than there is are corrected by it (Birge ratio); fewer
  // points than would show the scatter are left as they are.
  const double reduced =
      law.degrees_of_freedom > 0 ? law.chi_squared / law.degrees_of_freedom : kNaN;
  const double variance = data.weighted && !(reduced > 1) ? 1 : reduced;
  const bool from_scatter = !data.weighted || variance > 1;
  law.coverage_factor = coverage_factor(0.95, from_scatter ? law.degrees_of_freedom : 0);

  law.covariance = MatrixXd::Constant(p, p, kNaN);
  if (std::isfinite(variance)) {
    std::vector<std::string> names;
    VectorXd scales = VectorXd::Constant(p + 1, 10);  // a prior of 1 is no open end
    for (const int j : free) {
      scales[static_cast<Index>(names.size())] =
          std::max(std::abs(best[static_cast<std::size_t>(j)]), 1e-12);
      names.push_back(law.parameters[static_cast<std::size_t>(j)].name);
    }
    names.emplace_back("tension");
    // An offset or slope near zero has no relative uncertainty; what is asked is that the law's
    // own parameters are not hopelessly confounded.
    const double limit = kind == LawKind::saturating ? 1 : 1e6;
    const auto known =
        identifiability(jacobian / std::sqrt(std::max(variance, 1e-300)), scales, names, limit);
    law.covariance = known.covariance.topLeftCorner(p, p);
    for (Index j = 0; j < p; ++j) {
      law.parameters[static_cast<std::size_t>(free[static_cast<std::size_t>(j)])].std =
          known.std[j];
    }
    for (const auto& open : known.open) remark(open.message);
  } else {
    remark("as many parameters as points: no uncertainty");
  }

  const double k = static_cast<double>(p) + (data.weighted ? 0 : 1);
  if (count > k + 1) {
    const double misfit = data.weighted
                              ? law.chi_squared
                              : count * std::log(std::max(law.chi_squared, 1e-300) / count);
    law.aicc = misfit + 2 * k + 2 * k * (k + 1) / (count - k - 1);
  }
  return law;
}

// Orders the laws, best first, those that AICc cannot rank behind, and sets their Akaike weights,
// `decided` and `sentence`.
void rank_laws(StiffnessLaws& result, std::size_t points) {
  auto& laws = result.laws;
  std::stable_sort(laws.begin(), laws.end(), [](const FittedLaw& a, const FittedLaw& b) {
    const bool first = std::isfinite(a.aicc), second = std::isfinite(b.aicc);
    if (first != second) return first;
    return first ? a.aicc < b.aicc : a.rms_relative_error < b.rms_relative_error;
  });
  double total = 0;
  std::size_t ranked = 0;
  std::vector<std::string> close;
  for (auto& law : laws) {
    if (!std::isfinite(law.aicc)) continue;
    ++ranked;
    total += law.akaike_weight = std::exp(-0.5 * (law.aicc - laws[0].aicc));
    if (law.aicc - laws[0].aicc < 2) close.push_back(name_of(law.kind));
  }
  for (auto& law : laws) law.akaike_weight /= total;
  if (ranked > 1 && close.size() > 1) {
    result.sentence =
        fmt::format("The points cannot choose between {}: their AICc lie within 2 of each other.",
                    fmt::join(close, ", "));
  } else if (ranked > 1) {
    result.decided = true;
    result.sentence = fmt::format("The points favour the {} law (AICc lower by {:.1f} than {}).",
                                  close[0], laws[1].aicc - laws[0].aicc, name_of(laws[1].kind));
  } else {
    // One that could be ranked among several that could not says nothing about the choice.
    std::ranges::stable_sort(laws, {}, &FittedLaw::rms_relative_error);
    if (laws.size() > 1) {
      for (auto& law : laws) law.akaike_weight = kNaN;
    }
    result.sentence = fmt::format(
        "{} points{} are too few to choose between the laws (AICc needs more); they are listed by "
        "their misfit, which always favours the law with the most parameters.",
        points, result.weighted ? "" : " without stated uncertainty");
  }
}

}  // namespace

const char* name_of(LawKind kind) {
  constexpr std::array names{"linear", "square root", "power", "saturating"};
  return names[static_cast<std::size_t>(kind)];
}

StiffnessPrediction predict(const FittedLaw& law, double tension_N) {
  if (!(std::isfinite(tension_N) && tension_N > 0)) {
    throw std::invalid_argument("stiffness law: the tension must be positive");
  }
  using Jet = ceres::Jet<double, 3>;
  std::array<Jet, 3> values;
  std::vector<int> free;
  for (std::size_t j = 0; j < law.parameters.size(); ++j) {
    const int place = static_cast<int>(j);
    values[j] = Jet(law.parameters[j].value, place);
    if (!law.parameters[j].fixed) free.push_back(place);
  }
  const Jet EI = stiffness(law.kind, tension_N, law.reference_tension_N, values.data());
  StiffnessPrediction prediction;
  prediction.EI_Nm2 = EI.a;
  const VectorXd by = prediction.by_parameter = EI.v(free);
  const double own = law.covariance.rows() == by.size() ? by.dot(law.covariance * by) : kNaN;
  const double common = law.common_relative_std * prediction.EI_Nm2;
  prediction.std = std::sqrt(own + common * common);
  const double half = law.coverage_factor * prediction.std;
  prediction.low = prediction.EI_Nm2 - half, prediction.high = prediction.EI_Nm2 + half;
  return prediction;
}

StiffnessLaws fit_stiffness_laws(const std::vector<StiffnessPoint>& points,
                                 const StiffnessLawOptions& options) {
  if (points.size() < 2) throw std::invalid_argument("stiffness law: two points at least");
  const Data data = prepare(points, options);
  StiffnessLaws result;
  result.weighted = data.weighted;
  for (const LawKind kind :
       {LawKind::linear, LawKind::square_root, LawKind::power, LawKind::saturating}) {
    std::size_t free = 0;
    for (const auto& parameter : parameters_of(kind, options.bounds)) free += !parameter.fixed;
    if (free <= points.size()) result.laws.push_back(fit(kind, data, options));
  }
  rank_laws(result, points.size());
  return result;
}

StiffnessBounds stiffness_bounds(const StrandGeometry& geometry) {
  for (const double value : {geometry.youngs_modulus_Pa, static_cast<double>(geometry.elements),
                             geometry.element_diameter_m, geometry.strand_diameter_m}) {
    if (!(std::isfinite(value) && value > 0)) {
      throw std::invalid_argument("strand geometry: every value must be positive and finite");
    }
  }
  const double factor = geometry.youngs_modulus_Pa * std::numbers::pi / 64;
  return {.EI_min_Nm2 = factor * geometry.elements * std::pow(geometry.element_diameter_m, 4),
          .EI_max_Nm2 = factor * std::pow(geometry.strand_diameter_m, 4)};
}

double tension_spread(const Ref<const VectorXd>& tension, double noise) {
  if (tension.size() == 0) return 0;
  // The largest of n normal deviates is about sqrt(2 ln n).
  const double extreme = noise * std::sqrt(2 * std::log(static_cast<double>(tension.size())));
  const double low = tension.minCoeff() + extreme, high = tension.maxCoeff() - extreme;
  if (!(high > low)) return 0;
  const double mean = std::clamp(tension.mean(), low, high);
  return std::hypot(0.5 * (low + high) - mean, (high - low) / std::sqrt(12.0));
}

std::vector<double> change_by_tension(const std::vector<StiffnessPoint>& points) {
  std::vector<double> change(points.size(), 0.0);
  if (points.empty()) return change;
  const auto [low, high] = std::ranges::minmax(points, {}, &StiffnessPoint::tension_N);
  if (!(high.tension_N > 1.05 * low.tension_N)) return change;
  std::vector<double> x, y;
  for (const auto& one : points) {
    x.push_back(std::log(one.tension_N)), y.push_back(std::log(one.EI_Nm2));
  }
  // The slope of a line in the logarithms is the exponent.
  double offset = 0, exponent = 0, v00 = 0, v01 = 0, v11 = 0, squares = 0;
  gsl_fit_linear(x.data(), 1, y.data(), 1, x.size(), &offset, &exponent, &v00, &v01, &v11,
                 &squares);
  for (std::size_t i = 0; i < points.size(); ++i) {
    change[i] = exponent * points[i].EI_Nm2 / points[i].tension_N * points[i].tension_std_N;
  }
  return change;
}

double own_std(const StiffnessPoint& point) {
  const double whole = std::isfinite(point.low) && std::isfinite(point.high)
                           ? (point.high - point.low) / (2 * coverage_factor(0.95, 0))
                           : point.std;
  const double shared = point.shared_relative_std * point.EI_Nm2;
  return std::sqrt(std::max(whole * whole - shared * shared, 1e-6 * whole * whole));
}

}  // namespace rigfit::ident
