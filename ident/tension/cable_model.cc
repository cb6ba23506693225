#include "ident/tension/cable_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "model/linear/modal_analysis.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

// Strain taken where no EA is given: a steel cable at a third of its strength.
constexpr double kAssumedStrain = 1e-3;
constexpr double kAssumedStrainStd = 0.5;  // std of its logarithm: within a factor of 2 or so
// cos of the inclination from which a scene's tension is along the chord.
constexpr double kSteep = 0.0872;

double level(const CableDescription& cable) {
  return std::cos(cable.inclination_deg * signal::kTwoPi / 360);
}

double at_order(const std::vector<double>& values, std::size_t order) {
  return values.empty() ? 0 : values[std::min(order, values.size() - 1)];
}

void apply(const std::vector<double>& correction, std::vector<double>& frequencies) {
  if (correction.empty()) return;
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    frequencies[i] *= std::exp(at_order(correction, i));
  }
}

/// Frequencies of the segment model in one plane in the order of CableFrequencies; empty without an
/// equilibrium.
std::vector<double> segment_frequencies(const model::Scene& scene, model::ModePlane plane,
                                        int count, std::string& why) {
  const bool in = plane == model::ModePlane::in;
  model::ModesOptions options;
  options.count =
      in ? count + 4 : count;  // so that each family is complete, axial modes among them
  // Eight or more a half wave: 1e-5 of the frequency before the ratio is taken. The same number in
  // both planes, so that its error cancels.
  options.segments = std::max(100, 10 * count);
  options.plane = plane;
  options.damped = options.error_estimate = false;
  options.shapes = in;
  options.torsion = false;
  const auto analysis = model::analyse_modes(scene, options);
  if (analysis.modes.size() < static_cast<std::size_t>(count)) why = analysis.equilibrium.reason;
  std::vector<double> frequencies, symmetric, antisymmetric;
  const Eigen::Vector3d chord = (scene.nodes[1].position - scene.nodes[0].position).normalized();
  const Eigen::Vector3d across(-chord[1], chord[0], 0);
  for (const auto& mode : analysis.modes) {
    if (!in) {
      frequencies.push_back(mode.frequency_hz);
      continue;
    }
    const auto& displacement = mode.shape.front().displacement;
    const Eigen::RowVectorXd moved = across.transpose() * displacement;
    if (moved.squaredNorm() < (chord.transpose() * displacement).squaredNorm()) continue;  // axial
    (moved.dot(moved.reverse()) > 0 ? symmetric : antisymmetric).push_back(mode.frequency_hz);
  }
  for (std::size_t k = 0; k < symmetric.size(); ++k) {
    frequencies.push_back(symmetric[k]);
    if (k == antisymmetric.size()) break;
    frequencies.push_back(antisymmetric[k]);
  }
  return frequencies;
}

/// Rayleigh's quotient where the attached masses are `factor` times those of the correction.
void change_masses(const CableDescription& cable, double factor, std::vector<double>& frequencies) {
  const double all = cable.mass_per_length.value * cable.length_m.value;
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    double share = 0;
    for (const auto& mass : cable.masses) {
      const double moved =
          std::sin(static_cast<double>(i + 1) * signal::kTwoPi / 2 * mass.position);
      share += 2 * mass.mass * moved * moved / all;
    }
    frequencies[i] *= std::sqrt((1 + share) / (1 + factor * share));
  }
}

std::vector<double> logarithms_of_ratio(const std::vector<double>& segments,
                                        const std::vector<double>& straight_segments,
                                        const std::vector<double>& closed,
                                        const std::vector<double>& straight) {
  const std::size_t count =
      std::min({segments.size(), straight_segments.size(), closed.size(), straight.size()});
  std::vector<double> ln(count);
  for (std::size_t i = 0; i < count; ++i) {
    ln[i] = std::log(segments[i] / straight_segments[i] / (closed[i] / straight[i]));
  }
  return ln;
}

}  // namespace

