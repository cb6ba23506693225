#include "ident/update/likelihood.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <stdexcept>
#include <utility>

#include "ident/update/problem/sample_rate_input.h"
#include "model/scene/scene_error.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;

template <typename List, typename Predicate>
bool any_of(const List& list, Predicate predicate) {
  return std::any_of(list.begin(), list.end(), predicate);
}

void check(const UpdateState& state) {
  for (const auto& mode : state.measured) {
    if (!known(mode.frequency_hz.value)) {
      throw std::invalid_argument("update: every measured frequency must be positive");
    }
  }
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
  }
}

}  // namespace

const UpdateModelMode* UpdateStateModes::find(model::ModePlane plane, int order) const {
  for (const auto& mode : modes) {
    if (mode.plane == plane && mode.order == order) return &mode;
  }
  return nullptr;
}

Likelihood::Likelihood(std::vector<UpdateState> states, std::vector<FreeParameter> free,
                       UpdateOptions options, int held_out)
    : states_(std::move(states)),
      free_(std::move(free)),
      options_(std::move(options)),
      held_out_(held_out) {
  if (states_.empty()) throw std::invalid_argument("update: no scene");
  mesh.auto_segments = options_.auto_segments;
  if (!options_.solver) {
    options_.solver = [](const model::Scene& scene, const std::vector<std::string>& names,
                         const model::ModesOptions& modes) {
      if (!names.empty()) return model::analyse_mode_sensitivities(scene, names, modes);
      model::ModeSensitivities plain;
      plain.analysis = model::analyse_modes(scene, modes);
      return plain;
    };
  }
  if (!options_.frf_solver) {
    options_.frf_solver = [](const model::Scene& scene, const Eigen::VectorXd& lines,
                             const std::vector<std::string>& names, double decay_rate) {
      if (!names.empty()) {
        return model::synthesize_frf_sensitivities(scene, lines, names, {}, decay_rate);
      }
      model::FrfSensitivities plain;
      plain.frfs = model::synthesize_frfs(scene, lines, {}, decay_rate);
      return plain;
    };
  }
  for (const auto& state : states_) {
    check(state);
    stated_ = stated_ && !any_of(state.frfs, [](const auto& frf) { return frf.std.size() == 0; });
    for (const auto& mode : state.measured) {
      if (!state.modes_lead_only && !known(mode.frequency_hz.std)) stated_ = false;
      if (damping_fitted(mode)) damping_ = true;
    }
    const auto names = model::parameter_names(state.scene);
    present_.emplace_back(names.begin(), names.end());
    joint_dampers_.push_back(any_of(state.scene.members, [](const model::Member& member) {
      const auto& damping = member.damping;
      return damping.axial > 0 || damping.bending > 0 || damping.torsion > 0;
    }));
  }
  changes_.resize(states_.size());
  clocks_.resize(states_.size());
  for (std::size_t p = 0; p < free_.size(); ++p) add_coordinates(p);
  parameters_ = size();
  for (const auto& input : options_.inputs) add_input(input);
}

