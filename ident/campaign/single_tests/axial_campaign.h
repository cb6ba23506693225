// The hanging-mass test of a laboratory, from its recordings to EA and damping: the decays of every
// recording, the axial mode of each, and the test over all (axial_identification.h). The verb
// `axial` and the report call this, so that their numbers are the same.
//
// The axial mode: the band given, or else that mode which most of the decays' energy has at one EA
// (a factor of 1.6 either way). A mode at which the hung mass would stretch the cable by more than
// a tenth, g / (omega^2 L) > 0.1, is none: the mass swings (1 for its pendulum, 1/4 for the ripple
// that this makes in the tension). A mode that is not seen to decay (hum, ambient motion) is none
// where others do.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "ident/axial/axial_identification.h"
#include "ident/campaign/single_tests/finding.h"
#include "ident/update/model_update.h"
#include "model/scene/scene.h"
#include "signal/decay/decay.h"
#include "signal/recording/recording.h"

namespace rigfit::ident {

struct AxialRecording {
  std::string name;  ///< for messages
  signal::Recording recording;
  double length_m = 0;  ///< length of the cable between its ends
};

struct AxialInputs {
  std::vector<AxialRecording> recordings;
  std::string channel;                       ///< tension or motion; empty: the recording's only one
  double band_low_hz = 0, band_high_hz = 0;  ///< where the axial frequency is; 0: not known
  AxialSetup setup;
  AxialOptions options;
  int threads = 1;
};

struct AxialFoundDecay {
  std::size_t recording = 0;  ///< index of the inputs' recordings
  std::string channel, unit;
  double rate_hz = 0;
  double start_s = 0;          ///< start of the fitted window on the recording's time axis
  double samples_start_s = 0;  ///< of `samples`
  Eigen::VectorXd samples;     ///< as given to the estimator
  signal::DecayResult result;
  /// Index of the axial mode of `result`; empty: refused or none, see the findings.
  std::optional<std::size_t> mode;
  std::string left_out;  ///< code; empty: it takes part
};

struct AxialCampaignResult {
  std::vector<AxialFoundDecay> decays;  ///< in the order of recordings, then of time
  /// Empty: see `findings`. Its samples are the decays that have a mode, in order.
  std::optional<AxialTestResult> test;
  /// Refused: "not_uniform", "channel", "no_decay" (a recording, or all of them), "axial",
  /// "lengths_mixed", "length_suspected", "force_mismatch" (inputs that contradict the recordings).
  /// Warnings: "other_mode", and those of the decays and of the test.
  std::vector<Finding> findings;
};

/// A decay with what the test makes of it, for documents.
struct AxialRecord {
  const AxialRecording* recording;
  const AxialFoundDecay* decay;
  const AxialSample* sample;  ///< null: it takes no part

  [[nodiscard]] const signal::DecayMode& mode() const { return decay->result.modes[*decay->mode]; }
  [[nodiscard]] std::string refused() const {
    return decay->left_out.empty() ? "axial" : decay->left_out;
  }
};
[[nodiscard]] std::vector<AxialRecord> axial_records(const AxialInputs& inputs,
                                                     const AxialCampaignResult& result);

/// Throws nothing for what recordings hold; std::invalid_argument for a band that makes no sense.
[[nodiscard]] AxialCampaignResult axial_campaign(const AxialInputs& inputs);

/// What the axial test says of scenes.
struct AxialKnowledge {
  signal::Estimate EA_N, damping_ratio;
};
[[nodiscard]] AxialKnowledge knowledge_of(const AxialTestResult& result);

/// What the scenes' numbers from an axial test are known to, for a fit: one standard uncertainty of
/// EA moves all of them together, and so does one of the damping ratio.
struct AxialUncertainty {
  UncertainInput EA{"EA (axial test)"}, damping{"damping ratio (axial test)"};
};

/// Sets the scene's parameters `EA_of` and `damping_of` (such as "cable.EA",
/// "cable.damping_ratio") to the values of an axial test; what has no value (NaN) stays as it is.
/// `uncertainty`, when given, gets the effects on these parameters of the scene of state `state`.
/// Throws model::SceneError for a parameter that the scene does not have.
void apply_axial(const AxialKnowledge& known, const std::vector<std::string>& EA_of,
                 const std::vector<std::string>& damping_of, model::Scene& scene, int state = 0,
                 AxialUncertainty* uncertainty = nullptr);

}  // namespace rigfit::ident

namespace rigfit::describe {

template <>
struct Described<ident::AxialRecord> {
  using T = ident::AxialRecord;
  static constexpr auto used = [](const T& r) { return r.sample != nullptr; };
  static constexpr std::string_view title = "decays";
  static constexpr auto fields = std::tuple{
      field(
          "file", [](const T& r) { return r.recording->name; }, "", "file", "recording"),
      field(
          "length_m", [](const T& r) { return r.recording->length_m; }, "m", "length",
          "between the ends"),
      field(
          "start_s", [](const T& r) { return r.decay->start_s; }, "s", "start", "fitted from here"),
      field("refused", where([](const T& r) { return r.sample == nullptr; }, &T::refused), "",
            "left out", "code of why it takes no part"),
      field("damped_frequency_hz",
            where(used, [](const T& r) { return r.mode().damped_frequency_hz; }), "Hz", "frequency",
            "of the axial mode, damped"),
      field("damping_ratio", where(used, [](const T& r) { return r.mode().damping_ratio; }), "%",
            "damping ratio", "of the axial mode"),
      field("r_squared", where(used, [](const T& r) { return r.mode().r_squared; }), "", "",
            "of the fitted decay"),
      field("cycles", where(used, [](const T& r) { return r.mode().cycles; }), "", "", "fitted"),
      field("stiffness_N_m", where(used, [](const T& r) { return r.sample->stiffness_N_m; }), "N/m",
            "", "static, adapter included"),
      field("cable_stiffness_N_m",
            where(used, [](const T& r) { return r.sample->cable_stiffness_N_m; }), "N/m", "",
            "static, of the cable"),
      field("EA_N", where(used, [](const T& r) { return r.sample->EA_N; }), "N", "EA",
            "of this record, with the cable alone"),
      field("damping_Ns_m", where(used, [](const T& r) { return r.sample->damping_Ns_m; }), "N s/m",
            "damper", "equivalent viscous damper")};
};

}  // namespace rigfit::describe
