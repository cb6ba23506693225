#include "model/response.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "model/cvode_response.h"
#include "model/explicit_motion.h"
#include "model/implicit_motion.h"
#include "model/linear_answer.h"
#include "model/loaded_state.h"
#include "model/modes.h"
#include "model/motion_kernel.h"
#include "model/nonlinearity.h"
#include "model/scene_error.h"

namespace rigfit::model {
namespace {

constexpr int kAllModes = 400;  // unknowns of a motion up to which all modes are taken
constexpr int kSomeModes = 200;

std::vector<const ForceHistory*> records_of(const Scene& scene, const ResponseOptions& options) {
  std::vector<const ForceHistory*> records(scene.loads.size(), nullptr);
  for (std::size_t l = 0; l < scene.loads.size(); ++l) {
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
    records[l] = &record;
  }
  return records;
}

int largest_motion(const Scene& scene, const ResponseOptions& options) {
  int segments = 0;
  for (const Member& member : scene.members) {
    const int own = options.segments.value_or(member.segments);
    segments += own > 0 ? own : 30;
  }
  return 3 * segments;
}

// Nothing pushes the scene out of its plane, and nobody looks out of it.
bool plane_is_enough(const ChainModes& modes) {
  const Chain& chain = *modes.chain;
  if (!chain.planar) return false;
  const auto within = [](const Eigen::Vector3d& direction) {
    return std::abs(direction.z()) <= 1e-12;
  };
  return std::all_of(chain.load_direction.begin(), chain.load_direction.end(), within);
}

ModalDamping modal_damping(const ChainModes& modes, const LinearAnswer& answer,
                           const Assembly& assembly) {
  ModalDamping damping;
  if (answer.ratio.isZero(0)) return damping;
  std::vector<Eigen::VectorXd> shapes;
  std::vector<double> rates;
  for (std::size_t i = 0; i < answer.mode.size(); ++i) {
    const auto r = static_cast<Eigen::Index>(i);
    const MotionModes& motion = modes.motions[static_cast<std::size_t>(answer.mode[i].motion)];
    if (answer.ratio(r) == 0) continue;
    Eigen::VectorXd shape = renumbered(motion.shapes.col(answer.mode[i].mode),
                                       motion.assembly->numbering(), assembly.numbering());
    if (shape.isZero(0)) continue;
    shapes.push_back(std::move(shape));
    rates.push_back(2 * answer.ratio(r) * answer.omega(r));
  }
  damping.shapes.resize(assembly.size(), static_cast<Eigen::Index>(shapes.size()));
  damping.rate.resize(static_cast<Eigen::Index>(shapes.size()));
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    damping.shapes.col(static_cast<Eigen::Index>(i)) = shapes[i];
    damping.rate(static_cast<Eigen::Index>(i)) = rates[i];
  }
  return damping;
}

// Forces an explicit run evaluates a second, against what an implicit one does in the same units: a
// Newton iteration (three forces, at times a tangent and its factors) costs some twenty of them.
ResponseSolver cheaper(const MotionProblem& problem, double upper_frequency_hz, double accuracy,
                       double rate_hz) {
  if (!kernel_supports(*problem.chain, problem.motion == Motion::in_plane ? 2 : 3)) {
    return ResponseSolver::implicit_motion;
  }
  const double highest = highest_frequency(*problem.chain, problem.motion, problem.start);
  const double explicit_work = 2 * std::max(rate_hz, highest / 3.2);
  const double steps =
      std::max(rate_hz, 2 * std::numbers::pi * upper_frequency_hz / std::sqrt(12 * accuracy));
  return explicit_work > 60 * steps ? ResponseSolver::implicit_motion
                                    : ResponseSolver::explicit_motion;
}

}  // namespace

const char* name_of(ResponseSolver solver) {
  switch (solver) {
    case ResponseSolver::automatic:
      return "auto";
    case ResponseSolver::modal:
      return "modal";
    case ResponseSolver::large_motion:
      return "large-motion";
    case ResponseSolver::explicit_motion:
      return "explicit";
    case ResponseSolver::implicit_motion:
      return "implicit";
    case ResponseSolver::cvode_adams:
      return "cvode-adams";
    case ResponseSolver::cvode_banded:
      return "cvode-banded";
  }
  return "";
}

