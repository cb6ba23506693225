#include "model/explicit_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/motion_kernel.h"

namespace rigfit::model {
namespace {

// The forces of all loads, one value a step, such that impulse and its moment are exact: the
// average over neighbouring steps with a hat, less h^2/12 of the second difference that the average
// adds.
class StepForces {
 public:
  StepForces(const MotionProblem& problem, double step, long steps) {
    for (std::size_t l = 0; l < problem.loads.size(); ++l) {
      const LoadForce force(problem.loads[l], problem.records[l]);
      Load_ load;
      const double end = force.end_s();
      const std::vector<double> corners = force.corners();
      if (end > 0 && !corners.empty()) {
        load.first = std::max(0L, static_cast<long>(std::floor(corners.front() / step)) - 2);
        const long last = std::min(steps, static_cast<long>(std::ceil(end / step)) + 2);
        std::vector<double> hat;
        for (long n = load.first - 1; n <= last + 1; ++n) {
          // Mirrored at t = 0, where the first kick lasts half a step only.
          hat.push_back((n == 0 ? 2 : 1) *
                        hat_average(force, corners, static_cast<double>(std::abs(n)) * step, step));
        }
        for (std::size_t i = 1; i + 1 < hat.size(); ++i) {
          load.value.push_back(hat[i] - (hat[i + 1] - 2 * hat[i] + hat[i - 1]) / 12);
        }
        active_from_ = std::min(active_from_, load.first);
        active_to_ = std::max(active_to_, last);
      }
      loads_.push_back(std::move(load));
    }
  }
  [[nodiscard]] bool active(long n) const { return n >= active_from_ && n <= active_to_; }
  [[nodiscard]] double at(std::size_t l, long n) const {
    const Load_& load = loads_[l];
    const long i = n - load.first;
    return i >= 0 && i < static_cast<long>(load.value.size())
               ? load.value[static_cast<std::size_t>(i)]
               : 0;
  }
  [[nodiscard]] std::size_t count() const { return loads_.size(); }

 private:
  struct Load_ {
    long first = 0;
    std::vector<double> value;
  };

  // (1/h) int f(t + s) (1 - |s|/h) ds by Gauss-Legendre (5 points) between corners. Before t = 0
  // there is no force.
  static double hat_average(const LoadForce& force, const std::vector<double>& corners, double t,
                            double h) {
    std::vector<double> cuts{std::max(0.0, t - h), std::max(0.0, t), std::max(0.0, t + h)};
    for (auto c = std::lower_bound(corners.begin(), corners.end(), t - h);
         c != corners.end() && *c < t + h; ++c) {
      if (*c > 0) cuts.push_back(*c);
    }
    std::sort(cuts.begin(), cuts.end());
    static constexpr double kNode[5] = {-0.9061798459386640, -0.5384693101056831, 0,
                                        0.5384693101056831, 0.9061798459386640};
    static constexpr double kWeight[5] = {0.2369268850561891, 0.4786286704993665,
                                          0.5688888888888889, 0.4786286704993665,
                                          0.2369268850561891};
    double sum = 0;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      const double middle = (cuts[i] + cuts[i + 1]) / 2, half = (cuts[i + 1] - cuts[i]) / 2;
      if (!(half > 0)) continue;
      for (int k = 0; k < 5; ++k) {
        const double at = middle + half * kNode[k];
        sum += kWeight[k] * half * force.at(at) * (1 - std::abs(at - t) / h);
      }
    }
    return sum / h;
  }

