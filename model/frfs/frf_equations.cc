#include "model/frfs/frf_equations.h"

#include <Eigen/LU>

#include "model/linear/damped_modes.h"
#include "model/linear/segment_extrapolation.h"
#include "model/scene/sensor_quantity.h"

namespace rigfit::model {

namespace {

/// Real parts above imaginary parts.
Map<Eigen::Matrix2Xd> real_rows(Ref<VectorXcd> x) {
  return {reinterpret_cast<double*>(x.data()), 2, x.size()};
}

}  // namespace

Complex laplace_variable(double frequency_hz, double decay_rate_1_s) {
  return {decay_rate_1_s, 2 * M_PI * frequency_hz};
}

Complex quantity_factor(Sensor::Quantity quantity, Complex s) {
  const int derivatives = described(quantity).derivatives;
  return derivatives == 0 ? Complex(1) : derivatives == 1 ? s : s * s;
}

FrfEquations frf_equations(const MotionModes& motion, const ChainState& state, const Scene& scene) {
  FrfEquations out;
  out.motion = &motion;
  out.damping = motion.assembly->matrix();
  motion.assembly->damping(state, out.damping);
  out.sensors = sensor_rows(*motion.assembly, state, scene);
  out.loads = load_rows(*motion.assembly);
  out.dampers.resize(out.loads.rows(), 0);
  if (motion.omega2.size() > 0) {
    out.zeta = modal_ratios(*motion.assembly, motion.shapes, state, scene);
    out.dampers = motion.mass * motion.shapes;
  }
  return out;
}

FrfSolver::FrfSolver(const FrfEquations& equations, const MatrixXd& right, double farthest)
    : equations_(equations),
      wanted_(right.cols()),
      joint_(!equations.damping.values().isZero(0)),
      dynamic_(equations.motion->stiffness.envelope()),
      gain_(equations.zeta.size()) {
  const Index dampers = equations.zeta.size();
  right_.resize(right.rows(), wanted_ + dampers);
  right_.leftCols(wanted_) = right.cast<Complex>();
  right_.rightCols(dampers) = equations.dampers.cast<Complex>();
  solution_.resize(right.rows(), wanted_);
  if (dampers == 0 || joint_) return;
  modal_ = equations.motion->shapes.transpose() * right;
  expand(right - equations.dampers * modal_, farthest);
}

void FrfSolver::expand(const MatrixXd& outside, double farthest) {
  const MotionModes& motion = *equations_.motion;
  EnvelopeFactor stiffness;
  stiffness.factor(motion.stiffness);
  std::vector<MatrixXd> terms;
  double size = 1, first = 0;
  while (size > 1e-14 * first) {
    const auto k = terms.size();
    if (k == 64) return;
    MatrixXd term = k > 0 ? motion.mass * terms.back() : outside;
    stiffness.solve_in_place(term);
    // Rounding along the modes, which would grow by (|s| / omega_r)^2 a term, is taken out.
    term -= motion.shapes * (equations_.dampers.transpose() * term);
    size = term.norm() * std::pow(farthest, 2 * static_cast<double>(k));
    if (k == 0) first = size;
    terms.push_back(std::move(term));
  }
  const auto count = std::ssize(terms);
  parts_.resize(count + gain_.size());
  for (Index c = 0; c < wanted_; ++c) {
    auto& basis = basis_.emplace_back(parts_.size(), outside.rows());
    for (Index k = 0; k < count; ++k) {
      basis.row(k) = terms[static_cast<std::size_t>(k)].col(c).transpose();
    }
    basis.bottomRows(gain_.size()) = motion.shapes.transpose();
  }
}

const MatrixXcd& FrfSolver::solve(Complex s) {
  const MotionModes& motion = *equations_.motion;
  for (Index r = 0; r < gain_.size(); ++r) {
    gain_[r] = 2 * equations_.zeta[r] * std::sqrt(motion.omega2[r]) * s;
  }
  if (basis_.empty()) {
    solve_jointly(s);
  } else {
    solve_by_modes(s);
  }
  return solution_;
}

void FrfSolver::solve_jointly(Complex s) {
  const MotionModes& motion = *equations_.motion;
  dynamic_.values() = motion.stiffness.values().cast<Complex>() + s * s * motion.mass.values();
  if (joint_) dynamic_.values() += s * equations_.damping.values();
  factor_.factor(dynamic_);
  MatrixXcd all = right_;
  factor_.solve_in_place(all);
  solution_ = all.leftCols(wanted_);
  const Index dampers = gain_.size();
  if (dampers == 0 || s == Complex(0)) return;
  // (D + B G B')^-1 = D^-1 - D^-1 B (I + G B' D^-1 B)^-1 G B' D^-1.
  const auto b = right_.rightCols(dampers);
  const auto db = all.rightCols(dampers);
  small_ = gain_.asDiagonal() * (b.transpose() * db);
  small_.diagonal().array() += Complex(1);
  const MatrixXcd part = gain_.asDiagonal() * (b.transpose() * solution_);
  solution_ -= db * small_.partialPivLu().solve(part);
}

void FrfSolver::solve_by_modes(Complex s) {
  const auto dampers = gain_.size();
  parts_[0] = 1;
  for (Index k = 1; k < parts_.size() - dampers; ++k) parts_[k] = -s * s * parts_[k - 1];
  for (Index c = 0; c < wanted_; ++c) {
    for (Index r = 0; r < dampers; ++r) {
      parts_.tail(dampers)[r] = modal_(r, c) / (equations_.motion->omega2[r] + s * s + gain_[r]);
    }
    real_rows(solution_.col(c)).noalias() = real_rows(parts_) * basis_[static_cast<std::size_t>(c)];
  }
}

ChainModes frf_modes(const Scene& scene, const VectorXd& frequency_hz,
                     const ModesOptions& options) {
  ModesOptions wanted = options;
  const bool ratios = std::any_of(scene.members.begin(), scene.members.end(),
                                  [](const Member& m) { return m.damping_ratio.value_or(0) > 0; });
  const double highest = frequency_hz.size() > 0 ? frequency_hz.maxCoeff() : 0;
  wanted.band_hz = {0.0, 2 * highest};
  std::vector<int> segments;
  bool choose = false;
  for (const Member& member : scene.members) {
    segments.push_back(options.segments ? *options.segments : member.segments);
    choose = choose || segments.back() <= 0;
  }
  if (choose && highest > 0) {
    ModesOptions asked = options;
    asked.band_hz = {0.0, highest};
    const ResolvedModes choice = choose_segments(scene, asked);
    // Without a mode among the lines there is nothing to choose by: the default.
    if (!choice.modes.order.empty()) segments = choice.modes.chain->segment_counts();
  }
  return ratios && highest > 0 ? find_modes(scene, wanted, segments)
                               : prepare_motions(scene, wanted, segments);
}

}  // namespace rigfit::model
