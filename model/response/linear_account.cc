#include "model/response/linear_account.h"

#include <algorithm>
#include <cmath>

#include "model/response/linear_energy.h"

namespace rigfit::model {
namespace {

using Complex = std::complex<double>;

class Account {
 public:
  Account(const ChainModes& modes, const LinearAnswer& answer, const Scene& scene,
          const std::vector<const ForceHistory*>& records)
      : answer_(answer), model_(answer.modal), propagator_(model_, scene.loads, records) {
    const Eigen::Index poles = model_.poles.size();
    velocity_ = model_.output * model_.poles.asDiagonal();
    load_velocity_.resize(static_cast<Eigen::Index>(scene.loads.size()), poles);
    Eigen::MatrixXd shapes(answer.omega.size(), load_velocity_.rows());
    for (std::size_t i = 0; i < answer.mode.size(); ++i) {
      const int m = answer.mode[i].motion;
      const MotionModes& motion = modes.motions[static_cast<std::size_t>(m)];
      if (parts_.empty() || parts_.back().motion != m) {
        energies_.emplace_back(*motion.assembly, modes.equilibrium.state);
        parts_.push_back({m, static_cast<Eigen::Index>(i), 0, {}});
      }
      ++parts_.back().count;
    }
    for (Part& part : parts_) {
      const MotionModes& motion = modes.motions[static_cast<std::size_t>(part.motion)];
      part.shapes.resize(motion.shapes.rows(), part.count);
      for (Eigen::Index i = 0; i < part.count; ++i) {
        const int mode = answer.mode[static_cast<std::size_t>(part.first + i)].mode;
        part.shapes.col(i) = motion.shapes.col(mode);
      }
      for (Eigen::Index l = 0; l < shapes.cols(); ++l) {
        shapes.col(l).segment(part.first, part.count) =
            part.shapes.transpose() * load_row(*motion.assembly, static_cast<int>(l));
      }
    }
    load_velocity_.real() = shapes.transpose() * velocity_.real();
    load_velocity_.imag() = shapes.transpose() * velocity_.imag();
    quadratic_forms();
    std::vector<double> corners;
    for (std::size_t l = 0; l < scene.loads.size(); ++l) {
      for (const double corner : propagator_.force(l).corners()) corners.push_back(corner);
    }
    std::sort(corners.begin(), corners.end());
    corners_ = std::move(corners);
    panel_ = panel_length(scene);
    rest_ = modes.motions.front().assembly->energy(modes.equilibrium.state);
  }

  EnergyHistory run(const SamplingOptions& sampling) {
    EnergyHistory out;
    const long rows = sampling.rows(), stride = sampling.energy_stride();
    Eigen::VectorXcd z = propagator_.initial();
    double last = 0, supplied = 0, dissipated = 0;
    for (long row = 0; row < rows; ++row) {
      if (row % stride != 0 && row != rows - 1) continue;
      const double t = static_cast<double>(row) / sampling.rate_hz;
      integrate(z, last, t, supplied, dissipated);
      last = t;
      const Eigen::VectorXd q = (model_.output * z).real(), v = (velocity_ * z).real();
      EnergyAccount account = rest_;
      for (std::size_t k = 0; k < parts_.size(); ++k) {
        const Part& part = parts_[k];
        energies_[k].add(part.shapes * q.segment(part.first, part.count),
                         part.shapes * v.segment(part.first, part.count), account);
      }
      out.time_s.push_back(t);
      out.account.push_back(std::move(account));
      out.supplied.push_back(supplied);
      out.dissipated.push_back(dissipated);
    }
    return out;
  }

 private:
  struct Part {
    int motion;
    Eigen::Index first, count;
    Eigen::MatrixXd shapes;
  };