  std::vector<Load_> loads_;
  long active_from_ = std::numeric_limits<long>::max(), active_to_ = -1;
};

// Dampers act at least every four steps; the steps of a sample are a multiple of this.
long damping_pieces(long substeps) { return (substeps + 3) / 4; }

template <int D>
class ExplicitRun {
 public:
  ExplicitRun(const MotionProblem& problem, const ExplicitOptions& options, double step,
              long substeps)
      : problem_(problem),
        options_(options),
        kernel_(*problem.chain),
        assembly_(*problem.chain, problem.motion),
        mass_(assembly_.matrix()),
        h_(step),
        substeps_(substeps),
        piece_(substeps / damping_pieces(substeps)) {
    assembly_.mass(mass_);
    const int n = kernel_.size();
    q_ = kernel_.positions(problem.start);
    rest_ = kernel_.positions(problem.rest);
    v_ = problem.start_velocity.size() > 0
             ? kernel_.slot_values(problem.start_velocity, assembly_.numbering())
             : Eigen::VectorXd::Zero(n);
    a_ = first_ = ahead_ = Eigen::VectorXd::Zero(n);
    external_ = Eigen::VectorXd::Zero(n);
    const Chain& chain = *problem.chain;
    for (std::size_t l = 0; l < chain.loads.size(); ++l) {
      load_rows_.push_back(kernel_.row(chain.loads[l], chain.load_direction[l]));
    }
    for (std::size_t s = 0; s < chain.sensors.size(); ++s) {
      sensor_rows_.push_back(kernel_.row(chain.sensors[s], chain.sensor_direction[s]));
    }
    damped_ = problem.joint_damping || !problem.modal_damping.none();
    if (problem.joint_damping) damping_ = dissipation_ = assembly_.matrix();
    if (!problem.modal_damping.none()) {
      momentum_.resize(problem.modal_damping.shapes.rows(), problem.modal_damping.shapes.cols());
      Eigen::VectorXd column(mass_.size());
      for (Eigen::Index r = 0; r < momentum_.cols(); ++r) {
        mass_.multiply(problem.modal_damping.shapes.col(r), column);
        momentum_.col(r) = column;
      }
    }
  }

  MotionOutput run() {
    const long rows = options_.sampling.rows();
    const long stride = options_.sampling.energy_stride();
    MotionOutput out;
    out.step_s = h_;
    out.samples.resize(rows, static_cast<Eigen::Index>(sensor_rows_.size()));
    const StepForces forces(problem_, h_, (rows - 1) * substeps_);
    preprocess();
    double supplied = 0, dissipated = 0, start_energy = 0, moving = 0;
    load(forces, 0);
    evaluate();
    const double span = h_ * static_cast<double>(substeps_);
    const double piece = h_ * static_cast<double>(piece_);
    for (long row = 0; row < rows; ++row) {
      Eigen::VectorXd& before = v_before_;
      if (damped_) {
        before = v_;
        if (row > 0) dissipated += damp(piece / 2);
      }
      const bool account =
          options_.sampling.energy_samples > 0 && (row % stride == 0 || row == rows - 1);
      const bool watch = account || row % 16 == 0;
      if (watch) {
        processed_velocity();
        const double kinetic = kernel_.mass_product(vp_, vp_) / 2;
        const double energy =
            kernel_.potential(options_.verlet ? q_ : ahead_) + kinetic - supplied + dissipated;
        if (row == 0) {
          start_energy = energy;
          moving = std::abs(energy - kernel_.potential(rest_));
        }
        moving = std::max({moving, kinetic, std::abs(supplied)});
        // Reversible steps keep the energy to a small fraction; beyond a tenth they are unstable.
        if (!std::isfinite(energy) ||
            std::abs(energy - start_energy) > 0.1 * moving + 1e-9 * std::abs(start_energy)) {
          out.reason = "the energy grew without a load";
          return out;
        }
        if (account) record(out, static_cast<double>(row) * span, supplied, dissipated);
      } else if (velocity_wanted_) {
        processed_velocity();
      }
      sample(out, row);
      if (row + 1 == rows) break;
      if (damped_) {
        const Eigen::Index column_count = out.samples.cols();
        const double lost = damp(piece / 2);
        if (row > 0) {
          for (Eigen::Index s = 0; s < column_count; ++s) {
            const auto k = static_cast<std::size_t>(s);
            if (problem_.quantities[k] != Sensor::Quantity::acceleration) continue;
            out.samples(row, s) +=
                (sensor_rows_[k].dot(v_.data()) - sensor_rows_[k].dot(before.data())) / piece;
          }
        } else {
          for (Eigen::Index s = 0; s < column_count; ++s) {
            const auto k = static_cast<std::size_t>(s);
            if (problem_.quantities[k] != Sensor::Quantity::acceleration) continue;
            out.samples(row, s) +=
                (sensor_rows_[k].dot(v_.data()) - sensor_rows_[k].dot(before.data())) / (piece / 2);
          }
        }
        dissipated += lost;
      }
      const int n = kernel_.size();
      const double half = h_ / 2;
      for (long i = 0; i < substeps_; ++i) {
        if (damped_ && i > 0 && i % piece_ == 0) dissipated += damp(piece);
        double* q = q_.data();
        double* v = v_.data();
        const double* a = a_.data();
        const long step = row * substeps_ + i;
        const bool loaded = forces.active(step) || forces.active(step + 1);
        if (loaded) supplied += half * work(forces, step, half);
        for (int k = 0; k < n; ++k) {
          v[k] += half * a[k];
          q[k] += h_ * v[k];
        }
        if (loaded) load(forces, step + 1);
        evaluate();
        if (loaded) supplied += half * work(forces, step + 1, half);
        for (int k = 0; k < n; ++k) v[k] += half * a[k];
        ++out.steps;
      }
    }
    out.evaluations = evaluations_;
    out.completed = out.samples.allFinite();
    if (!out.completed) out.reason = "the motion is not finite";
    return out;
  }