void Likelihood::add_coordinates(std::size_t p) {
  FreeParameter& parameter = free_[p];
  if (parameter.targets.empty()) parameter.targets = {parameter.name};
  const std::string& first = parameter.targets[0];
  // A shared parameter need not be in every scene, but each of its targets in one.
  for (const auto& target : parameter.targets) {
    const bool somewhere =
        any_of(present_, [&](const auto& names) { return names.contains(target); });
    if (!somewhere) (void)model::parameter(states_[0].scene, target);  // says what there is
    for (std::size_t s = 0; is_joint_damper(target) && s < states_.size(); ++s) {
      if (present_[s].contains(target)) joint_dampers_[s] = true;
    }
  }
  const bool positive = !may_be_negative(first);
  for (std::size_t copy = 0; copy < (parameter.per_state ? states_.size() : 1); ++copy) {
    std::size_t home = copy;
    while (!parameter.per_state && home < states_.size() && !present_[home].contains(first)) ++home;
    const model::Scene& scene = states_[home < states_.size() ? home : 0].scene;
    const double own = model::parameter(scene, first) / parameter.factor(0);
    const double start = parameter.start.value_or(parameter.prior ? parameter.prior->value : own);
    auto prior = parameter.prior;
    if (!prior && parameter.prior_relative_std > 0) {
      prior = signal::Estimate{own, parameter.prior_relative_std * std::abs(own)};
    }
    UpdateCoordinate q;
    q.parameter = static_cast<int>(p);
    q.state = parameter.per_state ? static_cast<int>(copy) : -1;
    q.logarithmic = positive && start > 0;
    if (!q.logarithmic) {
      q.scale = std::abs(start) > 0 ? std::abs(start) : scale_at_zero(scene, first);
    }
    const double low = positive ? std::max(parameter.low, 0.0) : parameter.low;
    q.low = q.logarithmic && low <= 0 ? std::log(start) - std::log(1e6) : q.coordinate(low);
    q.high = std::isfinite(parameter.high) ? q.coordinate(parameter.high)
             : q.logarithmic               ? std::log(start) + std::log(1e6)
                                           : std::numeric_limits<double>::infinity();
    if (q.logarithmic) q.step_by_fixity(half_held(scene, first) / parameter.factor(0));
    q.start = std::clamp(q.coordinate(start), q.low, q.high);
    if (prior && known(prior->std)) {
      q.prior = q.coordinate(prior->value);
      q.prior_std = q.logarithmic ? prior->std / prior->value : prior->std / q.scale;
    }
    if (!std::isfinite(q.start) || !(q.low < q.high)) {
      throw std::invalid_argument(
          fmt::format("update: {} has no usable start or bounds", parameter.name));
    }
    coordinates_.push_back(q);
  }
}

void Likelihood::add_nuisance(const std::string& name) {
  constexpr double kMost = 6;  // standard uncertainties
  UpdateCoordinate q;
  q.parameter = -1;
  q.logarithmic = false;
  q.low = -kMost, q.high = kMost, q.prior_std = 1;
  coordinates_.push_back(q);
  nuisances_.push_back(name);
}

void Likelihood::add_input(const UncertainInput& input) {
  add_nuisance(input.name);
  for (const auto& effect : input.effects) {
    const auto s = static_cast<std::size_t>(effect.state);
    const Move move{size() - 1, effect.target, effect.change, true};
    if (effect.target == kSampleRateTarget) {
      clocks_[s].push_back(move);
      continue;
    }
    const bool fitted = any_of(free_, [&](const FreeParameter& parameter) {
      return std::count(parameter.targets.begin(), parameter.targets.end(), effect.target) > 0;
    });
    if (fitted) continue;
    changes_[s].push_back(move);
    if (is_joint_damper(effect.target)) joint_dampers_[s] = true;
  }
}

bool Likelihood::is_stated(int state, const std::string& target) const {
  for (const auto& move : moves_of(state)) {
    if (move.target == target) return true;
  }
  return any_of(free_, [&](const FreeParameter& parameter) {
    return std::count(parameter.targets.begin(), parameter.targets.end(), target) > 0;
  });
}

bool Likelihood::damping_fitted(const MeasuredMode& mode) const {
  if (!known(mode.damping_ratio.value)) return false;
  const auto of_damping = [](const std::string& name) {
    return name.find("damping") != std::string::npos;
  };
  return any_of(free_, [&](const FreeParameter& parameter) {
    return of_damping(parameter.name) || any_of(parameter.targets, of_damping);
  });
}

bool Likelihood::shape_fitted(const MeasuredMode& mode) const {
  return options_.shape_std > 0 && mode.shape.size() > 1 && mode.shape.allFinite() &&
         mode.shape.norm() > 0;
}

bool Likelihood::counts(int state, UpdateStage stage) const {
  return stage == UpdateStage::lead || !states_[static_cast<std::size_t>(state)].modes_lead_only;
}

bool Likelihood::has_modes() const {
  return any_of(states_, [](const auto& state) { return !state.measured.empty(); });
}

bool Likelihood::has_frfs() const {
  return any_of(states_, [](const auto& state) { return !state.frfs.empty(); });
}

Eigen::Index Likelihood::priors() const {
  return std::count_if(coordinates_.begin(), coordinates_.end(),
                       [](const auto& one) { return one.prior_std > 0; });
}

