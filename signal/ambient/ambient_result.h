// Options and result of modes from ambient motion (ambient_modes.h).
#pragma once

#include "signal/modes/modal_model.h"
#include "signal/poles/lscf.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

struct AmbientOptions {
  std::vector<std::string> channels;  ///< names or "#k"; empty: all
  /// Channels whose correlations with all others give the candidates; of several set-ups those that
  /// stay in place. Empty: up to six are chosen, or those that all set-ups have in common.
  std::vector<std::string> references;
  double low_hz = 0;   ///< 0: 100 over the length, where 5 % of damping is the least to be decided
  double high_hz = 0;  ///< 0: 0.4 times the sample rate
  int max_order = 0;  ///< highest in the stabilisation diagram; 0: by lines and references, 8 to 40
  double max_damping_ratio = 0.2;  ///< above it a pole describes the forces
  int groups = 24;                 ///< that the jackknife takes: 12 lower the coverage by 1 %
  int threads = 1;
};

struct AmbientTone {
  double frequency_hz = 0;
  double amplitude = 0;  ///< the largest of the channels, in its unit
  Index channel = 0;     ///< the one with that amplitude, of those analysed

  static constexpr std::string_view title = "steady tones, taken out";
  static constexpr auto fields() {
    using T = AmbientTone;
    return std::tuple{
        field("frequency_hz", &T::frequency_hz, "Hz", "frequency", ""),
        field("amplitude", &T::amplitude, "", "amplitude", "the largest of the channels", 3)};
  }
};

struct AmbientMode {
  /// Shape: largest component 1, unscaled otherwise, empty where a merged set-up lacks the mode;
  /// participation is empty.
  IdentifiedMode mode;
  Interval frequency_95, damping_95;  ///< Hz and 1; the damping's on the scale of its logarithm
  double degrees = 0;                 ///< of freedom of both standard deviations
  double decay_times = 0;             ///< T / tau
  double log_damping_std = 0;
  std::string code;  ///< why it is doubtful: "too_short", "close_modes", "peak_not_its_own", ...
  MatrixXcd without_group;  ///< shapes without each group: channels x groups
  int joined = 1;           ///< neighbouring groups that count as one

  [[nodiscard]] describe::Bounded frequency() const {
    const auto& f = mode.frequency_hz;
    return {f.value, f.std, frequency_95.low, frequency_95.high};
  }
  [[nodiscard]] describe::Bounded damping() const {
    const auto& zeta = mode.damping_ratio;
    return {zeta.value, zeta.std, damping_95.low, damping_95.high};
  }

  static constexpr auto fields() {
    using T = AmbientMode;
    return std::tuple{
        describe::part(&T::mode),
        field("frequency_hz", &T::frequency),
        field("damping_ratio", &T::damping),
        field("degrees_of_freedom", &T::degrees),
        field("decay_times", &T::decay_times, "", "T/tau", "length over the decay time", 3),
        field("doubt_code", &T::code)};
  }
};

struct AmbientSpectrum {
  VectorXd frequency_hz;
  /// Spectral matrix of the channels over their standard deviations, lines x channels.
  MatrixXd singular_values;
};

struct AmbientResult {
  std::vector<AmbientMode> modes;  ///< by rising frequency, doubtful ones as well
  std::vector<std::string> channels;
  std::vector<AmbientTone> tones;
  std::vector<Note> notes;
  double low_hz = 0, high_hz = 0;
  double lag_s = 0;                      ///< longest lag of the correlations
  double duration_s = 0;                 ///< all set-ups together
  LscfResult stabilisation;              ///< window included
  std::vector<AmbientSpectrum> spectra;  ///< by set-up, for figures

  [[nodiscard]] std::vector<MeasuredPoint> responses() const {
    std::vector<MeasuredPoint> points;
    for (const auto& name : channels) points.push_back({name, 0, 0});
    return points;
  }
  /// The modes that are not doubtful.
  [[nodiscard]] ModalModel sure_modes() const {
    ModalModel sure;
    sure.responses = responses();
    for (const auto& one : modes) {
      if (!one.mode.doubtful) sure.modes.push_back(one.mode);
    }
    return sure;
  }

  static constexpr auto fields() {
    using T = AmbientResult;
    return std::tuple{
        field("modes", &T::modes), field("responses", &T::responses), field("tones", &T::tones),
        field("band_hz", describe::ends_of(&T::low_hz, &T::high_hz)), field("lag_s", &T::lag_s)};
  }
};

}  // namespace rigfit::signal
