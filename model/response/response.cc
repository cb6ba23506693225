#include "model/response/response.h"

#include <chrono>
#include <sstream>

#include "model/linear/damped_modes.h"
#include "model/motion/explicit_motion.h"
#include "model/motion/motion_kernel.h"
#include "model/motion/stiff_motion.h"
#include "model/response/linear_answer.h"
#include "model/response/response_modes.h"
#include "model/statics/equilibrium.h"

namespace rigfit::model {
namespace {

std::vector<LoadForce> forces_of(const Scene& scene, const ResponseOptions& options) {
  std::vector<LoadForce> forces;
  for (std::size_t l = 0; l < scene.loads.size(); ++l) {
    forces.push_back({scene.loads[l]});
    if (scene.loads[l].kind != Load::Kind::record) continue;
    const std::string key = "load[" + std::to_string(l) + "].file";
    if (l >= options.records.size() || options.records[l].time_s.empty()) {
      throw SceneError({scene.file, 0, 0, key}, "the force history was not read",
                       "hand its samples in with the response's options");
    }
    const ForceHistory& record = options.records[l];
    bool good = record.time_s.size() == record.force_N.size();
    for (std::size_t i = 0; good && i < record.time_s.size(); ++i) {
      good = std::isfinite(record.time_s[i]) && std::isfinite(record.force_N[i]) &&
             (i == 0 || record.time_s[i] > record.time_s[i - 1]);
    }
    if (!good) {
      throw SceneError({scene.file, 0, 0, key}, "its times do not rise or a value is missing",
                       "give finite forces at strictly rising times");
    }
    forces[l].record = &record;
  }
  return forces;
}

std::vector<DampedModes> damped_modes(const LinearAnswer& answer, const Assembly& assembly) {
  std::vector<DampedModes> out;
  const ChainModes& modes = answer.modes;
  EnvelopeMatrix mass = assembly.matrix();
  assembly.mass(mass);
  const auto elongations = assembly.elongations(modes.equilibrium.state);
  const auto& segments = modes.chain->segments;
  VectorXd stiffness(std::ssize(segments));
  std::ranges::transform(segments, stiffness.begin(),
                         [](const Segment& s) { return s.EA / s.length; });
  Index first = 0;
  for (const MotionModes& motion : modes.motions) {
    const Index count = motion.omega2.size();
    const auto own = Eigen::seqN(first, count);
    first += count;
    if (answer.ratio(own).isZero(0)) continue;
    const auto to_problem = [&](const VectorXd& x) {
      return renumbered(x, motion.assembly->numbering(), assembly.numbering());
    };
    DampedModes damped;
    const VectorXd moved = to_problem(VectorXd::Ones(motion.assembly->size()));
    for (int i = 0; i < assembly.size(); ++i) {
      if (moved(i) > 0) damped.unknowns.push_back(i);
    }
    damped.shapes.resize(static_cast<Index>(damped.unknowns.size()), count);
    damped.momentum = damped.shapes;
    damped.axial.resize(stiffness.size(), count);
    for (Index i = 0; i < count; ++i) {
      const VectorXd shape = to_problem(motion.shapes.col(i));
      const VectorXd axial = stiffness.cwiseProduct(elongations * shape) / motion.omega2(i);
      const VectorXd momentum = mass * shape - elongations.transpose() * axial;
      damped.shapes.col(i) = shape(damped.unknowns);
      damped.momentum.col(i) = momentum(damped.unknowns);
      damped.axial.col(i) = axial;
    }
    damped.rate = 2 * answer.ratio(own).cwiseProduct(answer.omega(own));
    out.push_back(std::move(damped));
  }
  return out;
}

// Why the explicit scheme does not take a problem, as a reason for a person; empty: it does.
std::string not_explicit(const MotionProblem& problem) {
  if (!kernel_supports(*problem.chain, problem.motion == Motion::in_plane ? 2 : 3)) {
    return "the explicit solver takes neither torsion nor, in space, nodes that turn";
  }
  return problem.joint_damping ? "the explicit solver takes no joint dampers" : "";
}

// One simulation, step by step: what is decided in one is needed by the next.
class Simulation {
 public:
  Simulation(const Scene& scene, const ResponseOptions& options)
      : scene_(scene), options_(options), forces_(forces_of(scene, options)) {}

  ResponseResult run() {
    const auto started = std::chrono::steady_clock::now();
    bool good = find_modes();
    if (good) {
      choose();
      good = linear() ? run_modal() : run_exact();
    }
    out_.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    if (!good) return std::move(out_);
    out_.energy_drift = out_.energy.drift();
    say_what_was_left_out();
    return std::move(out_);
  }

