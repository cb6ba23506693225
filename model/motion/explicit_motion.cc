#include "model/motion/explicit_motion.h"

#include "model/motion/motion_kernel.h"
#include "model/scene/sensor_quantity.h"

// Sanitizers instrument the choice of a clone before they are ready for it.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define RIGFIT_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define RIGFIT_VECTOR_CLONES
#endif

namespace rigfit::model {
namespace {

// (1/h) int f(t + s) (1 - |s|/h) ds by Gauss-Legendre (5 points) between corners. Before t = 0
// there is no force.
double hat_average(const LoadForce& force, const std::vector<double>& corners, double t, double h) {
  std::vector<double> cuts{std::max(0.0, t - h), std::max(0.0, t), std::max(0.0, t + h)};
  for (auto c = std::lower_bound(corners.begin(), corners.end(), t - h);
       c != corners.end() && *c < t + h; ++c) {
    if (*c > 0) cuts.push_back(*c);
  }
  std::sort(cuts.begin(), cuts.end());
  static constexpr double kNode[5] = {-0.9061798459386640, -0.5384693101056831, 0,
                                      0.5384693101056831, 0.9061798459386640};
  static constexpr double kWeight[5] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                        0.4786286704993665, 0.2369268850561891};
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

// The forces of all loads as an explicit scheme takes them: one value a step, such that impulse and
// its moment are exact: the average over neighbouring steps with a hat, less h^2/12 of the second
// difference that the average adds.
class StepForces {
 public:
  StepForces(const MotionProblem& problem, double step, long steps) {
    for (const LoadForce& force : problem.loads) {
      LoadSteps load;
      const double end = force.end_s();
      if (end > 0) {
        const std::vector<double> corners = force.corners();
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

  /// Whether any force acts at step n.
  [[nodiscard]] bool active(long n) const { return n >= active_from_ && n <= active_to_; }
  /// N along the load's direction, of load l at step n.
  [[nodiscard]] double at(std::size_t l, long n) const {
    const LoadSteps& load = loads_[l];
    const long i = n - load.first;
    return i >= 0 && i < static_cast<long>(load.value.size())
               ? load.value[static_cast<std::size_t>(i)]
               : 0;
  }
  /// The largest size of load l's force at any step, N.
  [[nodiscard]] double largest(std::size_t l) const {
    double size = 0;
    for (const double f : loads_[l].value) size = std::max(size, std::abs(f));
    return size;
  }

 private:
  struct LoadSteps {
    long first = 0;
    std::vector<double> value;
  };
  std::vector<LoadSteps> loads_;
  long active_from_ = std::numeric_limits<long>::max(), active_to_ = -1;
};

constexpr double kSlowing = 1.0 / 8;  // kappa / h^2
constexpr double kStability = 3.2;    // omega h at the highest frequency of the start; less than
                                      // 2 sqrt(3) to leave room for stiffening by motion

/// y += A x as the processor runs it best (AVX-512). Eigen's for any x86-64 in its place takes 1.4
/// times as long in `rigfit synthesize testdata/jalali2021/scenes/cable.toml` (143 against 104 s of
/// processor time, side by side).
RIGFIT_VECTOR_CLONES void add_columns(Index rows, Index columns, const float* A, const float* x,
                                      float* __restrict y) {
  Index c = 0;
  for (; c + 4 <= columns; c += 4, A += 4 * rows) {
    const float *a1 = A + rows, *a2 = a1 + rows, *a3 = a2 + rows;
    const float x0 = x[c], x1 = x[c + 1], x2 = x[c + 2], x3 = x[c + 3];
    for (Index i = 0; i < rows; ++i) {
      y[i] += (A[i] * x0 + a1[i] * x1) + (a2[i] * x2 + a3[i] * x3);
    }
  }
  for (; c < columns; ++c, A += rows) {
    for (Index i = 0; i < rows; ++i) y[i] += A[i] * x[c];
  }
}

struct Dampers {
  VectorXd lost;  // the share of each mode's velocity that an interval takes, negative
  // Impulses that an interval gives to the unknowns and along the segments: the product of the
  // velocities and the elongations' rates with one after the other. In single precision, which
  // rounds what is lost and halves what is read from memory.
  std::vector<Eigen::MatrixXf> factors;
  std::vector<int> entries;  // one for each unknown
};
// `number`: by entry its unknown's, counted from 1; 0: held. What no entry has turns a node,
// without mass: its momentum is zero, whichever entry is read for it.
Dampers dampers_of(const DampedModes& modes, double interval, const VectorXd& number) {
  const auto& unknowns = modes.unknowns;
  Dampers out{(-interval * modes.rate).array().expm1(), {}, std::vector<int>(unknowns.size())};
  for (int entry = 0; entry < number.size(); ++entry) {
    const auto at = std::ranges::find(unknowns, static_cast<int>(number(entry)) - 1);
    if (at != unknowns.end()) out.entries[static_cast<std::size_t>(at - unknowns.begin())] = entry;
  }
  MatrixXd of_modes(modes.momentum.rows() + modes.axial.rows(), modes.rate.size());
  of_modes << modes.momentum, modes.axial;
  const MatrixXd to_modes = out.lost.asDiagonal() * of_modes.transpose();
  if (2 * to_modes.rows() < to_modes.cols()) {
    out.factors = {to_modes.cast<float>(), of_modes.cast<float>()};
  } else {
    out.factors = {(of_modes * to_modes).cast<float>()};
  }
  return out;
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
        period_(2 * std::max(1L, static_cast<long>(options.damper_interval_s / (2 * step)))),
        memory_(kArrays * static_cast<std::size_t>(kernel_.size()), 0.0) {
    q_ = kernel_.positions(problem.start);
    rest_ = kernel_.positions(problem.rest);
    if (kappa > 0) kernel_.slow_axial(kappa, rest_);
    v_ = problem.start_velocity.size() > 0 ? kernel_.entry_values(problem.start_velocity)
                                           : VectorXd::Zero(kernel_.size());
    const Chain& chain = *problem.chain;
    stretch_.setZero(std::ssize(chain.segments));
    moving_.setZero(kernel_.size() + stretch_.size());
    for (std::size_t l = 0; l < chain.loads.size(); ++l) {
      load_rows_.push_back(kernel_.row(chain.loads[l], chain.load_direction[l]));
    }
    for (std::size_t s = 0; s < chain.sensors.size(); ++s) {
      sensor_rows_.push_back(kernel_.row(chain.sensors[s], chain.sensor_direction[s]));
    }
    for (const auto quantity : problem_.quantities) {
      velocity_wanted_ = velocity_wanted_ || described(quantity).derivatives == 1;
    }
    const Index n = kernel_.unknowns(v_).size();
    const VectorXd number = kernel_.entry_values(VectorXd::LinSpaced(n, 1, static_cast<double>(n)));
    for (const DampedModes& modes : problem.damped_modes) {
      dampers_.push_back(dampers_of(modes, h_ * static_cast<double>(period_), number));
    }
    for (std::size_t s = 0; s < sensor_rows_.size(); ++s) drags_.push_back(drag(s));
  }

  MotionOutput run() {
    const long rows = options_.sampling.rows();
    const long stride = options_.sampling.energy_stride();
    // Steps that slow waves are unstable where the chain turns too far: nothing of that may stay.
    const double growth = kernel_.kappa() > 0 ? 0.003 : 0.1;
    MotionOutput out;
    out.step_s = h_;
    out.axial_slowing_s2 = kernel_.kappa();
    out.samples.resize(rows, static_cast<Index>(sensor_rows_.size()));
    out.steps = (rows - 1) * substeps_;
    const StepForces forces(problem_, h_, out.steps);
    out.energy.rounding = rounding() * static_cast<double>(out.steps);
    preprocess();
    double start_energy = 0, moving = kick(forces);
    load(forces, 0);
    evaluate();
    for (long row = 0; row < rows; ++row) {
      const bool account = row % stride == 0 || row == rows - 1;
      kernel_.stretch(v_.data(), stretch_);
      moving_ << v_, stretch_;
      if (account || velocity_wanted_) processed_velocity();
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
      for (long i = 0; i < substeps_ && row + 1 < rows; ++i) {
        const long number = row * substeps_ + i;
        step(forces, number);
        if (!dampers_.empty() && (number + 1) % period_ == period_ / 2) damp();
      }
    }
    out.completed = out.samples.allFinite();
    if (!out.completed) out.reason = "the motion is not finite";
    return out;
  }

 private:
  void step(const StepForces& forces, long number) {
    const double half = h_ / 2;
    supplied_ += half * power();
    v_ += half * a_;
    q_ += h_ * v_;
    load(forces, number + 1);
    evaluate();
    supplied_ += half * power();
    v_ += half * a_;
  }

  // Energy that a step adds at most by rounding positions to within d, J: that of nodes moved by d
  // against each other, m (omega d)^2 / 2 with omega h < 2 sqrt(3), EA/l d^2 / 2 in slowed waves.
  [[nodiscard]] double rounding() const {
    const double d = std::numeric_limits<double>::epsilon() * q_.cwiseAbs().maxCoeff();
    const VectorXd all = VectorXd::Constant(kernel_.size(), d / h_);
    double sum = 6 * kernel_.mass_product(all, all);
    for (const Segment& s : problem_.chain->segments) sum += s.EA / s.length * d * d / 2;
    return sum;
  }

  void evaluate() {
    const double* external = loaded_ ? external_.data() : nullptr;
    kernel_.acceleration(q_.data(), external, first_.data());
    ahead_ = q_ + h_ * h_ / 12 * first_;
    kernel_.acceleration(ahead_.data(), external, a_.data());
  }

  void load(const StepForces& forces, long step) {
    loaded_ = forces.active(step);
    if (loaded_) push([&](std::size_t l) { return forces.at(l, step); });
  }
  void push(const auto& force) {
    external_.setZero();
    for (std::size_t l = 0; l < load_rows_.size(); ++l) external_ += force(l) * load_rows_[l];
  }
  // Energy that the loads at their largest give to a chain at rest in one step, J: an account of
  // less says nothing, because no step resolves where a force begins.
  double kick(const StepForces& forces) {
    push([&](std::size_t l) { return forces.largest(l); });
    kernel_.acceleration(q_.data(), external_.data(), first_.data());
    kernel_.acceleration(q_.data(), nullptr, other_.data());
    return h_ * h_ / 2 * external_.dot(first_ - other_);
  }
  // The loads' power by the mean velocity of half a kick, v -> v + h/2 a.
  [[nodiscard]] double power() const { return loaded_ ? external_.dot(v_ + h_ / 4 * a_) : 0; }

  // The scheme's own variables for the start: q - h^2/12 a(q), v + h^2/12 da/dt.
  void preprocess() {
    const VectorXd start = q_;
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
    kernel_.acceleration(scratch_.data(), nullptr, rate_.data());
    scratch_ = q_ - h_ * v_;
    kernel_.acceleration(scratch_.data(), nullptr, other_.data());
    rate_ = (rate_ - other_) / (2 * h_);
  }
  void processed_velocity() {
    acceleration_rate();
    vp_ = v_ - h_ * h_ / 12 * rate_;
  }

  // The dampers alone for an interval, every mode's velocity decaying; what they take from the
  // kinetic energy of processed velocities, (v' - v) P (v' + v) / 2 with
  // P = (1 + h^2/12 da/dq)' M (1 + h^2/12 da/dq).
  void damp() {
    kernel_.stretch(v_.data(), stretch_);
    change_.setZero();
    for (const Dampers& dampers : dampers_) {
      const auto n = static_cast<Index>(dampers.entries.size());
      Eigen::VectorXf impulse(n + stretch_.size());
      impulse << v_(dampers.entries).template cast<float>(), stretch_.template cast<float>();
      for (const Eigen::MatrixXf& factor : dampers.factors) {
        Eigen::VectorXf product = Eigen::VectorXf::Zero(factor.rows());
        add_columns(factor.rows(), factor.cols(), factor.data(), impulse.data(), product.data());
        impulse.swap(product);
      }
      change_(dampers.entries) += impulse.head(n).template cast<double>();
      kernel_.push(impulse.data() + n, change_.data());
    }
    kernel_.velocities(change_.data());
    sum_ = 2 * v_ + change_;
    v_ += change_;
    processed(change_);
    processed(sum_);
    dissipated_ -= kernel_.slowed_product(change_, sum_) / 2;
  }
  // w - h^2/12 (da/dq) w, by a difference from a(q) of the last step; loads do not change with q.
  void processed(Ref<VectorXd> w) {
    const double* external = loaded_ ? external_.data() : nullptr;
    scratch_ = q_ + h_ * w;
    kernel_.acceleration(scratch_.data(), external, other_.data());
    w -= h_ / 12 * (other_ - first_);
  }
  // What the dampers add to a sensor's reading, as weights of the entries' velocities and then of
  // the elongations' rates: their force an acceleration (`now`); to velocities, and so to that
  // force, a part of the interval's loss between -1/2 just after they have acted and 1/2 just
  // before (`part`).
  struct Drag {
    VectorXd now, part;
  };
  Drag drag(std::size_t sensor) const {
    const int derivatives = described(problem_.quantities[sensor]).derivatives;
    const VectorXd weights = kernel_.unknowns(sensor_rows_[sensor]);
    VectorXd now = VectorXd::Zero(moving_.size()), part = now;
    for (std::size_t k = 0; derivatives > 0 && k < dampers_.size(); ++k) {
      const DampedModes& modes = problem_.damped_modes[k];
      const auto add = [&](const VectorXd& mode, VectorXd& all) {
        VectorXd momentum = VectorXd::Zero(weights.size());
        momentum(modes.unknowns) = modes.momentum * mode;
        all.head(kernel_.size()) += kernel_.covector(momentum);
        all.tail(stretch_.size()) += modes.axial * mode;
      };
      VectorXd mode = modes.shapes.transpose() * weights(modes.unknowns);
      if (derivatives == 2) {
        mode = -mode.cwiseProduct(modes.rate);
        add(mode, now);
      }
      add(mode.cwiseProduct(dampers_[k].lost), part);
    }
    return {now, part};
  }

  void sample(MotionOutput& out, long row) const {
    const double since =  // the dampers acted, in intervals, less 1/2
        static_cast<double>((row * substeps_ + period_ / 2) % period_) /
            static_cast<double>(period_) -
        0.5;
    for (std::size_t s = 0; s < sensor_rows_.size(); ++s) {
      const SensorQuantity& q = described(problem_.quantities[s]);
      const VectorXd& sensor = sensor_rows_[s];
      double& value = out.samples(row, static_cast<Index>(s));
      if (q.reading == SensorReading::axial_force) {
        value = kernel_.axial_force(problem_.chain->sensors[s].segment, ahead_.data());
      } else if (q.derivatives == 0) {
        value = sensor.dot(ahead_ - rest_);
      } else {
        value = sensor.dot(q.derivatives == 1 ? vp_ : a_);
        if (!dampers_.empty()) value += (drags_[s].now + since * drags_[s].part).dot(moving_);
      }
    }
  }

  Map<VectorXd> take() {
    const auto n = static_cast<std::size_t>(kernel_.size());
    return {memory_.data() + n * taken_++, kernel_.size()};
  }

  const MotionProblem& problem_;
  const ExplicitOptions& options_;
  MotionKernel<D> kernel_;
  double h_;
  long substeps_;
  long period_;  // steps from one action of the dampers to the next
  double supplied_ = 0, dissipated_ = 0;
  bool loaded_ = false, velocity_wanted_ = false;
  // Arrays of entries, each on the boundary of a cache line.
  static constexpr std::size_t kArrays = 13;
  LaneVector memory_;
  std::size_t taken_ = 0;
  Map<VectorXd> q_ = take(), v_ = take(), a_ = take(), first_ = take(), ahead_ = take(),
                external_ = take(), rest_ = take(), vp_ = take(), rate_ = take(), other_ = take(),
                scratch_ = take(), change_ = take(), sum_ = take();
  std::vector<VectorXd> load_rows_, sensor_rows_;
  VectorXd stretch_, moving_;     // elongations' rates; behind all velocities, at a sample
  std::vector<Dampers> dampers_;  // by the problem's damped modes
  std::vector<Drag> drags_;       // by sensor
};

template <int D>
double power_method(MotionKernel<D>& kernel, const ChainState& state) {
  const VectorXd q = kernel.positions(state);
  VectorXd x(q.size()), plus(q.size()), minus(q.size());
  // Neighbouring nodes against each other: near the highest axial mode of every member.
  for (Index i = 0; i < x.size(); ++i) {
    x(i) = (i % 2 == 0 ? 1 : -1) * (1 + 0.3 * std::sin(1.7 * static_cast<double>(i)));
  }
  x = kernel.entry_values(kernel.unknowns(x));  // without what is held
  double lambda = 0;
  // Small against a segment, large against rounding of positions.
  const double size = 1e-6 * (q.maxCoeff() - q.minCoeff());
  for (int i = 0; i < 80; ++i) {
    const double factor = size / x.cwiseAbs().maxCoeff();
    const VectorXd up = q + factor * x, down = q - factor * x;
    kernel.acceleration(up.data(), nullptr, plus.data());
    kernel.acceleration(down.data(), nullptr, minus.data());
    const VectorXd next = (minus - plus) / (2 * factor);
    const double norm = kernel.slowed_product(next, next), own = kernel.slowed_product(next, x);
    if (!(norm > 0) || !(own > 0)) break;
    // |K x|_M^2 / (x K x): a Rayleigh quotient one half-step ahead.
    lambda = norm / own;
    x = next;
  }
  return std::sqrt(lambda);
}

template <int D>
MotionOutput run_explicit(const MotionProblem& problem, const ExplicitOptions& options) {
  const double sample = 1 / options.sampling.rate_hz;
  MotionKernel<D> kernel(*problem.chain);
  const VectorXd rest = kernel.positions(problem.rest);
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
        const double h = sample / static_cast<double>(fewer);
        if (highest(kSlowing * h * h) * h > kStability) continue;
        substeps = fewer;
        slowing = kSlowing;
        break;
      }
    }
  }
  MotionOutput out;
  for (int attempt = 0; attempt < 5; ++attempt, substeps *= 2) {
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
