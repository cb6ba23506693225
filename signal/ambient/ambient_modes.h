// Modes from motion under unknown, ambient forces (wind, traffic, sea), with intervals; several
// set-ups of sensors joined by reference channels.
//
// What the data can tell of a mode is a matter of one number: T / tau, the length of the recording
// over the mode's decay time tau = 1 / (zeta omega). At best std(zeta) / zeta = (T / tau)^-1/2 and
// std(f) / f = zeta (T / tau)^-1/2 (Cramer-Rao bound of a long recording without noise). Below 40
// decay times no interval is vouched for.
//
// Way: 1. steady tones are found, fitted and taken out. 2. Correlations of 24 groups of the
// recording with an exponential lag window, whose decay is taken off the poles exactly; half
// spectra of them give candidates by poly-reference LSCF over all orders. 3. For every mode a
// linear combination of the channels that passes it with gain 1, suppresses its neighbours and has
// the least power otherwise in the mode's band: its auto-spectrum is one resonance, whatever the
// correlation of the forces. 4. Poles common to these spectra by Whittle's weights, residues
// eliminated (ambient_steps.h). 5. Shapes: residues of all channels' half spectra with the filtered
// signals. 6. Uncertainty: jackknife over the groups, joined until they hold five decay times; the
// degrees of freedom are those of the energy in the groups (gusts leave fewer), the intervals
// Student's. Forces need to be white in a mode's band only.
//
// Sources: Brincker and Ventura, Introduction to Operational Modal Analysis (2015); Peeters and Van
// der Auweraer, IOMAC 2005 (half spectra); Au, Mech. Syst. Signal Process. 48 (2014) 15 (bounds);
// Efron, The Jackknife (1982); Satterthwaite, Biometrics Bulletin 2 (1946) 110.
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

/// Modes of one set-up. Throws RecordingError as channel_index(), without a constant sample rate,
/// for constant or mostly missing channels, and when the band or the recording holds too little.
/// No mode: an empty list and a note.
[[nodiscard]] AmbientResult ambient_modes(const Recording& recording,
                                          const AmbientOptions& options = {});

/// One result for several set-ups, whose references have the same names. Modes without doubts are
/// matched by frequency and by the shape of the references; frequency and log damping are means
/// over set-ups where they agree, else random effects (groups.h) and a note "groups_differ". Shapes
/// are scaled by the references in the least-squares sense. A note "gain_changed" names a reference
/// whose ratio to the first one changed alike in all modes, "setup_lacks_mode" a mode that is not
/// matched in all set-ups; where one of these alone has a channel, the mode's shape is empty.
/// Throws RecordingError when a reference is missing in a set-up.
[[nodiscard]] AmbientResult merge_setups(std::span<const AmbientResult> setups,
                                         std::vector<std::string> references = {});

}  // namespace rigfit::signal
