#include "model/motion/cvode_response.h"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "model/motion/motion_kernel.h"
#include "model/scene/sensor_quantity.h"

namespace rigfit::model {
namespace {

template <auto F>
struct Free {
  template <typename T>
  void operator()(T* pointer) const {
    F(pointer);
  }
};
void free_cvode(void* memory) { CVodeFree(&memory); }
void free_context(SUNContext context) { SUNContext_Free(&context); }
using Vector = std::unique_ptr<std::remove_pointer_t<N_Vector>, Free<N_VDestroy>>;
using Memory = std::unique_ptr<void, Free<free_cvode>>;
using Context = std::unique_ptr<std::remove_pointer_t<SUNContext>, Free<free_context>>;
void free_nonlinear(SUNNonlinearSolver solver) { SUNNonlinSolFree(solver); }
using NonlinearSolver =
    std::unique_ptr<std::remove_pointer_t<SUNNonlinearSolver>, Free<free_nonlinear>>;
void free_linear(SUNLinearSolver solver) { SUNLinSolFreeEmpty(solver); }
using LinearSolver = std::unique_ptr<std::remove_pointer_t<SUNLinearSolver>, Free<free_linear>>;

// State y: positions and velocities of the free entries' unknowns (Assembly's without massless
// ones), then supplied and dissipated energy.
template <int D>
class CvodeRun {
 public:
  CvodeRun(const MotionProblem& problem, const CvodeOptions& options)
      : problem_(problem),
        options_(options),
        kernel_(*problem.chain),
        assembly_(*problem.chain, problem.motion),
        mass_(assembly_.matrix()),
        damping_(assembly_.matrix()),
        tangent_(assembly_.matrix()),
        system_(assembly_.matrix()) {
    assembly_.mass(mass_);
    const int n = assembly_.size();
    inertia_ = mass_;
    for (int i = 0; i < n; ++i) {
      if (mass_.at(i, i) > 0) {
        massive_.push_back(i);
      } else {
        inertia_.add(i, i, 1);
      }
    }
    mass_factor_.factor(inertia_);
    const Chain& chain = *problem.chain;
    // Entries of each unknown with mass: the first of a shared node is enough to write, all to
    // read.
    const Numbering& numbering = assembly_.numbering();
    Eigen::VectorXd mark = Eigen::VectorXd::Zero(n);
    for (int i = 0; i < n; ++i) mark(i) = i + 1;
    const Eigen::VectorXd marks = kernel_.entry_values(mark, numbering);
    std::vector<int> position_of_unknown(static_cast<std::size_t>(n), -1);
    for (std::size_t k = 0; k < massive_.size(); ++k) {
      position_of_unknown[static_cast<std::size_t>(massive_[k])] = static_cast<int>(k);
    }
    entry_unknown_.assign(static_cast<std::size_t>(kernel_.size()), -1);
    unknown_entry_.assign(massive_.size(), -1);
    for (int s = 0; s < kernel_.size(); ++s) {
      const int unknown = static_cast<int>(std::lround(marks(s))) - 1;
      if (unknown < 0) continue;
      const int k = position_of_unknown[static_cast<std::size_t>(unknown)];
      entry_unknown_[static_cast<std::size_t>(s)] = k;
      if (k >= 0) unknown_entry_[static_cast<std::size_t>(k)] = s;
    }
    entries_ = kernel_.positions(problem.start);
    velocity_entries_ = acceleration_ = external_ = Eigen::VectorXd::Zero(kernel_.size());
    rest_ = kernel_.positions(problem.rest);
    for (std::size_t l = 0; l < chain.loads.size(); ++l) {
      load_rows_.push_back(kernel_.row(chain.loads[l], chain.load_direction[l]));
      forces_.emplace_back(problem.loads[l], problem.records[l]);
    }
    for (std::size_t s = 0; s < chain.sensors.size(); ++s) {
      sensor_rows_.push_back(kernel_.row(chain.sensors[s], chain.sensor_direction[s]));
    }
    if (!problem.modal_damping.none()) {
      const auto& modal = problem.modal_damping;
      momentum_.resize(modal.shapes.rows(), modal.shapes.cols());
      for (Eigen::Index r = 0; r < modal.shapes.cols(); ++r) {
        momentum_.col(r) = mass_ * Eigen::VectorXd(modal.shapes.col(r));
      }
    }
    full_ = force_ = rhs_ = solution_ = Eigen::VectorXd::Zero(n);
  }

