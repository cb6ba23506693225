#include "model/motion/explicit_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/motion/motion_kernel.h"
#include "model/motion/step_forces.h"
#include "model/motion/vector_loops.h"
#include "model/scene/sensor_quantity.h"

namespace rigfit::model {
namespace {

constexpr double kSlowing = 1.0 / 8;  // kappa / h^2
constexpr double kStability = 3.2;    // omega h at the highest frequency of the start; less than
                                      // 2 sqrt(3) to leave room for stiffening by motion

// Dampers act at least every four steps, or once in the interval asked for; the steps of a sample
// are a multiple of the pieces between.
long damping_pieces(long substeps, double interval_s, const ExplicitOptions& options) {
  const double step = interval_s / static_cast<double>(substeps);
  const long together = std::max(4L, static_cast<long>(options.damper_interval_s / step));
  return (substeps + together - 1) / together;
}

template <int D>
class ExplicitRun {
 public:
  ExplicitRun(const MotionProblem& problem, const ExplicitOptions& options, double step,
              long substeps, double kappa)
      : problem_(problem),
        options_(options),
        kernel_(*problem.chain),
        h_(step),
        substeps_(substeps),
        piece_(substeps / damping_pieces(substeps, step * static_cast<double>(substeps), options)),
        damped_(!problem.modal_damping.none()),
        memory_(kArrays * static_cast<std::size_t>(kernel_.size()), 0.0) {
    q_ = kernel_.positions(problem.start);
    rest_ = kernel_.positions(problem.rest);
    if (kappa > 0) kernel_.slow_axial(kappa, rest_);
    v_ = problem.start_velocity.size() > 0 ? kernel_.entry_values(problem.start_velocity)
                                           : Eigen::VectorXd::Zero(kernel_.size());
    const Chain& chain = *problem.chain;
    for (std::size_t l = 0; l < chain.loads.size(); ++l) {
      load_rows_.push_back(kernel_.row(chain.loads[l], chain.load_direction[l]));
    }
    for (std::size_t s = 0; s < chain.sensors.size(); ++s) {
      sensor_rows_.push_back(kernel_.row(chain.sensors[s], chain.sensor_direction[s]));
    }
    for (const auto quantity : problem_.quantities) {
      velocity_wanted_ = velocity_wanted_ || described(quantity).derivatives == 1;
    }
    for (std::size_t k = 0; k < (damped_ ? 2 : 0); ++k) {
      const ModalDamping& damping = problem.modal_damping;
      const double time = h_ * static_cast<double>(piece_) / (k == 0 ? 2 : 1);
      const Eigen::VectorXd lost =
          (-time * damping.rate).unaryExpr([](double x) { return std::expm1(x); });
      decay_[k] = damping.shapes * lost.asDiagonal() * damping.momentum.transpose();
    }
  }

