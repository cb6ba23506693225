// Evaluates the free decays of one recording: finds every decay of a channel and fits the
// strongest, or fits each and pools their modes. Versions of a model answer the same release or
// tap.
//
// Pooled over decays, a mode's frequency (and likewise its damping ratio) is x_i = mu + u_i + e_i
// with var e_i from the fit and var u_i = tau^2 between decays
// (signal/estimation/groups.h). The result is the mean mu with its uncertainty, and the scatter
// tau, which does not shrink with more decays.
//
// The relative error of a rounded sample rate is added to all frequencies after pooling
// (test_recording.h). Damping ratios do not depend on the rate.
#pragma once

#include "ident/campaign/single_tests/test_recording.h"
#include "ident/statistics/uncertainty.h"
#include "model/response/response.h"
#include "signal/decay/decay.h"

namespace rigfit::ident {

struct DecayTestOptions {
  std::vector<std::string> channels;     ///< empty: all
  std::optional<double> start_s, end_s;  ///< on the file's time axis; a given start is not moved
  bool each = false;                     ///< fit every decay, not the strongest only
  signal::DecayOptions decay;            ///< its band; window and start time are set here
};

/// One decay of a channel.
struct FoundDecay {
  double start_s = 0, end_s = 0;              ///< window as fitted, or as found if not fitted
  bool fitted = false;                        ///< a fit was made
  std::optional<signal::DecayResult> result;  ///< with `each`

  static bool shown(const FoundDecay& d) { return d.result.has_value(); }
  static constexpr std::string_view title = "decays of the record";
  static constexpr auto fields() {
    using T = FoundDecay;
    constexpr auto of_strongest = [](auto part) {
      return [part](const T& d) {
        const bool any = d.result && !d.result->modes.empty();
        return any ? std::optional(std::invoke(part, d.result->modes.front())) : std::nullopt;
      };
    };
    constexpr auto of_result = [](auto part) {
      return [part](const T& d) {
        return std::invoke(part, d.result.value_or(signal::DecayResult()));
      };
    };
    return std::tuple{field("start_s", &T::start_s, "s", "start", "of the window"),
                      field("end_s", &T::end_s, "s", "end", "of the window"),
                      field("fitted", &T::fitted, "", "fitted", "a fit was made"),
                      field("frequency_hz", of_strongest(&signal::DecayMode::frequency_hz), "Hz",
                            "frequency", "of the strongest mode"),
                      field("damping_ratio", of_strongest(&signal::DecayMode::damping_ratio), "%",
                            "damping", "of the strongest mode"),
                      field("modes", of_result(&signal::DecayResult::modes), "", "",
                            "of each decay, where each was fitted"),
                      field("refusal", of_result(&signal::DecayResult::refusal), "", "remark",
                            "why it has no modes")};
  }
};

struct PooledMode {
  BoundedEstimate frequency_hz, damping_ratio;                 ///< mean
  double frequency_scatter_hz = 0, damping_ratio_scatter = 0;  ///< tau; 0: the decays agree
  std::size_t decays = 0;                                      ///< number that show the mode

  static constexpr std::string_view title = "pooled over the decays";
  static constexpr auto fields() {
    using namespace describe;
    using T = PooledMode;
    return std::tuple{
        field("frequency_hz", &T::frequency_hz, "Hz", "frequency", "mean over the decays"),
        field("frequency_scatter_hz", &T::frequency_scatter_hz, "Hz", "scatter", "between decays",
              2),
        field("damping_ratio", &T::damping_ratio, "%", "damping", "mean over the decays"),
        field("damping_ratio_scatter", &T::damping_ratio_scatter, "%", "scatter", "between decays",
              2),
        field("frequency_interval_95_hz", ends_of(&T::frequency_hz), "Hz", "", "95 %"),
        field("damping_ratio_interval_95", ends_of(&T::damping_ratio), "", "", "95 %"),
        field("decays", &T::decays, "", "decays", "that show the mode")};
  }
};

/// Samples of a recording as they were given to the estimator, and what came of them. Times are
/// those of the file.
struct RecordedDecay {
  std::string file, channel, unit;
  Origin origin = Origin::measured;
  double sample_rate_hz = 0;
  double start_time_s = 0;  ///< time of samples[0], s
  VectorXd samples = {};
  signal::DecayResult result = {};  ///< the strongest decay (signal/decay/decay.h)
  double start_s = 0, end_s = 0;    ///< window of `result`
  std::size_t recording = 0;        ///< index of a test's recordings

