#include "model/response/linear_balance.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rigfit::model {
namespace {

using Complex = std::complex<double>;

constexpr std::array<double, 5> kNode{-0.9061798459386640, -0.5384693101056831, 0,
                                      0.5384693101056831, 0.9061798459386640};
constexpr std::array<double, 5> kWeight{0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                        0.4786286704993665, 0.2369268850561891};

// q' D q' = Re(z^H A z + z' B z) / 2: A, B of the damping's power or of its integral over time.
struct Form {
  Eigen::MatrixXcd conjugate, plain;
  [[nodiscard]] double operator()(const Eigen::VectorXcd& z) const {
    return (z.dot(conjugate * z) + (z.transpose() * (plain * z)).value()).real() / 2;
  }
};

// Panels of Gauss's rule resolve the waves that loads move: all but a millionth of the static
// compliance at the loads lies below the frequency w of panels 2 / w.
double panel_length(const PoleModel& model, const Scene& scene) {
  std::vector<std::pair<double, double>> weights;  // frequency, compliance
  double sum = 0;
  for (Eigen::Index p = 0; p < model.poles.size(); ++p) {
    const double w = std::abs(model.poles(p));
    weights.emplace_back(w, model.input.row(p).squaredNorm() / std::max(w * w, 1e-300));
    sum += weights.back().second;
  }
  std::sort(weights.begin(), weights.end());
  double held = 0, top = 0;
  for (const auto& [w, weight] : weights) {
    top = w;
    held += weight;
    if (held >= (1 - 1e-6) * sum) break;
  }
  double panel = 2 / std::max(top, 1e-3);
  for (const Load& load : scene.loads) {
    if (load.kind == Load::Kind::impact) panel = std::min(panel, load.duration / 8);
  }
  return panel;
}

}  // namespace

EnergyBalance linear_balance(const LinearAnswer& answer, const Scene& scene,
                             const std::vector<const ForceHistory*>& records,
                             const SamplingOptions& sampling) {
  EnergyBalance out;
  if (sampling.energy_samples <= 0) return out;
  const PoleModel& model = answer.modal;
  const ModalPropagator propagator(model, scene.loads, records);
  const Eigen::MatrixXcd velocity = model.output * model.poles.asDiagonal();
  Form power;
  {  // by real and imaginary parts: D is real
    Eigen::MatrixXd damping = answer.damping;
    if (!answer.coupled) damping = (2 * answer.ratio.cwiseProduct(answer.omega)).asDiagonal();
    const Eigen::MatrixXd re = velocity.real(), im = velocity.imag();
    const Eigen::MatrixXd dre = damping * re, dim = damping * im;
    const Eigen::MatrixXd rr = re.transpose() * dre, ri = re.transpose() * dim,
                          ii = im.transpose() * dim;
    power.conjugate = (rr + ii).cast<Complex>() + Complex(0, 1) * (ri - ri.transpose());
    power.plain = (rr - ii).cast<Complex>() + Complex(0, 1) * (ri + ri.transpose());
  }
  Form free = power;
  for (Eigen::Index q = 0; q < model.poles.size(); ++q) {
    for (Eigen::Index p = 0; p < model.poles.size(); ++p) {
      if (power.conjugate(p, q) != Complex(0)) {
        free.conjugate(p, q) /= std::conj(model.poles(p)) + model.poles(q);
      }
      if (power.plain(p, q) != Complex(0)) free.plain(p, q) /= model.poles(p) + model.poles(q);
    }
  }
  std::vector<double> corners;
  for (std::size_t l = 0; l < scene.loads.size(); ++l) {
    for (const double corner : propagator.force(l).corners()) corners.push_back(corner);
  }
  std::sort(corners.begin(), corners.end());
  const double panel = panel_length(model, scene), last_force = propagator.last_force_s();

  Eigen::VectorXcd z = propagator.initial();
  double t = 0, supplied = 0, dissipated = 0;
  const long rows = sampling.rows(), stride = sampling.energy_stride();
  for (long row = 0; row < rows; ++row) {
    if (row % stride != 0 && row != rows - 1) continue;
    const double to = static_cast<double>(row) / sampling.rate_hz;
    while (t < to && t < last_force) {
      double end = std::min({to, last_force, t + panel});
      const auto corner = std::upper_bound(corners.begin(), corners.end(), t);
      if (corner != corners.end()) end = std::min(end, *corner);
      const double middle = (t + end) / 2, half = (end - t) / 2;
      for (std::size_t k = 0; k < kNode.size(); ++k) {
        const double here = middle + half * kNode[k];
        propagator.advance(z, t, here);
        t = here;
        dissipated += kWeight[k] * half * power(z);
        const Eigen::VectorXd v = (velocity * z).real();
        for (std::size_t l = 0; l < scene.loads.size(); ++l) {
          const double f = propagator.force(l).at(here);
          if (f == 0) continue;
          supplied +=
              kWeight[k] * half * f * answer.load_shape.col(static_cast<Eigen::Index>(l)).dot(v);
        }
      }
      propagator.advance(z, t, end);
      t = end;
    }
    if (t < to) {
      dissipated -= free(z);
      propagator.advance(z, t, to);
      dissipated += free(z);
      t = to;
    }
    const Eigen::VectorXd q = (model.output * z).real(), v = (velocity * z).real();
    out.add(answer.omega.cwiseProduct(q).squaredNorm() / 2, v.squaredNorm() / 2, supplied,
            dissipated);
  }
  return out;
}

}  // namespace rigfit::model
