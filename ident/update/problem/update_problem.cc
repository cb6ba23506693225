#include "ident/update/problem/update_problem.h"

#include <fmt/format.h>

#include "model/scene/actual_state.h"

namespace rigfit::ident {
namespace {

double largest_of(const VectorXd& shape) {
  return shape.size() > 0 ? shape.cwiseAbs().maxCoeff() : 0;
}

constexpr double kAssumedDampingStd = 0.2;  // relative; a weight, also in the evidence

// Scale of a quantity that starts at zero: 1 % of the scene's mass for masses, 1 % of the largest
// tension for a load cell's zero, else 1.
double scale_at_zero(const model::Scene& scene, const std::string& name) {
  if (name == "load_cell.zero") {
    double tension = 0;
    for (const auto& member : scene.members)
      tension = std::max(tension, member.tension.value_or(0));
    return 0.01 * tension;
  }
  double mass = 0;
  for (const auto& member : scene.members) {
    mass += member.mass_per_length * model::chord_of(scene, member).norm();
  }
  return name.ends_with(".mass") && mass > 0 ? 0.01 * mass : 1;
}

/// Whether a parameter may have any sign: coordinates of nodes, a load cell's zero, a change of
/// temperature. Everything else in a scene is positive or zero.
bool may_be_negative(const std::string& name) {
  if (name == "load_cell.zero" || name == "temperature_change") return true;
  const auto dot = name.rfind('.');
  if (dot == std::string::npos) return false;
  const std::string last = name.substr(dot + 1);
  return last == "x" || last == "y" || last == "z" || last == "stretch" ||
         last.starts_with("direction_");
}

}  // namespace

double UpdateCoordinate::value(double q) const { return logarithmic ? std::exp(q) : q * scale; }
double UpdateCoordinate::derivative(double q) const { return logarithmic ? std::exp(q) : scale; }
double UpdateCoordinate::coordinate(double v) const {
  return logarithmic ? std::log(v) : v / scale;
}

const UpdateModelMode* UpdateStateModes::find(model::ModePlane plane, int order) const {
  for (const auto& mode : modes) {
    if (mode.plane == plane && mode.order == order + 1) return &mode;
  }
  return nullptr;
}

UpdateProblem::UpdateProblem(const std::vector<UpdateState>& states,
                             const std::vector<FreeParameter>& free, const UpdateOptions& options)
    : states_(states), options_(options) {
  for (const auto& parameter : free) {
    for (const auto& target : parameter.all_targets()) {
      damping_free_ = damping_free_ || target.find("damping") != std::string::npos;
    }
  }
  if (states_.empty()) throw std::invalid_argument("update: no scene");
  std::vector<std::set<std::string>> present;  // parameters of each state's scene
  for (const auto& state : states_) {
    for (const auto& frf : state.frfs) {
      if (frf.sensor >= state.scene.sensors.size() || frf.load >= state.scene.loads.size() ||
          frf.H.size() != frf.frequency_hz.size() ||
          (frf.std.size() != 0 && frf.std.size() != frf.H.size()) ||
          (frf.H.size() > 0 && !(frf.frequency_hz.minCoeff() > 0)) || !(frf.decay_rate_1_s >= 0) ||
          !(frf.lines_per_independent >= 1)) {
        throw std::invalid_argument(
            "update: an FRF without its sensor, load, lines above 0 Hz, standard deviations or "
            "window");
      }
      if (frf.std.size() == 0) uncertainties_known_ = false;
    }
    for (const auto& mode : state.measured) {
      if (!state.modes_lead_only && !known(mode.frequency_hz.std)) uncertainties_known_ = false;
      if (!known(mode.frequency_hz.value)) {
        throw std::invalid_argument("update: every measured frequency must be positive");
      }
      if (damping_fitted(mode)) damping_ = true;
    }
    const auto names = model::parameter_names(state.scene);
    present.emplace_back(names.begin(), names.end());
  }
  for (std::size_t p = 0; p < free.size(); ++p) {
    const FreeParameter& parameter = free[p];
    const auto targets = parameter.all_targets();
    const auto& first = targets.front();
    std::size_t home = 0;  // the first state that has the first target
    // A shared parameter need not be in every scene, but each of its targets in one.
    for (const auto& target : targets) {
      const auto at =
          std::ranges::find_if(present, [&](const auto& names) { return names.contains(target); });
      if (at == present.end()) (void)model::parameter(states_[0].scene, target);  // says what is
      if (&target == &first) home = static_cast<std::size_t>(at - present.begin());
    }
    const std::size_t copies = parameter.per_state ? states_.size() : 1;
    for (std::size_t copy = 0; copy < copies; ++copy) {
      const auto& scene = states_[parameter.per_state ? copy : home].scene;
      const auto own = [&] { return model::parameter(scene, first) / parameter.factor(0); };
      auto prior = parameter.prior;
      const double start = parameter.start ? *parameter.start : prior ? prior->value : own();
      if (!prior && parameter.prior_relative_std > 0) {
        prior = Estimate{own(), parameter.prior_relative_std * std::abs(own())};
      }
      UpdateCoordinate q{parameter.name, static_cast<int>(p)};
      if (parameter.per_state) {
        q.state = static_cast<int>(copy);
        q.name += " [" + states_[copy].name + "]";
      }
      for (std::size_t s = 0; s < states_.size(); ++s) {
        for (std::size_t t = 0; t < targets.size(); ++t) {
          if ((parameter.per_state && s != copy) || !present[s].contains(targets[t])) continue;
          q.effects.push_back({static_cast<int>(s), targets[t], parameter.factor(t)});
        }
      }
      const bool positive = !may_be_negative(first);
      q.logarithmic = positive && start > 0;
      if (!q.logarithmic) q.scale = start != 0 ? std::abs(start) : scale_at_zero(scene, first);
      const double low = positive ? std::max(parameter.low, 0.0) : parameter.low;
      q.low = q.logarithmic && low <= 0 ? std::log(start) - std::log(1e6) : q.coordinate(low);
      q.high = std::isfinite(parameter.high) ? q.coordinate(parameter.high)
               : q.logarithmic               ? std::log(start) + std::log(1e6)
                                             : std::numeric_limits<double>::infinity();
      q.start = std::clamp(q.coordinate(start), q.low, q.high);
      if (prior && known(prior->std)) {
        q.prior = q.coordinate(prior->value);
        q.prior_std = q.logarithmic ? prior->std / prior->value : prior->std / q.scale;
        ++priors_;
      }
      if (!std::isfinite(q.start) || !(q.low < q.high)) {
        throw std::invalid_argument(
            fmt::format("update: {} has no usable start or bounds", parameter.name));
      }
      coordinates_.push_back(std::move(q));
    }
  }
  parameters_ = size();
  UncertainInput clock{std::string(kSampleRateTarget), {}};
  for (std::size_t s = 0; s < states_.size(); ++s) {
    const double std = states_[s].clock_relative_std;
    if (std > 0) clock.effects.push_back({static_cast<int>(s), clock.name, std});
  }
  for (const auto& input : options.inputs) add_nuisance({input.name, -1, -1, input.effects});
  if (!clock.effects.empty()) add_nuisance({clock.name, -1, -1, clock.effects});
  for (std::size_t s = 0; s < states_.size(); ++s) {
    for (const auto& member : states_[s].scene.members) {
      const auto& [axial, bending, torsion] = member.damping;
      joint_dampers_ = joint_dampers_ || axial > 0 || bending > 0 || torsion > 0;
    }
    for (const auto& [name, unit, get, set] : targets_of(static_cast<int>(s)).access) {
      const bool damper = name.find(".damping_") != std::string::npos && !name.ends_with("_ratio");
      joint_dampers_ = joint_dampers_ || damper;
    }
  }
}

const MeasuredMode& UpdateProblem::measured(int state, int mode) const {
  return state_at(state).measured[static_cast<std::size_t>(mode)];
}

VectorXd UpdateProblem::start() const {
  VectorXd q(size());
  for (Index j = 0; j < size(); ++j) q[j] = coordinate_at(j).start;
  return q;
}

std::vector<std::string> UpdateProblem::names() const {
  std::vector<std::string> names;
  for (const auto& q : coordinates_) names.push_back(q.name);
  return names;
}

model::Scene UpdateProblem::scene_at(int state, const VectorXd& q) const {
  model::Scene scene = state_at(state).scene;
  const auto [access, owner] = targets_of(state);
  for (std::size_t t = access.size(); t-- > 0;) {  // inputs first
    const auto [j, factor] = owner[t];
    const auto& coordinate = coordinate_at(j);
    access[t].set(scene, coordinate.parameter < 0 ? access[t].get(scene) + q[j] * factor
                                                  : factor * coordinate.value(q[j]));
  }
  return scene;
}

bool UpdateProblem::fixed_scene(int state, const VectorXd& q, model::Scene& scene,
                                std::string& failure) const {
  try {
    scene = scene_at(state, q);
  } catch (const model::SceneError& error) {  // a value that no scene may have
    failure = error.what();
    return false;
  }
  const double factor = is_resolved(state) ? 1 : variant_.segment_factor;
  // Five a half wave of the modes that were measured: what is left of their error is taken off.
  const auto measured = static_cast<int>(state_at(state).measured.size());
  const int segments = std::max(options_.auto_segments, 5 * measured / 2);
  for (auto& member : scene.members) {  // the same number all along, or frequencies would jump
    if (member.segments == 0) member.segments = segments;
    member.segments = std::max(std::min(member.segments, 8),
                               static_cast<int>(std::lround(factor * member.segments)));
    if (variant_.coarse)
      member.segments = std::min(member.segments, 2 * std::max(segments, mode_count(state)));
  }
  return true;
}

UpdateProblem::Targets UpdateProblem::targets_of(int state) const {
  Targets targets;
  std::vector<std::string> names;
  for (Index j = 0; j < size(); ++j) {
    for (const auto& effect : coordinate_at(j).effects) {
      if (effect.state != state || effect.target == kSampleRateTarget) continue;
      names.push_back(effect.target);
      targets.owner.emplace_back(j, effect.change);
    }
  }
  targets.access = model::parameters_named(state_at(state).scene, names);
  return targets;
}

UpdateProblem::Targets UpdateProblem::targets_together(int state, const model::Scene& scene) const {
  Targets together;
  const auto [access, owner] = targets_of(state);
  for (std::size_t t = 0; t < owner.size();) {
    const Index j = owner[t].first;
    std::vector<model::ParameterAccess> parts;
    std::vector<double> factors;
    for (; t < owner.size() && owner[t].first == j; ++t) {
      // Places may leave the plane of symmetry, what is zero may be stepped to one side only.
      if (access[t].unit == "m" || access[t].get(scene) == 0) {
        together.access.push_back(access[t]);
        together.owner.push_back(owner[t]);
        continue;
      }
      parts.push_back(access[t]);
      factors.push_back(owner[t].second);
    }
    if (parts.empty()) continue;
    together.access.push_back(model::moved_together(parts, factors));
    together.owner.emplace_back(j, factors.front());
  }
  return together;
}

UpdateProblem::ModeNeed UpdateProblem::need_of(int state,
                                               const std::vector<UpdateMatch>* matches) const {
  using model::ModePlane;
  // Joint dampers couple modes: all of them then.
  if (matches == nullptr || !*narrow_ || (damping_ && joint_dampers_)) return {};
  int in = 0, out = 0, other = 0;
  for (const auto& match : *matches) {
    if (match.state != state || match.cross_plane) continue;
    int& most = match.plane == ModePlane::in ? in : match.plane == ModePlane::out ? out : other;
    most = std::max(most, match.order + 3);  // two more: axial or torsional ones may lie between
  }
  return other > 0 ? ModeNeed{} : ModeNeed{in, out};
}

int UpdateProblem::mode_count(int state) const {
  const auto measured = state_at(state).measured.size();
  return std::min<int>(100, 3 * static_cast<int>(measured) + 8);
}

UpdateStateModes UpdateProblem::modes(int state, const VectorXd& q, bool derivatives,
                                      const std::vector<UpdateMatch>* matches) const {
  const auto asked = [&](const ModeNeed& need) {
    constexpr std::size_t kRemembered = 8;  // a search asks again at its last points only
    std::unique_lock lock(last_->mutex);
    auto& last = last_->by_state[state];
    for (const auto& one : last) {
      if (one.derivatives == derivatives && one.need == need && one.variant.solves_as(variant_) &&
          one.q.size() == q.size() && one.q == q) {
        return one.modes;
      }
    }
    lock.unlock();
    auto solved = solved_modes(state, q, derivatives, need);
    lock.lock();
    last.push_back({q, derivatives, need, variant_, solved});
    if (last.size() > kRemembered) last.pop_front();
    return solved;
  };
  const ModeNeed need = need_of(state, matches);
  UpdateStateModes result = asked(need);
  if (need == ModeNeed{} || !result.failure.empty()) return result;
  for (const auto& match : *matches) {
    if (match.state != state || match.cross_plane) continue;
    if (result.find(match.plane, match.order) != nullptr) continue;
    *narrow_ = false;  // such as a scene without a plane of symmetry
    return asked({});
  }
  return result;
}

UpdateStateModes UpdateProblem::solved_modes(int state, const VectorXd& q, bool derivatives,
                                             const ModeNeed& need) const {
  UpdateStateModes result;
  model::Scene scene;
  if (!fixed_scene(state, q, scene, result.failure)) return result;
  const auto [targets, owner] = derivatives ? targets_together(state, scene) : Targets{};
  model::ModesOptions modes;
  modes.count = mode_count(state);
  if (need != ModeNeed{}) modes.by_plane = {need.in, need.out}, modes.count = need.in + need.out;
  modes.damped = damping_;
  modes.shapes = false;
  modes.error_estimate = false;
  if (derivatives) scene.sensors.clear();  // rates of shapes cost as much as the modes
  model::ModeSensitivities solved;
  if (targets.empty()) {
    solved.analysis = model::analyse_modes(scene, modes);
  } else {
    solved = model::mode_sensitivities_by(scene, targets, modes);
  }
  const auto& analysis = solved.analysis;
  if (analysis.equilibrium.status != model::EquilibriumStatus::converged) {
    result.failure = fmt::format("no equilibrium: {}", analysis.equilibrium.reason);
    return result;
  }
  std::map<model::ModePlane, int> seen;
  for (std::size_t k = 0; k < analysis.modes.size(); ++k) {
    const auto& natural = analysis.modes[k];
    UpdateModelMode mode;
    mode.frequency_hz = natural.frequency_hz;
    mode.damping_ratio = natural.damping_ratio;
    mode.plane = natural.plane;
    mode.order = ++seen[natural.plane];
    mode.shape = natural.sensor_shape.cast<std::complex<double>>();
    mode.visibility = largest_of(natural.sensor_shape);
    if (natural.load_shape.size() > 0) mode.visibility *= largest_of(natural.load_shape);
    if (!known(mode.frequency_hz)) continue;  // a rigid motion: nothing that was measured
    if (derivatives) {
      mode.dlog_frequency = mode.dlog_damping = VectorXd::Zero(size());
      const auto row = static_cast<Index>(k);
      for (std::size_t t = 0; t < targets.size(); ++t) {
        const auto [j, factor] = owner[t];
        const double by = factor * coordinate_at(j).derivative(q[j]);
        const auto column = static_cast<Index>(t);
        mode.dlog_frequency[j] += solved.frequency(row, column) * by / mode.frequency_hz;
        if (damping_ && solved.damping_ratio.rows() > row && known(mode.damping_ratio)) {
          mode.dlog_damping[j] += solved.damping_ratio(row, column) * by / mode.damping_ratio;
        }
      }
    }
    result.modes.push_back(std::move(mode));
  }
  if (result.modes.empty()) result.failure = "the model has no modes";
  if (is_resolved(state)) {
    const auto& errors = (*variant_.segment_errors)[static_cast<std::size_t>(state)];
    for (auto& mode : result.modes) {
      const auto error = errors.find({*mode.plane, mode.order});
      if (error != errors.end()) mode.frequency_hz *= std::exp(-error->second);
    }
  }
  return result;
}

UpdateMatches UpdateProblem::match(const VectorXd& q, std::string& failure) const {
  return with_model_std(kListStd).assign(q, failure);
}

double UpdateProblem::relative_std(int state, int mode) const {
  const auto& frequency = measured(state, mode).frequency_hz;
  const double own =
      known(frequency.std) ? frequency.std / frequency.value : options_.assumed_relative_std;
  return std::hypot(std::hypot(own, options_.model_relative_std), variant_.model_std.first);
}

double UpdateProblem::damping_relative_std(int state, int mode) const {
  const auto& damping = measured(state, mode).damping_ratio;
  const double own = known(damping.std) ? damping.std / damping.value : kAssumedDampingStd;
  return std::hypot(own, variant_.model_std.second);
}

std::vector<std::pair<Index, double>> UpdateProblem::rate_changes(int state) const {
  std::vector<std::pair<Index, double>> changes;
  for (Index j = parameters_; j < size(); ++j) {
    for (const auto& effect : coordinate_at(j).effects) {
      if (effect.state == state && effect.target == kSampleRateTarget) {
        changes.emplace_back(j, effect.change);
      }
    }
  }
  return changes;
}

double UpdateProblem::measured_factor(int state, const VectorXd& q) const {
  double factor = 1;
  for (const auto& [j, change] : rate_changes(state)) factor += q[j] * change;
  return factor;
}

std::vector<UpdatedPair> UpdateProblem::pairs(const VectorXd& q,
                                              const std::vector<UpdateMatch>& matches) const {
  std::vector<UpdatedPair> result;
  int current = -1;
  UpdateStateModes modelled;
  for (const auto& match : matches) {
    if (match.state != current) {
      modelled = modes(match.state, q, false);
      current = match.state;
    }
    const UpdateModelMode* mode = modelled.find(match.plane, match.order);
    if (mode == nullptr) continue;
    const auto& [frequency, damping, plane, shape, order] = measured(match.state, match.measured);
    UpdatedPair pair{match, state_at(match.state).name, frequency.value, mode->frequency_hz};
    pair.relative_error = pair.model_hz / pair.measured_hz - 1;
    if (known(damping.value)) pair.measured_damping = damping.value;
    if (damping_) pair.model_damping = mode->damping_ratio;
    pair.measured_std_hz = frequency.std;
    result.push_back(std::move(pair));
  }
  return result;
}

double rms_of_pairs(const std::vector<UpdatedPair>& pairs) {
  double squares = 0;
  int count = 0;
  for (const auto& pair : pairs) {
    if (pair.cross_plane) continue;
    squares += pair.relative_error * pair.relative_error;
    ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : kNaN;
}

}  // namespace rigfit::ident
