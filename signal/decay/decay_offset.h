// An offset that dies away beside a decay: an amplifier's high-pass after the tap, a hand let go.
//
//   B exp(-b j),  B and b > 0 free,  j samples from the start of the window
//
// joins the background of the modes (damped_sinusoids.h): it takes steps of Gauss and Newton's in
// which the modes follow, and is kept where it explains more than noise of the residual's colour
// would. The modes' covariance is that of the fit of both (Schur's complement).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "signal/sinusoids/damped_sinusoids.h"
#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {

struct DecayingOffset {
  double amplitude = 0;  ///< at the start of the window, the signal's unit
  double rate = 0;       ///< b, per sample

  /// The offset at `count` samples, `first` samples after the start of the window.
  [[nodiscard]] Eigen::ArrayXd at_samples(Eigen::Index first, Eigen::Index count) const;
};

/// What the window's `samples` hold beside the modes of `fit`, at least one; none where noise
/// explains as much. `false_alarm`: the chance that noise alone shows one.
[[nodiscard]] std::optional<DecayingOffset> decaying_offset(const DecaySamples& samples,
                                                            const DampedSinusoidsFit& fit,
                                                            double false_alarm);

/// `unit_covariance` of `fit` when `offset` is fitted too; empty where they cannot be told apart.
[[nodiscard]] Eigen::MatrixXd covariance_beside_offset(const DampedSinusoidsFit& fit,
                                                       const DecayingOffset& offset,
                                                       std::span<const Eigen::Index> missing);

}  // namespace rigfit::signal
