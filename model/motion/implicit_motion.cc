#include "model/motion/implicit_motion.h"
#include "model/scene/sensor_quantity.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rigfit::model {
namespace {

struct Gauss {
  int points;
  double node[3], weight[3];
};
constexpr Gauss kTwo{2, {0.21132486540518711775, 0.78867513459481288225, 0}, {0.5, 0.5, 0}};
constexpr Gauss kThree{
    3, {0.11270166537925831148, 0.5, 0.88729833462074168852}, {5.0 / 18, 8.0 / 18, 5.0 / 18}};

class ImplicitRun {
 public:
  ImplicitRun(const MotionProblem& problem, const ImplicitOptions& options)
      : problem_(problem),
        options_(options),
        assembly_(*problem.chain, problem.motion),
        gauss_(options.points == 2 ? kTwo : kThree),
        mass_(assembly_.matrix()),
        tangent_(assembly_.matrix()),
        damping_(assembly_.matrix()),
        state_(problem.start),
        middle_(problem.start),
        next_(problem.start) {
    assembly_.mass(mass_);
    const int n = assembly_.size();
    v_ = problem.start_velocity.size() == n ? problem.start_velocity : Eigen::VectorXd::Zero(n);
    delta_ = force_ = residual_ = scratch_ = external_ = average_ = Eigen::VectorXd::Zero(n);
    const Chain& chain = *problem.chain;
    // What rounding of positions leaves of axial forces that balance each other.
    double stiffest = 0;
    for (const Segment& segment : chain.segments) {
      stiffest = std::max(stiffest, segment.EA / segment.length);
    }
    rounding_ = 16 * std::numeric_limits<double>::epsilon() * stiffest *
                problem.rest.position.cwiseAbs().maxCoeff();
    for (std::size_t l = 0; l < chain.loads.size(); ++l) {
      rows_.push_back(assembly_.row_of(chain.loads[l], chain.load_direction[l]));
      forces_.emplace_back(problem.loads[l], problem.records[l]);
    }
    for (std::size_t s = 0; s < chain.sensors.size(); ++s) {
      sensor_rows_.push_back(assembly_.row_of(chain.sensors[s], chain.sensor_direction[s]));
      rest_.push_back(
          chain.sensor_direction[s].dot(position_of(chain.sensors[s], problem.rest.position)));
    }
    if (!problem.modal_damping.none()) {
      const auto& modal = problem.modal_damping;
      momentum_.resize(modal.shapes.rows(), modal.shapes.cols());
      for (Eigen::Index r = 0; r < modal.shapes.cols(); ++r) {
        momentum_.col(r) = mass_ * Eigen::VectorXd(modal.shapes.col(r));
      }
    }
    // Rows without inertia need a diagonal to solve for accelerations: theirs are not used.
    inertia_ = mass_;
    double heaviest = 0;
    for (int i = 0; i < n; ++i) heaviest = std::max(heaviest, mass_.at(i, i));
    for (int i = 0; i < n; ++i) {
      if (mass_.at(i, i) == 0) {
        inertia_.add(i, i, heaviest);
        massless_.push_back(i);
      }
    }
    mass_factor_.factor(inertia_);
  }

  MotionOutput run(double step, long substeps) {
    MotionOutput out;
    const long rows = options_.sampling.rows(), stride = options_.sampling.energy_stride();
    out.step_s = step;
    out.samples.resize(rows, static_cast<Eigen::Index>(sensor_rows_.size()));
    const double span = step * static_cast<double>(substeps);
    for (long row = 0; row < rows; ++row) {
      const double t = span * static_cast<double>(row);
      sample(out, row, t);
      if (options_.sampling.energy_samples > 0 && (row % stride == 0 || row == rows - 1)) {
        out.energy.time_s.push_back(t);
        out.energy.account.push_back(assembly_.energy(state_, v_));
        out.energy.supplied.push_back(supplied_);
        out.energy.dissipated.push_back(dissipated_);
      }
      if (row + 1 == rows) break;
      for (long i = 0; i < substeps; ++i) {
        if (!advance(t + step * static_cast<double>(i), step, 6, out)) {
          out.evaluations = evaluations_;
          out.reason = "a step did not converge";
          return out;
        }
      }
    }
    out.evaluations = evaluations_;
    out.completed = out.samples.allFinite();
    if (!out.completed) out.reason = "the motion is not finite";
    return out;
  }

