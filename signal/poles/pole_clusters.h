// Groups the poles of a stabilisation diagram that belong together over the orders: candidates for
// physical modes, chosen without initial guesses.
//
// Distance of two poles: |p - q| over the sum of their half bandwidths -Re(p) - Re(q) (and of half
// a line spacing, below which no data tell poles apart). It is free of scale: two modes whose
// resonances can be seen apart lie further than 1 from each other however close they are in Hz;
// estimates of one mode by different orders lie within a small part of 1. Poles of successive
// orders are linked to tracks by that distance. Poles that follow noise change by their own
// bandwidth from order to order and form no long track. Where poles come with participation vectors
// (LscfOptions::participation), those whose vectors differ are never linked: two modes closer than
// their bandwidths stay two.
#pragma once

#include "signal/poles/lscf.h"

namespace rigfit::signal {

/// Largest distance of linked poles (1: bandwidths touch).
inline constexpr double kClusterRadius = 0.25;

struct PoleCluster {
  Complex pole_rad_s;            ///< medians over the upper half of the orders, window included
  double presence = 0;           ///< share of the upper half of the orders, 0..1
  double scatter = 0;            ///< rms distance from the median, in half bandwidths
  VectorXcd participation = {};  ///< that of the highest order's pole; may be empty
};

/// Distance of two poles over the sum of their half bandwidths and half of the lines' `spacing`,
/// rad/s. `window`: its decay rate, where poles are given without it.
[[nodiscard]] inline double apart(Complex p, Complex q, double window = 0, double spacing = 0) {
  return std::abs(p - q) /
         (std::abs(p.real() - window) + std::abs(q.real() - window) + spacing / 2);
}

/// Clusters by rising frequency. `line_spacing_hz` is that of the FRFs.
[[nodiscard]] std::vector<PoleCluster> cluster_poles(const LscfResult& stabilisation,
                                                     double line_spacing_hz);

}  // namespace rigfit::signal
