#include "model/frfs/frf_equations.h"

#include <Eigen/LU>
#include <cmath>

#include "model/linear/damped_modes.h"
#include "model/scene/sensor_quantity.h"

namespace rigfit::model {

using Complex = std::complex<double>;

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
  const int n = motion.assembly->size();
  out.damping = motion.assembly->matrix();
  motion.assembly->damping(state, out.damping);
  out.sensors.resize(n, static_cast<Eigen::Index>(scene.sensors.size()));
  for (Eigen::Index s = 0; s < out.sensors.cols(); ++s) {
    out.sensors.col(s) = sensor_row(*motion.assembly, state, scene, int(s));
  }
  out.loads.resize(n, static_cast<Eigen::Index>(scene.loads.size()));
  for (Eigen::Index l = 0; l < out.loads.cols(); ++l) {
    out.loads.col(l) = load_row(*motion.assembly, int(l));
  }
  if (motion.omega2.size() > 0) out.zeta = modal_ratios(motion, state, scene);
  out.dampers.resize(n, out.zeta.size());
  for (Eigen::Index r = 0; r < out.zeta.size(); ++r) {
    out.dampers.col(r) = motion.mass * Eigen::VectorXd(motion.shapes.col(r));
  }
  return out;
}

FrfSolver::FrfSolver(const FrfEquations& equations, const Eigen::MatrixXd& right)
    : equations_(equations),
      wanted_(right.cols()),
      joint_(!equations.damping.values().isZero(0)),
      dynamic_(equations.motion->stiffness.envelope()),
      gain_(equations.zeta.size()),
      outside_(right) {
  const Eigen::Index dampers = equations.zeta.size();
  right_.resize(right.rows(), wanted_ + dampers);
  right_.leftCols(wanted_) = right.cast<Complex>();
  right_.rightCols(dampers) = equations.dampers.cast<Complex>();
  solution_.resize(right.rows(), wanted_);
  if (dampers == 0) return;
  modal_ = equations.motion->shapes.transpose() * right;
  outside_ -= equations.dampers * modal_;
}

const Eigen::MatrixXcd& FrfSolver::solve(Complex s) {
  const MotionModes& motion = *equations_.motion;
  for (Eigen::Index r = 0; r < gain_.size(); ++r) {
    gain_[r] = 2 * equations_.zeta[r] * std::sqrt(motion.omega2[r]) * s;
  }
  dynamic_.values() = motion.stiffness.values().cast<Complex>() + s * s * motion.mass.values();
  if (joint_) dynamic_.values() += s * equations_.damping.values();
  factor_.factor(dynamic_);
  if (joint_ || s == Complex(0)) {
    solve_jointly(s);
  } else {
    solve_by_modes(s);
  }
  return solution_;
}

void FrfSolver::solve_jointly(Complex s) {
  Eigen::MatrixXcd all = right_;
  factor_.solve_in_place(all);
  solution_ = all.leftCols(wanted_);
  const Eigen::Index dampers = gain_.size();
  if (dampers == 0 || s == Complex(0)) return;
  // (D + B G B')^-1 = D^-1 - D^-1 B (I + G B' D^-1 B)^-1 G B' D^-1.
  const auto b = right_.rightCols(dampers);
  const auto db = all.rightCols(dampers);
  small_ = gain_.asDiagonal() * (b.transpose() * db);
  small_.diagonal().array() += Complex(1);
  const Eigen::MatrixXcd part = gain_.asDiagonal() * (b.transpose() * solution_);
  solution_ -= db * small_.partialPivLu().solve(part);
}

void FrfSolver::solve_by_modes(Complex s) {
  const MotionModes& motion = *equations_.motion;
  solution_ = outside_.cast<Complex>();
  factor_.solve_in_place(solution_);
  if (gain_.size() == 0) return;
  // Near a damped mode's frequency the matrix is nearly singular along it: rounding is taken out.
  small_ = modal_.cast<Complex>();
  for (Eigen::Index r = 0; r < gain_.size(); ++r) {
    small_.row(r) /= motion.omega2[r] + s * s + gain_[r];
  }
  small_.noalias() -= equations_.dampers.transpose().cast<Complex>() * solution_;
  solution_.noalias() += motion.shapes.cast<Complex>() * small_;
}

}  // namespace rigfit::model
