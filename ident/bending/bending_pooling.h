// One slope of several strokes. Inside of bending_analysis.
//
// Strokes are pooled with the scatter between them (estimation/groups.h), degrees of freedom after
// Welch and Satterthwaite (GUM G.4); or averaged over the laws of wire friction
// (friction_transient.h) by their Akaike weights, with the spread between laws in the variance.
#pragma once

#include <optional>
#include <vector>

#include "ident/bending/friction_transient.h"
#include "signal/numerics/estimate.h"

namespace rigfit::ident {

struct PooledSlope {
  double K = 0, variance = 0;  ///< N/m
  double welch = 0;            ///< variance^2 over its degrees of freedom
};

/// Variance of a slope, never zero.
[[nodiscard]] double slope_variance(const signal::Estimate& slope);

/// `freedoms`: degrees of freedom of each slope's uncertainty.
[[nodiscard]] PooledSlope pool_slopes(const std::vector<signal::Estimate>& slopes,
                                      const std::vector<double>& freedoms);

struct SlopeWithFriction {
  PooledSlope pooled;
  double probability = 0;          ///< Akaike weight of the laws with friction
  double travel_m = 0;             ///< over which friction turns round; 0: none is seen
  double load_N = 0;               ///< half of what it adds after a turn
  double relative_std = 0;         ///< of K: what the laws differ by
  double relative_correction = 0;  ///< of K, against straight lines
};

/// Empty where the strokes are too short to tell. `straight`: by the straight parts alone.
[[nodiscard]] std::optional<SlopeWithFriction> average_over_friction(
    const std::vector<FrictionStroke>& strokes, const PooledSlope& straight,
    double deflection_noise);

}  // namespace rigfit::ident