  void want_velocity() {
    for (const auto quantity : problem_.quantities) {
      velocity_wanted_ = velocity_wanted_ || quantity == Sensor::Quantity::velocity;
    }
  }

 private:
  void evaluate() {
    const double* external = loaded_ ? external_.data() : nullptr;
    if (options_.verlet) {
      kernel_.acceleration(q_.data(), external, a_.data());
      ++evaluations_;
      return;
    }
    kernel_.acceleration(q_.data(), external, first_.data());
    const double ahead = h_ * h_ / 12;
    const int n = kernel_.size();
    const double* q = q_.data();
    const double* f = first_.data();
    double* p = ahead_.data();
    for (int k = 0; k < n; ++k) p[k] = q[k] + ahead * f[k];
    kernel_.acceleration(p, external, a_.data());
    evaluations_ += 2;
  }

  void load(const StepForces& forces, long step) {
    loaded_ = forces.active(step);
    if (!loaded_) return;
    external_.setZero();
    for (std::size_t l = 0; l < forces.count(); ++l) {
      const double f = forces.at(l, step);
      for (std::size_t i = 0; i < load_rows_[l].index.size(); ++i) {
        external_(load_rows_[l].index[i]) += load_rows_[l].weight[i] * f;
      }
    }
  }
  // Force times mean velocity of the kick v -> v + half a: the power, whose product with `half` is
  // the work.
  double work(const StepForces& forces, long step, double half) const {
    double sum = 0;
    for (std::size_t l = 0; l < forces.count(); ++l) {
      const double f = forces.at(l, step);
      if (f == 0) continue;
      sum += f * (load_rows_[l].dot(v_.data()) + half / 2 * load_rows_[l].dot(a_.data()));
    }
    return sum;
  }

  // The scheme's own variables for the start: q - h^2/12 a(q), v + h^2/12 da/dt.
  void preprocess() {
    if (options_.verlet) return;
    const Eigen::VectorXd start = q_;
    for (int i = 0; i < 3; ++i) {
      kernel_.acceleration(q_.data(), nullptr, first_.data());
      q_ = start - h_ * h_ / 12 * first_;
    }
    if (v_.isZero(0)) return;
    acceleration_rate();
    v_ += h_ * h_ / 12 * rate_;
  }
  // d a(q)/dt along v, central difference over two steps.
  void acceleration_rate() {
    scratch_ = q_ + h_ * v_;
    rate_.resize(q_.size());
    kernel_.acceleration(scratch_.data(), nullptr, rate_.data());
    scratch_ = q_ - h_ * v_;
    other_.resize(q_.size());
    kernel_.acceleration(scratch_.data(), nullptr, other_.data());
    rate_ = (rate_ - other_) / (2 * h_);
    evaluations_ += 2;
  }
  void processed_velocity() {
    if (options_.verlet) {
      vp_ = v_;
      return;
    }
    acceleration_rate();
    vp_ = v_ - h_ * h_ / 12 * rate_;
  }