Eigen::VectorXd Likelihood::start() const {
  Eigen::VectorXd q(size());
  for (Eigen::Index j = 0; j < size(); ++j) q[j] = coordinates_[static_cast<std::size_t>(j)].start;
  return q;
}

std::vector<std::string> Likelihood::names() const {
  std::vector<std::string> names;
  for (const auto& q : coordinates_) {
    if (q.parameter < 0) break;
    const auto& name = free_[static_cast<std::size_t>(q.parameter)].name;
    names.push_back(
        q.state < 0 ? name : name + " [" + states_[static_cast<std::size_t>(q.state)].name + "]");
  }
  names.insert(names.end(), nuisances_.begin(), nuisances_.end());
  return names;
}

int Likelihood::fewest_segments() const {
  int fewest = std::numeric_limits<int>::max();
  for (const auto& state : states_) {
    for (const auto& member : state.scene.members) {
      fewest = std::min(fewest, member.segments == 0 ? mesh.auto_segments : member.segments);
    }
  }
  return fewest;
}

std::vector<Likelihood::Move> Likelihood::moves_of(int state) const {
  const auto s = static_cast<std::size_t>(state);
  std::vector<Move> moves = changes_[s];
  for (Eigen::Index j = 0; j < parameters_; ++j) {
    const auto& coordinate = coordinates_[static_cast<std::size_t>(j)];
    if (coordinate.state >= 0 && coordinate.state != state) continue;
    const auto& parameter = free_[static_cast<std::size_t>(coordinate.parameter)];
    for (std::size_t t = 0; t < parameter.targets.size(); ++t) {
      if (!present_[s].contains(parameter.targets[t])) continue;
      moves.push_back({j, parameter.targets[t], parameter.factor(t), false});
    }
  }
  return moves;
}

std::vector<std::string> Likelihood::targets_of(const std::vector<Move>& moves) const {
  std::vector<std::string> targets;
  for (const auto& move : moves) {
    if (std::find(targets.begin(), targets.end(), move.target) == targets.end()) {
      targets.push_back(move.target);
    }
  }
  return targets;
}

double Likelihood::slope(const Move& move, const Eigen::VectorXd& q) const {
  const auto& coordinate = coordinates_[static_cast<std::size_t>(move.coordinate)];
  return move.factor * (move.is_change ? 1 : coordinate.derivative(q[move.coordinate]));
}

model::Scene Likelihood::scene_at(int state, const Eigen::VectorXd& q) const {
  model::Scene scene = states_[static_cast<std::size_t>(state)].scene;
  for (const auto& move : moves_of(state)) {
    const double at = q[move.coordinate];
    if (move.is_change && at == 0) continue;
    const auto& coordinate = coordinates_[static_cast<std::size_t>(move.coordinate)];
    model::set_parameter(scene, move.target,
                         move.is_change ? model::parameter(scene, move.target) + at * move.factor
                                        : move.factor * coordinate.value(at));
  }
  return scene;
}

double Likelihood::clock_factor(int state, const Eigen::VectorXd& q) const {
  double factor = 1;
  for (const auto& move : clocks_[static_cast<std::size_t>(state)]) {
    factor += q[move.coordinate] * move.factor;
  }
  return factor;
}

bool Likelihood::fixed_scene(int state, const Eigen::VectorXd& q, model::Scene& scene,
                             std::string& failure) const {
  try {
    scene = scene_at(state, q);
  } catch (const model::SceneError& error) {  // a value that no scene may have
    failure = error.what();
    return false;
  }
  for (auto& member : scene.members) {  // the same number all along, or frequencies would jump
    if (member.segments == 0) member.segments = mesh.auto_segments;
    member.segments = std::max(std::min(member.segments, 8),
                               static_cast<int>(std::lround(mesh.factor * member.segments)));
  }
  return true;
}

Likelihood::ModeNeed Likelihood::need_of(int state, const std::vector<UpdateMatch>* matches) const {
  using model::ModePlane;
  // Joint dampers couple modes: all of them then.
  if (matches == nullptr || !shared_->narrow) return {};
  if (damping_ && joint_dampers_[static_cast<std::size_t>(state)]) return {};
  int in = 0, out = 0, other = 0;
  for (const auto& match : *matches) {
    if (match.state != state || match.cross_plane) continue;
    int& most = match.plane == ModePlane::in ? in : match.plane == ModePlane::out ? out : other;
    most = std::max(most, match.order + 1);
  }
  if (other > 0 || (in > 0) == (out > 0)) return {};
  // Two more, as axial or torsional modes may lie between.
  return {in > 0 ? ModePlane::in : ModePlane::out, std::max(in, out) + 2};
}