 private:
  bool find_modes() {
    out_.rate_hz = options_.sampling.rate_hz;
    for (const Sensor& sensor : scene_.sensors) out_.sensors.push_back(sensor.name);
    for (const Member& member : scene_.members) out_.members.push_back(member.name);
    const bool any_auto = std::any_of(scene_.members.begin(), scene_.members.end(),
                                      [](const Member& m) { return m.segments <= 0; });
    if (any_auto && !options_.segments) {
      answer_ = choose_response_segments(scene_, forces_, options_.sampling.duration_s);
      out_.resolution_error = answer_.resolution_error;
    } else {
      std::vector<int> segments;
      if (options_.segments) segments.assign(scene_.members.size(), *options_.segments);
      answer_ = linear_answer(response_modes(scene_, segments), scene_, forces_,
                              options_.sampling.duration_s);
    }
    const ChainModes& modes = answer_.modes;
    out_.equilibrium = describe(*modes.chain, modes.equilibrium, scene_);
    out_.segments = modes.chain->segment_counts();
    if (modes.motions.empty()) out_.reason = modes.equilibrium.reason;
    return !modes.motions.empty();
  }

  void choose() {
    const Chain& chain = *answer_.modes.chain;
    // The plane is enough where nothing pushes the scene out of it.
    plane_ = chain.planar && !options_.space &&
             std::ranges::all_of(chain.load_direction,
                                 [](const Vector3d& d) { return std::abs(d.z()) <= 1e-12; });
    problem_.motion = plane_ ? Motion::in_plane : Motion::space;
    out_.motion = plane_ ? "plane" : "space";
    assembly_ = std::make_unique<Assembly>(chain, problem_.motion);
    out_.unknowns = assembly_->size();

    shift_ =
        estimate_nonlinearity(answer_, scene_, forces_, options_.sampling.duration_s, *assembly_);
    out_.frequency_shift = shift_.frequency_shift;
    out_.frequency_at_rest_hz = shift_.frequency_at_rest_hz;
    out_.frequency_moving_hz = shift_.frequency_moving_hz;
    out_.nonlinear = shift_.frequency_shift > scene_.accuracy;
    out_.solver = options_.solver;
    if (out_.solver == ResponseSolver::automatic && !out_.nonlinear) {
      out_.solver = ResponseSolver::modal;
    } else if (out_.solver == ResponseSolver::modal && out_.nonlinear) {
      // In the middle of the duration, as a difference of two oscillations.
      out_.linear_error =
          2 * std::sin(std::min(std::numbers::pi / 2,
                                std::numbers::pi / 2 * shift_.frequency_shift *
                                    shift_.frequency_at_rest_hz * options_.sampling.duration_s));
    }
    for (const Sensor& sensor : scene_.sensors) problem_.quantities.push_back(sensor.quantity);
  }
  [[nodiscard]] bool linear() const { return out_.solver == ResponseSolver::modal; }

  bool run_modal() {
    out_.step_s = 1 / options_.sampling.rate_hz;
    const auto rows = static_cast<Index>(options_.sampling.rows());
    out_.samples = modal_response(answer_.sensors, problem_.quantities, forces_, out_.step_s, rows);
    out_.steps = static_cast<long>(rows) - 1;
    out_.completed = out_.samples.allFinite();
    if (!out_.completed) out_.reason = "the motion is not finite";
    return out_.completed;
  }

  bool run_exact() {
    const ChainState& rest = answer_.modes.equilibrium.state;
    problem_.chain = answer_.modes.chain.get();
    problem_.rest = problem_.start = rest;
    problem_.loads = forces_;
    problem_.joint_damping = has_joint_dampers(scene_);
    problem_.damped_modes = damped_modes(answer_, *assembly_);
    const VectorXd weight = load_rows(*assembly_) * hung_weights(scene_);
    std::optional<ChainState> loaded = loaded_state(*assembly_, rest, weight);
    if (!loaded) {
      out_.reason = "no equilibrium was found with the hung mass on";
      return false;
    }
    problem_.start = std::move(*loaded);
    const std::string why = not_explicit(problem_);
    if (out_.solver == ResponseSolver::automatic) {
      out_.solver = why.empty() ? ResponseSolver::explicit_motion : ResponseSolver::stiff_motion;
      out_.told = why;
    } else if (out_.solver == ResponseSolver::explicit_motion && !why.empty()) {
      out_.impossible = true;
      out_.reason = why + ": use stiff";
      return false;
    }
    static_cast<MotionOutput&>(out_) = integrate();
    return out_.completed;
  }

