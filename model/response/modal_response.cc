#include "model/response/modal_response.h"

#include <cassert>

#include "model/scene/sensor_quantity.h"

namespace rigfit::model {
namespace {

using std::numbers::pi;

// phi1 and phi2 (n), by their series where the closed forms cancel.
Complex phi(int n, Complex x) {
  if (std::abs(x) > 0.5) {
    return n == 1 ? (std::exp(x) - 1.0) / x : (std::exp(x) - 1.0 - x) / (x * x);
  }
  Complex sum = 1.0 / n, term = sum;
  for (int k = n + 1; k < n + 15; ++k) sum += (term *= x / static_cast<double>(k));
  return sum;
}

// int_0^T e^{s (T - tau)} sin(Omega (a + tau)) dtau
Complex sine_integral(Complex s, double Omega, double a, double T) {
  const auto part = [&](Complex w) {  // int_0^T e^{s (T - tau)} e^{w (a + tau)} dtau
    const Complex x = (w - s) * T;
    return std::exp(w * a) * (std::abs(x) > 0.5 ? (std::exp(w * T) - std::exp(s * T)) / (w - s)
                                                : std::exp(s * T) * T * phi(1, x));
  };
  const Complex i(0, 1);
  return (part(i * Omega) - part(-i * Omega)) / (2.0 * i);
}

// What a recorded force adds to z from one time to another.
void add_record(const PoleModel& model, const ForceHistory& record,
                const Ref<const VectorXcd>& input, double t0, double t1, VectorXcd& z) {
  const auto& t = record.time_s;
  const auto& f = record.force_N;
  if (t1 <= t.front() || t0 >= t.back()) return;
  auto i = static_cast<std::size_t>(
      std::max<std::ptrdiff_t>(1, std::upper_bound(t.begin(), t.end(), t0) - t.begin()));
  for (; i < t.size() && t[i - 1] < t1; ++i) {
    const double from = std::max(t0, t[i - 1]), to = std::min(t1, t[i]), h = to - from;
    if (!(h > 0)) continue;
    const double slope = (f[i] - f[i - 1]) / (t[i] - t[i - 1]);
    const double f0 = f[i - 1] + slope * (from - t[i - 1]), rise = slope * h;
    for (Index r = 0; r < z.size(); ++r) {
      const Complex s = model.poles(r), x = s * h;
      z(r) += input(r) * std::exp(s * (t1 - to)) * h * (phi(1, x) * f0 + phi(2, x) * rise);
    }
  }
}

// Samples of a system left to itself: y_n = Re sum_r w_r z_r lambda_r^n, all sensors, `z` its state
// at the first row. The powers of a block of rows are those of every block.
void free_samples(const PoleModel& model, const MatrixXcd& weights, double step, const VectorXcd& z,
                  Ref<MatrixXd> out) {
  constexpr Index kBlock = 256;
  const Index sensors = weights.rows(), rows = out.rows(), poles = z.size();
  const Index blocks = (rows + kBlock - 1) / kBlock;
  MatrixXd powers(kBlock, 2 * poles), states(2 * poles, blocks * sensors);
  for (Index p = 0; p < poles; ++p) {
    const Complex s = model.poles(p), lambda = std::exp(s * step);
    Complex power = 1;
    for (Index k = 0; k < kBlock; ++k, power *= lambda) {
      powers(k, 2 * p) = power.real();
      powers(k, 2 * p + 1) = -power.imag();
    }
    for (Index j = 0; j < blocks; ++j) {
      const Complex state = z(p) * std::exp(s * (step * static_cast<double>(kBlock * j)));
      for (Index k = 0; k < sensors; ++k) {
        const Complex value = weights(k, p) * state;
        states(2 * p, k * blocks + j) = value.real();
        states(2 * p + 1, k * blocks + j) = value.imag();
      }
    }
  }
  const MatrixXd samples = powers * states;
  for (Index k = 0; k < sensors; ++k) {
    out.col(k) = Map<const VectorXd>(samples.data() + k * blocks * kBlock, rows);
  }
}

}  // namespace

PoleModel pole_model(const VectorXd& omega, const VectorXd& damping_ratio,
                     const MatrixXd& load_shape, const MatrixXd& sensor_shape,
                     const VectorXd& displacement) {
  const Index modes = omega.size();
  assert(load_shape.rows() == modes && sensor_shape.cols() == modes);
  assert(displacement.size() == modes);
  Index poles = 0;
  for (Index r = 0; r < modes; ++r) poles += damping_ratio(r) < 1 ? 1 : 2;
  PoleModel model;
  model.poles.resize(poles);
  model.input.resize(poles, load_shape.cols());
  model.output.resize(sensor_shape.rows(), poles);
  model.initial = VectorXcd::Zero(poles);
  Index p = 0;
  for (Index r = 0; r < modes; ++r) {
    const double w = omega(r);
    double zeta = damping_ratio(r);
    // Two equal poles have no such expansion; 1e-8 beside them the response differs by as much.
    if (std::abs(zeta - 1) < 1e-8) zeta = zeta < 1 ? 1 - 1e-8 : 1 + 1e-8;
    // Both roots, the slow one without cancellation; one of a conjugate pair stands for both.
    const bool pair = zeta < 1;
    const Complex root = w * std::sqrt(Complex((zeta - 1) * (zeta + 1)));
    const Complex fast = -zeta * w - root, slow = w * w / fast;
    for (int k = 0; k < (pair ? 1 : 2); ++k, ++p) {
      const Complex own = k == 0 ? slow : fast, other = k == 0 ? fast : slow;
      model.poles(p) = own;
      model.input.row(p) = load_shape.row(r).cast<Complex>();
      model.output.col(p) =
          sensor_shape.col(r).cast<Complex>() * ((pair ? 2.0 : 1.0) / (own - other));
      model.initial(p) = -other * displacement(r);
    }
  }
  return model;
}

void advance(const PoleModel& model, const std::vector<LoadForce>& forces, double t0, double t1,
             VectorXcd& z) {
  const double h = t1 - t0;
  if (!(h > 0)) return;
  for (Index r = 0; r < z.size(); ++r) z(r) *= std::exp(model.poles(r) * h);
  for (std::size_t l = 0; l < forces.size(); ++l) {
    const Load& load = forces[l].load;
    const auto input = model.input.col(static_cast<Index>(l));
    if (load.kind == Load::Kind::impact) {
      const double from = std::max(t0, load.start);
      const double to = std::min(t1, load.start + load.duration);
      if (!(to > from)) continue;
      const double Omega = pi / load.duration;
      for (Index r = 0; r < z.size(); ++r) {
        const Complex s = model.poles(r);
        z(r) += input(r) * load.peak * std::exp(s * (t1 - to)) *
                sine_integral(s, Omega, from - load.start, to - from);
      }
    } else if (load.kind == Load::Kind::record) {
      add_record(model, *forces[l].record, input, t0, t1, z);
    }
  }
}

MatrixXd modal_response(const PoleModel& model, const std::vector<Sensor::Quantity>& quantities,
                        const std::vector<LoadForce>& forces, double step_s, Index rows) {
  const Index sensors = model.output.rows(), poles = model.poles.size();
  assert(static_cast<Index>(quantities.size()) == sensors && step_s > 0);
  assert(model.input.cols() == static_cast<Index>(forces.size()));
  // Derivatives of Re(c z): Re(c s z) + Re(c b) f, and so on; the first feed-through vanishes for
  // displacements, the second is the unit force's acceleration.
  MatrixXcd weights = model.output;
  MatrixXd direct = MatrixXd::Zero(sensors, model.input.cols());
  for (Index k = 0; k < sensors; ++k) {
    const int derivatives = described(quantities[static_cast<std::size_t>(k)]).derivatives;
    if (derivatives == 0) {
      if (model.direct.size() > 0) direct.row(k) = model.direct.row(k);
      continue;
    }
    weights.row(k) = weights.row(k).cwiseProduct(model.poles.transpose());
    if (derivatives == 2) {
      if (poles > 0) direct.row(k) = (weights.row(k) * model.input).real();
      weights.row(k) = weights.row(k).cwiseProduct(model.poles.transpose());
    }
  }

  MatrixXd out = MatrixXd::Zero(rows, sensors);
  VectorXcd z = model.initial;
  Index row = 0;
  // Sample by sample while any force acts, then freely.
  const double last_force = last_force_s(forces);
  for (double t = 0; row < rows && t < last_force; ++row, t = step_s * static_cast<double>(row)) {
    if (row > 0) advance(model, forces, step_s * static_cast<double>(row - 1), t, z);
    for (Index k = 0; k < sensors; ++k) out(row, k) = (weights.row(k) * z).real().value();
    for (std::size_t l = 0; l < forces.size(); ++l) {
      const double f = forces[l].at(t);
      if (f != 0) out.row(row) += f * direct.col(static_cast<Index>(l)).transpose();
    }
  }
  if (row < rows) {
    const double t = step_s * static_cast<double>(row);
    if (row > 0) advance(model, forces, step_s * static_cast<double>(row - 1), t, z);
    free_samples(model, weights, step_s, z, out.bottomRows(rows - row));
  }
  if (model.offset.size() > 0) out.rowwise() += model.offset.transpose();
  return out;
}

}  // namespace rigfit::model
