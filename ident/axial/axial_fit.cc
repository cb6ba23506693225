#include "ident/axial/axial_fit.h"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "ident/axial/rod_stiffness.h"

namespace rigfit::ident {
namespace {

using Eigen::Index;

// Parameters that the lengths share; each length has its own error besides.
enum Shared { kLogEA, kSeries, kPlace, kMass, kPerLength, kAdapter, kFrame, kRate, kShared };

// Least std of ln W: no clock of a logger is known to more than some 5 ppm.
constexpr double kLeastStd = 1e-5;

// An input known exactly still has a sensitivity.
double relative(const signal::Estimate& input) {
  return input.value > 0 ? std::max(input.std / input.value, 1e-7) : 0;
}

// Error of ln W of one length in standard deviations.
struct Residual {
  const AxialSetup* setup;
  double W, length, compliance_unit, std;

  template <class T>
  bool operator()(const T* log_EA, const T* series, const T* place, const T* mass,
                  const T* per_length, const T* adapter, const T* frame, const T* rate,
                  const T* own, T* residual) const {
    using std::exp, std::log, std::erf;
    const AxialSetup& s = *setup;
    const auto input = [](const signal::Estimate& x, const T& z) {
      return x.value * exp(relative(x) * z);
    };
    const T L = length * exp(relative({length, s.length_std_m.value_or(0)}) * *own);
    const T W_true = W * exp(2 * std::max(s.rate_relative_std, 1e-7) * *rate);
    const T kc = exp(*log_EA) / L, share = 0.5 + 0.5 * erf(*place * std::sqrt(0.5));
    T above = (1.0 - share) * compliance_unit * *series;
    T below = share * compliance_unit * *series;
    if (s.frame_stiffness_N_m.value > 0) above += 1.0 / input(s.frame_stiffness_N_m, *frame);
    if (s.adapter_stiffness_N_m.value > 0) below += 1.0 / input(s.adapter_stiffness_N_m, *adapter);
    const T inertia = W_true * input(s.mass_per_length_kg_m, *per_length) * L;
    const T compliance = rod_compliance(kc, inertia, above) + below;
    if (!(compliance > 0.0) || !(inertia < 2.4 * kc)) return false;  // beyond the first mode
    *residual = log(W_true * input(s.mass_kg, *mass) * compliance) / std;
    return true;
  }
};

struct Prior {
  double scale;
  template <class T>
  bool operator()(const T* z, T* residual) const {
    *residual = scale * *z;
    return true;
  }
};

class Problem {
 public:
  Problem(std::span<const AxialLengthData> lengths, const AxialSetup& setup, bool series,
          double between_std)
      : lengths_(lengths), setup_(setup), own_(lengths.size(), 0) {
    const auto& first = lengths.front();
    const auto cable = [&](const AxialLengthData& one) {
      return rod_stiffness({std::exp(one.log_omega_squared), setup.mass_kg.value,
                            setup.mass_per_length_kg_m.value, one.length_m,
                            setup.adapter_stiffness_N_m.value, setup.frame_stiffness_N_m.value});
    };
    shared_[kLogEA] = std::log(cable(first).cable_N_m * first.length_m);
    unit_ = first.length_m / std::exp(shared_[kLogEA]);
    for (std::size_t i = 0; i < lengths.size(); ++i) {
      const auto rod = cable(lengths[i]);
      const double W = std::exp(lengths[i].log_omega_squared);
      // Scatter of ln EA, as one of ln W; and what an error of ln W is in the residual.
      scatter_.push_back(between_std / rod.by_omega_squared);
      std_.push_back(
          std::hypot(std::max(lengths[i].log_omega_squared_std, kLeastStd), scatter_.back()));
      const double by_W = 1 + (std::log(chain(rod.cable_N_m, W * 1.0001, lengths[i].length_m)) -
                               std::log(chain(rod.cable_N_m, W / 1.0001, lengths[i].length_m))) /
                                  (2 * std::log(1.0001));
      double* const z = shared_.data();
      rows_.push_back(problem_.AddResidualBlock(
          new ceres::AutoDiffCostFunction<Residual, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1>(
              new Residual{&setup_, W, lengths[i].length_m, unit_, by_W * std_.back()}),
          nullptr, z, z + kSeries, z + kPlace, z + kMass, z + kPerLength, z + kAdapter, z + kFrame,
          z + kRate, &own_[i]));
    }
    free_.push_back(&shared_[kLogEA]);
    const auto& known = setup.series_compliance_std_m_N;
    parameter(kSeries, series, known ? unit_ / *known : 0);
    parameter(kPlace, series, 1);
    parameter(kMass, true, 1);
    parameter(kPerLength, setup.mass_per_length_kg_m.value > 0, 1);
    parameter(kAdapter, setup.adapter_stiffness_N_m.value > 0, 1);
    parameter(kFrame, setup.frame_stiffness_N_m.value > 0, 1);
    parameter(kRate, true, 1);
    for (double& own : own_) prior(&own, 1);
    degrees_ = static_cast<int>(lengths.size()) - 1 - (series && !known ? 1 : 0);
  }

  AxialFit solve() {
    AxialFit fit;
    fit.degrees = degrees_;
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.logging_type = ceres::SILENT;
    options.max_num_iterations = 200;
    options.function_tolerance = options.parameter_tolerance = 1e-14;
    options.gradient_tolerance = 1e-15;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    if (!summary.IsSolutionUsable()) return fit;
    fit.EA_N = std::exp(shared_[kLogEA]);
    fit.chi2 = 2 * summary.final_cost;
    uncertainty(fit);
    fit.converged = std::isfinite(fit.EA_relative_std) && fit.EA_N > 0;
    return fit;
  }

