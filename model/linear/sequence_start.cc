// Into how many segments the chains of a sequence are cut, and where.
#include <Eigen/Geometry>

#include "model/algebra/numbers.h"
#include "model/linear/segment_extrapolation.h"
#include "model/scene/actual_state.h"

namespace rigfit::model {
namespace {

// Segments of the first number m: by the phase of the highest wave (rad), in a layer of bending,
// which is followed down to e^-6, and of a member at least.
constexpr double kPhaseShare = 0.3, kLayerReach = 6, kLayerShare = 2 / kLayerReach;
constexpr int kFewestInStretch = 3;
constexpr double kLayerSeen =
    0.1;  // share of the accuracy: layers at pinned ends that do less are left out
constexpr double kApart = 1e-6;   // relative to a member: places nearer than this are one
constexpr double kWorthIt = 1.5;  // a layer's own stretches, where its reach times this fits
constexpr int kFewestSamples = 8;
constexpr double kSampleShare = 1.2;  // by the phase

/// What the segments of a member have to follow.
struct Demand {
  double by_phase = 0;                     // segments of m, of the whole member
  double reach = 0;                        // length of a layer relative to the member
  double by_layer = 0;                     // segments of m of a whole member as fine as a layer's
  std::array<bool, 2> bent{false, false};  // ends that bear a moment
};

int count(double wanted) { return std::max(1, static_cast<int>(std::ceil(wanted - 1e-9))); }

/// Between two places, `layer` telling which of them makes a layer.
void cut(double from, double to, std::array<bool, 2> layer, const Demand& demand,
         std::vector<Stretch>& out) {
  const double length = to - from;
  const double needed = demand.reach * (int(layer[0]) + int(layer[1]));
  if (!(needed > 0)) {
    out.push_back({to, count(demand.by_phase * length)});
    return;
  }
  const double density = std::max(demand.by_phase, demand.by_layer);
  if (kWorthIt * needed > length) {
    out.push_back({to, count(density * length)});
    return;
  }
  const int in_layer = count(density * demand.reach);
  if (layer[0]) out.push_back({from + demand.reach, in_layer});
  const double end = layer[1] ? to - demand.reach : to;
  out.push_back({end, count(demand.by_phase * (length - needed))});
  if (layer[1]) out.push_back({to, in_layer});
}

std::vector<Stretch> stretches_of(const Member& member, const Demand& demand) {
  std::vector<double> places{0};
  std::vector<double> masses;
  masses.reserve(member.masses.size());
  for (const AttachedMass& mass : member.masses) masses.push_back(mass.position);
  std::sort(masses.begin(), masses.end());
  for (const double place : masses) {
    if (place - places.back() > kApart && 1 - place > kApart) places.push_back(place);
  }
  places.push_back(1);
  std::vector<Stretch> out;
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    const bool first = i == 0, last = i + 2 == places.size();
    cut(places[i], places[i + 1], {first ? demand.bent[0] : true, last ? demand.bent[1] : true},
        demand, out);
  }
  int all = 0;
  for (const Stretch& stretch : out) all += stretch.segments;
  if (all < kFewestInStretch) {
    const auto longest =
        std::max_element(out.begin(), out.end(),
                         [&](const auto& a, const auto& b) { return a.segments < b.segments; });
    longest->segments += kFewestInStretch - all;
  }
  return out;
}

/// What the layers at the pinned ends of a sagging cable take off omega^2, relative, in order of
/// magnitude: lambda^4 (d / L)^3.
double sag_layer(const Scene& scene, const Member& member, double tension, double length) {
  if (!(tension > 0) || !(length > 0)) return 0;
  const double across = scene.gravity.cross(chord_of(scene, member).normalized()).norm();
  const double slope = member.mass_per_length * across * length / tension;
  const double lambda2 = slope * slope * member.EA / tension;
  const double depth = std::sqrt(std::max(member.EI[0], member.EI[1]) / tension) / length;
  return lambda2 * lambda2 * depth * depth * depth;
}

}  // namespace

ChainOptions SequenceStart::chain(int factor, const ModesOptions& options) const {
  ChainOptions out;
  out.rotary_inertia = RotaryInertia::even_powers;
  out.torsion = options.torsion;
  for (const auto& member : stretches) {
    std::vector<double>& places = out.places.emplace_back(1, 0.0);
    for (const Stretch& stretch : member) {
      const double from = places.back();
      const int n = factor * stretch.segments;
      for (int i = 1; i <= n; ++i) {
        places.push_back(i == n ? stretch.end : from + (stretch.end - from) * i / n);
      }
    }
  }
  return out;
}

SequenceStart sequence_start(const Scene& scene, const ChainModes& modes, double accuracy) {
  SequenceStart out;
  const Equilibrium rest = describe(*modes.chain, modes.equilibrium, scene);
  const std::vector<double> phases = wave_phases(scene, modes);
  for (std::size_t m = 0; m < scene.members.size(); ++m) {
    const Member& member = scene.members[m];
    const double tension = rest.members[m].tension_N;
    const double length = rest.members[m].unstretched_length_m;
    double stiffest = 0, softest = 0;  // extreme EI among axes that are not limp
    for (const double EI : member.EI) {
      if (!(EI > 0)) continue;
      stiffest = std::max(stiffest, EI);
      softest = softest > 0 ? std::min(softest, EI) : EI;
    }
    // Euler's least critical load, pi^2 EI / (2 L)^2: frequencies near it are differences of two
    // stiffnesses that converge each.
    const double critical = std::pow(0.5 * M_PI / length, 2) * std::min(member.EI[0], member.EI[1]);
    out.resolved = out.resolved && -tension <= critical;
    Demand demand;
    demand.by_phase = kPhaseShare * phases[m];
    const bool everywhere = sag_layer(scene, member, tension, length) > kLayerSeen * accuracy;
    for (std::size_t e = 0; e < 2; ++e) {
      demand.bent[e] = everywhere || modes.chain->members[m].end_joint[e] >= 0;
    }
    if (tension > 0 && stiffest > 0) {
      demand.reach = kLayerReach * std::sqrt(stiffest / tension) / length;
      demand.by_layer = kLayerShare * length * std::sqrt(tension / softest);
    }
    out.stretches.push_back(stretches_of(member, demand));
    out.samples.push_back(
        std::max(kFewestSamples, static_cast<int>(std::ceil(kSampleShare * phases[m]))));
  }
  return out;
}

}  // namespace rigfit::model
