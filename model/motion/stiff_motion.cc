#include "model/motion/stiff_motion.h"

#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>

#include <Eigen/Geometry>

#include "model/algebra/numbers.h"
#include "model/scene/sensor_quantity.h"

namespace rigfit::model {
namespace {

struct Free {
  void operator()(SUNContext context) const { SUNContext_Free(&context); }
  void operator()(N_Vector vector) const { N_VDestroy(vector); }
  void operator()(SUNLinearSolver solver) const { SUNLinSolFreeEmpty(solver); }
  void operator()(void* memory) const { IDAFree(&memory); }
};
template <typename T>
using Owned = std::unique_ptr<std::remove_pointer_t<T>, Free>;

constexpr double kTurned = 0.5;  // rad, from where increments are counted
constexpr double kFar = 1e30;
constexpr long kMostSteps = 50'000'000;  // over the whole response

class StiffRun {
 public:
  StiffRun(const MotionProblem& problem, const StiffOptions& options)
      : problem_(problem),
        options_(options),
        assembly_(*problem.chain, problem.motion),
        anchor_(problem.start),
        state_(problem.start),
        mass_(assembly_.matrix()),
        inertia_(mass_),
        damping_(mass_),
        tangent_(mass_),
        system_(mass_),
        n_(assembly_.size()) {
    assembly_.mass(mass_);
    inertia_ = mass_;
    for (int i = 0; i < n_; ++i) {
      if (mass_.at(i, i) > 0) {
        massive_.push_back(i);
      } else {
        inertia_.add(i, i, 1);  // to solve with; the solution is not used
      }
    }
    mass_factor_.factor(inertia_);
    moving_ = std::ssize(massive_);
    size_ = n_ + moving_ + 2;
    const Chain& chain = *problem.chain;
    for (std::size_t l = 0; l < chain.loads.size(); ++l) {
      load_rows_.push_back(assembly_.row_of(chain.loads[l], chain.load_direction[l]));
    }
    for (std::size_t s = 0; s < chain.sensors.size(); ++s) {
      sensor_rows_.push_back(assembly_.row_of(chain.sensors[s], chain.sensor_direction[s]));
      if (described(problem.quantities[s]).derivatives == 2) acceleration_wanted_ = true;
    }
    force_ = drag_ = full_ = rest_ = u_ = VectorXd::Zero(n_);
    w_ = problem.start_velocity.size() == n_ ? problem.start_velocity : rest_;
  }

