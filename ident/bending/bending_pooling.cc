#include "ident/bending/bending_pooling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "signal/estimation/groups.h"

namespace rigfit::ident {
namespace {

struct FrictionCandidate {
  PooledSlope pooled;
  FrictionFit fit;
};

}  // namespace

// Exact tables have lines without residuals; rounding keeps their variance from being zero.
double slope_variance(const signal::Estimate& slope) {
  const double std = std::max(slope.std, 1e-10 * slope.value);
  return std * std;
}

PooledSlope pool_slopes(const std::vector<signal::Estimate>& slopes,
                        const std::vector<double>& freedoms) {
  std::vector<double> values, variances;
  for (const auto& K : slopes) values.push_back(K.value), variances.push_back(slope_variance(K));
  const auto mean = signal::mean_over_groups(values, variances);
  PooledSlope pooled{mean.mean, mean.variance, 0};
  double scatter = mean.variance;  // what the strokes' own variances do not explain
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    const double own = mean.weights[i] * mean.weights[i] * variances[i];
    pooled.welch += own * own / std::max(1.0, freedoms[i]);
    scatter -= own;
  }
  if (slopes.size() > 1 && scatter > 0) {
    pooled.welch += scatter * scatter / static_cast<double>(slopes.size() - 1);
  }
  return pooled;
}

std::optional<SlopeWithFriction> average_over_friction(const std::vector<FrictionStroke>& strokes,
                                                       const PooledSlope& straight,
                                                       double deflection_noise) {
  std::vector<FrictionCandidate> candidates;
  double least = std::numeric_limits<double>::infinity();
  for (const FrictionLaw law : kFrictionLaws) {
    FrictionCandidate one;
    one.fit = fit_friction(strokes, law, deflection_noise);
    if (!one.fit.usable) return std::nullopt;
    one.pooled = pool_slopes(one.fit.stiffness_N_m,
                             std::vector<double>(strokes.size(), one.fit.degrees_of_freedom));
    if (law == FrictionLaw::none) {
      // Where nothing happens after the turns the line through the straight part is the best
      // there is: it is robust to toes and stops. Its residuals hardly show a drift.
      if (straight.variance > one.pooled.variance) {
        one.pooled = straight;
      } else {
        one.pooled.K = straight.K;
      }
    } else {
      double common = 0;
      for (double by : one.fit.by_travel) common += by / static_cast<double>(strokes.size());
      one.pooled.variance += common * common;
    }
    least = std::min(least, one.fit.aicc);
    candidates.push_back(std::move(one));
  }
  double weight = 0, K = 0, travel = 0, load = 0, none = 0;
  for (const auto& one : candidates) {
    const double w = std::exp(-0.5 * (one.fit.aicc - least));
    weight += w;
    K += w * one.pooled.K;
    if (one.fit.law == FrictionLaw::none) {
      none = w;
      continue;
    }
    travel += w * one.fit.travel_m;
    for (double a : one.fit.load_N) load += w * 0.5 * a / static_cast<double>(strokes.size());
  }
  K /= weight;
  SlopeWithFriction averaged;
  averaged.pooled.K = K;
  double spread = 0, welch = 0;
  for (const auto& one : candidates) {
    const double w = std::exp(-0.5 * (one.fit.aicc - least)) / weight;
    averaged.pooled.variance += w * (one.pooled.variance + std::pow(one.pooled.K - K, 2));
    spread += w * std::pow(one.pooled.K - K, 2);
    welch += w * one.pooled.welch / std::pow(one.pooled.variance, 2);
  }
  averaged.pooled.welch = welch * averaged.pooled.variance * averaged.pooled.variance;
  if (!(K > 0) || !std::isfinite(averaged.pooled.variance)) return std::nullopt;
  const double share = 1 - none / weight;
  // Neither law need be right, however well one of them fits: rectangular between them.
  const double law = share * (candidates[1].pooled.K - candidates[2].pooled.K) / std::sqrt(12.0);
  averaged.pooled.variance += law * law, spread += law * law;
  averaged.probability = share;
  averaged.travel_m = share > 0.5 ? travel / (weight - none) : 0;
  averaged.load_N = share > 0.5 ? load / (weight - none) : 0;
  averaged.relative_std = std::sqrt(spread) / K;
  averaged.relative_correction = K / straight.K - 1;
  return averaged;
}

}  // namespace rigfit::ident