  MotionOutput run() {
    const long rows = options_.sampling.rows();
    const long stride = options_.sampling.energy_stride();
    // Steps that slow waves are unstable where the chain turns too far: nothing of that may stay.
    const double growth = kernel_.kappa() > 0 ? 0.003 : 0.1;
    MotionOutput out;
    out.step_s = h_;
    out.axial_slowing_s2 = kernel_.kappa();
    out.samples.resize(rows, static_cast<Eigen::Index>(sensor_rows_.size()));
    out.steps = (rows - 1) * substeps_;
    const StepForces forces(problem_, h_, out.steps);
    out.energy.rounding = rounding() * static_cast<double>(out.steps);
    preprocess();
    double start_energy = 0, moving = kick(forces);
    load(forces, 0);
    evaluate();
    const double piece = h_ * static_cast<double>(piece_);
    for (long row = 0; row < rows; ++row) {
      const bool account = row % stride == 0 || row == rows - 1;
      // The dampers' two halves around a sample are one where nobody looks at the velocity between.
      const bool between = account || velocity_wanted_;
      if (damped_) {
        v_before_ = v_;
        if (row > 0 && between) damp(Part::half);
      }
      if (between) processed_velocity();
      if (account) {
        const double kinetic = kernel_.slowed_product(vp_, vp_) / 2;
        const double potential = kernel_.potential(ahead_);
        const double energy = potential + kinetic - supplied_ + dissipated_;
        if (row == 0) start_energy = energy;
        const double apart = row == 0 ? std::abs(energy - kernel_.potential(rest_)) : 0;
        moving = std::max({moving, apart, kinetic, std::abs(supplied_)});
        // Reversible steps keep the energy to a small fraction; beyond this they are unstable.
        const double unseen = 1e-9 * std::abs(start_energy) + out.energy.rounding;
        if (!std::isfinite(energy) || std::abs(energy - start_energy) > growth * moving + unseen) {
          out.reason = "the energy grew without a load";
          return out;
        }
        out.energy.add(potential, kernel_.mass_product(vp_, vp_) / 2, supplied_, dissipated_);
      }
      sample(out, row);
      if (row + 1 == rows) break;
      if (damped_) {
        damp(between || row == 0 ? Part::half : Part::whole);
        add_damping(out, row, row > 0 ? piece : piece / 2);
      }
      for (long i = 0; i < substeps_; ++i) {
        if (damped_ && i > 0 && i % piece_ == 0) damp(Part::whole);
        step(forces, row * substeps_ + i);
      }
    }
    out.completed = out.samples.allFinite();
    if (!out.completed) out.reason = "the motion is not finite";
    return out;
  }

 private:
  void step(const StepForces& forces, long number) {
    const int n = kernel_.size();
    const double half = h_ / 2;
    const bool loaded = forces.active(number) || forces.active(number + 1);
    if (loaded) supplied_ += half * work(forces, number, half);
    add_multiple(n, v_.data(), half, a_.data(), v_.data());
    add_multiple(n, q_.data(), h_, v_.data(), q_.data());
    if (loaded) load(forces, number + 1);
    evaluate();
    if (loaded) supplied_ += half * work(forces, number + 1, half);
    add_multiple(n, v_.data(), half, a_.data(), v_.data());
  }

  // Energy that a step adds at most by rounding positions to within d, J: that of nodes moved by d
  // against each other, m (omega d)^2 / 2 with omega h < 2 sqrt(3), EA/l d^2 / 2 in slowed waves.
  [[nodiscard]] double rounding() const {
    const double d = std::numeric_limits<double>::epsilon() * q_.cwiseAbs().maxCoeff();
    const Eigen::VectorXd all = Eigen::VectorXd::Constant(kernel_.size(), d / h_);
    double sum = 6 * kernel_.mass_product(all, all);
    for (const Segment& s : problem_.chain->segments) sum += s.EA / s.length * d * d / 2;
    return sum;
  }

  void evaluate() {
    const double* external = loaded_ ? external_.data() : nullptr;
    kernel_.acceleration(q_.data(), external, first_.data());
    add_multiple(kernel_.size(), q_.data(), h_ * h_ / 12, first_.data(), ahead_.data());
    kernel_.acceleration(ahead_.data(), external, a_.data());
  }

  void load(const StepForces& forces, long step) {
    loaded_ = forces.active(step);
    if (loaded_) push([&](std::size_t l) { return forces.at(l, step); });
  }
  void push(const auto& force) {
    external_.setZero();
    for (std::size_t l = 0; l < load_rows_.size(); ++l) {
      const double f = force(l);
      for (std::size_t i = 0; i < load_rows_[l].index.size(); ++i) {
        external_(load_rows_[l].index[i]) += load_rows_[l].weight[i] * f;
      }
    }
  }
  // Energy that the loads at their largest give to a chain at rest in one step, J: an account of
  // less says nothing, because no step resolves where a force begins.
  double kick(const StepForces& forces) {
    push([&](std::size_t l) { return forces.largest(l); });
    kernel_.acceleration(q_.data(), external_.data(), first_.data());
    kernel_.acceleration(q_.data(), nullptr, other_.data());
    return h_ * h_ / 2 * external_.dot(first_ - other_);
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
    const int n = kernel_.size();
    add_multiple(n, q_.data(), h_, v_.data(), scratch_.data());
    kernel_.acceleration(scratch_.data(), nullptr, rate_.data());
    add_multiple(n, q_.data(), -h_, v_.data(), scratch_.data());
    kernel_.acceleration(scratch_.data(), nullptr, other_.data());
    rate_ = (rate_ - other_) / (2 * h_);
  }
  void processed_velocity() {
    acceleration_rate();
    vp_ = v_ - h_ * h_ / 12 * rate_;
  }

