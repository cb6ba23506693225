#include "ident/axial/axial_fit.h"

#include <ceres/ceres.h>
#include <gsl/gsl_fit.h>

#include <Eigen/Dense>

#include "ident/statistics/root.h"

namespace rigfit::ident {
namespace {

// Parameters that the lengths share; each length has its own error besides.
enum Shared { kLogEA, kSeries, kPlace, kMass, kPerLength, kAdapter, kFrame, kRate, kShared };

// Least std of ln W: no clock of a logger is known to more than some 5 ppm.
constexpr double kLeastStd = 1e-5;

// An input known exactly still has a sensitivity.
double relative(const Estimate& input) {
  return input.value > 0 ? std::max(input.std / input.value, 1e-7) : 0;
}

struct Length : AxialLengthData {
  double W = 0;
  double std = 0, scatter = 0;  // in ln W: with the scatter of ln EA, and that alone
  double residual_std = 0;      // what an error of ln W is in the residual
};

// Errors of ln W by length in standard deviations, then the priors of the shared parameters and of
// each length. Parameters that nothing depends on stay at zero.
struct Residuals {
  const AxialSetup& setup;
  const std::vector<Length>& lengths;
  double unit;  // m/N, of the compliance in series
  bool series;

  [[nodiscard]] double prior_of_series() const {
    if (!series) return 1;
    const auto& known = setup.series_compliance_std_m_N;
    return known ? unit / *known : 0;
  }