UpdateStateModes Likelihood::modes(int state, const Eigen::VectorXd& q, bool derivatives,
                                   const std::vector<UpdateMatch>* matches) const {
  const ModeNeed need = need_of(state, matches);
  UpdateStateModes result = modes_asked(state, q, derivatives, need);
  if (need.count == 0 || !result.failure.empty()) return result;
  for (const auto& match : *matches) {
    if (match.state != state || match.cross_plane) continue;
    if (result.find(match.plane, match.order) != nullptr) continue;
    shared_->narrow = false;  // such as a scene without a plane of symmetry
    return modes_asked(state, q, derivatives, {});
  }
  return result;
}

UpdateStateModes Likelihood::modes_asked(int state, const Eigen::VectorXd& q, bool derivatives,
                                         const ModeNeed& need) const {
  UpdateStateModes result;
  const auto s = static_cast<std::size_t>(state);
  model::Scene scene;
  if (!fixed_scene(state, q, scene, result.failure)) return result;
  auto moves = derivatives ? moves_of(state) : std::vector<Move>{};
  std::erase_if(moves, [&](const Move& move) {  // where it is struck and read moves no frequency
    const auto named = [&](const auto& one) { return move.target.starts_with(one.name + "."); };
    return any_of(scene.loads, named) || any_of(scene.sensors, named);
  });
  const auto targets = targets_of(moves);
  model::ModesOptions modes;
  modes.count = need.count > 0
                    ? need.count
                    : std::min<int>(100, 3 * static_cast<int>(states_[s].measured.size()) + 8);
  modes.plane = need.plane;
  modes.damped = damping_;
  modes.shapes = false;
  modes.error_estimate = false;
  // Rates of shapes cost as much as the modes: only where shapes are fitted.
  if (derivatives && !(options_.shape_std > 0)) scene.sensors.clear();
  ++shared_->evaluations;
  const auto solved = options_.solver(scene, targets, modes);
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
    mode.order = seen[natural.plane]++;
    mode.shape = natural.sensor_shape.cast<std::complex<double>>();
    if (natural.sensor_shape.size() > 0) {
      mode.visibility =
          natural.sensor_shape.cwiseAbs().maxCoeff() *
          (natural.load_shape.size() > 0 ? natural.load_shape.cwiseAbs().maxCoeff() : 1);
    }
    if (!known(mode.frequency_hz)) continue;  // a rigid motion: nothing that was measured
    if (derivatives) {
      mode.dlog_frequency = mode.dlog_damping = Eigen::VectorXd::Zero(size());
      if (options_.shape_std > 0) {
        mode.dshape = Eigen::MatrixXd::Zero(natural.sensor_shape.size(), size());
      }
      const auto row = static_cast<Eigen::Index>(k);
      for (const auto& move : moves) {
        const Eigen::Index j = move.coordinate;
        const double by = slope(move, q);
        const auto column =
            std::find(targets.begin(), targets.end(), move.target) - targets.begin();
        mode.dlog_frequency[j] += solved.frequency(row, column) * by / mode.frequency_hz;
        if (mode.dshape.size() > 0) {
          const auto& rate = solved.sensor_shape.at(static_cast<std::size_t>(column));
          mode.dshape.col(j) += by * rate.col(row);
        }
        if (damping_ && solved.damping_ratio.rows() > row && known(mode.damping_ratio)) {
          mode.dlog_damping[j] += solved.damping_ratio(row, column) * by / mode.damping_ratio;
        }
      }
    }
    if (mesh.errors && mesh.factor == 1) {
      for (const auto& error : (*mesh.errors)[s]) {
        const bool same = error.plane == mode.plane && error.order == mode.order;
        if (same) mode.frequency_hz *= std::exp(-error.of_log);
      }
    }
    result.modes.push_back(std::move(mode));
  }
  if (result.modes.empty()) result.failure = "the model has no modes";
  return result;
}

