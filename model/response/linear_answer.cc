#include "model/response/linear_answer.h"

#include <cmath>

#include "model/algebra/general_eigen.h"
#include "model/linear/damped_modes.h"
#include "model/motion/motion_problem.h"
#include "model/scene/sensor_quantity.h"

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
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(2 * n, load.cols() + 1);
  right.bottomLeftCorner(n, load.cols()) = load;
  right.col(load.cols()).head(n) = omega.cwiseProduct(start);
  const auto [values, vectors, left] = general_eigenpairs(state, right);

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

namespace {

double moving_mass(const Assembly& assembly, const Eigen::VectorXd& shape, const ChainState* along,
                   bool twist) {
  const Chain& chain = assembly.chain();
  const Numbering& numbering = assembly.numbering();
  const auto at = [&](int node) {
    Eigen::Vector3d v = Eigen::Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const int i = numbering.displacement(axis, node);
      if (i >= 0) v[axis] = shape[i];
    }
    return v;
  };
  double sum = 0;
  for (std::size_t k = 0; k < chain.segments.size(); ++k) {
    const Segment& s = chain.segments[k];
    const int turn = numbering.twist[static_cast<Eigen::Index>(k)];
    if (twist && turn >= 0) sum += s.polar * shape[turn] * shape[turn];
    if (twist) continue;
    const Eigen::Vector3d v = 0.5 * (at(s.a) + at(s.b));
    if (along) {
      const Eigen::Vector3d t = (along->position.col(s.b) - along->position.col(s.a)).normalized();
      sum += s.mass * v.dot(t) * v.dot(t);
    } else {
      sum += s.mass * v.squaredNorm();
    }
  }
  return sum;
}

}  // namespace

double axial_share(const Assembly& assembly, const ChainState& state,
                   const Eigen::VectorXd& shape) {
  const double all =
      moving_mass(assembly, shape, nullptr, false) + moving_mass(assembly, shape, nullptr, true);
  return all > 0 ? moving_mass(assembly, shape, &state, false) / all : 0;
}

double twist_share(const Assembly& assembly, const Eigen::VectorXd& shape) {
  const double twist = moving_mass(assembly, shape, nullptr, true);
  const double all = moving_mass(assembly, shape, nullptr, false) + twist;
  return all > 0 ? twist / all : 0;
}

