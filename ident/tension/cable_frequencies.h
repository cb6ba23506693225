// Natural frequencies of a tensioned beam of shallow sag between equal rotational springs, exact
// within the linear theory.
//
//   EI y'''' - T y'' - m omega^2 y = h z'',   EI z'''' - T z'' = w,   h = -(EA / Le) int z'' y dx
//
// with h = 0 out of plane and in antisymmetric modes. At rest the ends carry no moment: a clamp or
// spring holds the direction in which the cable hangs. Then z'' = -(w / T) p, p = 1 - cosh(kappa x)
// / cosh(kappa l), kappa^2 = T / EI, l = L / 2; p = 1 for a flexible cable. With T b^2 + EI b^4 = m
// omega^2, a^2 = b^2 + kappa^2 and q = k / EI the ends y = 0, EI y'' = -+ k y' give
//
//   antisymmetric:      tan(b l)        = q b / (a^2 + b^2 + q a coth(a l))
//   symmetric, h = 0:   tan(b l - pi/2) = q b / (a^2 + b^2 + q a tanh(a l))
//   symmetric, sag:     S (m omega^2 - G <p p>) + G R (<p c> - cos(b l) <p h>) = 0
//                       S = cos(b l) + (b^2 cos b l + q b sin b l) / (a^2 + q a tanh(a l)),
//                       R = (kappa^2 + q kappa tanh(kappa l)) / (a^2 + q a tanh(a l)),
//                       G = lambda^2 T / L^2,  lambda^2 = (w L / T)^2 EA L / (T Le)
//
// <> means over the span, c = cos(b x), h = cosh(a x) / cosh(a l). The particular solution is p
// itself, as EI p'''' = T p''. The sag is one positive semi-definite term of rank one: it puts one
// root between every two neighbours of h = 0. For EI = 0 this is Irvine's equation tan(x) = x - (4
// / lambda^2) x^3, x = b l. Sources: T. M. Irvine, Cable Structures, 1981, ch. 3; H. Zui, T. Shinke
// and Y. Namita, J. Struct. Eng. 122 (1996) 651-656; G. Ricciardi and F. Saitta, J. Sound Vib. 310
// (2008) 1-24.
#pragma once

#include <vector>

namespace rigfit::ident {

struct SaggingBeam {
  double length_m = 0;         ///< chord, > 0
  double mass_per_length = 0;  ///< kg/m of the installed cable, > 0
  double tension_N = 0;        ///< > 0
  double EI_Nm2 = 0;           ///< > 0
  double spring_Nm_rad = 0;    ///< rotational spring at each end; 0: pinned, infinity: clamped
  double lambda_squared = 0;   ///< Irvine's parameter, 0: no sag
  /// The first end is pinned whatever the spring. Without sag these modes are the antisymmetric
  /// ones of the beam joined to its mirror image; the sag then changes them as those of a pinned
  /// cable.
  bool first_pinned = false;
};

/// Out of plane by rising frequency. In plane by family: symmetric modes at even places,
/// antisymmetric ones at odd places, each family rising. With sag the families cross, so that the
/// list as a whole need not rise. Those at odd places are out-of-plane modes too.
struct CableFrequencies {
  std::vector<double> in_hz, out_hz;
};

/// Roots of the last call, from which those of a neighbouring beam are found in two or three steps.
struct CableRoots {
  std::vector<double> straight, sagging;  ///< wave numbers times L / 2; 0: not known
  /// Relative step after which a root counts as found, its error of the order of the square; 1: one
  /// step, for difference quotients over 1e-4 or less.
  double last_step = 1e-8;
};

/// The first `count` of each plane, or those up to and including the first out-of-plane one at
/// `limit_hz` or above.
/// `near` is read and rewritten.
[[nodiscard]] CableFrequencies cable_frequencies(const SaggingBeam& cable, int count,
                                                 double limit_hz, CableRoots* near = nullptr);

}  // namespace rigfit::ident
