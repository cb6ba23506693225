// The time response of a linear system given by its poles, exact at every sample.
//
// Each pole s has a state z with z' = s z + b f(t); a sensor reads y = Re sum c z. A
// mass-normalised mode q'' + 2 zeta omega q' + omega^2 q = phi f with zeta < 1 is the pole s =
// -zeta omega + i omega_d with b = phi and c = -i / omega_d; with zeta > 1 it is two real poles.
// Between samples (step h, x = s h)
//   z1 = e^x z0 + b h [ phi1(x) f0 + phi2(x) (f1 - f0) ]          force linear between samples
//   phi1 = (e^x - 1)/x, phi2 = (e^x - 1 - x)/x^2
// and a half-sine pulse is integrated in closed form, whatever the step. Without force the samples
// in a block are one real matrix (powers of e^{s h}) times the states at the blocks' starts.
#pragma once

#include "model/algebra/numbers.h"
#include "model/scene/force_history.h"
#include "model/scene/scene.h"

namespace rigfit::model {

struct PoleModel {
  VectorXcd poles;    ///< rad/s; one of each conjugate pair, and all real ones
  MatrixXcd input;    ///< poles x loads: b
  MatrixXcd output;   ///< sensors x poles: c of the displacement along the sensor's direction
                      ///< (of the tension for a force sensor)
  VectorXcd initial;  ///< z at t = 0
  VectorXd offset;    ///< sensors: added to every sample (static tension); empty: zero
  MatrixXd direct;    ///< sensors x loads: what the force adds at once to a displacement
                      ///< or tension, for modes left out; empty: nothing
};

/// Poles of mass-normalised modes: `load_shape` modes x loads, `sensor_shape` sensors x modes,
/// started from the modal displacements `displacement`.
[[nodiscard]] PoleModel pole_model(const VectorXd& omega, const VectorXd& damping_ratio,
                                   const MatrixXd& load_shape, const MatrixXd& sensor_shape,
                                   const VectorXd& displacement);

/// Samples at 0, h, 2 h ...: rows x sensors. `quantities`: one a sensor; an acceleration of a
/// truncated model leaves out the inertia of the modes that are not in it.
[[nodiscard]] MatrixXd modal_response(const PoleModel& model,
                                      const std::vector<Sensor::Quantity>& quantities,
                                      const std::vector<LoadForce>& forces, double step_s,
                                      Index rows);

/// z from one time to another, exact for every load.
void advance(const PoleModel& model, const std::vector<LoadForce>& forces, double t0, double t1,
             VectorXcd& z);

}  // namespace rigfit::model
