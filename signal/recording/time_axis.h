// The sample rate that a column of times shows, and how far the column departs from it.
//
// t_k = start + k / rate, by least squares over all samples: the rounding of printed times averages
// out, where the median of their differences would keep it. Departures that printing explains
// (half of the last digit) and those below a hundredth of a step leave the sampling uniform.
#pragma once

#include <Eigen/Core>

namespace rigfit::signal {

struct TimeAxisOptions {
  double printed_resolution_s = 0;  ///< one unit of the last printed digit; 0: full precision
  double stated_rate_hz = 0;        ///< by a header; taken when the times agree with it; 0: none
};

struct TimeAxis {
  double rate_hz = 0;  ///< 0: not to be had (fewer than two times, or they do not rise)
  double start_s = 0;
  double jitter_s = 0;  ///< rms departure from uniform sampling
  bool uniform = false;
  bool agrees_with_stated = true;  ///< true also when nothing is stated
  long missing = 0;                ///< NaN among the times
  long repeated = 0;               ///< steps of zero that printing does not explain
  long backward = 0;
  long gaps = 0;                  ///< steps over 1.5 of the usual one
  Eigen::Index first_fault = -1;  /// sample after the first repeated, backward or long step
  Eigen::Index longest_gap_at = -1;
  double longest_gap_s = 0;
};

[[nodiscard]] TimeAxis time_axis(const Eigen::Ref<const Eigen::VectorXd>& time_s,
                                 const TimeAxisOptions& options = {});

/// Tick of a clock that is coarser than its times are printed and coarser than or near the sampling
/// step: the steps are all k or k + 1 ticks, evenly mixed. 0: the times show no such clock.
[[nodiscard]] double clock_tick(const Eigen::Ref<const Eigen::VectorXd>& time_s,
                                double printed_resolution_s);

/// A rate from a step printed with few digits.
struct RateOfStep {
  double rate_hz = 0;
  double relative_std = 0;  ///< rounding, uniform; 0: the step is a rate's own decimal fraction
};

/// `half_digit`: half a unit of the step's last printed digit. A step that is the exact decimal of
/// one over a round rate (0.001) gives that rate. Else the one rate that prints as this step and is
/// a power of two or has two digits is taken, if there is exactly one; else one over the step.
[[nodiscard]] RateOfStep rate_of_step(double step_s, double half_digit);

/// The roundest rate within `tolerance` (relative) of `rate_hz`: 65535.95 -> 65536 at 1e-5.
[[nodiscard]] double round_rate(double rate_hz, double tolerance);

}  // namespace rigfit::signal