  MotionOutput run() {
    MotionOutput out;
    const auto m = static_cast<sunindextype>(massive_.size());
    const sunindextype size = 2 * m + 2;
    SUNContext raw_context = nullptr;
    SUNContext_Create(nullptr, &raw_context);
    const Context context(raw_context);
    const Vector y(N_VNew_Serial(size, raw_context)), tolerance(N_VNew_Serial(size, raw_context));
    double* values = N_VGetArrayPointer(y.get());
    double* absolute = N_VGetArrayPointer(tolerance.get());
    for (sunindextype k = 0; k < m; ++k) {
      const auto i = static_cast<std::size_t>(k);
      values[k] = entries_(unknown_entry_[i]);
      values[m + k] = problem_.start_velocity.size() > 0 ? problem_.start_velocity(massive_[i]) : 0;
      absolute[k] = options_.absolute_displacement_m;
      absolute[m + k] = options_.absolute_velocity_m_s;
    }
    for (sunindextype k = 2 * m; k < size; ++k) values[k] = 0, absolute[k] = 1e30;

    const bool adams = options_.method == CvodeMethod::adams_fixed_point;
    const Memory memory(CVodeCreate(adams ? CV_ADAMS : CV_BDF, raw_context));
    memory_ = memory.get();
    CVodeInit(memory_, &CvodeRun::right_hand_side, 0, y.get());
    CVodeSVtolerances(memory_, options_.relative_tolerance, tolerance.get());
    CVodeSetUserData(memory_, this);
    CVodeSetMaxNumSteps(memory_, -1);
    CVodeSetErrHandlerFn(
        memory_, [](int, const char*, const char*, char*, void*) {}, nullptr);
    NonlinearSolver fixed_point;
    LinearSolver banded;
    if (adams) {
      fixed_point.reset(SUNNonlinSol_FixedPoint(y.get(), 0, raw_context));
      CVodeSetNonlinearSolver(memory_, fixed_point.get());
    } else {
      banded.reset(SUNLinSolNewEmpty(raw_context));
      banded->content = this;
      banded->ops->gettype = [](SUNLinearSolver) { return SUNLINEARSOLVER_MATRIX_EMBEDDED; };
      banded->ops->solve = &CvodeRun::solve;
      CVodeSetLinearSolver(memory_, banded.get(), nullptr);
    }

    const long rows = options_.sampling.rows(), stride = options_.sampling.energy_stride();
    out.samples.resize(rows, static_cast<Eigen::Index>(sensor_rows_.size()));
    // Stops where a force or its slope jumps.
    std::vector<double> stops;
    for (const LoadForce& force : forces_) {
      for (double corner : force.corners()) {
        if (corner > 0) stops.push_back(corner);
      }
    }
    std::sort(stops.begin(), stops.end());
    std::size_t stop = 0;
    double t = 0;
    for (long row = 0; row < rows; ++row) {
      const double target = static_cast<double>(row) / options_.sampling.rate_hz;
      while (t < target) {
        while (stop < stops.size() && stops[stop] <= t) ++stop;
        const bool before = stop < stops.size() && stops[stop] < target;
        const double goal = before ? stops[stop] : target;
        // A stop reached as the goal stays set in CVODE, behind the start of what follows: always
        // the next one, the last far away.
        CVodeSetStopTime(memory_, stop < stops.size() ? stops[stop] : 1e3 * (target + 1));
        const int flag = CVode(memory_, goal, y.get(), &t, CV_NORMAL);
        long steps = 0;
        CVodeGetNumSteps(memory_, &steps);
        if (flag < 0 || steps + finished_steps_ > options_.max_steps) {
          out.reason = flag < 0 ? "the integrator gave up" : "too many steps";
          return out;
        }
        if (flag == CV_TSTOP_RETURN || before) {
          finished_steps_ += steps;  // the count starts anew
          CVodeReInit(memory_, t, y.get());
        }
      }
      sample(out, row, target, values);
      if (options_.sampling.energy_samples > 0 && (row % stride == 0 || row == rows - 1)) {
        spread(values);
        out.energy.time_s.push_back(target);
        out.energy.account.push_back(assembly_.energy(
            kernel_.state(entries_), kernel_.unknowns(velocity_entries_, assembly_.numbering())));
        out.energy.supplied.push_back(values[2 * m]);
        out.energy.dissipated.push_back(values[2 * m + 1]);
      }
    }
    long steps = 0;
    CVodeGetNumSteps(memory_, &steps);
    out.steps = steps += finished_steps_;
    out.evaluations = evaluations_;
    out.step_s = options_.sampling.duration_s / static_cast<double>(std::max(1L, steps));
    out.completed = out.samples.allFinite();
    return out;
  }

