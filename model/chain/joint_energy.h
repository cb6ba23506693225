// Derivatives of one joint's energy W = sum w_i (1 - a_i . b_i) between two sets of directors.
//
// With rotation vectors psi_A, psi_B of the two sides and S = sum w_i b_i a_i' (3 x 3):
//   dW/dpsi_A = -sum w_i a_i x b_i = -dW/dpsi_B
//   d2W/dpsi_A2 = d2W/dpsi_B2 = tr(S) I - (S + S') / 2,   d2W/dpsi_A dpsi_B = S - tr(S) I
// (second variation of a -> a + psi x a + psi x (psi x a) / 2). A segment's rotation vector follows
// from its edge increment de and twist theta (twist, then parallel transport) as
//   psi = t x de / |e| + theta t - (t . de)(t x de) / |e|^2 + theta de_normal / (2 |e|) + O(3).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "model/chain/chain.h"

namespace rigfit::model {

/// Weights w of the three director pairs.
inline Eigen::Vector3d director_weights(double about_1, double about_2, double torsion) {
  return 0.5 * Eigen::Vector3d(about_1 + about_2 - torsion, about_2 + torsion - about_1,
                               about_1 + torsion - about_2);
}

/// 1 - a . b = |a - b|^2 / 2 of unit vectors, without cancellation.
inline double joint_energy(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b,
                           const Eigen::Vector3d& w) {
  return 0.5 * w.dot((a - b).colwise().squaredNorm().transpose());
}

struct RotationDerivatives {
  Eigen::Vector3d gradient_b;   ///< gradient with respect to side B; that of side A is its negative
  Eigen::Matrix3d same, cross;  ///< d2/dA2 = d2/dB2; d2/dA dB (rows A)
};

inline RotationDerivatives joint_derivatives(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b,
                                             const Eigen::Vector3d& w) {
  RotationDerivatives d;
  const Eigen::Matrix3d s = b * w.asDiagonal() * a.transpose();
  // sum w a x b is the axial vector of S - S'.
  d.gradient_b << s(2, 1) - s(1, 2), s(0, 2) - s(2, 0), s(1, 0) - s(0, 1);
  const double trace = s.trace();
  d.same = -0.5 * (s + s.transpose());
  d.same.diagonal().array() += trace;
  d.cross = s;
  d.cross.diagonal().array() -= trace;
  return d;
}

/// Columns de (3), as t x de / |e| = [t] de / |e|, and twist of d psi.
inline Eigen::Matrix<double, 3, 4> segment_rotation(const Eigen::Vector3d& t, double length) {
  const Eigen::Vector3d f = t / length;
  Eigen::Matrix<double, 3, 4> j;
  j << 0, -f.z(), f.y(), t.x(), f.z(), 0, -f.x(), t.y(), -f.y(), f.x(), 0, t.z();
  return j;
}

/// Adds what the second-order part of psi gives to the Hessian in (de, twist), for a moment
/// `gradient` = dW/dpsi.
inline void add_second_order(const Eigen::Vector3d& gradient, const Eigen::Vector3d& t,
                             double length, Eigen::Matrix4d& hessian) {
  const Eigen::Vector3d c = gradient.cross(t) / (length * length);
  hessian.topLeftCorner<3, 3>() -= c * t.transpose() + t * c.transpose();
  const Eigen::Vector3d half = (gradient - t * t.dot(gradient)) / (2 * length);
  hessian.topRightCorner<3, 1>() += half;
  hessian.bottomLeftCorner<1, 3>() += half.transpose();
}

}  // namespace rigfit::model