  // Velocities after `time` of the dampers alone; the kinetic energy they took.
  double damp(double time) {
    const double before = kernel_.mass_product(v_, v_) / 2;
    if (!problem_.modal_damping.none()) damp_modes(time);
    if (problem_.joint_damping) damp_joints(time);
    return before - kernel_.mass_product(v_, v_) / 2;
  }
  void damp_modes(double time) {
    const ModalDamping& damping = problem_.modal_damping;
    u_ = kernel_.unknowns(v_, assembly_.numbering());
    modal_.noalias() = momentum_.transpose() * u_;
    for (Eigen::Index r = 0; r < modal_.size(); ++r) {
      modal_(r) *= std::expm1(-damping.rate(r) * time);
    }
    u_.noalias() = damping.shapes * modal_;
    v_ += kernel_.slot_values(u_, assembly_.numbering());
  }
  void damp_joints(double time) {
    constexpr double gamma = 1 - std::numbers::sqrt2 / 2;
    if (time != damping_time_ || --damping_left_ <= 0) {
      assembly_.damping(kernel_.state(options_.verlet ? q_ : ahead_), damping_);
      dissipation_.values() = mass_.values() + gamma * time * damping_.values();
      // Turning nodes without dampers have neither mass nor damping: they follow freely.
      double largest = 0;
      for (int i = 0; i < dissipation_.size(); ++i) {
        largest = std::max(largest, dissipation_.at(i, i));
      }
      for (int i = 0; i < dissipation_.size(); ++i) {
        if (dissipation_.at(i, i) == 0) dissipation_.add(i, i, largest * 1e-12);
      }
      damping_factor_.factor(dissipation_);
      damping_time_ = time;
      damping_left_ = 1;
    }
    u_ = kernel_.unknowns(v_, assembly_.numbering());
    w_.resize(u_.size());
    mass_.multiply(u_, w_);
    damping_factor_.solve_in_place(w_);
    // (w - v)/(gamma time) is the first stage's slope.
    u_ += (1 - gamma) / gamma * (w_ - u_);
    mass_.multiply(u_, w_);
    damping_factor_.solve_in_place(w_);
    v_ = kernel_.slot_values(w_, assembly_.numbering());
  }

  void sample(MotionOutput& out, long row) const {
    const double* p = (options_.verlet ? q_ : ahead_).data();
    for (std::size_t s = 0; s < sensor_rows_.size(); ++s) {
      const auto column = static_cast<Eigen::Index>(s);
      switch (problem_.quantities[s]) {
        case Sensor::Quantity::displacement:
          out.samples(row, column) = sensor_rows_[s].dot(p) - sensor_rows_[s].dot(rest_.data());
          break;
        case Sensor::Quantity::velocity:
          out.samples(row, column) = sensor_rows_[s].dot(vp_.data());
          break;
        case Sensor::Quantity::acceleration:
          out.samples(row, column) = sensor_rows_[s].dot(a_.data());
          break;
        case Sensor::Quantity::force:
          out.samples(row, column) = kernel_.axial_force(problem_.chain->sensors[s].segment, p);
          break;
      }
    }
  }

  void record(MotionOutput& out, double time, double supplied, double dissipated) {
    const ChainState state = kernel_.state(options_.verlet ? q_ : ahead_);
    out.energy.time_s.push_back(time);
    out.energy.account.push_back(
        assembly_.energy(state, kernel_.unknowns(vp_, assembly_.numbering())));
    out.energy.supplied.push_back(supplied);
    out.energy.dissipated.push_back(dissipated);
  }

