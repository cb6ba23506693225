#include "model/response/response_modes.h"

#include "model/algebra/eigenpairs.h"
#include "model/scene/sensor_quantity.h"

namespace rigfit::model {
namespace {

constexpr std::size_t kCompared = 6;  // modes whose shift is looked at
constexpr int kAllModes = 400;        // unknowns of a motion up to which all modes are taken
constexpr int kSomeModes = 200;
constexpr double kUsualSegments = 30, kMostAutoSegments = 400;

bool driven(const MotionModes& motion) { return !load_rows(*motion.assembly).isZero(1e-12); }

// Share of axial stretching in a mode's strain energy, phi' K_axial phi / omega^2.
double stretching(const LinearAnswer& answer, Index mode) {
  const ChainModes& modes = answer.modes;
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

// The eigenvalues of K x = lambda M x whose vectors are nearest to the given mass-normalised
// shapes; empty when K is not positive definite. Among the lowest: as many again and more, because
// a motion in space has modes between that no load drives.
VectorXd nearest_eigenvalues(const EnvelopeMatrix& stiffness, const EnvelopeMatrix& mass,
                             const MatrixXd& shapes) {
  EnvelopeFactor factor;
  if (!factor.factor(stiffness) || factor.negative_pivots() > 0) return {};
  const Eigenpairs pairs =
      lowest_eigenpairs(stiffness, mass, 2 * static_cast<int>(shapes.cols()) + 4);
  if (pairs.values.size() == 0) return {};
  VectorXd values(shapes.cols());
  for (Index i = 0; i < shapes.cols(); ++i) {
    Index nearest = 0;
    (pairs.vectors.transpose() * (mass * VectorXd(shapes.col(i)))).cwiseAbs().maxCoeff(&nearest);
    values(i) = pairs.values(nearest);
  }
  return values;
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

Nonlinearity estimate_nonlinearity(const LinearAnswer& answer, const Scene& scene,
                                   const std::vector<LoadForce>& forces, double duration_s,
                                   const Assembly& assembly) {
  Nonlinearity out;
  const ChainModes& modes = answer.modes;
  const Index count = answer.omega.size();
  if (count == 0) return out;
  const double last_force = last_force_s(forces);
  double begin = duration_s;
  for (const LoadForce& force : forces) {
    for (const double t : force.corners()) begin = std::clamp(t, 0.0, begin);
  }

  // Modal coordinates where the strain energy is greatest. A hung mass' own state is the start.
  VectorXcd z = answer.modal.initial;
  const auto coordinates = [&]() -> VectorXd { return (answer.modal.output * z).real(); };
  const auto energies = [&](const VectorXd& q) -> VectorXd {
    return 0.5 * (answer.omega.cwiseProduct(q)).cwiseAbs2();
  };
  VectorXd q = coordinates();
  double greatest = energies(q).sum();
  if (last_force > 0) {
    const double lowest = answer.omega.minCoeff();
    const double end =
        std::min(duration_s, last_force + 4 * std::numbers::pi / std::max(lowest, 1e-3));
    if (!z.isZero(0)) begin = 0;  // else at rest until a force begins
    const int instants = 80;
    for (int i = 1; i <= instants; ++i) {
      const double t = begin + (end - begin) * i / instants;
      advance(answer.modal, forces, begin + (end - begin) * (i - 1) / instants, t, z);
      const VectorXd here = coordinates();
      const double energy = energies(here).sum();
      if (energy > greatest) greatest = energy, q = here;
    }
  }
  out.energy_J = greatest;
  if (!(greatest > 0)) return out;
  const VectorXd share = energies(q) / greatest;

  std::vector<Index> rising(static_cast<std::size_t>(count));
  for (Index i = 0; i < count; ++i) rising[static_cast<std::size_t>(i)] = i;
  std::sort(rising.begin(), rising.end(),
            [&](Index a, Index b) { return answer.omega(a) < answer.omega(b); });
  double held = 0;
  for (Index i : rising) {
    held += share(i);
    out.upper_frequency_hz = answer.omega(i) / (2 * std::numbers::pi);
    if (held >= 0.99) break;
  }

  // Elastic forces of the linear answer in the motion's unknowns, and its lowest shapes.
  const Numbering& to = assembly.numbering();
  EnvelopeMatrix stiffness = assembly.matrix(), mass = assembly.matrix();
  VectorXd force(assembly.size());
  assembly.force_and_tangent(modes.equilibrium.state, force, stiffness);
  assembly.mass(mass);
  VectorXd u = VectorXd::Zero(assembly.size());
  std::vector<Index> lowest;
  MatrixXd shapes(assembly.size(), 0);
  for (Index i : rising) {
    const auto [m, k] = answer.mode[static_cast<std::size_t>(i)];
    const MotionModes& motion = modes.motions[static_cast<std::size_t>(m)];
    const VectorXd shape = renumbered(motion.shapes.col(k), motion.assembly->numbering(), to);
    if (q(i) != 0) u += q(i) * shape;
    if (lowest.size() < kCompared && !shape.isZero(0)) {
      lowest.push_back(i);
      shapes.conservativeResize(Eigen::NoChange, shapes.cols() + 1);
      shapes.rightCols(1) = shape;
    }
  }
  // Without forces the hung masses themselves.
  const VectorXd load =
      last_force > 0 ? stiffness * u : VectorXd(load_rows(assembly) * hung_weights(scene));
  if (lowest.empty()) return out;
  // Eigenvalues in both extremes; one alone when there is no equilibrium the other way.
  VectorXd values[2];
  for (int side = 0; side < 2; ++side) {
    const std::optional<ChainState> loaded =
        loaded_state(assembly, modes.equilibrium.state, side == 0 ? load : VectorXd(-load));
    if (!loaded) continue;
    assembly.force_and_tangent(*loaded, force, stiffness);
    values[side] = nearest_eigenvalues(stiffness, mass, shapes);
  }
  if (values[0].size() == 0 || values[1].size() == 0) {
    out.frequency_shift = 1;
    return out;
  }
  double weighted = 0, weight = 0, most = -1;
  for (Index i = 0; i < std::ssize(lowest); ++i) {
    const Index mode = lowest[static_cast<std::size_t>(i)];
    const double rest = answer.omega(mode) * answer.omega(mode);
    const double even = ((values[0](i) + values[1](i)) / (2 * rest) - 1) / 8;
    const double half = (values[0](i) - values[1](i)) / (2 * rest), odd = 5 * half * half / 48;
    weighted += share(mode) * (std::abs(even) + odd);
    weight += share(mode);
    if (share(mode) > most) {
      most = share(mode);
      out.frequency_at_rest_hz = answer.omega(mode) / (2 * std::numbers::pi);
      out.frequency_moving_hz = out.frequency_at_rest_hz * (1 + even - odd);
    }
  }
  out.frequency_shift = weight > 0 ? weighted / weight : 0;
  return out;
}

double resolution_error(const Scene& scene, const LinearAnswer& answer) {
  const ChainModes& modes = answer.modes;
  std::vector<int> finer = modes.chain->segment_counts();
  for (int& segments : finer) segments *= 2;
  const ChainModes fine = prepare_motions(scene, ModesOptions{}, finer);
  if (fine.motions.size() != modes.motions.size()) return 1;
  double error = 0;
  Index first = 0;
  for (std::size_t k = 0; k < modes.motions.size(); ++k) {
    const Index own = modes.motions[k].omega2.size();
    const VectorXd energy = answer.energy.segment(first, own);
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

LinearAnswer choose_response_segments(const Scene& scene, const std::vector<LoadForce>& forces,
                                      double duration_s) {
  LinearAnswer now;
  double n = kUsualSegments;
  for (int round = 0; round < 4; ++round) {
    std::vector<int> trial;
    for (const Member& member : scene.members) {
      trial.push_back(member.segments > 0 ? member.segments : static_cast<int>(n));
    }
    LinearAnswer next = linear_answer(response_modes(scene, trial), scene, forces, duration_s);
    const bool rests = next.modes.equilibrium.status == EquilibriumStatus::converged;
    if (rests || round == 0) now = std::move(next);
    if (!rests) break;
    now.resolution_error = resolution_error(scene, now);
    const double ratio = now.resolution_error / scene.accuracy;
    if (ratio <= 1 || n >= kMostAutoSegments) break;
    n = std::min(std::ceil(1.05 * n * std::clamp(std::sqrt(ratio), 1.05, 4.0)), kMostAutoSegments);
  }
  return now;
}

StepErrors explicit_step_errors(const LinearAnswer& answer, double shift, double step_s,
                                double kappa) {
  StepErrors out;
  for (Index p = 0; p < answer.sensed.size(); ++p) {
    const double weight = answer.sensed(p);
    if (!(weight > 1e-12)) continue;
    const double omega2 = std::norm(answer.modal.poles(p)), x = omega2 * step_s * step_s;
    out.scheme += weight * std::min(1.0, x * x / 1440);
    if (!(kappa > 0)) continue;
    const double axial = stretching(answer, answer.mode_of_pole[static_cast<std::size_t>(p)]);
    const double moving = 2 * shift * std::max(omega2, answer.mean_omega2);
    out.slowed_axial += weight * std::min(1.0, kappa * (omega2 * axial / 2 + moving));
  }
  return out;
}

double slowed_step(const LinearAnswer& answer, double shift, double interval_s, double accuracy) {
  for (int n = 1; n <= 64; ++n) {
    const double h = interval_s / n;
    const StepErrors errors = explicit_step_errors(answer, shift, h, h * h / 8);
    if (errors.scheme + errors.slowed_axial <= accuracy) return h;
  }
  return 0;
}

double damper_interval(const LinearAnswer& answer, double upper_hz, double sample_s,
                       double accuracy) {
  const VectorXcd& s = answer.modal.poles;
  const auto seen = (s.cwiseAbs().array() * sample_s <= std::numbers::pi).cast<double>();
  const VectorXd weight = answer.sensed.array() * seen;
  const VectorXd rate2 = s.real().cwiseAbs2();
  const double sixteenth = 1 / (16 * std::max(upper_hz, 1e-3));
  return std::min(
      {sample_s, sixteenth, std::sqrt(2 * accuracy / std::max(weight.dot(rate2), 1e-12))});
}

double truncated_part(const LinearAnswer& answer, const Scene& scene) {
  if (!answer.truncated) return 0;
  const double top = answer.modal.poles.cwiseAbs().maxCoeff();
  double upper = 0;
  for (Index p = 0; p < answer.sensed.size(); ++p) {
    if (std::abs(answer.modal.poles(p)) > top / 2) upper += answer.sensed(p);
  }
  // Mean squares per mode fall by r^-4, -2, 0 in displacement, velocity, acceleration: beyond the
  // top there is 1/7 of what its upper half holds, as much, or no end.
  double factor = 1.0 / 7;
  for (const Sensor& sensor : scene.sensors) {
    const int derivatives = described(sensor.quantity).derivatives;
    if (derivatives == 1) factor = std::max(factor, 1.0);
    if (derivatives == 2) return upper > 0 ? 1 : 0;
  }
  const double all = answer.sensed.sum();
  return all > 0 ? std::sqrt(factor * upper / all) : 0;
}

}  // namespace rigfit::model
