#include "ident/axial/axial_fit.h"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace rigfit::ident {
namespace {

// Parameters that the lengths share; each length has its own error besides.
enum Shared { kLogEA, kSeries, kPlace, kMass, kPerLength, kAdapter, kFrame, kRate, kShared };

// Least std of ln W: no clock of a logger is known to more than some 5 ppm.
constexpr double kLeastStd = 1e-5;

// An input known exactly still has a sensitivity.
double relative(const signal::Estimate& input) {
  return input.value > 0 ? std::max(input.std / input.value, 1e-7) : 0;
}

// Compliance under the mass of a rod of stiffness kc, without what is not told.
template <class T>
T told_chain(const AxialSetup& setup, double kc, const T& W, double length) {
  const double frame = setup.frame_stiffness_N_m.value, adapter = setup.adapter_stiffness_N_m.value;
  return rod_compliance(T(kc), W * setup.mass_per_length_kg_m.value * length,
                        T(frame > 0 ? 1 / frame : 0)) +
         (adapter > 0 ? 1 / adapter : 0);
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
    const auto input = [](const signal::Estimate& x, const T& by) {
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

// Contributions to ln EA, which moves with each residual of unit variance by its gain.
void add_shares(const Residuals& model, const Eigen::VectorXd& gain, AxialFit& fit) {
  const AxialSetup& setup = model.setup;
  const auto n = static_cast<Eigen::Index>(model.lengths.size());
  AxialShare frequency{"frequency", "Hz", 0, 0, 0, 0}, scatter{"between lengths", "N", 0, 0, 1, 0};
  AxialShare length{"length", "m", 0, setup.length_std_m.value_or(0), 0, 0};
  for (Eigen::Index i = 0; i < n; ++i) {
    const Length& one = model.lengths[static_cast<std::size_t>(i)];
    const double part = std::pow(one.scatter / one.std, 2), own = gain[n + kShared + i];
    frequency.variance += (1 - part) * gain[i] * gain[i];
    scatter.variance += part * gain[i] * gain[i];
    length.value += one.length_m / static_cast<double>(n);
    length.by_input += own / (relative({one.length_m, length.std}) * one.length_m);
    if (length.std > 0) length.variance += own * own;
  }
  fit.shares = {frequency, scatter, length};
  const auto add = [&](Shared which, const char* source, const char* unit,
                       const signal::Estimate& input, double step) {
    const double g = gain[n + which];
    if (!(step > 0)) return;
    fit.shares.push_back(
        {source, unit, input.value, input.std, g / step, input.std > 0 ? g * g : 0});
  };
  const auto value = [&](Shared which, const char* source, const char* unit,
                         const signal::Estimate& input) {
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
}

}  // namespace

RodStiffness rod_of(const AxialSetup& setup, double omega_squared, double length) {
  return rod_stiffness({omega_squared, setup.mass_kg.value, setup.mass_per_length_kg_m.value,
                        length, setup.adapter_stiffness_N_m.value,
                        setup.frame_stiffness_N_m.value});
}

AxialFit fit_axial(std::span<const AxialLengthData> data, const AxialSetup& setup, bool series,
                   double between_std) {
  std::vector<Length> lengths;
  double unit = 0, squares = 0;                       // m/N; of lengths, m2
  Eigen::Vector4d moments = Eigen::Vector4d::Zero();  // sums of 1, L, 1 / k, L / k
  Eigen::VectorXd z = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(kShared + data.size()));
  for (const auto& one : data) {
    Length length{one};
    length.W = std::exp(one.log_omega_squared);
    const auto rod = rod_of(setup, length.W, one.length_m);
    length.scatter = between_std / rod.by_omega_squared;
    length.std = std::hypot(std::max(one.log_omega_squared_std, kLeastStd), length.scatter);
    const ceres::Jet<double, 1> W(length.W, 0);
    const auto chain = told_chain(setup, rod.cable_N_m, W, one.length_m);
    length.residual_std = (1 + length.W * chain.v[0] / chain.a) * length.std;
    if (lengths.empty()) unit = 1 / rod.cable_N_m, z[kLogEA] = std::log(one.length_m / unit);
    lengths.push_back(length);
    moments += Eigen::Vector4d(1, one.length_m, 1 / rod.cable_N_m, one.length_m / rod.cable_N_m);
    squares += one.length_m * one.length_m;
  }
  // From the straight line of compliance over length: far from it the compliance's place would run
  // to one of the ends and stay.
  const double slope = (moments[0] * moments[3] - moments[1] * moments[2]) /
                       (moments[0] * squares - moments[1] * moments[1]);
  if (series && slope > 0) {
    z[kLogEA] = -std::log(slope);
    z[kSeries] = (moments[2] - slope * moments[1]) / (moments[0] * unit);
  }
  AxialFit fit;
  fit.between_std = between_std;
  const auto n = static_cast<Eigen::Index>(lengths.size()), rows = n + z.size();
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
  Eigen::VectorXd residuals(rows);
  const double* const at = z.data();
  double* by = J.data();
  (void)cost->Evaluate(&at, residuals.data(), &by);
  const Eigen::MatrixXd gains = J.householderQr().solve(Eigen::MatrixXd::Identity(rows, rows));
  if (series) {
    fit.compliance_m_N = {unit * z[kSeries], unit * gains.row(kSeries).norm()};
  }
  add_shares(*model, gains.row(kLogEA), fit);
  double variance = 0;  // without what stands in for exact inputs
  for (const auto& share : fit.shares) variance += share.variance;
  fit.EA_relative_std = std::sqrt(variance);
  fit.converged = std::isfinite(fit.EA_relative_std) && fit.EA_N > 0;
  return fit;
}

}  // namespace rigfit::ident