UpdateMatches Likelihood::match(const Eigen::VectorXd& q, double common_factor_range,
                                std::string& failure, int only) const {
  UpdateMatches result;
  PairingOptions pairing = options_.pairing;
  pairing.common_factor_range = common_factor_range;
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    if (only >= 0 ? s != only : !takes_part(s)) continue;
    const auto& state = states_[static_cast<std::size_t>(s)];
    const UpdateStateModes modelled = modes(s, q, false);
    if (!modelled.failure.empty()) {
      failure = (state.name.empty() ? "" : state.name + ": ") + modelled.failure;
      return {};
    }
    std::vector<PairingMode> measured_modes, model_modes;
    for (const auto& mode : state.measured) {
      measured_modes.push_back(
          {.frequency_hz = mode.frequency_hz.value, .plane = mode.plane, .shape = mode.shape});
    }
    for (const auto& mode : modelled.modes) {
      model_modes.push_back(
          {.frequency_hz = mode.frequency_hz, .plane = mode.plane, .shape = mode.shape});
    }
    const ModePairing paired = pair_modes(measured_modes, model_modes, pairing);
    for (const auto& pair : paired.pairs) {
      const auto& mode = modelled.modes[static_cast<std::size_t>(pair.model)];
      result.matches.push_back(
          {s, pair.measured, mode.plane, mode.order, pair.mac, pair.cross_plane});
    }
    for (const auto& mode : paired.unpaired_measured) {
      result.unpaired.push_back({s,
                                 measured_modes[static_cast<std::size_t>(mode.index)].frequency_hz,
                                 true, false, mode.reason});
      ++result.unpaired_measured;
    }
    for (const auto& mode : paired.unpaired_model) {
      if (!mode.missing) continue;  // outside of what was measured: nobody looked
      result.unpaired.push_back({s, model_modes[static_cast<std::size_t>(mode.index)].frequency_hz,
                                 false, true, mode.reason});
    }
  }
  return result;
}

double Likelihood::relative_std(int state, int measured) const {
  const auto& mode =
      states_[static_cast<std::size_t>(state)].measured[static_cast<std::size_t>(measured)];
  const double own = known(mode.frequency_hz.std) ? mode.frequency_hz.std / mode.frequency_hz.value
                                                  : options_.assumed_relative_std;
  return std::hypot(std::hypot(own, options_.model_relative_std), errors.frequency);
}

double Likelihood::damping_relative_std(int state, int measured) const {
  const auto& damping = states_[static_cast<std::size_t>(state)]
                            .measured[static_cast<std::size_t>(measured)]
                            .damping_ratio;
  const double own =
      known(damping.std) ? damping.std / damping.value : options_.assumed_damping_relative_std;
  return std::hypot(own, errors.damping);
}

std::vector<UpdatedPair> Likelihood::pairs(const Eigen::VectorXd& q,
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
    const auto& measured = states_[static_cast<std::size_t>(match.state)]
                               .measured[static_cast<std::size_t>(match.measured)];
    result.push_back({.state = match.state,
                      .measured = match.measured,
                      .plane = match.plane,
                      .order = match.order,
                      .measured_hz = measured.frequency_hz.value,
                      .model_hz = mode->frequency_hz,
                      .relative_error = mode->frequency_hz / measured.frequency_hz.value - 1,
                      .mac = match.mac,
                      .measured_damping =
                          known(measured.damping_ratio.value) ? measured.damping_ratio.value : kNaN,
                      .model_damping = damping_ ? mode->damping_ratio : kNaN,
                      .cross_plane = match.cross_plane});
  }
  return result;
}

Eigen::Index Likelihood::residual_count(const std::vector<UpdateMatch>& matches,
                                        UpdateStage stage) const {
  Eigen::Index count = priors();
  for (const auto& match : matches) {
    if (match.cross_plane || !counts(match.state, stage)) continue;
    const auto& mode = states_[static_cast<std::size_t>(match.state)]
                           .measured[static_cast<std::size_t>(match.measured)];
    count += damping_fitted(mode) ? 2 : 1;
    if (shape_fitted(mode)) count += mode.shape.size();
  }
  if (stage == UpdateStage::full) count += 2 * frf_lines();
  return count;
}