 private:
  void spread(const double* y) {
    const std::size_t m = massive_.size();
    for (std::size_t s = 0; s < entry_unknown_.size(); ++s) {
      const int k = entry_unknown_[s];
      if (k < 0) continue;
      entries_(static_cast<Eigen::Index>(s)) = y[k];
      velocity_entries_(static_cast<Eigen::Index>(s)) = y[m + static_cast<std::size_t>(k)];
    }
  }

  // Accelerations in entries; adds the powers of loads and dampers to the last two rates.
  void evaluate(double t, const double* y, double* supplied_rate, double* dissipated_rate) {
    spread(y);
    ++evaluations_;
    const double* external = nullptr;
    double power = 0;
    for (std::size_t l = 0; l < forces_.size(); ++l) {
      const double f = forces_[l].at(t);
      if (f == 0) continue;
      if (!external) external_.setZero();
      external = external_.data();
      for (std::size_t i = 0; i < load_rows_[l].index.size(); ++i) {
        external_(load_rows_[l].index[i]) += f * load_rows_[l].weight[i];
      }
      power += f * load_rows_[l].dot(velocity_entries_.data());
    }
    kernel_.acceleration(entries_.data(), external, acceleration_.data());
    double lost = 0;
    if (problem_.joint_damping || momentum_.size() > 0) {
      full_ = kernel_.unknowns(velocity_entries_, assembly_.numbering());
      rhs_.setZero();
      if (problem_.joint_damping) {
        assembly_.damping(kernel_.state(entries_), damping_);
        turn_with(full_);
        damping_.multiply(full_, rhs_);
        lost += full_.dot(rhs_);
      }
      if (momentum_.size() > 0) {
        const Eigen::VectorXd modal = momentum_.transpose() * full_;
        lost += modal.dot(problem_.modal_damping.rate.cwiseProduct(modal));
        rhs_ += momentum_ * problem_.modal_damping.rate.cwiseProduct(modal);
      }
      for (int i = 0; i < assembly_.size(); ++i) {
        if (mass_.at(i, i) == 0) rhs_(i) = 0;
      }
      mass_factor_.solve_in_place(rhs_);
      acceleration_ -= kernel_.entry_values(rhs_, assembly_.numbering());
    }
    *supplied_rate = power;
    *dissipated_rate = lost;
  }

  // Rates of turning nodes at which their dampers bear no moment in sum.
  void turn_with(Eigen::VectorXd& velocity) {
    for (int sweep = 0; sweep < 2; ++sweep) {
      for (int i = 0; i < assembly_.size(); ++i) {
        if (mass_.at(i, i) > 0) continue;
        const double own = damping_.at(i, i);
        if (!(own > 0)) continue;
        damping_.multiply(velocity, rhs_);
        velocity(i) -= rhs_(i) / own;
      }
    }
    rhs_.setZero();
  }

  static int right_hand_side(double t, N_Vector y, N_Vector rate, void* user) {
    auto& self = *static_cast<CvodeRun*>(user);
    const std::size_t m = self.massive_.size();
    const double* values = N_VGetArrayPointer(y);
    double* out = N_VGetArrayPointer(rate);
    self.evaluate(t, values, out + 2 * m, out + 2 * m + 1);
    for (std::size_t k = 0; k < m; ++k) {
      out[k] = values[m + k];
      out[m + k] = self.acceleration_(self.unknown_entry_[k]);
    }
    return 0;
  }

