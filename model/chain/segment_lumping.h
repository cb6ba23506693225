// Lumping of a segment of length l: how its mass is shared by its nodes, and the flexibility of its
// joints, chosen so that errors stay small at clamped ends too.
//
// Joints are given by their flexibility in l / EI (1: the plain joint of EI / l).
//   mass    c of it couples a segment's nodes, 1/2 - c is at each. c = 1/6 (a rigid rod's) cancels
//           the error of a chain that bending stiffens to the fourth order of l, c = 1/12 that of
//           one that tension stiffens: (2 - 2 cos kl) / (kl)^2 = 1 - (kl)^2 / 12 = its mass.
//   clamp   The complementary energy, flexibility times moment squared / 2 summed over joints, is a
//           trapezoidal rule with its end error of second order. Weights at the end and at the two
//           next joints remove it: without tension Gregory's 3/8, 7/6, 23/24 (C. Jordan, Calculus
//           of Finite Differences, 1939, sec. 99). With tension moments go as e^(+-pi), p from
//           2 cosh p - 2 = q^2, q = l sqrt(T / EI) the segment over a boundary layer's depth; for
//           each A cosh pi + B sinh pi
//             e_1 = (sinh p - p) coth p / q^2,  e_2 = -(sinh p - p) / (4 q^2 sinh p cosh p)
//           are added to the joints one and two segments away, and the end's own,
//             e_0 = (q - 1 + 1 / (e^p + q^2 e_1 + q^2 e_2 e^(-2p) / (1 + q^2 e_2 e^(-p)))) / q^2,
//           puts the chain, beyond a layer it may not resolve, where the beam is: at x - sqrt(EI/T)
//           times its slope.
//   beam    An axial force N (weight, guys) leaves an error of N l^2 / 12 times the fourth
//           derivative when c = 1/6, which is subtracted from the joints' EI. Gregory's weights
//           turn the first two segments at a clamp by -1/8 and 1/24 of l M / EI too far, on which N
//           does work: the sum of their squares, 5/288 N l^2 / EI, is added to the end's
//           flexibility of 3/8, and 5/108 N l^2 to its EI. The buckling load of a column then is
//           right to the fourth order.
// The paper's lumping is c = 1/6, plain joints, and half a segment (1/2, 0, 0) at a clamp. With c =
// 0 for cables instead, errors are in even powers of l alone, with quickly falling coefficients
// (those of sin(kl/2) / (kl/2)): such coarse chains are extrapolated to l = 0.
#pragma once

#include "model/algebra/numbers.h"
#include "model/scene/scene.h"

namespace rigfit::model {

/// How segments are lumped. rigid_rod is the paper's: rotary inertia m l^2/12 about a transverse
/// axis, joints of EI / l, half a segment at a clamp; frequencies err by l^2. Accurate takes the
/// inertia and the joints for which they err by l^4, tension and clamps included. even_powers is
/// for extrapolation: errors are a series in l^2.
enum class RotaryInertia { accurate, rigid_rod, even_powers };

/// A clamp's joint, and what it adds to the joints one and two segments away, in l / EI.
struct ClampFlexibility {
  double end = 0.5, next = 0, second = 0;
};

/// `q2` = T l^2 / EI, not negative; infinite for a member without bending stiffness.
[[nodiscard]] ClampFlexibility clamp_flexibility(double q2);

/// Estimated tension of a member, N, before the equilibrium is known: from its stated tension or
/// length, sag included; zero for a beam. `chord` m, `gravity` m/s^2, in the same axes.
[[nodiscard]] double nominal_tension(const Member& member, const Vector3d& chord,
                                     const Vector3d& gravity);

/// Axial force that varies linearly along a member, tension positive, N.
struct AxialForce {
  double first = 0, second = 0;
  /// Force at `s` from 0 (first node) to 1 (second), N.
  [[nodiscard]] double at(double s) const { return first + (second - first) * s; }
};

/// Axial force in a beam between a supported node and a free one, as drawn: from its weight, the
/// weight of the free node and of half of the other members there, and the cables' tension. Zero
/// for cables and for beams held at both ends or at none. `ends`: nodes of each member.
[[nodiscard]] AxialForce nominal_axial_force(const Scene& scene,
                                             const std::vector<std::array<int, 2>>& ends,
                                             std::size_t member);

}  // namespace rigfit::model