bool Likelihood::residuals(const Eigen::VectorXd& q, const std::vector<UpdateMatch>& matches,
                           UpdateStage stage, Eigen::VectorXd& r, Eigen::MatrixXd* jacobian) const {
  r.setZero(residual_count(matches, stage));
  if (jacobian != nullptr) jacobian->setZero(r.size(), size());
  Eigen::Index row = 0;
  int current = -1;
  UpdateStateModes modelled;
  for (const auto& match : matches) {  // ordered by state
    if (match.cross_plane || !counts(match.state, stage)) continue;
    if (match.state != current) {
      modelled = modes(match.state, q, jacobian != nullptr, &matches);
      if (!modelled.failure.empty()) return false;
      current = match.state;
    }
    const UpdateModelMode* mode = modelled.find(match.plane, match.order);
    if (mode == nullptr) return false;
    const auto& measured = states_[static_cast<std::size_t>(match.state)]
                               .measured[static_cast<std::size_t>(match.measured)];
    const double std = relative_std(match.state, match.measured);
    const double clock = clock_factor(match.state, q);
    const double measured_hz = measured.frequency_hz.value * clock;
    r[row] = std::log(mode->frequency_hz / measured_hz) / std;
    if (jacobian != nullptr) {
      jacobian->row(row) = mode->dlog_frequency / std;
      for (const auto& move : clocks_[static_cast<std::size_t>(match.state)]) {
        (*jacobian)(row, move.coordinate) -= move.factor / clock / std;
      }
    }
    ++row;
    if (damping_fitted(measured)) {
      if (!known(mode->damping_ratio)) return false;
      const double damping_std = damping_relative_std(match.state, match.measured);
      r[row] = std::log(mode->damping_ratio / measured.damping_ratio.value) / damping_std;
      if (jacobian != nullptr) jacobian->row(row) = mode->dlog_damping / damping_std;
      ++row;
    }
    if (shape_fitted(measured)) {
      // The measured shape turned to be as real as it can be; the model's has its sign.
      const Eigen::VectorXcd turned =
          measured.shape *
          std::polar(1.0, -0.5 * std::arg((measured.shape.array() * measured.shape.array()).sum()));
      const Eigen::VectorXd wanted = turned.real().normalized();
      const Eigen::VectorXd shape = mode->shape.real();
      const double length = shape.norm();
      if (shape.size() != wanted.size() || !(length > 0)) return false;
      const Eigen::VectorXd unit = shape / length;
      const double sign = unit.dot(wanted) < 0 ? -1 : 1;
      r.segment(row, wanted.size()) = (sign * unit - wanted) / options_.shape_std;
      if (jacobian != nullptr && mode->dshape.size() > 0) {
        jacobian->middleRows(row, wanted.size()) =
            sign / (length * options_.shape_std) *
            (mode->dshape - unit * (unit.transpose() * mode->dshape));
      }
      row += wanted.size();
    }
  }
  if (stage == UpdateStage::full) {
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
      if (!takes_part(s)) continue;
      if (!frf_residuals(s, q, row, r, jacobian)) return false;
    }
  }
  for (Eigen::Index j = 0; j < size(); ++j) {
    const auto& coordinate = coordinates_[static_cast<std::size_t>(j)];
    if (coordinate.prior_std <= 0) continue;
    r[row] = (q[j] - coordinate.prior) / coordinate.prior_std;
    if (jacobian != nullptr) (*jacobian)(row, j) = 1 / coordinate.prior_std;
    ++row;
  }
  return r.allFinite() && (jacobian == nullptr || jacobian->allFinite());
}

std::vector<Likelihood::FrequencyRow> Likelihood::frequency_rows(
    const std::vector<UpdateMatch>& matches, UpdateStage stage) const {
  std::vector<FrequencyRow> rows;
  Eigen::Index row = 0;
  for (std::size_t m = 0; m < matches.size(); ++m) {
    const auto& match = matches[m];
    if (match.cross_plane || !counts(match.state, stage)) continue;
    const auto& mode = states_[static_cast<std::size_t>(match.state)]
                           .measured[static_cast<std::size_t>(match.measured)];
    const bool damping = damping_fitted(mode);
    rows.push_back({row, damping ? row + 1 : -1, m});
    row += damping ? 2 : 1;
    if (shape_fitted(mode)) row += mode.shape.size();
  }
  return rows;
}