  const MotionProblem& problem_;
  const ExplicitOptions& options_;
  MotionKernel<D> kernel_;
  Assembly assembly_;
  EnvelopeMatrix mass_, damping_, dissipation_;
  EnvelopeFactor damping_factor_;
  double damping_time_ = -1;
  int damping_left_ = 0;
  double h_;
  long substeps_, piece_;
  long evaluations_ = 0;
  bool loaded_ = false, damped_ = false, velocity_wanted_ = false;
  Eigen::VectorXd q_, v_, a_, first_, ahead_, external_, rest_, vp_, rate_, other_, scratch_, u_,
      w_, modal_, v_before_;
  Eigen::MatrixXd momentum_;
  std::vector<typename MotionKernel<D>::Row> load_rows_, sensor_rows_;
};

template <int D>
double power_method(const Chain& chain, const ChainState& state) {
  MotionKernel<D> kernel(chain);
  const Eigen::VectorXd q = kernel.positions(state);
  Eigen::VectorXd x(q.size()), plus(q.size()), minus(q.size());
  // Neighbouring nodes against each other: near the highest axial mode of every member.
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    x(i) = (i % 2 == 0 ? 1 : -1) * (1 + 0.3 * std::sin(1.7 * static_cast<double>(i)));
  }
  kernel.acceleration(q.data(), nullptr, plus.data());
  double lambda = 0;
  // Small against a segment, large against rounding of positions.
  const double size = 1e-6 * (q.maxCoeff() - q.minCoeff());
  for (int i = 0; i < 80; ++i) {
    const double factor = size / x.cwiseAbs().maxCoeff();
    const Eigen::VectorXd up = q + factor * x, down = q - factor * x;
    kernel.acceleration(up.data(), nullptr, plus.data());
    kernel.acceleration(down.data(), nullptr, minus.data());
    Eigen::VectorXd next = (minus - plus) / (2 * factor);
    const double norm = kernel.mass_product(next, next), own = kernel.mass_product(next, x);
    if (!(norm > 0) || !(own > 0)) break;
    // |K x|_M^2 / (x K x): a Rayleigh quotient one half-step ahead. The first few x have parts in
    // directions that are held.
    lambda = norm / own;
    x = next;
  }
  return std::sqrt(lambda);
}

template <int D>
MotionOutput run_explicit(const MotionProblem& problem, const ExplicitOptions& options) {
  const double sample = 1 / options.sampling.rate_hz;
  double largest = options.step_s.value_or(0);
  if (!options.step_s) {
    const double highest = std::max(power_method<D>(*problem.chain, problem.start),
                                    power_method<D>(*problem.chain, problem.rest));
    const double limit = options.verlet ? options.stability / std::sqrt(3) : options.stability;
    largest = highest > 0 ? limit / highest : sample;
  }
  long substeps = std::max(1L, static_cast<long>(std::ceil(sample / largest * (1 - 1e-12))));
  MotionOutput out;
  for (int attempt = 0; attempt < 5; ++attempt, substeps *= 2) {
    const long pieces = damping_pieces(substeps);
    substeps = pieces * ((substeps + pieces - 1) / pieces);
    while (substeps % damping_pieces(substeps) != 0) ++substeps;
    ExplicitRun<D> run(problem, options, sample / static_cast<double>(substeps), substeps);
    run.want_velocity();
    out = run.run();
    if (out.completed) return out;
  }
  return out;
}

}  // namespace

double highest_frequency(const Chain& chain, Motion motion, const ChainState& state) {
  return motion == Motion::in_plane ? power_method<2>(chain, state) : power_method<3>(chain, state);
}

MotionOutput explicit_motion(const MotionProblem& problem, const ExplicitOptions& options) {
  return problem.motion == Motion::in_plane ? run_explicit<2>(problem, options)
                                            : run_explicit<3>(problem, options);
}

}  // namespace rigfit::model