  [[nodiscard]] double time_s(Index sample) const {
    return start_time_s + static_cast<double>(sample) / sample_rate_hz;
  }
};
/// `samples`: of the channel, the first of them sample `from` of the recording.
[[nodiscard]] RecordedDecay estimated_decay(const TestRecording& recorded,
                                            const signal::Channel& channel, Index from, Index to,
                                            signal::DecayOptions options);

/// Response of one version of the model to a release or tap.
struct ReleaseAnswer {
  std::string label;               ///< the version's
  model::ResponseResult response;  ///< first sensor only
  Index start = 0;                 ///< sample of the record where it begins
  signal::DecayResult found;  ///< decay of the response, from the record's estimator and window
  std::string failure;        ///< why there is no answer; empty: there is one
};

/// The samples between start and end.
struct ChannelDecays : RecordedDecay {
  std::vector<FoundDecay> decays = {};  ///< in time, one at least
  /// With `each`, in the order of the strongest decay's modes.
  std::vector<PooledMode> pooled = {};
  std::vector<ReleaseAnswer> answers = {};  ///< "as given", then by fit; empty: not modelled

  static constexpr auto fields() {
    using namespace describe;
    using T = ChannelDecays;
    using Decay = signal::DecayResult;
    constexpr auto of_solved = [](auto part) {
      return where([](const T& c) { return c.result.refusal_code.empty(); },
                   within(&T::result, part));
    };
    return std::tuple{
        field("channel", &T::channel, "", "", "name"),
        field("unit", &T::unit, "", "", "of the channel"),
        field("sample_rate_hz", &T::sample_rate_hz, "Hz", "", "of the recording"),
        field("modes", within(&T::result, &Decay::modes), "", "modes",
              "of the strongest decay, strongest first"),
        field("start_s", &T::start_s, "s", "", "of the window fitted"),
        field("end_s", &T::end_s, "s", "", "of the window fitted"),
        field(
            "samples", [](const T& c) { return c.result.end - c.result.start; }, "", "",
            "of the window fitted"),
        field("decays", &T::decays, "", "decays", "of the record, in time"),
        field("pooled", &T::pooled, "", "pooled", "modes over the decays, where each was fitted"),
        field("frequency_drift_hz",
              of_solved([](const Decay& d) { return d.envelope.frequency_drift_hz.value; }), "Hz",
              "", "of the strongest, from the first span to the last"),
        field("frequency_drift_std_hz",
              of_solved([](const Decay& d) { return d.envelope.frequency_drift_hz.std; }), "Hz", "",
              "standard uncertainty"),
        field(
            "amplitude_dependence",
            [](const T& c) {
              auto envelope = c.result.envelope;
              for (auto& point : envelope.points) point.time_s += c.start_s;
              return envelope;
            },
            "", "along the decay", "of the strongest"),
        field("steady_tones", within(&T::result, &Decay::steady_tones_hz), "Hz", "",
              "hum that does not decay"),
        field("noise_std", of_solved(&Decay::noise_std), "", "noise", "rms, channel's unit", 3),
        field("signal_to_noise_db", of_solved(&Decay::signal_to_noise_db), "dB", "signal to noise",
              "of the strongest mode at the start", 3),
        field("degrees_of_freedom", of_solved(&Decay::degrees_of_freedom), "", "", "of the fit")};
  }
};

/// One entry per channel, but for one that is missing and for recordings with uneven times. `where`
/// of a finding: "recording", "recording: channel", "recording: channel at 1.5 s". Refused: there
/// is no such channel, or its strongest decay has no result.
struct DecayTest {
  std::vector<ChannelDecays> channels;
  std::vector<Finding> findings;
};

/// A missing channel is refused; throws std::invalid_argument when there are no samples between
/// start and end.
[[nodiscard]] DecayTest run_decay_test(const TestRecording& recorded,
                                       const DecayTestOptions& options);

/// One version of the model: as given, fitted, ...
struct ModelVersion {
  std::string label;
  model::Scene scene;  ///< instrumented as the test was
};

/// Simulates every version, whose scenes have one load and one sensor, as long as the record's
/// decay, which has modes, lasts or until its strongest mode has died away, and shifts each in time
/// to best match the record.
[[nodiscard]] std::vector<ReleaseAnswer> release_answers(const ChannelDecays& decays,
                                                         const signal::DecayOptions& options,
                                                         const std::vector<ModelVersion>& versions,
                                                         int threads);

/// The mode of another decay that corresponds to `mode`: the nearest in frequency, no farther than
/// that part (by default an answer's, which the model gives); null when there is none.
[[nodiscard]] const signal::DecayMode* same_mode(const signal::DecayMode& mode,
                                                 const signal::DecayResult& other,
                                                 double within = 0.15);

}  // namespace rigfit::ident
