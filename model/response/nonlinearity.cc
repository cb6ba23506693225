#include "model/response/nonlinearity.h"

#include "model/algebra/eigenpairs.h"
#include "model/algebra/numbers.h"

namespace rigfit::model {
namespace {

constexpr std::size_t kCompared = 6;  // modes whose shift is looked at

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
  VectorXd values(shapes.cols()), momentum(shapes.rows());
  for (Index i = 0; i < shapes.cols(); ++i) {
    mass.multiply(shapes.col(i), momentum);
    Index nearest = 0;
    (pairs.vectors.transpose() * momentum).cwiseAbs().maxCoeff(&nearest);
    values(i) = pairs.values(nearest);
  }
  return values;
}

}  // namespace

Nonlinearity estimate_nonlinearity(const ChainModes& modes, const LinearAnswer& answer,
                                   const Scene& scene,
                                   const std::vector<const ForceHistory*>& records,
                                   double duration_s, const Assembly& assembly) {
  Nonlinearity out;
  const Index count = answer.omega.size();
  if (count == 0) return out;
  const ModalPropagator propagator(answer.modal, scene.loads, records);
  const double last_force = propagator.last_force_s();
  double begin = duration_s;
  for (std::size_t l = 0; l < scene.loads.size(); ++l) {
    for (const double t : propagator.force(l).corners()) begin = std::clamp(t, 0.0, begin);
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
      propagator.advance(z, begin + (end - begin) * (i - 1) / instants, t);
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
  VectorXd load(assembly.size());
  if (last_force > 0 || answer.truncated) {
    stiffness.multiply(u, load);
  }
  if (last_force == 0) {  // the hung masses themselves
    load = load_rows(assembly) * hung_weights(scene);
  }
  if (lowest.empty()) return out;
  // Eigenvalues in both extremes; one alone when there is no equilibrium the other way.
  VectorXd values[2];
  for (int side = 0; side < 2; ++side) {
    const LoadedState loaded =
        loaded_state(assembly, modes.equilibrium.state, side == 0 ? load : VectorXd(-load));
    if (!loaded.converged) continue;
    assembly.force_and_tangent(loaded.state, force, stiffness);
    values[side] = nearest_eigenvalues(stiffness, mass, shapes);
  }
  if (values[0].size() == 0 || values[1].size() == 0) {
    out.frequency_shift = 1;
    return out;
  }
  double weighted = 0, weight = 0, most = -1;
  const auto compared = static_cast<Index>(lowest.size());
  for (Index i = 0; i < std::min({compared, values[0].size(), values[1].size()}); ++i) {
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

}  // namespace rigfit::model