ResponseResult simulate_response(const Scene& scene, const ResponseOptions& options) {
  const auto started = std::chrono::steady_clock::now();
  ResponseResult out;
  const auto finish = [&] {
    out.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    return out;
  };
  const std::vector<const ForceHistory*> records = records_of(scene, options);
  out.rate_hz = options.sampling.rate_hz;
  for (const Sensor& sensor : scene.sensors) out.sensors.push_back(sensor.name);
  for (const Member& member : scene.members) out.members.push_back(member.name);

  ModesOptions wanted;
  const int unknowns = largest_motion(scene, options);
  wanted.count =
      options.modes > 0 ? options.modes : (unknowns <= kAllModes ? 2 * unknowns : kSomeModes);
  wanted.torsion = options.torsion;
  wanted.segments = options.segments;
  std::vector<int> segments;
  if (options.segments) segments.assign(scene.members.size(), *options.segments);
  const ChainModes modes = find_modes(scene, wanted, segments);
  out.equilibrium = describe(*modes.chain, modes.equilibrium, scene);
  if (modes.equilibrium.status != EquilibriumStatus::converged || modes.motions.empty()) {
    out.reason = modes.equilibrium.reason;
    return finish();
  }
  const Chain& chain = *modes.chain;
  const ChainState& rest = modes.equilibrium.state;
  const LinearAnswer answer = linear_answer(modes, scene);

  MotionProblem problem;
  const bool plane = options.plane.value_or(true) && chain.planar &&
                     (options.plane.value_or(false) || plane_is_enough(modes));
  problem.motion = plane ? Motion::in_plane : Motion::space;
  out.motion = plane ? "plane" : "space";
  const MotionModes* own = nullptr;
  for (const MotionModes& motion : modes.motions) {
    if (motion.motion == problem.motion) own = &motion;
  }
  std::unique_ptr<Assembly> made;
  if (!own) made = std::make_unique<Assembly>(chain, problem.motion);
  const Assembly& assembly = own ? *own->assembly : *made;
  out.unknowns = assembly.size();

  const Nonlinearity shift =
      estimate_nonlinearity(modes, answer, scene, records, options.sampling.duration_s, assembly);
  out.frequency_shift = shift.frequency_shift;
  out.frequency_at_rest_hz = shift.frequency_at_rest_hz;
  out.frequency_moving_hz = shift.frequency_moving_hz;
  out.nonlinear = shift.frequency_shift > scene.accuracy;
  out.solver = options.solver;
  if (out.solver == ResponseSolver::automatic) {
    out.solver = out.nonlinear ? ResponseSolver::large_motion : ResponseSolver::modal;
  }

  std::vector<Sensor::Quantity> quantities;
  for (const Sensor& sensor : scene.sensors) quantities.push_back(sensor.quantity);
  out.kept.push_back("axial dynamics");
  if (chain.torsion) {
    out.kept.push_back("torsion");
  } else {
    // Where no torque enters it is zero to first order; forced off it may not be.
    const bool present = std::any_of(scene.members.begin(), scene.members.end(),
                                     [](const Member& m) { return m.GJ > 0; });
    if (present) out.left_out.push_back({"torsion", 0});
  }
  if (plane) {
    out.left_out.push_back({"motion out of the plane of symmetry", 0});
  } else {
    out.kept.push_back("motion out of the plane");
  }

  if (out.solver == ResponseSolver::modal) {
    out.left_out.push_back({"change of stiffness with motion", shift.frequency_shift});
    const double step = 1 / options.sampling.rate_hz;
    const auto rows = static_cast<Eigen::Index>(options.sampling.rows());
    out.samples = modal_response(answer.sensors, quantities, scene.loads, records, step, rows);
    out.steps = static_cast<long>(rows) - 1;
    out.step_s = step;
    out.completed = out.samples.allFinite();
    if (!out.completed) out.reason = "the motion is not finite";
    return finish();
  }
  out.kept.push_back("geometrically exact stiffness");

  problem.chain = &chain;
  problem.rest = problem.start = rest;
  problem.loads = scene.loads;
  problem.records = records;
  problem.quantities = quantities;
  problem.joint_damping = any_joint_damping(chain);
  problem.modal_damping = modal_damping(modes, answer, assembly);
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(assembly.size());
  for (std::size_t l = 0; l < scene.loads.size(); ++l) {
    const double force = hung_weight(scene, scene.loads[l]);
    if (force != 0) weight += force * load_row(assembly, static_cast<int>(l));
  }
  const LoadedState loaded = loaded_state(assembly, rest, weight);
  if (!loaded.converged) {
    out.reason = "no equilibrium was found with the hung mass on";
    return finish();
  }
  problem.start = loaded.state;

  if (out.solver == ResponseSolver::large_motion) {
    out.solver =
        cheaper(problem, shift.upper_frequency_hz, scene.accuracy, options.sampling.rate_hz);
  }
  const bool supported = kernel_supports(chain, plane ? 2 : 3);
  if (!supported && out.solver != ResponseSolver::implicit_motion) {
    out.reason = std::string("the solver ") + name_of(out.solver) +
                 " takes neither torsion nor, in space, nodes that turn; use implicit";
    return finish();
  }
  MotionOutput motion;
  switch (out.solver) {
    case ResponseSolver::implicit_motion: {
      ImplicitOptions run;
      run.sampling = options.sampling;
      run.step_s = options.step_s;
      run.frequency_hz = shift.upper_frequency_hz;
      run.accuracy = scene.accuracy;
      motion = implicit_motion(problem, run);
      break;
    }
    case ResponseSolver::cvode_adams:
    case ResponseSolver::cvode_banded: {
      CvodeOptions run;
      run.sampling = options.sampling;
      run.method = out.solver == ResponseSolver::cvode_adams ? CvodeMethod::adams_fixed_point
                                                             : CvodeMethod::bdf_banded;
      run.relative_tolerance = options.relative_tolerance;
      run.absolute_displacement_m = 1e-3 * options.relative_tolerance;
      run.absolute_velocity_m_s = options.relative_tolerance;
      motion = cvode_response(problem, run);
      break;
    }
    default: {
      ExplicitOptions run;
      run.sampling = options.sampling;
      run.step_s = options.step_s;
      motion = explicit_motion(problem, run);
      break;
    }
  }
  out.samples = std::move(motion.samples);
  out.energy = std::move(motion.energy);
  out.energy_drift = out.energy.drift();
  out.steps = motion.steps;
  out.step_s = motion.step_s;
  out.completed = motion.completed;
  out.reason = motion.reason;
  return finish();
}

}  // namespace rigfit::model
