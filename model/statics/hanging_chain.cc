// The exact equilibrium of a cable's segments without bending stiffness: the cold start of every
// equilibrium, for any tension.
//
// Under weights at its nodes the force in segment i is H h + V_i u (h: horizontal, u: up), with
// V_(i+1) = V_i + weight of the node between. Its vector is l (1 / |F| + 1 / EA) F, and all of them
// add up to the chord: two equations for V_0 and the unstretched length (H given) or H (length
// given). Started from the catenary: H. M. Irvine, Cable Structures, 1981, ch. 1.
#include <fmt/format.h>

#include "model/algebra/numbers.h"
#include "model/scene/actual_state.h"
#include "model/statics/equilibrium.h"

namespace rigfit::model {
namespace {

constexpr double kLongest = 50;  // cable lengths over the chord beyond which it is called slack

struct Problem {
  double across = 0, up = 0;      // chord
  std::vector<double> EA;         // by segment
  std::vector<double> share;      // share of the length, by segment
  std::vector<double> by_length;  // weight of segments on each inner node over the length, N/m
  std::vector<double> fixed;      // weight of attached masses on each inner node, N
  double total_by_length = 0;     // N/m of unstretched length
};

struct Sums {
  double across = 0, up = 0;
  double across_v = 0, up_v = 0;            // by V0
  double across_length = 0, up_length = 0;  // by the length
};

Sums add_up(const Problem& p, double h, double v0, double length) {
  Sums s;
  const auto n = p.EA.size();
  double v = v0, v_length = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double l = length * p.share[i];
    const double f2 = h * h + v * v, f = std::sqrt(f2);
    const double compliance = 1 / f + 1 / p.EA[i];
    s.across += l * compliance * h;
    s.up += l * compliance * v;
    const double across_v = -l * h * v / (f2 * f), up_v = l * (compliance - v * v / (f2 * f));
    s.across_v += across_v;
    s.up_v += up_v;
    s.across_length += compliance * h * p.share[i] + across_v * v_length;
    s.up_length += compliance * v * p.share[i] + up_v * v_length;
    if (i + 1 < n) {
      v += p.by_length[i] * length + p.fixed[i];
      v_length += p.by_length[i];
    }
  }
  return s;
}

/// V0 and length for a horizontal force. Newton, halved while the error grows.
bool solve(const Problem& p, double h, double& v0, double& length) {
  const double chord = std::hypot(p.across, p.up);
  const auto error_of = [&](const Sums& s) { return std::hypot(s.across - p.across, s.up - p.up); };
  Sums s = add_up(p, h, v0, length);
  double error = error_of(s);
  for (int iteration = 0; iteration < 60; ++iteration) {
    if (error <= 1e-14 * (chord + length)) return true;
    const double determinant = s.across_v * s.up_length - s.across_length * s.up_v;
    if (!(std::abs(determinant) > 0)) return false;
    const double ra = p.across - s.across, ru = p.up - s.up;
    const double dv = (ra * s.up_length - s.across_length * ru) / determinant;
    const double dl = (s.across_v * ru - ra * s.up_v) / determinant;
    bool better = false;
    for (double factor = 1; factor > 1e-4; factor /= 2) {
      const double v = v0 + factor * dv, l = length + factor * dl;
      if (!(l > 0)) continue;
      const Sums next = add_up(p, h, v, l);
      const double next_error = error_of(next);
      if (next_error < error) {
        v0 = v, length = l, s = next, error = next_error, better = true;
        break;
      }
    }
    if (!better) return error <= 1e-10 * (chord + length);
  }
  return error <= 1e-10 * (chord + length);
}

/// Catenary's guess for a horizontal force; false when it would be absurdly long.
bool catenary(const Problem& p, double h, double& v0, double& length) {
  const double chord = std::hypot(p.across, p.up);
  const double w = p.total_by_length;
  if (!(w > 0) || w * p.across < 1e-9 * h) {
    length = chord / (1 + h / (p.EA[0] * (p.across / chord)));
    v0 = h * p.up / p.across - w * length / 2;
    return true;
  }
  const double c = h / w, u = p.across / (2 * c);
  if (u > 30) return false;
  const double reach = 2 * c * std::sinh(u);
  const double stretched = std::hypot(p.up, reach);
  if (stretched > 2 * kLongest * chord) return false;
  const double middle = std::asinh(p.up / reach);
  v0 = h * std::sinh(middle - u);
  length = stretched / (1 + h / p.EA[0] * (stretched / p.across));
  return true;
}

/// A cable between its drawn ends, for its target tension (and `extra` N more, which stands for
/// what bending carries) or its unstretched length. The reason why it is slack; empty: it hangs.
std::string hang(Chain& chain, int index, double extra, ChainState& state) {
  const ChainMember& member = chain.members[at(index)];
  const auto n = at(member.segments);
  const Vector3d from = chain.drawn.col(member.nodes.front());
  const Vector3d chord = chain.drawn.col(member.nodes.back()) - from;
  const double g = chain.gravity.norm();
  const Vector3d up = g > 0 ? Vector3d(-chain.gravity / g) : Vector3d(Vector3d::Zero());
  const Vector3d level = chord - up * up.dot(chord);
  const auto segment = [&](std::size_t i) -> const Segment& {
    return chain.segments[static_cast<std::size_t>(member.first_segment) + i];
  };

  Problem p;
  p.EA.resize(n);
  p.share.resize(n);
  p.by_length.assign(n - 1, 0);
  p.fixed.assign(n - 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    p.EA[i] = segment(i).EA;
    p.share[i] = member.even ? 1 / double(n) : member.places[i + 1] - member.places[i];
    const double weight = segment(i).mass * g / member.unstretched_length;
    p.total_by_length += weight;
    if (i > 0) p.by_length[i - 1] += weight / 2;
    if (i + 1 < n) p.by_length[i] += weight / 2;
  }
  for (const PointMass& mass : chain.masses) {
    if (mass.member != index) continue;
    for (std::size_t i = 1; i < n; ++i) {
      if (member.nodes[i] == mass.node[0]) p.fixed[i - 1] += mass.mass * g * (1 - mass.fraction);
      if (member.nodes[i] == mass.node[1]) p.fixed[i - 1] += mass.mass * g * mass.fraction;
    }
  }

  const bool steep = level.norm() < 0.0872 * chord.norm();
  if (steep || !(g > 0)) {
    // Straight along the chord, tension varying with the weight below.
    double length = member.unstretched_length, tension = 0;
    if (member.target_tension) {
      tension = *member.target_tension + extra;
      double compliance = 0;
      for (std::size_t i = 0; i < n; ++i) compliance += p.share[i] / p.EA[i];
      length = chord.norm() / (1 + tension * compliance);
    } else {
      tension = p.EA[n / 2] * (chord.norm() / length - 1);
    }
    if (!(tension > 0)) {
      return fmt::format("it is {:.6g} m long unstretched and its ends are {:.6g} m apart", length,
                         chord.norm());
    }
    for (std::size_t i = 1; i < n; ++i) {
      state.position.col(member.nodes[i]) = from + chord * member.places[i];
    }
    chain.set_unstretched_length(index, length);
    return {};
  }

  const Vector3d h = level.normalized();
  p.across = level.norm();
  p.up = up.dot(chord);
  double v0 = 0, length = 0;
  double horizontal = 0;
  if (member.target_tension) {
    horizontal = *member.target_tension + extra;
    if (!(horizontal > 0) || !catenary(p, horizontal, v0, length) ||
        !solve(p, horizontal, v0, length) || length > kLongest * chord.norm()) {
      return fmt::format(
          "with a horizontal tension of {:.6g} N under its own weight it would be more than {} "
          "times as long as its span",
          horizontal, kLongest);
    }
  } else {
    // The length falls as the force rises: bisection in its logarithm.
    const double wanted = member.unstretched_length;
    if (wanted > kLongest * chord.norm()) {
      return fmt::format("it is more than {} times as long as its span", kLongest);
    }
    double low = std::log(1e-6 * std::max(p.total_by_length * wanted, 1e-12 * p.EA[0]));
    double high = std::log(2 * p.EA[0] * (1 + chord.norm() / wanted));
    const auto too_long = [&](double log_force) {
      const double force = std::exp(log_force);
      return !catenary(p, force, v0, length) || !solve(p, force, v0, length) || length > wanted;
    };
    if (too_long(high) || !too_long(low)) {
      return "no horizontal tension holds it at its unstretched length";
    }
    while (high - low > 1e-13 * (1 + std::abs(high))) {
      const double middle = 0.5 * (low + high);
      (too_long(middle) ? low : high) = middle;
    }
    horizontal = std::exp(high);
    (void)too_long(high);  // v0 and length there
  }

  double v = v0;
  Vector3d x = from;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double f = std::hypot(horizontal, v);
    x += length * p.share[i] * (1 / f + 1 / p.EA[i]) * (horizontal * h + v * up);
    state.position.col(member.nodes[i + 1]) = x;
    v += p.by_length[i] * length + p.fixed[i];
  }
  chain.set_unstretched_length(index, length);
  return {};
}

}  // namespace

bool hang_cables(Chain& chain, const Scene& scene, bool with_bending, ChainEquilibrium& result) {
  ChainState& state = result.state;
  state = drawn_state(chain);
  for (std::size_t m = 0; m < chain.members.size(); ++m) {
    const ChainMember& member = chain.members[m];
    if (!member.cable) continue;
    double extra = 0;
    if (with_bending) {  // a half sine's, or a whole one's between clamps
      const Member& given = scene.members[m];
      const bool straight = given.assembled == Member::Assembled::straight &&
                            member.end_joint[0] >= 0 && member.end_joint[1] >= 0;
      const double wave = (straight ? 2 : 1) * M_PI / chord_of(scene, given).norm();
      extra = given.EI[0] * wave * wave;
    }
    const std::string reason = hang(chain, static_cast<int>(m), extra, state);
    if (!reason.empty()) {
      result.status = EquilibriumStatus::slack;
      result.reason = fmt::format("cable \"{}\" is slack: {}; {}", scene.members[m].name, reason,
                                  how_to_tighten(scene.members[m]));
      return false;
    }
  }
  carry_frames(chain, drawn_state(chain), state);
  return true;
}

}  // namespace rigfit::model