  enum class Part { half, whole };
  // The dampers alone for a piece or half of one, every mode's velocity decaying; what they take
  // from the kinetic energy of processed velocities, (v' - v) P (v' + v) / 2 with
  // P = (1 + h^2/12 da/dq)' M (1 + h^2/12 da/dq).
  void damp(Part part) {
    const Eigen::MatrixXd& decay = decay_[part == Part::half ? 0 : 1];
    const auto unknowns = static_cast<int>(decay.rows());
    const Eigen::VectorXd u = kernel_.unknowns(v_);
    Eigen::VectorXd w = u;
    add_product(unknowns, unknowns, decay.data(), u.data(), w.data());
    change_ = sum_ = v_;
    v_ = kernel_.entry_values(w);
    sum_ += v_;
    change_ = v_ - change_;
    processed(change_);
    processed(sum_);
    dissipated_ -= kernel_.slowed_product(change_, sum_) / 2;
  }
  // w - h^2/12 (da/dq) w, by a difference from a(q) of the last step; loads do not change with q.
  void processed(Eigen::Ref<Eigen::VectorXd> w) {
    const double* external = loaded_ ? external_.data() : nullptr;
    const int n = kernel_.size();
    add_multiple(n, q_.data(), h_, w.data(), scratch_.data());
    kernel_.acceleration(scratch_.data(), external, other_.data());
    add_multiple(n, other_.data(), -1, first_.data(), other_.data());
    add_multiple(n, w.data(), -h_ / 12, other_.data(), w.data());
  }
  // The dampers' part of accelerations at a sample, of which they act half before and half after.
  void add_damping(MotionOutput& out, long row, double time) const {
    for (std::size_t s = 0; s < sensor_rows_.size(); ++s) {
      if (described(problem_.quantities[s]).derivatives != 2) continue;
      out.samples(row, static_cast<Eigen::Index>(s)) +=
          (sensor_rows_[s].dot(v_.data()) - sensor_rows_[s].dot(v_before_.data())) / time;
    }
  }

  void sample(MotionOutput& out, long row) const {
    const double* p = ahead_.data();
    for (std::size_t s = 0; s < sensor_rows_.size(); ++s) {
      const auto column = static_cast<Eigen::Index>(s);
      const SensorQuantity& q = described(problem_.quantities[s]);
      out.samples(row, column) =
          q.derivatives == 0 ? kernel_.reading(q.reading, s, sensor_rows_[s], p, rest_.data())
                             : sensor_rows_[s].dot(q.derivatives == 1 ? vp_.data() : a_.data());
    }
  }

  Eigen::Map<Eigen::VectorXd> take() {
    const auto n = static_cast<std::size_t>(kernel_.size());
    return {memory_.data() + n * taken_++, kernel_.size()};
  }

