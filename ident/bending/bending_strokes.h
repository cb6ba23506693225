// Strokes of a load-deflection record: where it turns, how noisy it is, and the straight part of a
// stroke with its line. Inside of bending_analysis.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/bending/bending_result.h"

namespace rigfit::ident {

struct StrokeRange {
  Eigen::Index first, last;  ///< inclusive
  int direction;             ///< of the deflection
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
/// local mean leaves it. `degrees_of_freedom` of its slope.
[[nodiscard]] BendingStroke fit_straight_part(const StrokeRange& run, const StrokeData& data,
                                              const BendingTestOptions& options,
                                              double& degrees_of_freedom);

}  // namespace rigfit::ident