  MotionOutput run() {
    MotionOutput out;
    SUNContext raw = nullptr;
    SUNContext_Create(nullptr, &raw);
    const Owned<SUNContext> context(raw);
    const Owned<N_Vector> y(N_VNew_Serial(size_, raw)), rate(N_VNew_Serial(size_, raw)),
        tolerance(N_VNew_Serial(size_, raw));
    set_tolerances(of(tolerance.get()));
    of(y.get()).setZero();
    rest_massless();
    start(0, of(y.get()), of(rate.get()));
    const Owned<void*> memory(IDACreate(raw));
    memory_ = memory.get();
    IDAInit(memory_, &StiffRun::residual, 0, y.get(), rate.get());
    IDASVtolerances(memory_, options_.relative_tolerance, tolerance.get());
    IDASetUserData(memory_, this);
    IDASetMaxNumSteps(memory_, -1);
    IDASetErrHandlerFn(
        memory_, [](int, const char*, const char*, char*, void*) {}, nullptr);
    const Owned<SUNLinearSolver> solver(SUNLinSolNewEmpty(raw));
    solver->content = this;
    solver->ops->gettype = [](SUNLinearSolver) { return SUNLINEARSOLVER_MATRIX_EMBEDDED; };
    solver->ops->solve = &StiffRun::solve;
    IDASetLinearSolver(memory_, solver.get(), nullptr);

    full_(massive_) = velocities(of(tolerance.get()));
    out.energy.rounding = full_.dot(mass_ * full_) / 2;
    std::vector<double> stops;  // where a force or its slope jumps
    for (const LoadForce& force : problem_.loads) {
      for (const double corner : force.corners()) stops.push_back(corner);
    }
    stops.push_back(kFar);
    std::sort(stops.begin(), stops.end());
    // The integrator does not start towards a time that rounding alone tells from its own.
    const double close = 1e-12 * options_.sampling.duration_s;
    const long rows = options_.sampling.rows(), stride = options_.sampling.energy_stride();
    out.samples.resize(rows, static_cast<Index>(sensor_rows_.size()));
    auto stop = stops.begin();
    double t = 0;
    for (long row = 0; row < rows; ++row) {
      const double target = static_cast<double>(row) / options_.sampling.rate_hz;
      while (t + close < target) {
        while (*stop <= t + close) ++stop;
        IDASetStopTime(memory_, *stop);
        const int flag =
            IDASolve(memory_, std::min(*stop, target), &t, y.get(), rate.get(), IDA_NORMAL);
        const long steps = finished_ + steps_so_far();
        if (flag < 0 || steps > kMostSteps) {
          out.reason = flag < 0 ? "the integrator gave up" : "too many steps";
          return out;
        }
        set(of(y.get()), of(rate.get()));
        if (*stop <= t + close || turned()) {
          finished_ += steps_so_far();
          start(t, of(y.get()), of(rate.get()));
          IDAReInit(memory_, t, y.get(), rate.get());
          factored_step_ = -1;
        }
      }
      sample(out, row, target);
      if (row % stride == 0 || row == rows - 1) {
        const double kinetic = w_.dot(mass_ * w_) / 2;
        out.energy.add(assembly_.potential(state_), kinetic, of(y.get())(size_ - 2),
                       of(y.get())(size_ - 1));
      }
    }
    out.steps = finished_ + steps_so_far();
    out.step_s = options_.sampling.duration_s / static_cast<double>(std::max(1L, out.steps));
    out.completed = out.samples.allFinite();
    if (!out.completed) out.reason = "the motion is not finite";
    return out;
  }

 private:
  using Values = Map<VectorXd>;
  Values of(N_Vector vector) const { return {N_VGetArrayPointer(vector), size_}; }
  // The velocities of the unknowns with inertia, behind the increments of all.
  [[nodiscard]] Values velocities(Values y) const { return {y.data() + n_, moving_}; }
  [[nodiscard]] long steps_so_far() const {
    long steps = 0;
    IDAGetNumSteps(memory_, &steps);
    return steps;
  }

  // What has no inertia is in balance at every instant, so at the start too.
  void rest_massless() {
    for (int i = 0; i < 4 && moving_ < n_; ++i) {
      assembly_.force_and_tangent(state_, force_, tangent_);
      system_ = tangent_;
      const double held = 1e12 * tangent_.values().cwiseAbs().maxCoeff();
      for (const int k : massive_) system_.add(k, k, held);
      force_(massive_).setZero();
      factor_.factor(system_);
      factor_.solve_in_place(force_);
      assembly_.advance(state_, force_, -1, state_);
    }
  }

  void set_tolerances(Values absolute) const {
    const double r = options_.relative_tolerance;
    const Numbering& numbering = assembly_.numbering();
    double shortest = kFar;
    for (const Segment& s : problem_.chain->segments) shortest = std::min(shortest, s.length);
    const auto own = [&](Index i) {
      return (numbering.displacement.array() == static_cast<int>(i)).any() ? 1.0 : 1 / shortest;
    };
    for (Index i = 0; i < n_; ++i) absolute(i) = r * options_.displacement_m * own(i);
    for (std::size_t k = 0; k < massive_.size(); ++k) {
      absolute(n_ + static_cast<Index>(k)) = r * options_.velocity_m_s * own(massive_[k]);
    }
    absolute.tail<2>().setConstant(kFar);
  }

  // State and rates from the integrator's variables.
  void set(const Values& y, const Values& rate) {
    full_ = y.head(n_);
    assembly_.advance(anchor_, full_, 1, state_);
    u_ = rate.head(n_);
    turn_rates(full_);
    w_ = u_;
    w_(massive_) = velocities(y);
  }