  template <class T>
  bool operator()(T const* const* parameters, T* residuals) const {
    using std::exp, std::log, std::erf;
    const T* z = parameters[0];
    const auto input = [](const Estimate& x, const T& by) {
      return x.value * exp(relative(x) * by);
    };
    const std::size_t n = lengths.size();
    for (std::size_t i = 0; i < n; ++i) {
      const Length& one = lengths[i];
      const T L = input({one.length_m, setup.length_std_m.value_or(0)}, z[kShared + i]);
      const T W = one.W * exp(2 * std::max(setup.rate_relative_std, 1e-7) * z[kRate]);
      const T kc = exp(z[kLogEA]) / L, share = 0.5 + 0.5 * erf(z[kPlace] * std::sqrt(0.5));
      T above(0.0), below(0.0);
      if (series) above = (1.0 - share) * unit * z[kSeries], below = share * unit * z[kSeries];
      if (setup.frame_stiffness_N_m.value > 0) {
        above += 1.0 / input(setup.frame_stiffness_N_m, z[kFrame]);
      }
      if (setup.adapter_stiffness_N_m.value > 0) {
        below += 1.0 / input(setup.adapter_stiffness_N_m, z[kAdapter]);
      }
      const T inertia = W * input(setup.mass_per_length_kg_m, z[kPerLength]) * L;
      const T compliance = rod_compliance(kc, inertia, above) + below;
      if (!(compliance > 0.0) || !(inertia < 2.4 * kc)) return false;  // beyond the first mode
      residuals[i] = log(W * input(setup.mass_kg, z[kMass]) * compliance) / one.residual_std;
      residuals[n + kShared + i] = z[kShared + i];
    }
    for (std::size_t j = 0; j < kShared; ++j) residuals[n + j] = z[j];
    residuals[n + kLogEA] = T(0.0);
    residuals[n + kSeries] = prior_of_series() * z[kSeries];
    return true;
  }
};

// Contributions to EA, whose logarithm moves with each residual of unit variance by its gain.
void add_budget(const Residuals& model, const VectorXd& gain, AxialFit& fit) {
  const AxialSetup& setup = model.setup;
  const auto n = static_cast<Index>(model.lengths.size());
  const double each = 1 / static_cast<double>(n), length_std = setup.length_std_m.value_or(0);
  double own = 0, between = 0, cut = 0, by_length = 0, length = 0, frequency = 0;
  for (Index i = 0; i < n; ++i) {
    const Length& one = model.lengths[static_cast<std::size_t>(i)];
    const double part = std::pow(one.scatter / one.std, 2), g = gain[n + kShared + i];
    own += (1 - part) * gain[i] * gain[i];
    between += part * gain[i] * gain[i];
    cut += length_std > 0 ? g * g : 0;
    by_length += g / (relative({one.length_m, length_std}) * one.length_m);
    length += each * one.length_m;
    frequency += each * std::sqrt(one.W) / kTwoPi;
  }
  const auto push = [&](const char* source, const char* unit, const Estimate& input,
                        double by_input, double variance) {
    fit.budget.push_back({source, unit, input.value, input.std, fit.EA_N * by_input,
                          fit.EA_N * std::sqrt(variance), variance});
    fit.EA_relative_std = std::hypot(fit.EA_relative_std, std::sqrt(variance));
  };
  push("frequency", "Hz", {frequency, std::sqrt(own) * frequency / 2}, 2 / frequency, own);
  push("between lengths", "N", {kNaN, fit.EA_N * fit.between_std}, 1 / fit.EA_N, between);
  push("length", "m", {length, length_std}, by_length, cut);
  const auto add = [&](Shared which, const char* source, const char* unit, const Estimate& input,
                       double step) {
    const double g = gain[n + which];
    if (step > 0) push(source, unit, input, g / step, input.std > 0 ? g * g : 0);
  };
  const auto value = [&](Shared which, const char* source, const char* unit,
                         const Estimate& input) {
    add(which, source, unit, input, relative(input) * input.value);
  };
  value(kMass, "hung mass", "kg", setup.mass_kg);
  value(kPerLength, "cable mass per length", "kg/m", setup.mass_per_length_kg_m);
  value(kAdapter, "adapter stiffness", "N/m", setup.adapter_stiffness_N_m);
  value(kFrame, "frame stiffness", "N/m", setup.frame_stiffness_N_m);
  value(kRate, "sample rate", "1", {1, setup.rate_relative_std});
  if (model.series) {
    const double known = setup.series_compliance_std_m_N.value_or(0), place = std::sqrt(1.0 / 12);
    add(kSeries, "compliance in series", "m/N", {0, known}, known);
    add(kPlace, "place of the compliance", "1", {0.5, place}, place);
  }
  for (auto& row : fit.budget) row.share /= std::pow(fit.EA_relative_std, 2);
}

}  // namespace

RodStiffness rod_stiffness(const RodOnMass& rod) {
  RodStiffness result;
  const auto told = [](double stiffness) { return stiffness > 0 ? 1 / stiffness : 0; };
  const double adapter = told(rod.adapter_N_m), frame = told(rod.frame_N_m);
  const double whole = rod.omega_squared * rod.mass_kg;
  const double seen = 1 / (1 / whole - adapter);  // what the rod and the frame have together, N/m
  const double inertia = rod.omega_squared * rod.mass_per_length_kg_m * rod.length_m;
  // Smooth, and rising from x = pi / 2, where it is negative, through its largest root.
  const auto over = [&](double kc) { return 1 / rod_compliance(kc, inertia, frame) - seen; };
  const double low = std::max(1e-3 * seen, 4 * inertia / (std::numbers::pi * std::numbers::pi));
  double high = low;
  for (int i = 0; i < 200 && !(over(high) > 0); ++i) high *= 2;
  if (!(seen > 0) || !(inertia >= 0) || !(over(high) > 0)) {
    result.cable_N_m = result.series_N_m = kNaN;
    return result;
  }
  const double kc = result.cable_N_m = root_between(low, high, 4e-16, over);
  result.series_N_m = 1 / (1 / kc + adapter + frame);
  using Jet = ceres::Jet<double, 2>;  // by ln kc, ln inertia
  const Jet K = 1.0 / rod_compliance(kc * exp(Jet(0, 0)), inertia * exp(Jet(0, 1)), Jet(frame));
  result.by_omega_squared = (seen * seen / whole - K.v[1]) / K.v[0];
  result.by_length = -K.v[1] / K.v[0];
  result.misfit_by_omega_squared = 1 - K.v[1] * whole / (seen * seen);
  return result;
}

RodStiffness rod_of(const AxialSetup& setup, double omega_squared, double length) {
  return rod_stiffness({omega_squared, setup.mass_kg.value, setup.mass_per_length_kg_m.value,
                        length, setup.adapter_stiffness_N_m.value,
                        setup.frame_stiffness_N_m.value});
}

AxialFit fit_axial(std::span<const AxialLengthData> data, const AxialSetup& setup, bool series,
                   double between_std) {
  std::vector<Length> lengths;
  double unit = 0;  // m/N
  std::vector<double> at_m, compliance;
  VectorXd z = VectorXd::Zero(static_cast<Index>(kShared + data.size()));
  for (const auto& one : data) {
    Length length{one};
    length.W = std::exp(one.log_omega_squared);
    const auto rod = rod_of(setup, length.W, one.length_m);
    length.scatter = between_std / rod.by_omega_squared;
    length.std = std::hypot(std::max(one.log_omega_squared_std, kLeastStd), length.scatter);
    length.residual_std = rod.misfit_by_omega_squared * length.std;
    if (lengths.empty()) unit = 1 / rod.cable_N_m, z[kLogEA] = std::log(one.length_m / unit);
    lengths.push_back(length);
    at_m.push_back(one.length_m), compliance.push_back(1 / rod.cable_N_m);
  }
  // From the straight line of compliance over length: far from it the compliance's place would run
  // to one of the ends and stay.
  double offset = 0, slope = 0, v00 = 0, v01 = 0, v11 = 0, squares = 0;
  gsl_fit_linear(at_m.data(), 1, compliance.data(), 1, at_m.size(), &offset, &slope, &v00, &v01,
                 &v11, &squares);
  if (series && slope > 0) z[kLogEA] = -std::log(slope), z[kSeries] = offset / unit;
  AxialFit fit;
  fit.between_std = between_std;
  const auto n = static_cast<Index>(lengths.size()), rows = n + z.size();
  const bool free = series && !setup.series_compliance_std_m_N;
  fit.degrees = static_cast<int>(n) - 1 - (free ? 1 : 0);
  auto* const model = new Residuals{setup, lengths, unit, series};
  auto* const cost = new ceres::DynamicAutoDiffCostFunction<Residuals>(model);
  cost->AddParameterBlock(static_cast<int>(z.size()));
  cost->SetNumResiduals(static_cast<int>(rows));
  ceres::Problem problem;
  problem.AddResidualBlock(cost, nullptr, z.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 200;
  options.function_tolerance = options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 1e-15;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) return fit;
  fit.EA_N = std::exp(z[kLogEA]);
  fit.chi2 = 2 * summary.final_cost;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> J(rows, z.size());
  VectorXd residuals(rows);
  const double* const at = z.data();
  double* by = J.data();
  (void)cost->Evaluate(&at, residuals.data(), &by);
  const MatrixXd gains = J.householderQr().solve(MatrixXd::Identity(rows, rows));
  if (series) {
    fit.compliance_m_N = {unit * z[kSeries], unit * gains.row(kSeries).norm()};
  }
  add_budget(*model, gains.row(kLogEA), fit);
  fit.converged = std::isfinite(fit.EA_relative_std) && fit.EA_N > 0;
  return fit;
}

}  // namespace rigfit::ident
