// Amplitude, frequency and damping along a decay, and the log decrement that a person would read.
//
// A mode's complex amplitude C_k is fitted to each cycle by least squares, beside an offset,
//   y_j = Re(C_k exp(p (j - m_k))) + c_k,   m_k the cycle's middle, p the pole of the whole decay,
// so that C_k = A exp(p m_k) for a decay that is exponential. Straight lines through ln|C_k| and
// arg C_k, weighted with |C_k|^2 (their noise goes as 1 / |C_k|), give over all cycles the log
// decrement, delta = -T d ln|C| / dt = 2 pi zeta / sqrt(1 - zeta^2), and over spans of several
// cycles damping and frequency at that amplitude,
//   decay rate r = -d ln|C| / dt,   zeta = r / sqrt(r^2 + (2 pi f_d)^2).
// The law of the decay is exponential where ln|C| is a straight line over all cycles (r = alpha),
// friction where it bends down (r = alpha + beta / A), drag where it bends up (r = alpha + gamma
// A): a parabola over the line, beyond noise.
// Source: Inman, Engineering Vibration, sections 1.6 (decrement) and 1.10 (friction and drag).
#pragma once

#include "document/describe.h"
#include "signal/numerics/numbers.h"

namespace rigfit::signal {

enum class DecayLaw { exponential, friction, drag };
[[nodiscard]] const char* name_of(DecayLaw law);

/// Amplitudes of a mode, cycle by cycle, for as long as they stand out of the noise.
struct CycleAmplitudes {
  Complex pole;                  ///< p, per sample
  double sample_rate_hz = 0;     ///< rate of the samples they were fitted to
  std::vector<double> time_s;    ///< m_k, from the first sample
  std::vector<double> log_size;  ///< ln|C_k|
  std::vector<double> turn;      ///< arg C_k - Im p m_k, unwrapped
  std::vector<double> weight;    ///< inverse variance of `log_size` and of `turn`
};

/// `alone`: samples of one mode and what no mode explains. `noise_variance`: white-equivalent
/// variance of a sample near the mode.
[[nodiscard]] CycleAmplitudes cycle_amplitudes(const Ref<const VectorXd>& alone,
                                               double sample_rate_hz, Complex pole,
                                               double noise_variance);

struct LogDecrement {
  Estimate damping_ratio;  ///< NaN when refused
  std::string refusal;     ///< why there is no result; empty when there is one
};
/// Its uncertainty is that of the misfit of a straight line.
[[nodiscard]] LogDecrement log_decrement(const CycleAmplitudes& cycles);

struct EnvelopePoint {
  double time_s = 0;      ///< middle of the span, from the fit's first sample
  double amplitude = 0;   ///< at that time, the signal's unit
  Estimate frequency_hz;  ///< damped frequency
  Estimate damping_ratio;

  static constexpr std::string_view title = "along the decay of the strongest";
  static constexpr auto fields() {
    using T = EnvelopePoint;
    return std::tuple{
        field("time_s", &T::time_s, "s", "time", "middle of the span", 4),
        field("amplitude", &T::amplitude, "", "amplitude", "in the channel's unit", 4),
        field("frequency_hz", &T::frequency_hz, "Hz", "damped frequency", "over the span"),
        field("damping_ratio", &T::damping_ratio, "%", "damping", "over the span")};
  }
};

struct EnvelopeResult {
  std::vector<EnvelopePoint> points;  ///< eight spans of equal duration, fewer in few cycles
  DecayLaw law = DecayLaw::exponential;
  /// Change of the damped frequency from the first point to the last, weighted line in time.
  Estimate frequency_drift_hz;

  static constexpr auto fields() {
    using T = EnvelopeResult;
    constexpr auto followed = [](const T& e) { return e.points.size() > 1; };
    return std::tuple{field("law", describe::where(followed, &T::law), "", "law of the decay",
                            "exponential, friction or drag"),
                      field("points", describe::where(followed, &T::points), "", "points",
                            "amplitude, frequency, damping")};
  }
};

[[nodiscard]] EnvelopeResult envelope_of(const CycleAmplitudes& cycles);

}  // namespace rigfit::signal