CableState state_of(const CableDescription& cable, const CableShape& shape, double tension_N) {
  const double L = cable.length_m.value, flexible = 1e-10 * tension_N * L * L;
  const double EI = cable.EI_Nm2 ? std::max(cable.EI_Nm2->value, flexible)
                                 : tension_N * L * L / (shape.x * shape.x);
  const bool open = shape.q > 0 && !std::isinf(shape.q);
  return {.tension_N = tension_N,
          .EI_Nm2 = EI,
          .spring_Nm_rad = open ? shape.q * EI * (L * std::sqrt(tension_N / EI) + 4) / L : shape.q,
          .first_pinned = shape.first_pinned};
}

std::vector<CableInput> uncertain_inputs(const CableDescription& cable, bool springs) {
  std::vector<CableInput> inputs;
  const auto add = [&](std::size_t index, double std, double CableState::*factor,
                       bool measured = true) {
    if (std > 0) inputs.push_back({index, std, factor, measured});
  };
  add(0, cable.length_m.std / cable.length_m.value, &CableState::length);
  add(1, cable.mass_per_length.std / cable.mass_per_length.value, &CableState::mass);
  if (cable.EA_N) {
    add(2, cable.EA_N->std / cable.EA_N->value, &CableState::EA);
  } else {
    add(3, kAssumedStrainStd, &CableState::EA);
  }
  if (!cable.masses.empty()) add(4, cable.masses_std, &CableState::attached);
  add(5, cable.rate_relative_std, &CableState::rate);
  if (!cable.EI_Nm2) {
    add(6, kRangeOfX.step(), &CableState::EI, false);  // x^2, half the distance of the centres
  } else if (cable.EI_Nm2->value > 0) {
    add(6, cable.EI_Nm2->std / cable.EI_Nm2->value, &CableState::EI);
  }
  if (springs) add(7, 0.5 * kRangeOfQ.step(), &CableState::spring, false);
  return inputs;
}

CableModel::CableModel(const CableDescription& cable, CableCorrection correction)
    : cable_(cable), correction_(std::move(correction)) {}

double CableModel::axial_rigidity(double tension_N) const {
  return cable_.EA_N ? cable_.EA_N->value : tension_N / kAssumedStrain;
}

double CableModel::weight_across() const {
  return cable_.mass_per_length.value * cable_.gravity * level(cable_);
}

double CableModel::lambda_squared(double tension_N) const {
  return lambda_squared(CableState{tension_N});
}

double CableModel::lambda_squared(const CableState& state) const {
  const double T = state.tension_N,
               slope = weight_across() * state.mass * cable_.length_m.value * state.length / T;
  if (slope < 1e-9) return 0;  // a hanger
  return slope * slope * axial_rigidity(T) * state.EA / (T * (1 + slope * slope / 8));
}

bool CableModel::needs_correction(double tension_N) const {
  const double weight = cable_.mass_per_length.value * cable_.gravity * cable_.length_m.value;
  const double along = weight * std::sqrt(std::max(0.0, 1 - level(cable_) * level(cable_)));
  return !cable_.masses.empty() || weight_across() * cable_.length_m.value > 0.016 * tension_N ||
         along > 0.02 * tension_N;
}

SaggingBeam CableModel::beam(const CableState& state, bool sags) const {
  // Mass per length as installed: unstretched, the same mass lies on a shorter length.
  const bool installed = cable_.mass_reference == MassReference::installed;
  const double strain = state.tension_N / (axial_rigidity(state.tension_N) * state.EA);
  const double mass = cable_.mass_per_length.value * state.mass;
  return {cable_.length_m.value * state.length,
          mass / (installed ? 1 : 1 + strain),
          state.tension_N,
          state.EI_Nm2,
          state.spring_Nm_rad,
          sags ? lambda_squared(state) : 0,
          state.first_pinned};
}

