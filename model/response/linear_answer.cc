#include "model/response/linear_answer.h"

#include "model/algebra/eigenpairs.h"
#include "model/linear/damped_modes.h"
#include "model/scene/sensor_quantity.h"

namespace rigfit::model {
namespace {

// Poles of q'' + D q' + diag(omega^2) q = L f, started from q0 at rest.
PoleModel coupled_poles(const VectorXd& omega, const MatrixXd& damping, const MatrixXd& load,
                        const VectorXd& start) {
  const Index n = omega.size();
  // In (omega q, q'): of one size, so that the eigenvectors are well scaled.
  MatrixXd state = MatrixXd::Zero(2 * n, 2 * n);
  state.topRightCorner(n, n) = omega.asDiagonal();
  state.bottomLeftCorner(n, n) = -MatrixXd(omega.asDiagonal());
  state.bottomRightCorner(n, n) = -damping;
  MatrixXd right = MatrixXd::Zero(2 * n, load.cols() + 1);
  right.bottomLeftCorner(n, load.cols()) = load;
  right.col(load.cols()).head(n) = omega.cwiseProduct(start);
  const auto [values, vectors, left] = general_eigenpairs(state, right);

  std::vector<Index> keep;
  for (Index k = 0; k < 2 * n; ++k) {
    if (values(k).imag() >= 0) keep.push_back(k);
  }
  const auto poles = static_cast<Index>(keep.size());
  PoleModel model;
  model.poles.resize(poles);
  model.input.resize(poles, load.cols());
  model.output.resize(n, poles);
  model.initial.resize(poles);
  for (Index p = 0; p < poles; ++p) {
    const Index k = keep[static_cast<std::size_t>(p)];
    model.poles(p) = values(k);
    model.input.row(p) = left.row(k).head(load.cols());
    model.initial(p) = left(k, load.cols());
    const double twice = values(k).imag() > 0 ? 2 : 1;
    model.output.col(p) = twice * vectors.col(k).head(n).cwiseQuotient(omega.cast<Complex>());
  }
  return model;
}

// What each mode and each pole has of the motion after the last force.
void weigh(const Scene& scene, const std::vector<LoadForce>& forces, double duration_s,
           LinearAnswer& out) {
  const PoleModel& model = out.modal;
  const Index modes = out.omega.size(), poles = model.poles.size();
  out.energy = VectorXd::Zero(modes);
  out.sensed = VectorXd::Zero(poles);
  VectorXcd z = model.initial;
  const double begin = std::min(duration_s, last_force_s(forces));
  advance(model, forces, 0, begin, z);

  const double span = std::max(duration_s - begin, 1e-9);
  const auto mean_decay = [&](Index p) {
    const double decay = -2 * model.poles(p).real() * span;
    return decay > 1e-9 ? -std::expm1(-decay) / decay : 1;
  };
  double all = 0;
  for (Index p = 0; p < poles; ++p) {
    Index& mode = out.mode_of_pole.emplace_back(0);
    model.output.col(p).cwiseAbs().cwiseProduct(out.omega).maxCoeff(&mode);
    // Amplitude, not the displacement of the moment.
    const double omega2 = std::norm(model.poles(p));
    const double energy = std::norm(model.output(mode, p) * z(p)) * omega2 / 2;
    out.energy(mode) += energy;
    out.mean_omega2 += energy * mean_decay(p) * omega2;
    all += energy;
  }
  if (all > 0) out.mean_omega2 /= all;
  if (out.energy.sum() > 0) out.energy /= out.energy.sum();

  for (Index s = 0; s < out.sensors.output.rows(); ++s) {
    const int derivatives =
        described(scene.sensors[static_cast<std::size_t>(s)].quantity).derivatives;
    VectorXd own(poles);
    for (Index p = 0; p < poles; ++p) {
      own(p) = std::norm(out.sensors.output(s, p) * z(p)) *
               std::pow(std::norm(model.poles(p)), derivatives) * mean_decay(p);
    }
    if (own.sum() > 0) out.sensed += own / own.sum();
  }
  if (out.sensed.sum() > 0) out.sensed /= out.sensed.sum();
}

}  // namespace

VectorXd hung_weights(const Scene& scene) {
  VectorXd weights = VectorXd::Zero(static_cast<Index>(scene.loads.size()));
  for (Index l = 0; l < weights.size(); ++l) {
    const Load& load = scene.loads[static_cast<std::size_t>(l)];
    if (load.kind == Load::Kind::release) weights(l) = load.mass * scene.gravity.norm();
  }
  return weights;
}

VectorXd renumbered(const VectorXd& x, const Numbering& from, const Numbering& to) {
  VectorXd result = VectorXd::Zero(to.size);
  const auto move = [&](const auto& a, const auto& b) {
    for (Index i = 0; i < a.size(); ++i) {
      if (a.data()[i] >= 0 && b.data()[i] >= 0) result(b.data()[i]) = x(a.data()[i]);
    }
  };
  move(from.displacement, to.displacement);
  move(from.twist, to.twist);
  move(from.rotation, to.rotation);
  return result;
}

LinearAnswer linear_answer(ChainModes found, const Scene& scene,
                           const std::vector<LoadForce>& forces, double duration_s) {
  LinearAnswer out;
  out.modes = std::move(found);
  const ChainModes& modes = out.modes;
  if (modes.motions.empty()) return out;
  const ChainState& rest = modes.equilibrium.state;
  const auto loads = static_cast<Index>(scene.loads.size());
  const auto sensors = static_cast<Index>(scene.sensors.size());
  for (std::size_t k = 0; k < modes.motions.size(); ++k) {
    for (int i = 0; i < modes.motions[k].omega2.size(); ++i) {
      out.mode.push_back({static_cast<int>(k), i});
    }
  }
  const auto count = static_cast<Index>(out.mode.size());
  out.omega.resize(count);
  out.ratio.resize(count);
  MatrixXd sensor_shape(sensors, count), load_shape(count, loads);
  const bool coupled = has_joint_dampers(scene);  // by the dampers
  MatrixXd damping = MatrixXd::Zero(coupled ? count : 0, coupled ? count : 0);

  MatrixXd direct = MatrixXd::Zero(sensors, loads);
  Index first = 0;
  for (const MotionModes& motion : modes.motions) {
    const Index n = motion.omega2.size();
    if (n == 0) continue;
    const MatrixXd& shapes = motion.shapes;
    const VectorXd omega2 = motion.omega2.cwiseMax(0.0);
    out.ratio.segment(first, n) = modal_ratios(*motion.assembly, shapes, rest, scene);
    out.omega.segment(first, n) = omega2.cwiseSqrt();
    const MatrixXd load = load_rows(*motion.assembly);
    const MatrixXd sensor = sensor_rows(*motion.assembly, rest, scene);
    const MatrixXd own_load = shapes.transpose() * load;
    const MatrixXd own_sensor = sensor.transpose() * shapes;
    load_shape.middleRows(first, n) = own_load;
    sensor_shape.middleCols(first, n) = own_sensor;
    if (coupled) {
      EnvelopeMatrix c = motion.assembly->matrix();
      motion.assembly->damping(rest, c);
      damping.block(first, first, n, n) = shapes.transpose() * (c * shapes);
    }
    int inertial = 0;
    for (int i = 0; i < motion.mass.size(); ++i) inertial += motion.mass.at(i, i) > 0;
    if (n < inertial) {
      out.truncated = true;
      // The modes left out follow a force without delay: K^-1 less what the others give.
      EnvelopeFactor factor;
      factor.factor(motion.stiffness);
      MatrixXd x = load;
      factor.solve_in_place(x);
      direct += sensor.transpose() * x -
                own_sensor * omega2.cwiseMax(1e-300).cwiseInverse().asDiagonal() * own_load;
    }
    first += n;
  }

  const VectorXd start =
      (load_shape * hung_weights(scene)).cwiseQuotient(out.omega.cwiseAbs2().cwiseMax(1e-300));
  if (coupled) {
    damping.diagonal() += 2 * out.ratio.cwiseProduct(out.omega);
    out.modal = coupled_poles(out.omega, damping, load_shape, start);
  } else {
    out.modal =
        pole_model(out.omega, out.ratio, load_shape, MatrixXd::Identity(count, count), start);
  }
  out.sensors = out.modal;
  out.sensors.output.resize(sensors, out.modal.output.cols());
  out.sensors.output.real() = sensor_shape * out.modal.output.real();
  out.sensors.output.imag() = sensor_shape * out.modal.output.imag();
  if (out.truncated) out.sensors.direct = direct;
  out.sensors.offset = VectorXd::Zero(sensors);
  const VectorXd axial = axial_forces(*modes.chain, rest);
  for (Index s = 0; s < sensors; ++s) {
    const int segment = modes.chain->sensors[static_cast<std::size_t>(s)].segment;
    const auto quantity = scene.sensors[static_cast<std::size_t>(s)].quantity;
    if (described(quantity).reading == SensorReading::axial_force && segment >= 0) {
      out.sensors.offset(s) = axial(segment);
    }
  }
  weigh(scene, forces, duration_s, out);
  return out;
}

}  // namespace rigfit::model
