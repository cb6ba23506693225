#include "model/chain/segment_lumping.h"

#include <Eigen/Geometry>

namespace rigfit::model {
namespace {

/// x^n / n! taken out of the rest of an exponential series from there on: 1 + x / (n + 1) + ...
/// (stride 1) or, by x^2, of a hyperbolic one (stride 2); without cancellation.
double tail(double x, int next, int stride) {
  double term = 1, sum = 1;
  for (int n = next; std::abs(term) > 1e-17 * sum && n < 200; n += stride) {
    for (int k = 0; k < stride; ++k) term /= n + k;
    term *= x;
    sum += term;
  }
  return sum;
}

/// Mean mass per length of a tapered member, kg/m.
double mean_mass(const Member& member) {
  return member.mass_per_length * (1 + member.taper + member.taper * member.taper) / 3;
}

}  // namespace

ClampFlexibility clamp_flexibility(double q2) {
  if (!(q2 > 0)) return {3.0 / 8, 1.0 / 6, -1.0 / 24};
  // Beyond 1e8 a joint's moment is nothing beside what tension does.
  q2 = std::min(q2, 1e8);
  const double q = std::sqrt(q2);
  const double p = 2 * std::asinh(q / 2), m = std::exp(-p);
  const double sinh = std::sinh(p), cosh = std::cosh(p);
  const double sinh_less = p < 1 ? p * p * p / 6 * tail(p * p, 4, 2) : sinh - p;
  const double exp_less = p < 1 ? p * p / 2 * tail(p, 3, 1) : std::exp(p) - 1 - p;
  const double next = sinh_less * cosh / sinh, second = -sinh_less / (4 * sinh * cosh);
  // 1 + s: the moment at the clamp over that one segment away. q - 1 + 1 / (1 + s) without
  // cancellation: (q s - (s - q)) / (1 + s), and q - p = q^3 / 24 - ... from asinh's series.
  const double q_less = q < 0.1 ? q * q2 / 24 * (1 - 9 * q2 / 80 + 75 * q2 * q2 / 4480) : q - p;
  const double excess = exp_less + next + second * m * m / (1 + second * m) - q_less;  // s - q
  const double s = q + excess;
  return {(q * s - excess) / (1 + s) / q2, next / q2, second / q2};
}

double nominal_tension(const Member& member, const Vector3d& ends, const Vector3d& gravity) {
  if (member.kind != Member::Kind::cable) return 0;
  const double chord = ends.norm();
  const double across = gravity.cross(ends / chord).norm();
  if (member.tension) {
    const double level = gravity.norm() > 0 ? across / gravity.norm() : 1;
    return *member.tension / (level > 0.0872 ? level : 1);
  }
  const double length = member.unstretched_length ? *member.unstretched_length
                        : member.stretch          ? chord - *member.stretch
                                                  : chord;
  // T / EA - (w L / T)^2 / 24 = chord / length - 1, a cubic in T: Newton's method from above,
  // where the cubic is convex, to rounding.
  const double strain = chord / length - 1, pull = mean_mass(member) * across * chord;
  if (!(pull > 0)) return std::max(0.0, member.EA * strain);
  const double taut = member.EA * strain, sag = member.EA * pull * pull / 24;
  double tension = std::max(0.0, taut) + std::cbrt(sag);
  for (double step = tension; step > 1e-14 * tension; tension -= step) {
    step = (tension * tension * (tension - taut) - sag) / (tension * (3 * tension - 2 * taut));
  }
  return tension;
}

AxialForce nominal_axial_force(const Scene& scene, const std::vector<std::array<int, 2>>& ends,
                               std::size_t member) {
  const Member& beam = scene.members[member];
  const auto node = [&](int k) -> const SceneNode& { return scene.nodes[at(k)]; };
  const auto held = [&](int k) { return node(k).support.kind != Support::Kind::free; };
  const auto [first, second] = ends[member];
  if (beam.kind == Member::Kind::cable || held(first) == held(second)) return {};
  const int tip = held(first) ? second : first, foot = held(first) ? first : second;
  Vector3d force = node(tip).mass * scene.gravity;
  for (std::size_t m = 0; m < ends.size(); ++m) {
    if (m == member || (ends[m][0] != tip && ends[m][1] != tip)) continue;
    const Member& other = scene.members[m];
    const int far = ends[m][0] == tip ? ends[m][1] : ends[m][0];
    const Vector3d chord = node(far).position - node(tip).position;
    const double length = chord.norm();
    if (!(length > 0)) continue;
    force += 0.5 * mean_mass(other) * length * scene.gravity;
    if (other.kind != Member::Kind::cable) continue;
    force += nominal_tension(other, chord, scene.gravity) / length * chord;
  }
  const Vector3d axis = node(tip).position - node(foot).position;
  const double length = axis.norm();
  if (!(length > 0)) return {};
  const double at_tip = force.dot(axis) / length;
  const double at_foot = at_tip + mean_mass(beam) * scene.gravity.dot(axis);
  return held(first) ? AxialForce{at_foot, at_tip} : AxialForce{at_tip, at_foot};
}

}  // namespace rigfit::model
