// Amplitude, frequency and damping along a decay.
//
// The analytic signal of one mode is the exact one of its fitted damped sinusoid plus that of the
// residual, taken by FFT in a band around the mode: the transform sees only what is small and has
// no step at the ends, so its edge effects are of second order. Over spans of several cycles
// straight lines through log amplitude and phase give damping and frequency at that amplitude:
//   decay rate r = -d ln A / dt,   zeta = r / sqrt(r^2 + (2 pi f_d)^2).
// The law of the decay is chosen among
//   exponential r = alpha,   friction r = alpha + beta / A,   drag r = alpha + gamma A
// (viscous; plus Coulomb: linear envelope; plus quadratic).
// Source: Feldman, Mech. Syst. Signal Process. 25 (2011) 735 (Hilbert transform in vibration);
// Inman, Engineering Vibration, section 1.10 (friction and drag).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "signal/numerics/estimate.h"
#include "signal/sinusoids/damped_sinusoids.h"

namespace rigfit::signal {

enum class DecayLaw { exponential, friction, drag };
[[nodiscard]] const char* name_of(DecayLaw law);

struct EnvelopePoint {
  double time_s = 0;      ///< middle of the span, from the fit's first sample
  double amplitude = 0;   ///< geometric mean over the span, the signal's unit
  Estimate frequency_hz;  ///< damped frequency
  Estimate damping_ratio;
};

struct EnvelopeOptions {
  int points = 8;              ///< spans of equal duration; fewer if cycles or signal are too few
  double least_cycles = 3;     ///< per span
  double least_amplitude = 4;  ///< least usable envelope, in standard deviations of its own noise
};

struct EnvelopeResult {
  std::vector<EnvelopePoint> points;
  DecayLaw law = DecayLaw::exponential;
  /// Drop in chi-squared of `law` against exponential; 0 for exponential.
  double law_evidence = 0;
  /// d zeta / d ln A over the points, weighted line; NaN with fewer than three points.
  Estimate damping_per_log_amplitude;
  /// Change of the damped frequency from the first point to the last, weighted line in time.
  Estimate frequency_drift_hz;
  double clear_until_s = 0;  ///< the envelope is above the noise until then
};

/// Envelope of mode `m` of a fit. `noise_variance`: white-equivalent variance of a sample near the
/// mode.
[[nodiscard]] EnvelopeResult mode_envelope(const DampedSinusoidsFit& fit, std::size_t m,
                                           double sample_rate_hz, double noise_variance,
                                           const EnvelopeOptions& options = {});

}  // namespace rigfit::signal