UpdateMatches Likelihood::assign_state(int s, const UpdateStateModes& modelled, double factor,
                                       int parity) const {
  const auto& state = states_[static_cast<std::size_t>(s)];
  std::vector<PairingMode> measured, model;
  double by_rate = 0;
  for (const auto& move : clocks_[static_cast<std::size_t>(s)]) {
    by_rate = std::hypot(by_rate, move.factor);
  }
  std::vector<double> stds;
  for (std::size_t m = 0; m < state.measured.size(); ++m) {
    const auto& mode = state.measured[m];
    measured.push_back(
        {.frequency_hz = mode.frequency_hz.value, .plane = mode.plane, .shape = mode.shape});
    stds.push_back(std::hypot(relative_std(s, static_cast<int>(m)), by_rate));
  }
  for (const auto& mode : modelled.modes) {
    model.push_back({.frequency_hz = mode.frequency_hz,
                     .plane = mode.plane,
                     .shape = mode.shape,
                     .visibility = parity < 0                       ? mode.visibility
                                   : (mode.order + 1) % 2 == parity ? 1.0
                                                                    : 0.0});
  }
  const ModeAssignment found =
      assign_modes(measured, stds, model, state.band_hz, options_.assignment, factor);
  UpdateMatches result;
  result.log_likelihood = found.log_likelihood;
  result.log_detected = found.log_detected;
  result.log_false = found.log_false;
  result.log_missed = found.log_missed;
  for (const auto& pair : found.pairs) {
    const auto& mode = modelled.modes[static_cast<std::size_t>(pair.model)];
    result.matches.push_back(
        {s, pair.measured, mode.plane, mode.order, pair.mac, pair.cross_plane});
  }
  for (const int index : found.unpaired_measured) {
    const double hz = measured[static_cast<std::size_t>(index)].frequency_hz;
    result.unpaired.push_back({s, hz, true, false, "no mode of the model explains it"});
    ++result.unpaired_measured;
  }
  for (const auto& missed : found.missed) {
    const auto& mode = modelled.modes[static_cast<std::size_t>(missed.model)];
    result.unpaired.push_back({s, mode.frequency_hz, false, true,
                               fmt::format("{} {}: the test should have seen it",
                                           model::name_of(mode.plane), mode.order + 1)});
  }
  return result;
}

UpdateMatches Likelihood::assign(const Eigen::VectorXd& q, std::string& failure) const {
  std::array<UpdateMatches, 3> ways;  // by the scene, even orders, odd orders
  bool one_span = true;               // orders of a rig have no common nodes
  for (std::size_t way = 0; way < ways.size(); ++way) {
    const double one = options_.assignment.one_parity;
    const double log_prior = std::log(way == 0 ? 1 - 2 * one : one);
    ways[way].log_likelihood = ways[way].log_detected = log_prior;
  }
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    if (!takes_part(s)) continue;
    const auto& state = states_[static_cast<std::size_t>(s)];
    if (state.measured.empty()) continue;
    const UpdateStateModes modelled = modes(s, q, false);
    if (!modelled.failure.empty()) {
      failure = (state.name.empty() ? "" : state.name + ": ") + modelled.failure;
      return {};
    }
    one_span = one_span && state.scene.members.size() == 1;
    for (std::size_t way = 0; way < (one_span ? ways.size() : 1); ++way) {
      const UpdateMatches one = assign_state(s, modelled, 1, static_cast<int>(way) - 1);
      auto& all = ways[way];
      all.matches.insert(all.matches.end(), one.matches.begin(), one.matches.end());
      all.unpaired.insert(all.unpaired.end(), one.unpaired.begin(), one.unpaired.end());
      all.unpaired_measured += one.unpaired_measured;
      all.log_likelihood += one.log_likelihood;
      all.log_detected += one.log_detected;
      all.log_false += one.log_false;
      all.log_missed += one.log_missed;
    }
  }
  return *std::max_element(
      ways.begin(), one_span ? ways.end() : ways.begin() + 1,
      [](const auto& a, const auto& b) { return a.log_likelihood < b.log_likelihood; });
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
