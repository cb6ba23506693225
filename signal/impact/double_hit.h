// Second contacts of a hammer with the structure, before or after the hit.
//
// y(k) = sum_i p_i x(k + i) / sum_i p_i^2 with p the hit's own pulse scaled to one: a second
// contact of the same shape and a times the height peaks at y = a times the hit's peak, white noise
// falls by sqrt(sum p^2).
#pragma once

#include <Eigen/Core>

namespace rigfit::signal {

struct DoubleHitOptions {
  double ratio = 0.03;      ///< smallest second contact looked for, of the peak
  double noise_factor = 6;  ///< and it exceeds so many standard deviations of the filtered noise
  double ringing_ratio =
      0.5;  ///< swings to the other side beside it of this part of its height: ringing
};

struct SecondContact {
  double ratio = 0;             ///< second contact relative to the peak; 0: none found
  Eigen::Index delay = 0;       ///< samples from peak to peak; negative: before the hit
  double smallest_visible = 0;  ///< larger of `ratio` and what noise hides, relative to the peak
};

/// `force`: one block, offset removed, pulses upwards, finite; the hit's pulse spans
/// pulse_first..pulse_last with its peak at `peak`.
[[nodiscard]] SecondContact find_second_contact(const Eigen::Ref<const Eigen::VectorXd>& force,
                                                Eigen::Index pulse_first, Eigen::Index peak,
                                                Eigen::Index pulse_last,
                                                const DoubleHitOptions& options = {});

}  // namespace rigfit::signal
