// End conditions of a bending test, and the stiffness of a beam without tension:
//
//   EI = L^3 / (c s),   s = d / Q,   c = 192 clamped, 48 pinned (load at mid-span), 3 cantilever
//   (load at its end)
//
// These are the limits of the tensioned beam's equation (bending_equation.h) for tension zero: an
// Euler-Bernoulli beam with small deflections and without shear. Source: Gere and Timoshenko,
// Mechanics of Materials, appendix G.
#pragma once

namespace rigfit::ident {

enum class BeamEnds {
  tensioned,   ///< clamped at both ends under a measured tension
  clamped,     ///< at both ends, no tension
  pinned,      ///< on two simple supports, no tension
  cantilever,  ///< clamped at one end, loaded at the other; the span is the length to the load
};

/// The factor c; with tension 192, the limit for tension zero.
[[nodiscard]] constexpr double beam_stiffness_factor(BeamEnds ends) {
  if (ends == BeamEnds::pinned) return 48;
  return ends == BeamEnds::cantilever ? 3 : 192;
}

[[nodiscard]] constexpr const char* name_of(BeamEnds ends) {
  switch (ends) {
    case BeamEnds::tensioned:
      return "tensioned";
    case BeamEnds::clamped:
      return "clamped";
    case BeamEnds::pinned:
      return "pinned";
    case BeamEnds::cantilever:
      return "cantilever";
  }
  return "tensioned";
}

}  // namespace rigfit::ident
