#include "model/linear_answer.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "model/damped_modes.h"
#include "model/motion_problem.h"

namespace rigfit::model {
namespace {

using Complex = std::complex<double>;

// Poles of q'' + D q' + diag(omega^2) q = L f, started from q0 at rest.
PoleModel coupled_poles(const Eigen::VectorXd& omega, const Eigen::MatrixXd& damping,
                        const Eigen::MatrixXd& load, const Eigen::VectorXd& start) {
  const Eigen::Index n = omega.size();
  // In (omega q, q'): of one size, so that the eigenvectors are well scaled.
  Eigen::MatrixXd state = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  state.topRightCorner(n, n) = omega.asDiagonal();
  state.bottomLeftCorner(n, n) = -Eigen::MatrixXd(omega.asDiagonal());
  state.bottomRightCorner(n, n) = -damping;
  const Eigen::EigenSolver<Eigen::MatrixXd> eigen(state);
  const Eigen::VectorXcd values = eigen.eigenvalues();
  const Eigen::MatrixXcd vectors = eigen.eigenvectors();
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(2 * n, load.cols() + 1);
  right.bottomLeftCorner(n, load.cols()) = load;
  right.col(load.cols()).head(n) = omega.cwiseProduct(start);
  const Eigen::MatrixXcd left = vectors.partialPivLu().solve(right.cast<Complex>());

  std::vector<Eigen::Index> keep;
  for (Eigen::Index k = 0; k < 2 * n; ++k) {
    if (values(k).imag() >= 0) keep.push_back(k);
  }
  const auto poles = static_cast<Eigen::Index>(keep.size());
  PoleModel model;
  model.poles.resize(poles);
  model.input.resize(poles, load.cols());
  model.output.resize(n, poles);
  model.initial.resize(poles);
  for (Eigen::Index p = 0; p < poles; ++p) {
    const Eigen::Index k = keep[static_cast<std::size_t>(p)];
    model.poles(p) = values(k);
    model.input.row(p) = left.row(k).head(load.cols());
    model.initial(p) = left(k, load.cols());
    const double twice = values(k).imag() > 0 ? 2 : 1;
    model.output.col(p) = twice * vectors.col(k).head(n).cwiseQuotient(omega.cast<Complex>());
  }
  return model;
}

}  // namespace

double hung_weight(const Scene& scene, const Load& load) {
  return load.kind == Load::Kind::release ? load.mass * scene.gravity.norm() : 0;
}

Eigen::VectorXd renumbered(const Eigen::VectorXd& x, const Numbering& from, const Numbering& to) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(to.size);
  const auto move = [&](const auto& a, const auto& b) {
    for (Eigen::Index i = 0; i < a.size(); ++i) {
      if (a.data()[i] >= 0 && b.data()[i] >= 0) result(b.data()[i]) = x(a.data()[i]);
    }
  };
  move(from.displacement, to.displacement);
  move(from.twist, to.twist);
  move(from.rotation, to.rotation);
  return result;
}

