#include "ident/axial/axial_fit.h"

#include <ceres/ceres.h>
#include <ceres/jet.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "ident/axial/axial_result.h"

namespace rigfit::ident {
namespace {

using Eigen::Index;

// What one length's frequency depends on; the columns of the fit in this order, then those that
// each length has by itself.
enum Shared { kLogEA, kSeries, kMass, kPerLength, kAdapter, kFrame, kPlace, kSharedInputs };
enum Own { kLength = kSharedInputs, kBetween, kInputs };

// Of the place of the compliance: most of it is either the adapter's or the frame's.
constexpr double kPlaceStd = 0.5;

template <class T>
T tangent_ratio(const T& q) {  // tan(x) / x, x^2 = q
  using std::sqrt, std::tan;
  if (q < 1e-4) return 1.0 + q / 3.0 + q * q * (2.0 / 15);  // next term below 1e-13
  const T x = sqrt(q);
  return tan(x) / x;
}

struct Point {  // values of the inputs of one length
  double omega_squared = 0, compliance_unit = 0;
  double mass = 0, mass_rel = 0, per_length = 0, per_length_std = 0, adapter = 0, adapter_rel = 0;
  double frame = 0, frame_rel = 0;
  double length = 0, length_rel = 0, between = 0;

  // ln(W M / K(W)): zero where W is the frequency squared. Nuisance inputs in standard deviations.
  template <class T>
  T misfit(const T* z, double W) const {
    using std::exp, std::log;
    const T kc_EA = exp(z[kLogEA] + between * z[kBetween]);
    const T L = length * exp(length_rel * z[kLength]);
    const T kc = kc_EA / L;
    const T s = compliance_unit * z[kSeries];
    const T place = 0.5 + kPlaceStd * z[kPlace];
    const T q = W * (per_length + per_length_std * z[kPerLength]) * L / kc;
    const T t = tangent_ratio(q);
    T above = (1.0 - place) * s;
    if (frame > 0) above += exp(-frame_rel * z[kFrame]) / frame;
    const T r = kc * above;
    T compliance = (t + r) / (kc * (1.0 - q * t * r)) + place * s;
    if (adapter > 0) compliance += exp(-adapter_rel * z[kAdapter]) / adapter;
    return log(W * mass * exp(mass_rel * z[kMass]) * compliance);
  }
};

using Jet = ceres::Jet<double, kInputs>;

class Problem {
 public:
  Problem(std::span<const AxialLengthData> lengths, const AxialSetup& setup, bool series,
          double between, double start_EA)
      : setup_(setup), series_(series), between_(between) {
    const double k = start_EA / lengths.front().length_m;
    for (const auto& one : lengths) {
      Point p;
      p.omega_squared = std::exp(one.log_omega_squared);
      p.compliance_unit = 1 / k;
      p.mass = setup.mass_kg.value, p.mass_rel = setup.mass_kg.std / setup.mass_kg.value;
      p.per_length = setup.mass_per_length_kg_m.value;
      p.per_length_std = setup.mass_per_length_kg_m.std;
      p.adapter = setup.adapter_stiffness_N_m.value;
      if (p.adapter > 0) p.adapter_rel = setup.adapter_stiffness_N_m.std / p.adapter;
      p.frame = setup.frame_stiffness_N_m.value;
      if (p.frame > 0) p.frame_rel = setup.frame_stiffness_N_m.std / p.frame;
      p.length = one.length_m, p.length_rel = setup.length_std_m / one.length_m;
      p.between = between;
      points_.push_back(p);
      // Where neither records nor inputs have any uncertainty, equal weights.
      std_.push_back(std::max(one.log_omega_squared_std, 1e-12));
    }
    column(kLogEA, true), column(kSeries, series);
    column(kMass, points_[0].mass_rel > 0), column(kPerLength, points_[0].per_length_std > 0);
    column(kAdapter, points_[0].adapter_rel > 0), column(kFrame, points_[0].frame_rel > 0);
    column(kPlace, series);
    columns_ = shared_columns_;
    if (setup.length_std_m > 0) own_[0] = columns_, columns_ += count();
    if (between > 0) own_[1] = columns_, columns_ += count();
    start_ = Eigen::VectorXd::Zero(columns_);
    start_[0] = std::log(start_EA);
    // ln W of the model less that which was measured is -misfit over its slope by ln W.
    for (const auto& p : points_) {
      constexpr double h = 1e-4;
      double z[kInputs] = {};
      z[kLogEA] = start_[0];
      slope_.push_back(
          (p.misfit(z, p.omega_squared * (1 + h)) - p.misfit(z, p.omega_squared * (1 - h))) /
          (2 * h));
    }
  }