 private:
  // One step, or two of half its size and so on.
  bool advance(double t, double h, int halvings, MotionOutput& out) {
    if (step(t, h)) {
      ++out.steps;
      return true;
    }
    return halvings > 0 && advance(t, h / 2, halvings - 1, out) &&
           advance(t + h / 2, h / 2, halvings - 1, out);
  }

  bool step(double t, double h) {
    external_.setZero();
    bool loaded = false;
    for (std::size_t l = 0; l < rows_.size(); ++l) {
      const double mean = mean_force(l, t, h);
      if (mean == 0) continue;
      external_ += mean * rows_[l];
      loaded = true;
    }
    delta_ = h * v_;
    for (int i : massless_) delta_(i) = 0;
    double last = 0;
    bool fresh = false;
    for (int iteration = 0; iteration < 12; ++iteration) {
      // Residual 2 M (Delta/h - v0)/h + C Delta/h + mean dV/dq - f.
      average_.setZero();
      for (int g = 0; g < gauss_.points; ++g) {
        assembly_.advance(state_, delta_, gauss_.node[g], middle_);
        assembly_.force(middle_, force_);
        ++evaluations_;
        average_ += gauss_.weight[g] * force_;
      }
      if (iteration == 0) refactor(h), fresh = true;
      scratch_ = delta_ / h;
      drag_ = viscous(scratch_);
      scratch_ = 2 / h * (scratch_ - v_);
      mass_.multiply(scratch_, residual_);
      const double scale = std::max(
          {average_.cwiseAbs().maxCoeff(), residual_.cwiseAbs().maxCoeff(), largest_force_, 1e-12});
      residual_ += average_ + drag_ - external_;
      const double size = residual_.cwiseAbs().maxCoeff();
      if (!std::isfinite(size)) return false;
      if (size <= std::max(options_.tolerance * scale, rounding_)) {
        largest_force_ = scale;  // of steps taken only: iterations that diverge have any forces
        finish(h, loaded);
        return true;
      }
      if (iteration > 0 && size > 0.3 * last) {
        if (fresh && iteration > 6) return false;
        refactor(h);
        fresh = true;
      } else if (iteration > 0) {
        fresh = false;
      }
      last = size;
      solve(residual_, h);
      delta_ -= residual_;
    }
    return false;
  }

  // d residual / d Delta at the step's middle: 2 M/h^2 + K/2 + C/h (modal damping aside).
  void refactor(double h) {
    assembly_.advance(state_, delta_, 0.5, middle_);
    assembly_.force_and_tangent(middle_, force_, tangent_);
    ++evaluations_;
    tangent_.values() = 2 / (h * h) * mass_.values() + 0.5 * tangent_.values();
    if (problem_.joint_damping) {
      assembly_.damping(middle_, damping_);
      tangent_.values() += 1 / h * damping_.values();
    }
    factor_.factor(tangent_);
  }
  void solve(Eigen::VectorXd& x, double) const { factor_.solve_in_place(x); }

  Eigen::VectorXd viscous(const Eigen::VectorXd& velocity) {
    Eigen::VectorXd drag = Eigen::VectorXd::Zero(velocity.size());
    if (problem_.joint_damping) damping_.multiply(velocity, drag);
    if (momentum_.size() > 0) {
      drag +=
          momentum_ * (problem_.modal_damping.rate.cwiseProduct(momentum_.transpose() * velocity));
    }
    return drag;
  }