LinearAnswer linear_answer(const ChainModes& modes, const Scene& scene,
                           const LinearAnswerOptions& options) {
  LinearAnswer out;
  const ChainState& rest = modes.equilibrium.state;
  const auto loads = static_cast<Eigen::Index>(scene.loads.size());
  const auto sensors = static_cast<Eigen::Index>(scene.sensors.size());
  // The modes that take part, motion by motion.
  std::vector<std::vector<int>> used(modes.motions.size());
  std::vector<bool> whole(modes.motions.size(), true);
  for (std::size_t k = 0; k < modes.motions.size(); ++k) {
    const MotionModes& motion = modes.motions[k];
    const Eigen::Index n = motion.omega2.size();
    if (n == 0 || (options.planar && motion.motion == Motion::out_of_plane)) continue;
    int inertial = 0;
    for (int i = 0; i < motion.mass.size(); ++i) inertial += motion.mass.at(i, i) > 0;
    if (n < inertial) whole[k] = false, out.truncated = true;
    for (int i = 0; i < n; ++i) {
      if (!options.axial && axial_share(*motion.assembly, rest, motion.shapes.col(i)) > 0.5) {
        whole[k] = false;
        continue;
      }
      used[k].push_back(i);
      out.mode.push_back({static_cast<int>(k), i});
    }
  }
  const auto count = static_cast<Eigen::Index>(out.mode.size());
  out.omega.resize(count);
  out.ratio.resize(count);
  Eigen::MatrixXd sensor_shape(sensors, count);
  Eigen::MatrixXd& load_shape = out.load_shape;
  load_shape.resize(count, loads);
  out.coupled = any_joint_damping(*modes.chain);
  if (out.coupled) out.damping = Eigen::MatrixXd::Zero(count, count);

  Eigen::MatrixXd direct = Eigen::MatrixXd::Zero(sensors, loads);
  bool any_direct = false;
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < modes.motions.size(); ++k) {
    const MotionModes& motion = modes.motions[k];
    const auto n = static_cast<Eigen::Index>(used[k].size());
    if (n == 0) continue;
    const Eigen::VectorXd ratios = modal_ratios(motion, rest, scene);
    Eigen::MatrixXd shapes(motion.shapes.rows(), n);
    Eigen::VectorXd omega2(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const int mode = used[k][static_cast<std::size_t>(i)];
      shapes.col(i) = motion.shapes.col(mode);
      omega2(i) = std::max(0.0, motion.omega2(mode));
      out.ratio(first + i) = ratios(mode);
    }
    out.omega.segment(first, n) = omega2.cwiseSqrt();
    std::vector<Eigen::VectorXd> load_rows, sensor_rows;
    for (Eigen::Index l = 0; l < loads; ++l) {
      load_rows.push_back(load_row(*motion.assembly, static_cast<int>(l)));
      load_shape.col(l).segment(first, n).noalias() = shapes.transpose() * load_rows.back();
    }
    for (Eigen::Index s = 0; s < sensors; ++s) {
      sensor_rows.push_back(sensor_row(*motion.assembly, rest, scene, static_cast<int>(s)));
      sensor_shape.row(s).segment(first, n).noalias() = sensor_rows.back().transpose() * shapes;
    }
    if (out.coupled) {
      EnvelopeMatrix c = motion.assembly->matrix();
      motion.assembly->damping(rest, c);
      Eigen::MatrixXd product(shapes.rows(), n);
      for (Eigen::Index i = 0; i < n; ++i) product.col(i) = c * Eigen::VectorXd(shapes.col(i));
      out.damping.block(first, first, n, n) = shapes.transpose() * product;
    }
    if (!whole[k]) {
      any_direct = true;
      // The modes left out follow a force without delay: K^-1 less what the others give.
      EnvelopeFactor factor;
      factor.factor(motion.stiffness);
      for (std::size_t l = 0; l < load_rows.size(); ++l) {
        Eigen::VectorXd x = load_rows[l];
        factor.solve_in_place(x);
        const auto column = static_cast<Eigen::Index>(l);
        for (Eigen::Index s = 0; s < sensors; ++s) {
          direct(s, column) +=
              sensor_rows[static_cast<std::size_t>(s)].dot(x) -
              sensor_shape.row(s).segment(first, n).dot(load_shape.col(column)
                                                            .segment(first, n)
                                                            .cwiseQuotient(omega2.cwiseMax(1e-300))
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
    out.damping.diagonal() += 2 * out.ratio.cwiseProduct(out.omega);
    out.modal = coupled_poles(out.omega, out.damping, load_shape, start);
  } else {
    out.modal = pole_model(out.omega, out.ratio, load_shape,
                           Eigen::MatrixXd::Identity(count, count), start);
  }
  out.sensors = out.modal;
  out.sensors.output.resize(sensors, out.modal.output.cols());
  out.sensors.output.real() = sensor_shape * out.modal.output.real();
  out.sensors.output.imag() = sensor_shape * out.modal.output.imag();
  if (any_direct) out.sensors.direct = direct;
  out.sensors.offset = Eigen::VectorXd::Zero(sensors);
  const Assembly& assembly = *modes.motions.front().assembly;
  Eigen::VectorXd axial(static_cast<Eigen::Index>(modes.chain->segments.size()));
  assembly.axial_forces(rest, axial);
  for (Eigen::Index s = 0; s < sensors; ++s) {
    const int segment = modes.chain->sensors[static_cast<std::size_t>(s)].segment;
    const auto quantity = scene.sensors[static_cast<std::size_t>(s)].quantity;
    if (described(quantity).reading == SensorReading::axial_force && segment >= 0) {
      out.sensors.offset(s) = axial(segment);
    }
  }
  return out;
}

}  // namespace rigfit::model
