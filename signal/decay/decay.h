// Frequency and damping of a free decay, with uncertainty.
//
//   y(t) = sum_m A_m exp(-zeta_m w_m t) cos(w_m sqrt(1 - zeta_m^2) t + phi_m) + c0 + c1 t + noise
//
// by least squares (damped_sinusoids.h). f = w / 2 pi is the undamped natural frequency, as for
// modes from FRFs; the damped one is given beside it. Starts come from a matched-filter bank; modes
// are added strongest first as long as the residual holds a peak that noise of its own colour
// would not show. Uncertainties follow from the residual, its colour and where in the record it is
// large (residual_noise.h). Where the band asked for lies far below the sample rate, the fit is
// made there (decay_steps.h).
#pragma once

#include "signal/envelope/envelope.h"
#include "signal/recording/recording.h"
#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {

struct DecayWindow {
  Index start = 0, end = 0;  ///< samples [start, end); a start > 0 is behind an impact
};

struct DecayOptions {
  /// Look for the decay in the record (decay_window.cc). False: the samples given are the decay.
  bool choose_window = true;
  /// Move the start on while the first half cycle fits worse than the rest (the tail of an impact).
  bool trim_start = true;
  double band_low_hz = 0;   ///< modes below are not reported; 0: no limit
  double band_high_hz = 0;  ///< modes above are not reported; 0: no limit
  double start_time_s = 0;  ///< time of the first sample, for messages
  /// Each sample's time behind its place, in steps of the rate, at most half a step; empty: none.
  VectorXd late = {};
};

struct DecayMode {
  Estimate frequency_hz;  ///< undamped natural frequency
  Estimate damped_frequency_hz;
  Estimate damping_ratio;
  Interval frequency_interval_95_hz, damping_ratio_interval_95;
  double amplitude = 0;  ///< at the start of the window, the signal's unit
  double energy = 0;     ///< sum of squares over the window: sets the order
  double cycles = 0;     ///< damped cycles in the window
  /// Energy over the largest that coloured noise reaches with probability kFalseAlarm.
  double detection = 0;
  /// Share of the signal left by other modes and background that this mode explains.
  double r_squared = 0;
  Estimate log_decrement;  ///< 2 pi zeta / sqrt(1 - zeta^2), per cycle, from the fit
  LogDecrement by_cycles;  ///< the same, cycle by cycle (envelope.h)

  static constexpr std::string_view title = "modes, strongest first";
  static constexpr auto fields() {
    using T = DecayMode;
    constexpr auto counted = [](const T& m) { return m.by_cycles.refusal.empty(); };
    return std::tuple{
        field("frequency_hz", &T::frequency_hz, "Hz", "frequency", "undamped natural frequency"),
        field("damping_ratio", &T::damping_ratio, "%", "damping", "ratio to critical damping"),
        field("frequency_interval_95_hz", describe::ends_of(&T::frequency_interval_95_hz), "Hz", "",
              "95 %"),
        field("damping_ratio_interval_95", describe::ends_of(&T::damping_ratio_interval_95), "", "",
              "95 %"),
        field("damped_frequency_hz", &T::damped_frequency_hz, "Hz", "", "f sqrt(1 - zeta^2)"),
        field("log_decrement", &T::log_decrement, "", "", "per cycle, from the fit"),
        field(
            "damping_ratio_log_decrement",
            [](const T& m) { return m.by_cycles.damping_ratio.value; }, "%", "by log decrement",
            "from the swings, as a check", 4),
        field("damping_ratio_log_decrement_std",
              describe::where(counted, [](const T& m) { return m.by_cycles.damping_ratio.std; }),
              "", "", "standard uncertainty"),
        field("log_decrement_refusal",
              describe::where(std::not_fn(counted),
                              describe::within(&T::by_cycles, &LogDecrement::refusal)),
              "", "", "why there is no log decrement"),
        field("cycles", &T::cycles, "", "cycles", "in the window", 4),
        field("r_squared", &T::r_squared, "", "R2", "share of the signal that the mode explains",
              4),
        field("detection", &T::detection, "", "", "energy over the most that noise reaches"),
        field("amplitude", &T::amplitude, "", "amplitude", "at the window's start, channel's unit",
              4)};
  }
};

struct DecayResult {
  std::string refusal_code;  ///< code for programs; empty: there is a result
  std::string refusal;       ///< for a person: what is wrong and what would help

  Index start = 0, end = 0;  ///< window that was fitted, samples of the input
  /// All decays of the record, in time (decay_window.cc), and which of them was fitted.
  std::vector<DecayWindow> decays;
  std::size_t fitted_decay = 0;
  std::vector<DecayMode> modes;         ///< strongest first
  std::vector<double> steady_tones_hz;  ///< hum: does not decay while the modes do; strongest first
  double noise_std = 0;                 ///< standard deviation of the residual
  double signal_to_noise_db = 0;        ///< strongest mode's power at the start over the noise's
  Index degrees_of_freedom = 0;
  /// Factor on a standard uncertainty for a 95 % interval (Student).
  double coverage_factor_95 = 1.96;
  EnvelopeResult envelope;  ///< for the strongest mode
  /// What is left of the window's samples `start`, `start` + `step`, ..., in the band where one is
  /// given; 0 where samples are missing. And the fit there.
  VectorXd residual, fitted;
  Index step = 1;
  std::vector<Note> notes;

  /// Ends the result without an answer: false.
  bool refuse(std::string code, std::string message) {
    refusal_code = std::move(code), refusal = std::move(message);
    return false;
  }
};

/// `y`: samples, NaN where missing, uniform but for `options.late`. Throws std::invalid_argument
/// for a rate or a band that makes no sense; unsuitable data lead to a refusal or a note.
[[nodiscard]] DecayResult estimate_decay(const Ref<const VectorXd>& y, double sample_rate_hz,
                                         const DecayOptions& options = {});

/// All decays of a record, in time. Never empty for a record that has samples. `y`: NaN where
/// missing.
[[nodiscard]] std::vector<DecayWindow> find_decays(const Ref<const VectorXd>& y,
                                                   const DecayBand& band = {0, 0.5, true});

}  // namespace rigfit::signal