  const MotionProblem& problem_;
  const ExplicitOptions& options_;
  MotionKernel<D> kernel_;
  double h_;
  long substeps_, piece_;
  double supplied_ = 0, dissipated_ = 0;
  bool loaded_ = false, damped_ = false, velocity_wanted_ = false;
  // Arrays of entries, each on the boundary of a cache line.
  static constexpr std::size_t kArrays = 14;
  LaneVector memory_;
  std::size_t taken_ = 0;
  Eigen::Map<Eigen::VectorXd> q_ = take(), v_ = take(), a_ = take(), first_ = take(),
                              ahead_ = take(), external_ = take(), rest_ = take(), vp_ = take(),
                              rate_ = take(), other_ = take(), scratch_ = take(),
                              v_before_ = take(), change_ = take(), sum_ = take();
  std::vector<typename MotionKernel<D>::Row> load_rows_, sensor_rows_;
  Eigen::MatrixXd decay_[2];  // what the dampers add to unknowns in half a piece and in a whole one
};

template <int D>
double power_method(MotionKernel<D>& kernel, const ChainState& state) {
  const Eigen::VectorXd q = kernel.positions(state);
  Eigen::VectorXd x(q.size()), plus(q.size()), minus(q.size());
  // Neighbouring nodes against each other: near the highest axial mode of every member.
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    x(i) = (i % 2 == 0 ? 1 : -1) * (1 + 0.3 * std::sin(1.7 * static_cast<double>(i)));
  }
  x = kernel.entry_values(kernel.unknowns(x));  // without what is held
  double lambda = 0;
  // Small against a segment, large against rounding of positions.
  const double size = 1e-6 * (q.maxCoeff() - q.minCoeff());
  for (int i = 0; i < 80; ++i) {
    const double factor = size / x.cwiseAbs().maxCoeff();
    const Eigen::VectorXd up = q + factor * x, down = q - factor * x;
    kernel.acceleration(up.data(), nullptr, plus.data());
    kernel.acceleration(down.data(), nullptr, minus.data());
    const Eigen::VectorXd next = (minus - plus) / (2 * factor);
    const double norm = kernel.slowed_product(next, next), own = kernel.slowed_product(next, x);
    if (!(norm > 0) || !(own > 0)) break;
    // |K x|_M^2 / (x K x): a Rayleigh quotient one half-step ahead.
    lambda = norm / own;
    x = next;
  }
  return std::sqrt(lambda);
}

// Steps of a sample: a multiple of the pieces between which dampers act.
long whole_pieces(long substeps, const ExplicitOptions& options) {
  const double interval = 1 / options.sampling.rate_hz;
  while (substeps % damping_pieces(substeps, interval, options) != 0) ++substeps;
  return substeps;
}

template <int D>
MotionOutput run_explicit(const MotionProblem& problem, const ExplicitOptions& options) {
  const double sample = 1 / options.sampling.rate_hz;
  MotionKernel<D> kernel(*problem.chain);
  const Eigen::VectorXd rest = kernel.positions(problem.rest);
  const auto highest = [&](double kappa) {
    kernel.slow_axial(kappa, rest);
    return std::max(power_method<D>(kernel, problem.start), power_method<D>(kernel, problem.rest));
  };
  const auto steps_for = [&](double largest) {
    return std::max(1L, static_cast<long>(std::ceil(sample / largest * (1 - 1e-12))));
  };
  long substeps = 1, own_steps = 1;
  double slowing = 0;
  if (options.step_s) {
    substeps = steps_for(*options.step_s);
  } else {
    const double own = highest(0);
    substeps = own_steps = own > 0 ? steps_for(kStability / own) : 1;
    // Fewer, with axial waves slowed, where that is enough for stability.
    if (options.slowed_step_s > 0) {
      for (long fewer = steps_for(options.slowed_step_s); fewer < substeps; ++fewer) {
        const double h = sample / static_cast<double>(whole_pieces(fewer, options));
        if (highest(kSlowing * h * h) * h > kStability) continue;
        substeps = fewer;
        slowing = kSlowing;
        break;
      }
    }
  }
  MotionOutput out;
  for (int attempt = 0; attempt < 5; ++attempt, substeps *= 2) {
    substeps = whole_pieces(substeps, options);
    const double h = sample / static_cast<double>(substeps);
    out = ExplicitRun<D>(problem, options, h, substeps, slowing * h * h).run();
    const bool closes = options.step_s || attempt == 4 || out.energy.drift() <= options.drift;
    if (out.completed && closes) return out;
    if (attempt == 1 && slowing > 0) {  // the chain turns too far for it
      slowing = 0;
      substeps = std::max(substeps, (own_steps + 1) / 2);
    }
  }
  return out;
}

}  // namespace

MotionOutput explicit_motion(const MotionProblem& problem, const ExplicitOptions& options) {
  return problem.motion == Motion::in_plane ? run_explicit<2>(problem, options)
                                            : run_explicit<3>(problem, options);
}

}  // namespace rigfit::model