  [[nodiscard]] Index count() const { return static_cast<Index>(points_.size()); }
  [[nodiscard]] Index columns() const { return columns_; }
  [[nodiscard]] Index residuals() const { return count() + columns_ - 1 - (free_series() ? 1 : 0); }
  [[nodiscard]] bool free_series() const {
    return series_ && !setup_.series_compliance_std_m_N.has_value();
  }
  [[nodiscard]] const Eigen::VectorXd& start() const { return start_; }
  [[nodiscard]] double compliance_unit() const { return points_[0].compliance_unit; }
  [[nodiscard]] Index shared(int input) const { return shared_[input]; }
  [[nodiscard]] Index own(int input) const { return own_[input - kLength]; }
  // Row of the prior of a column; a compliance that is free has none.
  [[nodiscard]] Index prior_row(Index column) const {
    return count() + column - 1 - (free_series() && column > shared_[kSeries] ? 1 : 0);
  }

  // Rows: a frequency a length, then the priors in the order of the columns.
  void evaluate(const double* x, double* residuals, Eigen::MatrixXd* jacobian) const {
    if (jacobian) jacobian->setZero(this->residuals(), columns_);
    for (Index i = 0; i < count(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      Jet z[kInputs];
      std::array<Index, kInputs> at{};
      for (int j = 0; j < kInputs; ++j) {
        at[j] = j < kSharedInputs ? shared_[j] : own_[j - kLength] < 0 ? -1 : own_[j - kLength] + i;
        z[j] = Jet(at[j] < 0 ? 0 : x[at[j]], j);
      }
      const Jet r = -points_[k].misfit(z, points_[k].omega_squared) / (slope_[k] * std_[k]);
      residuals[i] = r.a;
      if (!jacobian) continue;
      for (int j = 0; j < kInputs; ++j) {
        if (at[j] >= 0) (*jacobian)(i, at[j]) = r.v[j];
      }
    }
    for (Index c = 1; c < columns_; ++c) {
      if (c == shared_[kSeries] && free_series()) continue;
      const double scale =
          c == shared_[kSeries] ? compliance_unit() / *setup_.series_compliance_std_m_N : 1;
      residuals[prior_row(c)] = scale * x[c];
      if (jacobian) (*jacobian)(prior_row(c), c) = scale;
    }
  }

 private:
  void column(int input, bool present) { shared_[input] = present ? shared_columns_++ : -1; }

  const AxialSetup& setup_;
  bool series_;
  double between_;
  std::vector<Point> points_;
  std::vector<double> std_, slope_;
  std::array<Index, kSharedInputs> shared_{};
  std::array<Index, 2> own_{-1, -1};  // first column of lengths, of scatter
  Index shared_columns_ = 0, columns_ = 0;
  Eigen::VectorXd start_;
};

class Cost : public ceres::CostFunction {
 public:
  explicit Cost(const Problem& problem) : problem_(problem) {
    set_num_residuals(static_cast<int>(problem.residuals()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.columns()));
  }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    Eigen::MatrixXd jacobian;
    const bool wanted = jacobians && jacobians[0];
    problem_.evaluate(blocks[0], residuals, wanted ? &jacobian : nullptr);
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    if (wanted) Eigen::Map<Rows>(jacobians[0], jacobian.rows(), jacobian.cols()) = jacobian;
    for (Index i = 0; i < problem_.residuals(); ++i) {
      if (!std::isfinite(residuals[i])) return false;
    }
    return true;
  }

