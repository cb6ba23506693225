// What a channel's spectrum says about its quality: the broadband floor and mains hum.
#pragma once

#include <Eigen/Core>

#include "signal/quality/quality_result.h"

namespace rigfit::signal {

struct SpectralQuality {
  double noise_floor = 0;  ///< rms of white noise with the spectrum's median density
  double mains_hz = 0;     ///< 0: none found
  double mains_rms = 0;
  int harmonics = 0;  ///< lines found, the fundamental included
};

/// `samples` without NaN. Hann windows; the median density of averaged periodograms, corrected for
/// the bias of a median (Wilson and Hilferty); hum from one long transform.
[[nodiscard]] SpectralQuality spectral_quality(const Eigen::Ref<const Eigen::VectorXd>& samples,
                                               double sample_rate_hz,
                                               const QualityOptions& options);

}  // namespace rigfit::signal
