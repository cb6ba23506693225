// Wire friction in load-deflection strokes: what it does after every turn, and the slope without
// it.
//
//   Q = c + K x - (sign of the stroke) a u(s / delta),   s: travel since the turn
//
// Wires that rubbed one way must first be dragged the other way: over a travel delta the strand is
// stiffer than it will be, then friction is constant and K is the slope. A straight line through
// such a stroke is too steep by about a / travel. u falls from 1 to 0; which law it follows is not
// known, so two of Dahl's (1968) are fitted,
//   du/ds = -u^i / delta:  i = 1 exponential, 2 a long tail,
// all strokes of a record together with one delta, and the caller averages over the laws by AICc
// (Burnham and Anderson 2002, ch. 4), "no friction" among them; what the two laws differ by is
// uncertainty besides, whichever fits. Linear in c, K, a for given delta,
// which is found by profile. Strokes are averaged into bins first; Huber weights. A stroke in which
// the transient would soften the beginning (a toe, not friction) has none.
//
// Noise of the bins is white and a random walk (drift of load cell and LVDT), their variances by
// moments from the residuals of all strokes together: a walk hardly shows in residuals, of which
// the line has taken most, but moves the slope 6/5 of its whole way over the stroke (in variance).
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "signal/numerics/estimate.h"

namespace rigfit::ident {

enum class FrictionLaw { none, exponential, hyperbola };
inline constexpr std::array<FrictionLaw, 3> kFrictionLaws{
    FrictionLaw::none, FrictionLaw::exponential, FrictionLaw::hyperbola};

/// u(z), z = s / delta.
[[nodiscard]] double friction_transient(FrictionLaw law, double z);

/// One stroke, samples in the order they were taken.
struct FrictionStroke {
  double sign = 1;  ///< +1 loading, -1 unloading
  Eigen::VectorXd travel_m, x_m, load_N;
};

struct FrictionFit {
  bool usable = false;
  FrictionLaw law = FrictionLaw::none;
  double travel_m = 0;                          ///< delta
  std::vector<signal::Estimate> stiffness_N_m;  ///< K of each stroke; std without delta's share
  std::vector<double> by_travel;  ///< change of each K by one standard deviation of delta
  std::vector<double> load_N;     ///< a of each stroke, not negative
  double residual_rms_N = 0;      ///< rms residual of the bins
  /// Share of the slopes' variance by drift rather than white noise.
  double walk_share = 0;
  double degrees_of_freedom = 0;  ///< for one stroke's variance
  double aicc = 0;
};

/// `noise_x`: standard deviation of one sample of x, corrected for to first order. Strokes need 12
/// samples; not usable otherwise.
[[nodiscard]] FrictionFit fit_friction(const std::vector<FrictionStroke>& strokes, FrictionLaw law,
                                       double noise_x_m);

}  // namespace rigfit::ident
