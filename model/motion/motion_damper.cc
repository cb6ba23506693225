#include "model/motion/motion_damper.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/motion/vector_loops.h"

namespace rigfit::model {
namespace {

constexpr double kGamma = 1 - std::numbers::sqrt2 / 2;
constexpr double kTurn = 2e-3;  // turn of a segment after which C is renewed, rad

}  // namespace

template <int D>
MotionDamper<D>::MotionDamper(const MotionProblem& problem, const MotionKernel<D>& kernel)
    : problem_(problem),
      kernel_(kernel),
      assembly_(kernel.assembly()),
      mass_(assembly_.matrix()),
      joints_(problem.joint_damping),
      modal_(!problem.modal_damping.none()) {
  if (!active()) return;
  const int n = assembly_.size();
  u_.setZero(n);
  w_.setZero(n);
  assembly_.mass(mass_);
  if (modal_) {
    const ModalDamping& damping = problem.modal_damping;
    momentum_.resize(n, damping.shapes.cols());
    for (Eigen::Index r = 0; r < momentum_.cols(); ++r) {
      mass_.multiply(damping.shapes.col(r), w_);
      momentum_.col(r) = w_;
    }
  }
  if (joints_) damping_ = system_ = assembly_.matrix();
}

template <int D>
const Eigen::MatrixXd& MotionDamper<D>::decay(double time) {
  for (const Decay& known : decays_) {
    if (known.time == time) return known.matrix;
  }
  const ModalDamping& damping = problem_.modal_damping;
  Eigen::VectorXd lost(damping.rate.size());
  for (Eigen::Index r = 0; r < lost.size(); ++r) lost(r) = std::expm1(-damping.rate(r) * time);
  decays_.push_back({time, damping.shapes * lost.asDiagonal() * momentum_.transpose()});
  return decays_.back().matrix;
}

template <int D>
void MotionDamper<D>::apply(double time, const Entries& positions,
                            Eigen::Ref<Eigen::VectorXd> velocities) {
  if (modal_) {
    u_ = kernel_.unknowns(velocities);
    const Eigen::MatrixXd& matrix = decay(time);
    w_ = u_;
    add_product(static_cast<int>(matrix.rows()), static_cast<int>(matrix.cols()), matrix.data(),
                u_.data(), w_.data());
    velocities = kernel_.entry_values(w_);
  }
  if (joints_) damp_joints(time, positions, velocities);
}

// Largest angle between a segment's directions in two places of the chain: the difference of its
// nodes' moves over its length.
template <int D>
double MotionDamper<D>::turn(const Entries& from, const Entries& to) const {
  const int entries = kernel_.entries();
  double largest = 0;
  for (const auto& [a, b] : kernel_.segment_entries()) {
    double length = 0, moved = 0;
    for (int c = 0; c < D; ++c) {
      const int i = c * entries + a, j = c * entries + b;
      const double now = to(j) - to(i), then = from(j) - from(i);
      length += now * now;
      moved += (now - then) * (now - then);
    }
    if (moved > largest * length && length > 0) largest = moved / length;
  }
  return std::sqrt(largest);
}

template <int D>
void MotionDamper<D>::damp_joints(double time, const Entries& positions,
                                  Eigen::Ref<Eigen::VectorXd> velocities) {
  if (damped_at_.size() == 0 || turn(damped_at_, positions) > kTurn) {
    // In the middle of the way that it will be used on: its errors before and after cancel.
    damped_at_ = positions + time * velocities;
    const double ahead = turn(positions, damped_at_);
    const double steps = ahead > 0 ? std::min(20.0, 0.9 * kTurn / ahead) : 0;
    damped_at_ = positions + steps * time * velocities;
    assembly_.damping(kernel_.state(damped_at_), damping_);
    factors_.clear();
  }
  const EnvelopeFactor* factor = nullptr;
  for (const Factor& known : factors_) {
    if (known.time == time) factor = &known.factor;
  }
  if (!factor) {
    system_.values() = mass_.values() + kGamma * time * damping_.values();
    // Turning nodes without dampers have neither mass nor damping: they follow freely.
    double largest = 0;
    for (int i = 0; i < system_.size(); ++i) largest = std::max(largest, system_.at(i, i));
    for (int i = 0; i < system_.size(); ++i) {
      if (system_.at(i, i) == 0) system_.add(i, i, largest * 1e-12);
    }
    factors_.push_back({time, {}});
    factors_.back().factor.factor(system_);
    factor = &factors_.back().factor;
  }
  u_ = kernel_.unknowns(velocities);
  mass_.multiply(u_, w_);
  factor->solve_in_place(w_);
  // (w - v)/(gamma time) is the first stage's slope.
  u_ += (1 - kGamma) / kGamma * (w_ - u_);
  mass_.multiply(u_, w_);
  factor->solve_in_place(w_);
  velocities = kernel_.entry_values(w_);
}

template class MotionDamper<2>;
template class MotionDamper<3>;

}  // namespace rigfit::model
