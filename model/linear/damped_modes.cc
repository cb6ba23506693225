#include "model/linear/damped_modes.h"

#include "model/algebra/eigenpairs.h"

namespace rigfit::model {
namespace {

/// u' A u without conjugation.
Complex form(const EnvelopeMatrix& a, const VectorXcd& u) { return u.transpose() * (a * u); }

}  // namespace

bool has_joint_dampers(const Scene& scene) {
  return std::any_of(scene.members.begin(), scene.members.end(), [](const Member& m) {
    return m.damping.axial > 0 || m.damping.bending > 0 || m.damping.torsion > 0;
  });
}

double damping_ratio_of(Complex pole) { return -pole.real() / std::abs(pole); }

VectorXd modal_ratios(const Assembly& assembly, const MatrixXd& shapes, const ChainState& state,
                      const Scene& scene) {
  const Index modes = shapes.cols();
  VectorXd ratios = VectorXd::Zero(modes);
  const auto ratio_of = [](const Member& member) { return member.damping_ratio.value_or(0); };
  const double first = scene.members.empty() ? 0 : ratio_of(scene.members[0]);
  const bool same = std::all_of(scene.members.begin(), scene.members.end(),
                                [&](const Member& member) { return ratio_of(member) == first; });
  if (same && (first == 0 || assembly.chain().supports.empty())) return ratios.setConstant(first);
  const MatrixXd energy = assembly.stiffness_energy(state, shapes);
  for (Index i = 0; i < modes; ++i) {
    double sum = 0, weighted = 0;
    for (Index m = 0; m < energy.rows(); ++m) {
      // A part that softens (a compressed beam's) stores nothing that could be lost.
      const double part = std::max(0.0, energy(m, i));
      sum += part;
      if (m + 1 < energy.rows()) {
        weighted += part * ratio_of(scene.members[static_cast<std::size_t>(m)]);
      }
    }
    ratios[i] = sum > 0 ? weighted / sum : 0;
  }
  return ratios;
}

VectorXcd damped_poles(const MotionModes& motion, const ChainState& state, const Scene& scene) {
  const Index modes = motion.omega2.size();
  const VectorXd ratios = modal_ratios(*motion.assembly, motion.shapes, state, scene);
  VectorXcd poles(modes);
  const VectorXd omega = motion.omega2.cwiseSqrt();
  if (!has_joint_dampers(scene) || modes == 0) {
    for (Index i = 0; i < modes; ++i) {
      const double z = ratios[i];
      poles[i] = omega[i] * Complex(-z, std::sqrt(std::max(0.0, 1 - z * z)));
    }
    return poles;
  }
  EnvelopeMatrix c = motion.assembly->matrix();
  motion.assembly->damping(state, c);

  // The quadratic problem among the modes asked for, as a first-order one.
  MatrixXd first_order = MatrixXd::Zero(2 * modes, 2 * modes);
  first_order.topRightCorner(modes, modes).setIdentity();
  first_order.bottomLeftCorner(modes, modes).diagonal() = -motion.omega2;
  first_order.bottomRightCorner(modes, modes) = -motion.shapes.transpose() * (c * motion.shapes);
  const GeneralEigenpairs eigen = general_eigenpairs(first_order, {});
  const MatrixXcd& vectors = eigen.vectors;
  std::vector<bool> taken(static_cast<std::size_t>(2 * modes), false);
  ComplexEnvelopeMatrix dynamic(motion.stiffness.envelope());
  ComplexEnvelopeFactor factor;
  for (Index i = 0; i < modes; ++i) {
    // The root with the largest part of this undamped mode, of those above the real axis.
    Index best = -1;
    double most = -1;
    for (Index r = 0; r < 2 * modes; ++r) {
      const Complex s = eigen.values[r];
      if (taken[static_cast<std::size_t>(r)] || s.imag() < 0) continue;
      const auto v = vectors.col(r).head(modes);
      double part = std::norm(v[i]) / v.squaredNorm();
      if (s.imag() == 0) part *= 1 + 1e-6 / (1 + std::abs(s));  // the slower of a real pair
      if (part > most) most = part, best = r;
    }
    poles[i] = best < 0 ? Complex(0, omega[i]) : eigen.values[best];
    if (best < 0) continue;
    taken[static_cast<std::size_t>(best)] = true;
    Complex s = poles[i];
    VectorXcd u = motion.shapes.cast<Complex>() * vectors.col(best).head(modes);
    u /= u.norm();
    bool converged = false;
    for (int iteration = 0; iteration < 30 && !converged; ++iteration) {
      const Complex s2 = s * s;
      for (Index e = 0; e < dynamic.values().size(); ++e) {
        dynamic.values()[e] =
            s2 * motion.mass.values()[e] + s * c.values()[e] + motion.stiffness.values()[e];
      }
      factor.factor(dynamic, 1e-15);
      // Newton's right-hand side: the derivative of the matrix by s, times the vector.
      VectorXcd right = 2.0 * s * (motion.mass * u) + c * u;
      factor.solve_in_place(right);
      const double size = right.norm();
      if (!(size > 0) || !std::isfinite(size)) break;
      u = right / size;
      const Complex mass = form(motion.mass, u), damp = form(c, u),
                    stiff = form(motion.stiffness, u);
      // The root of the Rayleigh functional nearer to the last value.
      const Complex root = std::sqrt(damp * damp - 4.0 * mass * stiff);
      const Complex plus = (-damp + root) / (2.0 * mass), minus = (-damp - root) / (2.0 * mass);
      const Complex next = std::abs(plus - s) < std::abs(minus - s) ? plus : minus;
      if (!std::isfinite(next.real()) || !std::isfinite(next.imag())) break;
      converged = std::abs(next - s) <= 1e-12 * std::abs(next);
      s = next;
    }
    if (!converged) s = poles[i];
    // Modal ratios of other members come on top.
    if (ratios[i] > 0) {
      const double size = std::abs(s), z = std::min(1.0, damping_ratio_of(s) + ratios[i]);
      s = size * Complex(-z, std::sqrt(1 - z * z));
    }
    poles[i] = s;
  }
  return poles;
}

}  // namespace rigfit::model
