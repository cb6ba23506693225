#include "model/response/response_modes.h"

#include "model/algebra/eigenpairs.h"
#include "model/scene/sensor_quantity.h"

namespace rigfit::model {
namespace {

constexpr int kAllModes = 400;  // unknowns of a motion up to which all modes are taken
constexpr int kSomeModes = 200;
constexpr double kUsualSegments = 30, kMostAutoSegments = 400;

bool driven(const MotionModes& motion) { return !load_rows(*motion.assembly).isZero(1e-12); }

// Share of axial stretching in a mode's strain energy, phi' K_axial phi / omega^2.
double stretching(const ChainModes& modes, const LinearAnswer& answer, int mode) {
  const auto [m, k] = answer.mode[static_cast<std::size_t>(mode)];
  const MotionModes& motion = modes.motions[static_cast<std::size_t>(m)];
  const VectorXd stretch =
      motion.assembly->elongations(modes.equilibrium.state) * motion.shapes.col(k);
  double sum = 0;
  for (Index s = 0; s < stretch.size(); ++s) {
    const Segment& segment = modes.chain->segments[static_cast<std::size_t>(s)];
    sum += segment.EA / segment.length * stretch(s) * stretch(s);
  }
  const double omega2 = motion.omega2(k);
  return omega2 > 0 ? std::min(1.0, sum / omega2) : 0;
}

}  // namespace

ChainModes response_modes(const Scene& scene, const std::vector<int>& segments) {
  ChainModes out = prepare_motions(scene, ModesOptions{}, segments);
  bool any = false;
  for (const MotionModes& motion : out.motions) any = any || driven(motion);
  for (std::size_t k = 0; k < out.motions.size(); ++k) {
    MotionModes& motion = out.motions[k];
    const int n = motion.assembly->size();
    motion.shapes.resize(n, 0);
    motion.complete = true;
    if (any ? !driven(motion) : k > 0) continue;
    motion.take(lowest_eigenpairs(motion.stiffness, motion.mass, n <= kAllModes ? n : kSomeModes));
  }
  return out;
}

ModeWeights mode_weights(const LinearAnswer& answer, const Scene& scene,
                         const std::vector<const ForceHistory*>& records, double duration_s) {
  ModeWeights out;
  const PoleModel& model = answer.modal;
  const Index modes = answer.omega.size(), poles = model.poles.size();
  out.energy = VectorXd::Zero(modes);
  out.sensors = VectorXd::Zero(poles);
  out.mode_of_pole.assign(static_cast<std::size_t>(poles), 0);
  if (poles == 0) return out;
  const ModalPropagator propagator(model, scene.loads, records);
  VectorXcd z = model.initial;
  const double begin = std::min(duration_s, propagator.last_force_s());
  propagator.advance(z, 0, begin);

  const double span = std::max(duration_s - begin, 1e-9);
  const auto mean_decay = [&](Index p) {
    const double decay = -2 * model.poles(p).real() * span;
    return decay > 1e-9 ? -std::expm1(-decay) / decay : 1;
  };
  double all = 0;
  for (Index p = 0; p < poles; ++p) {
    Index mode = 0;
    model.output.col(p).cwiseAbs().cwiseProduct(answer.omega).maxCoeff(&mode);
    out.mode_of_pole[static_cast<std::size_t>(p)] = static_cast<int>(mode);
    // Amplitude, not the displacement of the moment.
    const double omega2 = std::norm(model.poles(p));
    const double energy = std::norm(model.output(mode, p) * z(p)) * omega2 / 2;
    out.energy(mode) += energy;
    out.mean_omega2 += energy * mean_decay(p) * omega2;
    all += energy;
  }
  if (all > 0) out.mean_omega2 /= all;
  if (out.energy.sum() > 0) out.energy /= out.energy.sum();

  for (Index s = 0; s < answer.sensors.output.rows(); ++s) {
    const int derivatives =
        described(scene.sensors[static_cast<std::size_t>(s)].quantity).derivatives;
    VectorXd own(poles);
    for (Index p = 0; p < poles; ++p) {
      own(p) = std::norm(answer.sensors.output(s, p) * z(p)) *
               std::pow(std::norm(model.poles(p)), derivatives) * mean_decay(p);
    }
    if (own.sum() > 0) out.sensors += own / own.sum();
  }
  if (out.sensors.sum() > 0) out.sensors /= out.sensors.sum();
  return out;
}

double resolution_error(const Scene& scene, const ChainModes& modes, const LinearAnswer& answer,
                        const ModeWeights& weights) {
  std::vector<int> finer = modes.chain->segment_counts();
  for (int& segments : finer) segments *= 2;
  const ChainModes fine = prepare_motions(scene, ModesOptions{}, finer);
  if (fine.motions.size() != modes.motions.size()) return 1;
  double error = 0;
  Index first = 0;
  for (std::size_t k = 0; k < modes.motions.size(); ++k) {
    const Index own = modes.motions[k].omega2.size();
    const VectorXd energy = weights.energy.segment(first, own);
    // The lowest modes that hold all but a thousandth of this motion's energy.
    int count = 0;
    for (double held = 0; count < own && held < 0.999 * energy.sum(); ++count) {
      held += energy(count);
    }
    const VectorXd values =
        lowest_eigenpairs(fine.motions[k].stiffness, fine.motions[k].mass, count).values;
    if (values.size() < count) return 1;
    for (Index i = 0; i < count; ++i) {
      const double other = std::sqrt(std::max(values(i), 0.0));
      if (!(other > 0)) continue;
      error += energy(i) * std::abs(answer.omega(first + i) / other - 1) * 4 / 3;
    }
    first += own;
  }
  return error;
}

ResponseResolution choose_response_segments(const Scene& scene,
                                            const std::vector<const ForceHistory*>& records,
                                            double duration_s) {
  ResponseResolution now;
  double n = kUsualSegments;
  for (int round = 0; round < 4; ++round) {
    std::vector<int> trial;
    for (const Member& member : scene.members) {
      trial.push_back(member.segments > 0 ? member.segments : static_cast<int>(n));
    }
    ChainModes modes = response_modes(scene, trial);
    if (modes.equilibrium.status != EquilibriumStatus::converged) {
      if (round == 0) now.modes = std::move(modes);
      break;
    }
    now = {std::move(modes), {}, 0};
    now.answer = linear_answer(now.modes, scene);
    const ModeWeights weights = mode_weights(now.answer, scene, records, duration_s);
    now.relative_error = resolution_error(scene, now.modes, now.answer, weights);
    const double ratio = now.relative_error / scene.accuracy;
    if (ratio <= 1 || n >= kMostAutoSegments) break;
    n = std::min(std::ceil(1.05 * n * std::clamp(std::sqrt(ratio), 1.05, 4.0)), kMostAutoSegments);
  }
  return now;
}

StepErrors explicit_step_errors(const ChainModes& modes, const LinearAnswer& answer,
                                const ModeWeights& weights, double shift, double step_s,
                                double kappa) {
  StepErrors out;
  for (Index p = 0; p < weights.sensors.size(); ++p) {
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
  const VectorXcd& s = answer.modal.poles;
  const auto seen = (s.cwiseAbs().array() * sample_s <= std::numbers::pi).cast<double>();
  const VectorXd weight = weights.sensors.array() * seen;
  const VectorXd rate2 = s.real().cwiseAbs2();
  const double sixteenth = 1 / (16 * std::max(upper_hz, 1e-3));
  return std::min(
      {sample_s, sixteenth, std::sqrt(2 * accuracy / std::max(weight.dot(rate2), 1e-12))});
}

double truncated_part(const LinearAnswer& answer, const ModeWeights& weights, const Scene& scene) {
  if (!answer.truncated) return 0;
  const double top = answer.modal.poles.cwiseAbs().maxCoeff();
  double upper = 0;
  for (Index p = 0; p < weights.sensors.size(); ++p) {
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
  const double all = weights.sensors.sum();
  return all > 0 ? std::sqrt(factor * upper / all) : 0;
}

}  // namespace rigfit::model