LinearAnswer linear_answer(const ChainModes& modes, const Scene& scene) {
  LinearAnswer out;
  Eigen::Index count = 0;
  for (const MotionModes& motion : modes.motions) count += motion.omega2.size();
  const auto loads = static_cast<Eigen::Index>(scene.loads.size());
  const auto sensors = static_cast<Eigen::Index>(scene.sensors.size());
  out.omega.resize(count);
  out.ratio.resize(count);
  Eigen::MatrixXd load_shape(count, loads), sensor_shape(sensors, count);
  Eigen::MatrixXd damping;
  out.coupled = any_joint_damping(*modes.chain);
  if (out.coupled) damping = Eigen::MatrixXd::Zero(count, count);

  Eigen::MatrixXd direct = Eigen::MatrixXd::Zero(sensors, loads);
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < modes.motions.size(); ++k) {
    const MotionModes& motion = modes.motions[k];
    const Eigen::Index n = motion.omega2.size();
    out.omega.segment(first, n) = motion.omega2.cwiseMax(0).cwiseSqrt();
    out.ratio.segment(first, n) = modal_ratios(motion, modes.equilibrium.state, scene);
    for (Eigen::Index l = 0; l < loads; ++l) {
      load_shape.col(l).segment(first, n) =
          motion.shapes.transpose() * load_row(*motion.assembly, static_cast<int>(l));
    }
    for (Eigen::Index s = 0; s < sensors; ++s) {
      sensor_shape.row(s).segment(first, n) =
          sensor_row(*motion.assembly, modes.equilibrium.state, scene, static_cast<int>(s))
              .transpose() *
          motion.shapes;
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      out.mode.push_back({static_cast<int>(k), static_cast<int>(i)});
    }
    if (out.coupled) {
      EnvelopeMatrix c = motion.assembly->matrix();
      motion.assembly->damping(modes.equilibrium.state, c);
      Eigen::MatrixXd product(motion.shapes.rows(), n);
      for (Eigen::Index i = 0; i < n; ++i) {
        product.col(i) = c * Eigen::VectorXd(motion.shapes.col(i));
      }
      damping.block(first, first, n, n) = motion.shapes.transpose() * product;
    }
    int inertial = 0;
    for (int i = 0; i < motion.mass.size(); ++i) inertial += motion.mass.at(i, i) > 0;
    if (n < inertial) {
      out.truncated = true;
      // The modes left out follow a force without delay: K^-1 less what the others give.
      EnvelopeFactor factor;
      factor.factor(motion.stiffness);
      for (Eigen::Index l = 0; l < loads; ++l) {
        Eigen::VectorXd x = load_row(*motion.assembly, static_cast<int>(l));
        factor.solve_in_place(x);
        for (Eigen::Index s = 0; s < sensors; ++s) {
          direct(s, l) +=
              sensor_row(*motion.assembly, modes.equilibrium.state, scene, static_cast<int>(s))
                  .dot(x) -
              sensor_shape.row(s).segment(first, n).dot(
                  load_shape.col(l)
                      .segment(first, n)
                      .cwiseQuotient(motion.omega2.cwiseMax(1e-300))
                      .transpose());
        }
      }
    }
    first += n;
  }

  Eigen::VectorXd start = Eigen::VectorXd::Zero(count);
  for (Eigen::Index l = 0; l < loads; ++l) {
    start += hung_weight(scene, scene.loads[static_cast<std::size_t>(l)]) *
             load_shape.col(l).cwiseQuotient(out.omega.cwiseAbs2().cwiseMax(1e-300));
  }
  if (out.coupled) {
    damping.diagonal() += 2 * out.ratio.cwiseProduct(out.omega);
    out.modal = coupled_poles(out.omega, damping, load_shape, start);
  } else {
    out.modal = pole_model(out.omega, out.ratio, load_shape,
                           Eigen::MatrixXd::Identity(count, count), start);
  }
  out.sensors = out.modal;
  out.sensors.output = sensor_shape.cast<Complex>() * out.modal.output;
  if (out.truncated) out.sensors.direct = direct;
  out.sensors.offset = Eigen::VectorXd::Zero(sensors);
  const Assembly& assembly = *modes.motions.front().assembly;
  Eigen::VectorXd axial(static_cast<Eigen::Index>(modes.chain->segments.size()));
  assembly.axial_forces(modes.equilibrium.state, axial);
  for (Eigen::Index s = 0; s < sensors; ++s) {
    const int segment = modes.chain->sensors[static_cast<std::size_t>(s)].segment;
    if (scene.sensors[static_cast<std::size_t>(s)].quantity == Sensor::Quantity::force &&
        segment >= 0) {
      out.sensors.offset(s) = axial(segment);
    }
  }
  return out;
}

}  // namespace rigfit::model