  // u = T(q) q': a twist's parallel transport from the anchor's tangent t0 to t turns by
  // -(t0 x t) . t' / (1 + t0 . t); a rotation vector's rate is its left Jacobian times.
  void turn_rates(const VectorXd& q) {
    const Chain& chain = *problem_.chain;
    const Numbering& numbering = assembly_.numbering();
    for (std::size_t k = 0; chain.frames > 0 && k < chain.segments.size(); ++k) {
      const int twist = numbering.twist[static_cast<Index>(k)];
      if (twist < 0) continue;
      const Segment& s = chain.segments[k];
      const Vector3d e = state_.position.col(s.b) - state_.position.col(s.a);
      const Vector3d t = e.normalized(), t0 = tangent_at_anchor(s);
      const Vector3d de = numbering.displacement_in(u_, s.b) - numbering.displacement_in(u_, s.a);
      u_(twist) -= t0.cross(t).dot(de) / (e.norm() * (1 + t0.dot(t)));
    }
    for (Index r = 0; r < numbering.rotation.cols(); ++r) {
      const Vector3d psi = numbering.rotation_in(q, r);
      Vector3d d = numbering.rotation_in(u_, r);
      const double a = psi.norm();
      if (a < 1e-6) continue;  // below, psi x d / 2 is a millionth of d
      const Vector3d across = psi.cross(d);
      d += (1 - std::cos(a)) / (a * a) * across +
           (a - std::sin(a)) / (a * a * a) * psi.cross(across);
      for (int axis = 0; axis < 3; ++axis) {
        const int i = numbering.rotation(axis, r);
        if (i >= 0) u_(i) = d[axis];
      }
    }
  }
  [[nodiscard]] Vector3d tangent_at_anchor(const Segment& s) const {
    return (anchor_.position.col(s.b) - anchor_.position.col(s.a)).normalized();
  }

  // Further than increments may be counted from the anchor.
  [[nodiscard]] bool turned() const {
    const Chain& chain = *problem_.chain;
    for (const Segment& s : chain.segments) {
      if (s.frame < 0) continue;
      const Vector3d t = (state_.position.col(s.b) - state_.position.col(s.a)).normalized();
      if (t.dot(tangent_at_anchor(s)) < std::cos(kTurned)) return true;
    }
    for (std::size_t r = 0; r < anchor_.rotation.size(); ++r) {
      const Matrix3d by = state_.rotation[r] * anchor_.rotation[r].transpose();
      if (by.trace() < 1 + 2 * std::cos(kTurned)) return true;
    }
    return false;
  }

  // Increments anew from the present state, and the rates that go with them at `t`: accelerations
  // from the equations, and of what has no inertia the rates that it had.
  void start(double t, Values y, Values rate) {
    anchor_ = state_;
    y.head(n_).setZero();
    velocities(y) = w_(massive_);
    const double power = forces(t);
    rate.head(n_) = w_;
    mass_factor_.solve_in_place(force_);
    velocities(rate) = -force_(massive_);
    rate(size_ - 2) = power;
    rate(size_ - 1) = drag_.dot(w_);
  }

  // force_ = dV/dq + C w + D w - f at the present state, drag_ its damping; the loads' power.
  double forces(double t) {
    assembly_.force(state_, force_);
    drag_.setZero();
    if (problem_.joint_damping) {
      assembly_.damping(state_, damping_);
      damping_.multiply(w_, drag_);
    }
    const auto elongations = assembly_.elongations(state_);
    for (const DampedModes& modes : problem_.damped_modes) {
      const VectorXd force =
          modes.rate.cwiseProduct(modes.momentum.transpose() * w_(modes.unknowns) +
                                  modes.axial.transpose() * (elongations * w_));
      drag_(modes.unknowns) += modes.momentum * force;
      drag_ += elongations.transpose() * (modes.axial * force);
    }
    force_ += drag_;
    double power = 0;
    for (std::size_t l = 0; l < load_rows_.size(); ++l) {
      const double f = problem_.loads[l].at(t);
      if (f == 0) continue;
      force_ -= f * load_rows_[l];
      power += f * load_rows_[l].dot(w_);
    }
    return power;
  }