  // q' D q' = Re(z^H A z + z' B z) / 2, and the same integrated over a free motion.
  void quadratic_forms() {
    const Eigen::Index poles = model_.poles.size();
    // By real and imaginary parts: D is real, and real products are cheap to compile.
    Eigen::MatrixXd damping = answer_.damping;
    if (!answer_.coupled) damping = (2 * answer_.ratio.cwiseProduct(answer_.omega)).asDiagonal();
    const Eigen::MatrixXd re = velocity_.real(), im = velocity_.imag();
    const Eigen::MatrixXd dre = damping * re, dim = damping * im;
    const Eigen::MatrixXd rr = re.transpose() * dre, ri = re.transpose() * dim,
                          ir = im.transpose() * dre, ii = im.transpose() * dim;
    conjugate_.resize(poles, poles);
    plain_.resize(poles, poles);
    conjugate_.real() = rr + ii;
    conjugate_.imag() = ri - ir;
    plain_.real() = rr - ii;
    plain_.imag() = ri + ir;
    free_conjugate_ = conjugate_;
    free_plain_ = plain_;
    for (Eigen::Index q = 0; q < poles; ++q) {
      for (Eigen::Index p = 0; p < poles; ++p) {
        if (conjugate_(p, q) != Complex(0)) {
          free_conjugate_(p, q) /= std::conj(model_.poles(p)) + model_.poles(q);
        }
        if (plain_(p, q) != Complex(0)) free_plain_(p, q) /= model_.poles(p) + model_.poles(q);
      }
    }
  }
  static double form(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b,
                     const Eigen::VectorXcd& z) {
    return (z.dot(a * z) + (z.transpose() * (b * z)).value()).real() / 2;
  }

  // Panels of Gauss's rule resolve the waves that loads move: all but a millionth of the static
  // compliance at the loads lies below the frequency w of panels 2 / w.
  double panel_length(const Scene& scene) const {
    std::vector<std::pair<double, double>> weights;  // frequency, compliance
    double sum = 0;
    for (Eigen::Index p = 0; p < model_.poles.size(); ++p) {
      const double w = std::abs(model_.poles(p));
      weights.emplace_back(w, model_.input.row(p).squaredNorm() / std::max(w * w, 1e-300));
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

  void integrate(Eigen::VectorXcd& z, double from, double to, double& supplied,
                 double& dissipated) const {
    static constexpr double kNode[5] = {-0.9061798459386640, -0.5384693101056831, 0,
                                        0.5384693101056831, 0.9061798459386640};
    static constexpr double kWeight[5] = {0.2369268850561891, 0.4786286704993665,
                                          0.5688888888888889, 0.4786286704993665,
                                          0.2369268850561891};
    const double last_force = propagator_.last_force_s();
    double t = from;
    while (t < to && t < last_force) {
      double end = std::min({to, last_force, t + panel_});
      const auto corner = std::upper_bound(corners_.begin(), corners_.end(), t);
      if (corner != corners_.end()) end = std::min(end, *corner);
      const double middle = (t + end) / 2, half = (end - t) / 2;
      double done = t;
      for (int k = 0; k < 5; ++k) {
        const double here = middle + half * kNode[k];
        propagator_.advance(z, done, here);
        done = here;
        dissipated += kWeight[k] * half * form(conjugate_, plain_, z);
        const Eigen::VectorXd v = (load_velocity_ * z).real();
        for (Eigen::Index l = 0; l < v.size(); ++l) {
          supplied +=
              kWeight[k] * half * v(l) * propagator_.force(static_cast<std::size_t>(l)).at(here);
        }
      }
      propagator_.advance(z, done, end);
      t = end;
    }
    if (t >= to) return;
    dissipated -= form(free_conjugate_, free_plain_, z);
    propagator_.advance(z, t, to);
    dissipated += form(free_conjugate_, free_plain_, z);
  }

  const LinearAnswer& answer_;
  const PoleModel& model_;
  ModalPropagator propagator_;
  Eigen::MatrixXcd velocity_, load_velocity_, conjugate_, plain_, free_conjugate_, free_plain_;
  std::vector<LinearEnergy> energies_;
  std::vector<Part> parts_;
  std::vector<double> corners_;
  double panel_ = 0;
  EnergyAccount rest_;
};

}  // namespace

EnergyHistory linear_account(const ChainModes& modes, const LinearAnswer& answer,
                             const Scene& scene, const std::vector<const ForceHistory*>& records,
                             const SamplingOptions& sampling) {
  if (sampling.energy_samples <= 0 || modes.motions.empty()) return {};
  return Account(modes, answer, scene, records).run(sampling);
}

}  // namespace rigfit::model
