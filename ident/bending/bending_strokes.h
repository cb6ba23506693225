// Strokes of a load-deflection record: spikes, where it turns, how noisy it is, and the straight
// part of a stroke with its line. Inside of bending_analysis.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/bending/bending_result.h"

namespace rigfit::ident {

struct StrokeRange {
  Eigen::Index first, last;  ///< inclusive
  int direction;             ///< sign of the deflection's change
};

/// Runs of one direction: a turn counts when the signal has come back by `least`.
[[nodiscard]] std::vector<StrokeRange> find_strokes(const Eigen::VectorXd& deflection,
                                                    double least);

/// Standard deviation of the noise of one sample, from second differences, which a smooth signal
/// hardly has; 0 under 20 samples.
[[nodiscard]] double sample_noise(const Eigen::VectorXd& x);

/// Record as it is fitted: `x` the deflection corrected for the changing tension.
struct StrokeData {
  const Eigen::VectorXd &deflection, &x, &load;
  double load_range = 0, load_noise = 0, deflection_noise = 0;
};

/// Straight part of a stroke: a Deming line through its middle, followed outwards to where the
/// local mean leaves it, without `turn_share` of the travel after the turn.
[[nodiscard]] BendingStroke fit_straight_part(const StrokeRange& run, const StrokeData& data,
                                              double turn_share, double& degrees_of_freedom);

/// Samples of one channel (20 at least, else none) that lie off the mean of their neighbours and
/// off the straight lines through the two samples before and after, all three, by more than 12
/// robust standard deviations of that and by a twentieth of the channel's central range. A turn is
/// on one of the two lines, a step too.
[[nodiscard]] std::vector<Eigen::Index> find_spikes(const Eigen::VectorXd& channel);

/// Range of the middle 80 % of the values.
[[nodiscard]] double central_range(const std::vector<double>& values);

/// After every turn friction first changes sign: this share of a stroke's travel is not used
/// (strokes of 20 samples and more).
inline constexpr double kTurnShare = 0.15;
/// The share where loading and unloading lie apart. A transient of any of Dahl's laws then leaves
/// at most twice the change of the slope by this, as long as that is under kFrictionRefusal
/// (tests/bench/bending_coverage); more is a stroke too short for its friction.
inline constexpr double kFrictionShare = 0.35, kFrictionRefusal = 0.007;
/// A transient over most of a stroke is itself taken for its straight part, and the end of the
/// stroke, where it is over, is left out. Bilinear friction that takes 0.8 of a stroke to turn
/// round leaves 0.2 there, straight strokes next to nothing: the limit lies between.
inline constexpr double kFrictionFarEnd = 0.1;
/// Where the local median over a twentieth of a stroke leaves the line by more than this share of
/// the load range (and four times its noise), toe, stop or slip begin.
inline constexpr double kStraight = 0.005;
/// Relative change of slope over the straight part: above the first it is warned of, above the
/// second there is no one EI.
inline constexpr double kCurvatureWarning = 0.05, kCurvatureRefusal = 0.25;

}  // namespace rigfit::ident
