// The damped equations of one motion at a line of a frequency response function, with its loads,
// sensors and modal dampers: shared by the functions and their sensitivities.
//
//   D = K + s C + s^2 M + s sum_r g_r (M phi_r)(M phi_r)',  g_r = 2 zeta_r omega_r,
//
// s = i omega + a, a the decay rate of an exponential window shared by force and response (0:
// none); the sum (modal damping ratios) over the modes the motion carries. Without joint dampers
// these modes answer each for itself, by 1 / (s^2 + s g_r + omega_r^2), and what lies outside of
// them without damping,
//   (K + s^2 M)^-1 b = sum_k (-s^2)^k (K^-1 M)^k K^-1 b,
// which converges by (|s| / omega)^2 a term, omega the first mode that is not carried: twice the
// highest line, so that some 25 vectors serve all lines in place of a factorisation each. With
// joint dampers the sum is inverted by Woodbury's formula, line by line.
#pragma once

#include "model/algebra/numbers.h"
#include "model/linear/modes.h"

namespace rigfit::model {

struct FrfEquations {
  const MotionModes* motion = nullptr;
  EnvelopeMatrix damping;   ///< joint dampers
  MatrixXd sensors, loads;  ///< unknowns x sensors, unknowns x loads
  MatrixXd dampers;         ///< M phi_r: unknowns x modes; empty without modal ratios
  VectorXd zeta;            ///< modal ratio of each damper
};

/// `motion` must outlive the result.
[[nodiscard]] FrfEquations frf_equations(const MotionModes& motion, const ChainState& state,
                                         const Scene& scene);

/// D^-1 of given right sides, line by line.
class FrfSolver {
 public:
  /// `farthest`: the largest |s|.
  FrfSolver(const FrfEquations& equations, const MatrixXd& right, double farthest);
  /// unknowns x right sides; valid until the next call.
  [[nodiscard]] const MatrixXcd& solve(Complex s);

 private:
  /// The vectors of the series; none where it does not converge.
  void expand(const MatrixXd& outside, double farthest);
  void solve_jointly(Complex s);
  void solve_by_modes(Complex s);

  const FrfEquations& equations_;
  Index wanted_;
  bool joint_;  ///< there are joint dampers
  MatrixXcd right_, solution_, small_;
  ComplexEnvelopeMatrix dynamic_;
  ComplexEnvelopeFactor factor_;
  VectorXcd gain_;
  MatrixXd modal_;  ///< the right sides' part along the damped modes
  /// By right side: the series' vectors, by power of -s^2, and the modes' shapes, row by row.
  std::vector<MatrixXd> basis_;
  VectorXcd parts_;  ///< their factors at a line
};

/// The rig at rest with what its FRFs at these lines need: its motions' matrices and, where a
/// member has a modal damping ratio, all modes up to twice the highest line.
[[nodiscard]] ChainModes frf_modes(const Scene& scene, const VectorXd& frequency_hz,
                                   const ModesOptions& options);

/// From displacement (or force) to a sensor's quantity.
[[nodiscard]] Complex quantity_factor(Sensor::Quantity quantity, Complex s);

/// i omega + a of a line, 1/s.
[[nodiscard]] Complex laplace_variable(double frequency_hz, double decay_rate_1_s);

}  // namespace rigfit::model