  MotionOutput integrate() {
    if (out_.solver == ResponseSolver::stiff_motion) {
      StiffOptions run;
      run.sampling = options_.sampling;
      run.relative_tolerance = options_.relative_tolerance.value_or(scene_.accuracy / 1000);
      double mass = 0;
      for (const Segment& segment : answer_.modes.chain->segments) mass += segment.mass;
      if (shift_.energy_J > 0 && shift_.frequency_at_rest_hz > 0) {
        run.velocity_m_s = std::sqrt(2 * shift_.energy_J / mass);
        run.displacement_m =
            run.velocity_m_s / (2 * std::numbers::pi * shift_.frequency_at_rest_hz);
      }
      return stiff_motion(problem_, run);
    }
    ExplicitOptions run;
    run.sampling = options_.sampling;
    run.step_s = options_.step_s;
    const double interval = 1 / options_.sampling.rate_hz;
    run.damper_interval_s =
        damper_interval(answer_, shift_.upper_frequency_hz, interval, scene_.accuracy);
    // A step that is asked for is meant for the dampers too: they converge with it.
    if (options_.step_s) {
      run.damper_interval_s = std::min(run.damper_interval_s, 4 * *options_.step_s);
    }
    // Waves slowed because they were told to may cost energy; nothing else may.
    if (options_.axial.value_or(true)) run.drift = scene_.accuracy;
    if (options_.axial) {
      run.slowed_step_s = *options_.axial ? 0 : interval;
    } else if (shift_.frequency_shift < 1) {
      // A third of what is asked for: the number of segments and the estimates take theirs.
      run.slowed_step_s =
          slowed_step(answer_, shift_.frequency_shift, interval, scene_.accuracy / 3);
    }
    return explicit_motion(problem_, run);
  }

  void say_what_was_left_out() {
    const auto leave_out = [&](std::string what, double error, const char* of = "frequency") {
      out_.left_out.push_back({std::move(what), error, of});
    };
    if (linear()) {
      leave_out("change of stiffness with motion", shift_.frequency_shift);
      if (answer_.truncated) {
        leave_out("modes above those found", truncated_part(answer_, scene_), "response");
      }
    } else {
      out_.kept.push_back("geometrically exact stiffness");
    }
    const StepErrors errors =
        explicit_step_errors(answer_, shift_.frequency_shift, out_.step_s, out_.axial_slowing_s2);
    if (out_.axial_slowing_s2 > 0) {
      // kappa omega^2 / 2 = 1 %
      const double at_hz = std::sqrt(0.02 / out_.axial_slowing_s2) / (2 * std::numbers::pi);
      std::ostringstream what;
      what.precision(3);
      what << "axial waves at their own speed (1 % slow at " << at_hz << " Hz)";
      leave_out(what.str(), errors.slowed_axial);
    } else {
      out_.kept.push_back("axial dynamics");
    }
    if (out_.solver == ResponseSolver::explicit_motion) {
      leave_out("what happens within a step", errors.scheme);
    }
    if (answer_.modes.chain->frames > 0) {
      out_.kept.push_back("torsion");
    } else if (std::any_of(scene_.members.begin(), scene_.members.end(),
                           [](const Member& m) { return m.GJ > 0; })) {
      // Where no torque enters it is zero to first order, and exactly so in the plane.
      leave_out("torsion", 0);
    }
    if (plane_) {
      leave_out("motion out of the plane of symmetry", 0, "response");  // no load drives it
    } else {
      out_.kept.push_back("motion out of the plane");
    }
    if (out_.resolution_error < 0 && options_.resolution_estimate) {
      out_.resolution_error = resolution_error(scene_, answer_);
    }
    if (out_.resolution_error >= 0) {
      leave_out("bending within segments", out_.resolution_error);
    }
  }

  const Scene& scene_;
  const ResponseOptions& options_;
  const std::vector<LoadForce> forces_;
  ResponseResult out_;
  LinearAnswer answer_;
  Nonlinearity shift_;
  MotionProblem problem_;
  std::unique_ptr<Assembly> assembly_;
  bool plane_ = false;
};

}  // namespace

ResponseResult simulate_response(const Scene& scene, const ResponseOptions& options) {
  return Simulation(scene, options).run();
}

}  // namespace rigfit::model