CableFrequencies CableModel::frequencies(const CableState& state, int count, double limit_hz,
                                         CableRoots* near) const {
  auto found = cable_frequencies(beam(state, true), count, limit_hz, near);
  apply(correction_.in, found.in_hz);
  apply(correction_.out, found.out_hz);
  if (state.attached != 1) {
    change_masses(cable_, state.attached, found.in_hz);
    change_masses(cable_, state.attached, found.out_hz);
  }
  if (state.rate != 1) {  // a clock that is slow makes what it records fast
    for (auto* list : {&found.in_hz, &found.out_hz}) {
      for (double& hz : *list) hz /= state.rate;
    }
  }
  return found;
}

CableCorrection segment_correction(const CableModel& model, CableEnds ends, const CableState& state,
                                   int count, std::string& why) {
  CableDescription cable = model.cable();
  cable.EA_N = signal::Estimate{model.axial_rigidity(state.tension_N) * state.EA, 0};
  cable.length_m.value *= state.length;
  cable.mass_per_length.value *= state.mass;
  CableDescription straight = cable;
  straight.gravity = straight.inclination_deg = 0;
  straight.masses.clear();
  const auto with_springs = [&](const CableDescription& one) {
    auto scene = cable_scene(one, ends, state.tension_N, state.EI_Nm2);
    if (ends == CableEnds::springs) {
      for (auto& node : scene.nodes) node.support.rotational.setConstant(state.spring_Nm_rad);
    }
    return scene;
  };
  const auto hanging = with_springs(cable), level_scene = with_springs(straight);
  const double all = std::numeric_limits<double>::infinity();
  const auto closed = cable_frequencies(model.beam(state, true), count, all);
  const auto closed_straight = cable_frequencies(model.beam(state, false), count, all);
  // Out of plane: without axial modes.
  const auto reference = segment_frequencies(level_scene, model::ModePlane::out, count, why);
  CableCorrection correction;
  correction.in =
      logarithms_of_ratio(segment_frequencies(hanging, model::ModePlane::in, count, why), reference,
                          closed.in_hz, closed_straight.in_hz);
  correction.out =
      logarithms_of_ratio(segment_frequencies(hanging, model::ModePlane::out, count, why),
                          reference, closed.out_hz, closed_straight.out_hz);
  return correction;
}

model::Scene cable_scene(const CableDescription& cable, CableEnds ends, double tension_N,
                         double EI_Nm2) {
  model::Scene scene;
  scene.title = std::string("cable, ") + name_of(ends) + " ends";
  scene.gravity = {0, -cable.gravity, 0};
  const double angle = cable.inclination_deg * signal::kTwoPi / 360, L = cable.length_m.value;
  scene.nodes.resize(2);
  scene.nodes[0].name = "start";
  scene.nodes[1].name = "end";
  scene.nodes[1].position = {L * std::cos(angle), L * std::sin(angle), 0};
  for (auto& node : scene.nodes) {
    const bool pinned = ends == CableEnds::pinned ||
                        (ends == CableEnds::pinned_clamped && &node == &scene.nodes.front());
    node.support.kind = pinned ? model::Support::Kind::pinned : model::Support::Kind::clamped;
    if (ends == CableEnds::springs) {
      node.support.kind = model::Support::Kind::elastic;
      node.support.translational.setConstant(std::numeric_limits<double>::infinity());
      node.support.rotational.setConstant(10 * EI_Nm2 / L);
    }
  }
  model::Member member;
  member.name = "cable";
  member.nodes = {"start", "end"};
  const double EA = CableModel(cable).axial_rigidity(tension_N);
  const bool installed = cable.mass_reference == MassReference::installed;
  member.mass_per_length = cable.mass_per_length.value * (installed ? 1 + tension_N / EA : 1);
  member.EA = EA;
  member.EI = {EI_Nm2, EI_Nm2};
  member.GJ = EI_Nm2;
  member.tension = tension_N * (level(cable) > kSteep ? level(cable) : 1);
  member.masses = cable.masses;
  scene.members.push_back(member);
  return scene;
}

}  // namespace rigfit::ident