  void finish(double h, bool loaded) {
    scratch_ = delta_ / h;
    if (loaded) supplied_ += external_.dot(delta_);
    dissipated_ += drag_.dot(delta_);
    acceleration_ = 2 / h * (scratch_ - v_);
    v_ = 2 * scratch_ - v_;
    // What has no inertia has no velocity of its own either.
    for (int i : massless_) v_(i) = scratch_(i);
    assembly_.advance(state_, delta_, 1, next_);
    std::swap(state_, next_);
  }

  // Mean over the step, exact for records and pulses up to Gauss's rule between corners.
  double mean_force(std::size_t l, double t, double h) const {
    if (t >= forces_[l].end_s()) return 0;
    std::vector<double> cuts{t, t + h};
    for (double corner : forces_[l].corners()) {
      if (corner > t && corner < t + h) cuts.push_back(corner);
    }
    std::sort(cuts.begin(), cuts.end());
    double sum = 0;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      for (int g = 0; g < 3; ++g) {
        sum += kThree.weight[g] * (cuts[i + 1] - cuts[i]) *
               forces_[l].at(cuts[i] + kThree.node[g] * (cuts[i + 1] - cuts[i]));
      }
    }
    return sum / h;
  }

  void sample(MotionOutput& out, long row, double t) {
    bool accelerations = false;
    for (const auto q : problem_.quantities) {
      accelerations = accelerations || described(q).derivatives == 2;
    }
    if (accelerations) {
      assembly_.force(state_, force_);
      ++evaluations_;
      if (problem_.joint_damping) assembly_.damping(state_, damping_);
      scratch_ = -force_ - viscous(v_);
      for (std::size_t l = 0; l < rows_.size(); ++l) {
        const double f = forces_[l].at(t);
        if (f != 0) scratch_ += f * rows_[l];
      }
      for (int i : massless_) scratch_(i) = 0;
      mass_factor_.solve_in_place(scratch_);
    }
    for (std::size_t s = 0; s < sensor_rows_.size(); ++s) {
      const ChainPoint& point = problem_.chain->sensors[s];
      const SensorQuantity& q = described(problem_.quantities[s]);
      double value = 0;
      if (q.derivatives > 0) {
        value = sensor_rows_[s].dot(q.derivatives == 1 ? v_ : scratch_);
      } else if (q.reading == SensorReading::axial_force) {
        axial_.resize(static_cast<Eigen::Index>(problem_.chain->segments.size()));
        assembly_.axial_forces(state_, axial_);
        value = axial_(point.segment);
      } else {
        value =
            problem_.chain->sensor_direction[s].dot(position_of(point, state_.position)) - rest_[s];
      }
      out.samples(row, static_cast<Eigen::Index>(s)) = value;
    }
  }

  const MotionProblem& problem_;
  const ImplicitOptions& options_;
  Assembly assembly_;
  const Gauss& gauss_;
  EnvelopeMatrix mass_, inertia_, tangent_, damping_;
  EnvelopeFactor factor_, mass_factor_;
  ChainState state_, middle_, next_;
  Eigen::VectorXd v_, delta_, force_, residual_, scratch_, external_, average_, drag_,
      acceleration_, axial_;
  Eigen::MatrixXd momentum_;
  std::vector<Eigen::VectorXd> rows_, sensor_rows_;
  std::vector<LoadForce> forces_;
  std::vector<double> rest_;
  std::vector<int> massless_;
  double supplied_ = 0, dissipated_ = 0, largest_force_ = 0, rounding_ = 0;
  long evaluations_ = 0;
};

}  // namespace

MotionOutput implicit_motion(const MotionProblem& problem, const ImplicitOptions& options) {
  const double sample = 1 / options.sampling.rate_hz;
  double largest = sample;
  if (options.step_s) {
    largest = *options.step_s;
  } else if (options.frequency_hz > 0) {
    largest = std::sqrt(12 * options.accuracy) / (2 * 3.14159265358979 * options.frequency_hz);
  }
  const long substeps = std::max(1L, static_cast<long>(std::ceil(sample / largest * (1 - 1e-12))));
  ImplicitRun run(problem, options);
  return run.run(sample / static_cast<double>(substeps), substeps);
}

}  // namespace rigfit::model