 private:
  const Problem& problem_;
};

// Where the uncertainty of ln EA comes from: every residual has unit variance, and ln EA moves by
// the entry of (J'J)^-1 J' when it does.
void contributions(const Problem& problem, const Eigen::VectorXd& x, AxialFit& fit) {
  Eigen::VectorXd residuals(problem.residuals());
  Eigen::MatrixXd jacobian;
  problem.evaluate(x.data(), residuals.data(), &jacobian);
  // By QR: the rows may differ by the inverse of the machine's precision.
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(jacobian);
  const Index p = problem.columns();
  const auto row_of = [&](Index parameter) -> Eigen::VectorXd {
    Eigen::VectorXd y = Eigen::VectorXd::Zero(jacobian.rows());
    y.head(p) = qr.matrixQR().topRows(p).triangularView<Eigen::Upper>().transpose().solve(
        Eigen::VectorXd::Unit(p, parameter));
    return qr.householderQ() * y;
  };
  const Eigen::VectorXd gain = row_of(0);
  fit.EA_relative_std = gain.norm();
  if (fit.series) {
    const Index s = problem.shared(kSeries);
    fit.compliance_m_N = problem.compliance_unit() * x[s];
    fit.compliance_std_m_N = problem.compliance_unit() * row_of(s).norm();
  }
  const auto add = [&](const char* source, Index column, Index number) {
    const double variance =
        column < 0 ? 0 : gain.segment(problem.prior_row(column), number).squaredNorm();
    fit.contributions.push_back({source, variance});
  };
  const Index n = problem.count();
  fit.contributions.push_back({"frequency", gain.head(n).squaredNorm()});
  add("hung mass", problem.shared(kMass), 1);
  add("cable mass per length", problem.shared(kPerLength), 1);
  add("length", problem.own(kLength), n);
  add("adapter stiffness", problem.shared(kAdapter), 1);
  add("frame stiffness", problem.shared(kFrame), 1);
  add("place of the compliance", problem.shared(kPlace), 1);
  add("compliance in series", problem.free_series() ? -1 : problem.shared(kSeries), 1);
  add("between lengths", problem.own(kBetween), n);
  fit.between_variance = fit.contributions.back().variance;
}

}  // namespace

AxialFit fit_axial(std::span<const AxialLengthData> lengths, const AxialSetup& setup, bool series,
                   double between_std, double start_EA_N) {
  AxialFit fit;
  fit.series = series, fit.between_std = between_std;
  const Problem problem(lengths, setup, series, between_std, start_EA_N);
  Eigen::VectorXd x = problem.start();
  ceres::Problem ceres_problem;
  ceres_problem.AddResidualBlock(new Cost(problem), nullptr, x.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 200;
  options.function_tolerance = options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 1e-15;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  const int free = problem.free_series() ? 2 : 1;
  fit.degrees = static_cast<int>(lengths.size()) - free;
  if (!summary.IsSolutionUsable() || !x.allFinite()) return fit;
  fit.EA_N = std::exp(x[0]);
  fit.chi2 = 2 * summary.final_cost;
  contributions(problem, x, fit);
  fit.converged = std::isfinite(fit.EA_relative_std) && fit.EA_N > 0;
  fit.log_likelihood = -0.5 * fit.chi2;
  for (const auto& one : lengths) {  // variance of ln EA of one length, without and with scatter
    const double own = std::pow(std::max(one.log_omega_squared_std, 1e-12), 2) +
                       std::pow(setup.length_std_m / one.length_m, 2);
    fit.log_likelihood -= 0.5 * std::log1p(between_std * between_std / own);
  }
  return fit;
}

AxialFit fit_axial_with_scatter(std::span<const AxialLengthData> lengths, const AxialSetup& setup,
                                const AxialFit& without) {
  if (!without.converged || without.degrees < 1 || without.chi2 <= without.degrees) return without;
  const auto at = [&](double between) {
    return fit_axial(lengths, setup, without.series, between, without.EA_N);
  };
  double low = 0, high = 1e-3;
  AxialFit fit = at(high);
  for (int k = 0; k < 24 && fit.chi2 > fit.degrees; ++k) low = high, high *= 2, fit = at(high);
  for (int k = 0; k < 60 && high - low > 1e-6 * high; ++k) {
    const double middle = 0.5 * (low + high);
    fit = at(middle);
    (fit.chi2 > fit.degrees ? low : high) = middle;
  }
  return at(high);
}

}  // namespace rigfit::ident