 private:
  // Compliance under the mass of a rod that is told.
  [[nodiscard]] double chain(double kc, double W, double length) const {
    const double frame = setup_.frame_stiffness_N_m.value;
    const double adapter = setup_.adapter_stiffness_N_m.value;
    return rod_compliance(kc, W * setup_.mass_per_length_kg_m.value * length,
                          frame > 0 ? 1 / frame : 0) +
           (adapter > 0 ? 1 / adapter : 0);
  }
  void parameter(Shared which, bool present, double scale) {
    if (!present) return problem_.SetParameterBlockConstant(&shared_[which]);
    prior_row_[which] = prior(&shared_[which], scale);
  }
  // The row of a prior; -1 for a parameter that has none.
  Index prior(double* z, double scale) {
    free_.push_back(z);
    if (!(scale > 0)) return -1;
    rows_.push_back(problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Prior, 1, 1>(new Prior{scale}), nullptr, z));
    return static_cast<Index>(rows_.size()) - 1;
  }

  // Every residual has unit variance: ln EA moves with it by the first row of (J'J)^-1 J'.
  void uncertainty(AxialFit& fit) {
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = free_, options.residual_blocks = rows_;
    ceres::CRSMatrix sparse;
    problem_.Evaluate(options, nullptr, nullptr, nullptr, &sparse);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
    for (int r = 0; r < sparse.num_rows; ++r) {
      const auto row = static_cast<std::size_t>(r);
      for (int k = sparse.rows[row]; k < sparse.rows[row + 1]; ++k) {
        J(r, sparse.cols[static_cast<std::size_t>(k)]) = sparse.values[static_cast<std::size_t>(k)];
      }
    }
    const Eigen::MatrixXd gains =
        J.householderQr().solve(Eigen::MatrixXd::Identity(J.rows(), J.rows()));
    const Eigen::VectorXd gain = gains.row(0);
    const bool series = free_.size() > 1 && free_[1] == &shared_[kSeries];
    if (series) {
      fit.compliance_m_N = {unit_ * shared_[kSeries], unit_ * gains.row(1).norm()};
    }
    const auto n = static_cast<Index>(lengths_.size());
    AxialShare frequency{"frequency", "Hz", 0, 0, 0, 0},
        scatter{"between lengths", "N", 0, 0, 1, 0};
    AxialShare length{"length", "m", 0, setup_.length_std_m.value_or(0), 0, 0};
    for (Index i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double part = std::pow(scatter_[k] / std_[k], 2);
      frequency.variance += (1 - part) * gain[i] * gain[i];
      scatter.variance += part * gain[i] * gain[i];
      const double relative_std = relative({lengths_[k].length_m, setup_.length_std_m.value_or(0)});
      const double by = gain[J.rows() - n + i] / (relative_std * lengths_[k].length_m);
      length.value += lengths_[k].length_m / static_cast<double>(n);
      length.by_input += by;
      if (length.std > 0) length.variance += std::pow(gain[J.rows() - n + i], 2);
    }
    fit.shares = {frequency, scatter, length};
    const auto add = [&](Shared which, const char* source, const char* unit,
                         const signal::Estimate& input, double step) {
      if (prior_row_[which] < 0) return;
      const double g = gain[prior_row_[which]];
      fit.shares.push_back(
          {source, unit, input.value, input.std, g / step, input.std > 0 ? g * g : 0});
    };
    const auto value = [&](Shared which, const char* source, const char* unit,
                           const signal::Estimate& input) {
      add(which, source, unit, input, relative(input) * input.value);
    };
    value(kMass, "hung mass", "kg", setup_.mass_kg);
    value(kPerLength, "cable mass per length", "kg/m", setup_.mass_per_length_kg_m);
    value(kAdapter, "adapter stiffness", "N/m", setup_.adapter_stiffness_N_m);
    value(kFrame, "frame stiffness", "N/m", setup_.frame_stiffness_N_m);
    add(kRate, "sample rate", "1", {1, setup_.rate_relative_std},
        std::max(setup_.rate_relative_std, 1e-7));
    if (series) {
      const double known = setup_.series_compliance_std_m_N.value_or(0);
      add(kSeries, "compliance in series", "m/N", {0, known}, known);
      add(kPlace, "place of the compliance", "1", {0.5, std::sqrt(1.0 / 12)}, std::sqrt(1.0 / 12));
    }
    double variance = 0;  // without what stands in for exact inputs
    for (const auto& share : fit.shares) variance += share.variance;
    fit.EA_relative_std = std::sqrt(variance);
  }

  std::span<const AxialLengthData> lengths_;
  const AxialSetup& setup_;
  std::array<double, kShared> shared_{};
  std::vector<double> own_, std_, scatter_;
  std::array<Index, kShared> prior_row_{-1, -1, -1, -1, -1, -1, -1, -1};
  ceres::Problem problem_;
  std::vector<double*> free_;
  std::vector<ceres::ResidualBlockId> rows_;
  double unit_ = 0;
  int degrees_ = 0;
};

}  // namespace

AxialFit fit_axial(std::span<const AxialLengthData> lengths, const AxialSetup& setup, bool series,
                   double between_std) {
  AxialFit fit = Problem(lengths, setup, series, between_std).solve();
  fit.between_std = between_std;
  return fit;
}

}  // namespace rigfit::ident