  // (I - gamma J) x = b in place of Newton's linear system, see the header. The tangent is that of
  // the predicted state, kept while gamma and the state stay near.
  static int solve(SUNLinearSolver solver, SUNMatrix, N_Vector x, N_Vector b, double) {
    auto& self = *static_cast<CvodeRun*>(solver->content);
    double t = 0, gamma = 0, rl1 = 0;
    N_Vector predicted = nullptr, now = nullptr, f = nullptr, z = nullptr;
    void* user = nullptr;
    if (CVodeGetNonlinearSystemData(self.memory_, &t, &predicted, &now, &f, &gamma, &rl1, &z,
                                    &user) != CV_SUCCESS) {
      return -1;
    }
    const std::size_t m = self.massive_.size();
    long steps = 0;
    CVodeGetNumSteps(self.memory_, &steps);
    if (steps != self.factored_step_ || gamma != self.factored_gamma_) {
      self.spread(N_VGetArrayPointer(now ? now : predicted));
      const ChainState state = self.kernel_.state(self.entries_);
      self.assembly_.force_and_tangent(state, self.force_, self.tangent_);
      self.system_.values() = self.mass_.values() + gamma * gamma * self.tangent_.values();
      if (self.problem_.joint_damping) {
        self.assembly_.damping(state, self.damping_);
        self.system_.values() += gamma * self.damping_.values();
      }
      self.system_factor_.factor(self.system_);
      self.factored_step_ = steps;
      self.factored_gamma_ = gamma;
    }
    const double* right = N_VGetArrayPointer(b);
    double* left = N_VGetArrayPointer(x);
    // x_q = b_q + gamma x_v; (M + gamma C + gamma^2 K) x_v = M b_v - gamma K b_q.
    self.full_.setZero();
    for (std::size_t k = 0; k < m; ++k) self.full_(self.massive_[k]) = right[k];
    self.tangent_.multiply(self.full_, self.rhs_);
    for (std::size_t k = 0; k < m; ++k) self.full_(self.massive_[k]) = right[m + k];
    self.mass_.multiply(self.full_, self.solution_);
    self.solution_ -= gamma * self.rhs_;
    self.system_factor_.solve_in_place(self.solution_);
    const double supplied = right[2 * m], dissipated = right[2 * m + 1];
    for (std::size_t k = 0; k < m; ++k) {
      const double velocity = self.solution_(self.massive_[k]);
      left[k] = right[k] + gamma * velocity;
      left[m + k] = velocity;
    }
    left[2 * m] = supplied;
    left[2 * m + 1] = dissipated;
    return 0;
  }

  void sample(MotionOutput& out, long row, double t, const double* y) {
    bool accelerations = false;
    for (const auto q : problem_.quantities) {
      accelerations = accelerations || described(q).derivatives == 2;
    }
    double a = 0, b = 0;
    if (accelerations) {
      evaluate(t, y, &a, &b);
    } else {
      spread(y);
    }
    for (std::size_t s = 0; s < sensor_rows_.size(); ++s) {
      const SensorQuantity& q = described(problem_.quantities[s]);
      out.samples(row, static_cast<Eigen::Index>(s)) =
          q.derivatives == 0
              ? kernel_.reading(q.reading, s, sensor_rows_[s], entries_.data(), rest_.data())
              : sensor_rows_[s].dot(q.derivatives == 1 ? velocity_entries_.data()
                                                       : acceleration_.data());
    }
  }

  const MotionProblem& problem_;
  const CvodeOptions& options_;
  MotionKernel<D> kernel_;
  Assembly assembly_;
  EnvelopeMatrix mass_, inertia_, damping_, tangent_, system_;
  EnvelopeFactor mass_factor_, system_factor_;
  std::vector<int> massive_, entry_unknown_, unknown_entry_;
  Eigen::VectorXd entries_, velocity_entries_, acceleration_, external_, rest_, full_, force_, rhs_,
      solution_;
  Eigen::MatrixXd momentum_;
  std::vector<typename MotionKernel<D>::Row> load_rows_, sensor_rows_;
  std::vector<LoadForce> forces_;
  void* memory_ = nullptr;
  long evaluations_ = 0, factored_step_ = -1, finished_steps_ = 0;
  double factored_gamma_ = 0;
};

}  // namespace

MotionOutput cvode_response(const MotionProblem& problem, const CvodeOptions& options) {
  if (problem.motion == Motion::in_plane) return CvodeRun<2>(problem, options).run();
  return CvodeRun<3>(problem, options).run();
}

}  // namespace rigfit::model