  static int residual(double t, N_Vector y, N_Vector rate, N_Vector r, void* user) {
    auto& self = *static_cast<StiffRun*>(user);
    const Values values = self.of(y), rates = self.of(rate);
    Values out = self.of(r);
    const Index n = self.n_;
    self.set(values, rates);
    const double power = self.forces(t);
    self.full_.setZero();
    self.full_(self.massive_) = self.velocities(rates);
    self.velocities(out) = self.u_(self.massive_) - self.velocities(values);
    self.mass_.multiply(self.full_, self.rest_);
    out.head(n) = self.rest_ + self.force_;
    out(self.size_ - 2) = rates(self.size_ - 2) - power;
    out(self.size_ - 1) = rates(self.size_ - 1) - self.drag_.dot(self.w_);
    return out.allFinite() ? 0 : 1;
  }

  // Newton's linear system, see the header. The tangent is that of the step's first iteration.
  static int solve(SUNLinearSolver solver, SUNMatrix, N_Vector x, N_Vector b, double) {
    auto& self = *static_cast<StiffRun*>(solver->content);
    double t = 0, cj = 0;
    N_Vector predicted = nullptr, predicted_rate = nullptr, now = nullptr, rate = nullptr,
             res = nullptr;
    void* user = nullptr;
    if (IDAGetNonlinearSystemData(self.memory_, &t, &predicted, &predicted_rate, &now, &rate, &res,
                                  &cj, &user) != IDA_SUCCESS) {
      return -1;
    }
    const long steps = self.finished_ + self.steps_so_far();
    if (steps != self.factored_step_ || cj != self.factored_cj_) {
      self.assembly_.force_and_tangent(self.state_, self.force_, self.tangent_);
      self.system_.values() = cj * cj * self.mass_.values() + self.tangent_.values();
      if (self.problem_.joint_damping) self.system_.values() += cj * self.damping_.values();
      self.factor_.factor(self.system_);
      self.factored_step_ = steps;
      self.factored_cj_ = cj;
    }
    const Values right = self.of(b);
    Values left = self.of(x);
    const Index n = self.n_;
    self.full_.setZero();
    self.full_(self.massive_) = self.velocities(right);
    self.mass_.multiply(self.full_, self.rest_);
    VectorXd q = right.head(n) + cj * self.rest_;
    if (self.problem_.joint_damping) {
      self.damping_.multiply(self.full_, self.rest_);
      q += self.rest_;
    }
    self.factor_.solve_in_place(q);
    left.head(n) = q;
    self.velocities(left) = cj * q(self.massive_) - self.velocities(right);
    left.tail<2>() = right.tail<2>() / cj;
    return 0;
  }

  void sample(MotionOutput& out, long row, double t) {
    const Chain& chain = *problem_.chain;
    if (acceleration_wanted_) {
      forces(t);
      mass_factor_.solve_in_place(force_);
    }
    for (std::size_t s = 0; s < sensor_rows_.size(); ++s) {
      const SensorQuantity& q = described(problem_.quantities[s]);
      double value = 0;
      if (q.derivatives > 0) {
        value = q.derivatives == 1 ? sensor_rows_[s].dot(w_) : -sensor_rows_[s].dot(force_);
      } else if (q.reading == SensorReading::axial_force) {
        value = axial_forces(chain, state_)(chain.sensors[s].segment);
      } else {
        value = chain.sensor_direction[s].dot(
            position_of(chain.sensors[s], state_.position - problem_.rest.position));
      }
      out.samples(row, static_cast<Index>(s)) = value;
    }
  }

  const MotionProblem& problem_;
  const StiffOptions& options_;
  Assembly assembly_;
  ChainState anchor_, state_;
  EnvelopeMatrix mass_, inertia_, damping_, tangent_, system_;
  EnvelopeFactor mass_factor_, factor_;
  Index n_, moving_ = 0, size_ = 0;
  std::vector<int> massive_;
  std::vector<VectorXd> load_rows_, sensor_rows_;
  VectorXd u_, w_, force_, drag_, full_, rest_;
  bool acceleration_wanted_ = false;
  void* memory_ = nullptr;
  long finished_ = 0, factored_step_ = -1;
  double factored_cj_ = 0;
};

}  // namespace

MotionOutput stiff_motion(const MotionProblem& problem, const StiffOptions& options) {
  return StiffRun(problem, options).run();
}

}  // namespace rigfit::model
