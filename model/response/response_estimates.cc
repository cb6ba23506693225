#include "model/response/response_estimates.h"
#include "model/scene/sensor_quantity.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigfit::model {
namespace {

// Share of axial stretching in a mode's strain energy, phi' K_axial phi / omega^2.
double stretching(const ChainModes& modes, const LinearAnswer& answer, int mode) {
  const auto [m, k] = answer.mode[static_cast<std::size_t>(mode)];
  const MotionModes& motion = modes.motions[static_cast<std::size_t>(m)];
  const Chain& chain = *modes.chain;
  const ChainState& rest = modes.equilibrium.state;
  const Numbering& numbering = motion.assembly->numbering();
  const auto shape = motion.shapes.col(k);
  double sum = 0;
  for (const Segment& s : chain.segments) {
    const Eigen::Vector3d t = (rest.position.col(s.b) - rest.position.col(s.a)).normalized();
    const double stretch =
        t.dot(numbering.displacement_in(shape, s.b) - numbering.displacement_in(shape, s.a));
    sum += s.EA / s.length * stretch * stretch;
  }
  const double omega2 = motion.omega2(k);
  return omega2 > 0 ? std::min(1.0, sum / omega2) : 0;
}

double root_part(double part, double all) { return all > 0 ? std::sqrt(part / all) : 0; }

}  // namespace

StepErrors explicit_step_errors(const ChainModes& modes, const LinearAnswer& answer,
                                const ModeWeights& weights, double shift, double step_s,
                                double kappa) {
  StepErrors out;
  for (Eigen::Index p = 0; p < weights.sensors.size(); ++p) {
    const double weight = weights.sensors(p);
    if (!(weight > 1e-12)) continue;
    const double omega2 = std::norm(answer.modal.poles(p)), x = omega2 * step_s * step_s;
    out.scheme += weight * std::min(1.0, x * x / 1440);
    if (!(kappa > 0)) continue;
    const double axial =
        stretching(modes, answer, weights.mode_of_pole[static_cast<std::size_t>(p)]);
    const double moving = 2 * shift * std::max(omega2, weights.mean_omega2);
    out.slowed_axial += weight * std::min(1.0, kappa * (omega2 * axial / 2 + moving));
  }
  return out;
}

double slowed_step(const ChainModes& modes, const LinearAnswer& answer, const ModeWeights& weights,
                   double shift, double interval_s, double accuracy) {
  for (int n = 1; n <= 64; ++n) {
    const double h = interval_s / n;
    const StepErrors errors = explicit_step_errors(modes, answer, weights, shift, h, h * h / 8);
    if (errors.scheme + errors.slowed_axial <= accuracy) return h;
  }
  return 0;
}

double damper_interval(const LinearAnswer& answer, const ModeWeights& weights, double upper_hz,
                       double sample_s, double accuracy) {
  const Eigen::VectorXcd& s = answer.modal.poles;
  const auto seen = (s.cwiseAbs().array() * sample_s <= std::numbers::pi).cast<double>();
  const Eigen::VectorXd weight = weights.sensors.array() * seen;
  const Eigen::VectorXd rate2 = s.real().cwiseAbs2();
  const double sixteenth = 1 / (16 * std::max(upper_hz, 1e-3));
  return std::min(
      {sample_s, sixteenth, std::sqrt(2 * accuracy / std::max(weight.dot(rate2), 1e-12))});
}

double truncated_part(const LinearAnswer& answer, const ModeWeights& weights, const Scene& scene) {
  if (!answer.truncated) return 0;
  const double top = answer.modal.poles.cwiseAbs().maxCoeff();
  double upper = 0;
  for (Eigen::Index p = 0; p < weights.sensors.size(); ++p) {
    if (std::abs(answer.modal.poles(p)) > top / 2) upper += weights.sensors(p);
  }
  // Mean squares per mode fall by r^-4, -2, 0 in displacement, velocity, acceleration: beyond the
  // top there is 1/7 of what its upper half holds, as much, or no end.
  double factor = 1.0 / 7;
  for (const Sensor& sensor : scene.sensors) {
    const int derivatives = described(sensor.quantity).derivatives;
    if (derivatives == 1) factor = std::max(factor, 1.0);
    if (derivatives == 2) return upper > 0 ? 1 : 0;
  }
  return root_part(factor * upper, weights.sensors.sum());
}

}  // namespace rigfit::model
