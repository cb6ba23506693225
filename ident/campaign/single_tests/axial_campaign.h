// Analyses hanging-mass tests from recordings to EA and damping: finds the decays of every
// recording and the axial mode of each, and evaluates them together (axial_identification.h). The
// verb `axial` and the report call this, so that their numbers are the same.
//
// The axial mode lies in the given band, or is the mode with most of the decays' energy at one EA
// (within a factor of 1.6). A mode with g / (omega^2 L) > 0.1, at which the hung mass would stretch
// the cable by more than a tenth, is excluded: the mass swings (the pendulum has 1, its ripple in
// the tension 1/4).
#pragma once

#include "ident/axial/axial_identification.h"
#include "ident/campaign/single_tests/decay_campaign.h"

namespace rigfit::ident {

struct AxialInputs {
  std::vector<TestRecording> recordings;
  std::string channel;                       ///< tension or motion; empty: the recording's only one
  double band_low_hz = 0, band_high_hz = 0;  ///< where the axial frequency is; 0: not known
  AxialSetup setup;
  int threads = 1;
};

/// One decay of a recording.
struct AxialRecord : RecordedDecay {
  double length_m = 0;
  /// Index of the axial mode in `result`; empty: refused or none found, see the findings.
  std::optional<std::size_t> mode = {};
  std::string left_out = {};               ///< code of the reason; empty: used
  std::optional<AxialSample> sample = {};  ///< what the test found of it; empty: not used

  [[nodiscard]] const signal::DecayMode& axial() const { return result.modes[*mode]; }
  [[nodiscard]] bool used() const { return sample.has_value(); }
  [[nodiscard]] std::string refused() const { return left_out.empty() ? "axial" : left_out; }

  static constexpr std::string_view title = "decays";
  static constexpr auto fields() {
    using namespace describe;
    using T = AxialRecord;
    // A field of the axial mode, of the sample of a decay that is used.
    constexpr auto of_mode = [](auto part) { return where(&T::used, within(&T::axial, part)); };
    constexpr auto of_sample = [](auto part) {
      return where(&T::used, [part](const T& r) { return std::invoke(part, *r.sample); });
    };
    using Mode = signal::DecayMode;
    using Sample = AxialSample;
    return std::tuple{
        field("file", &T::file, "", "file", "recording"),
        field("length_m", &T::length_m, "m", "length", "between the ends"),
        field("start_s", &T::start_s, "s", "start", "fitted from here"),
        field("refused", where([](const T& r) { return !r.used(); }, &T::refused), "", "left out",
              "code of why it takes no part"),
        field("damped_frequency_hz", of_mode(&Mode::damped_frequency_hz), "Hz", "frequency",
              "of the axial mode, damped"),
        field("damping_ratio", of_mode(&Mode::damping_ratio), "%", "damping ratio",
              "of the axial mode"),
        field("r_squared", of_mode(&Mode::r_squared), "", "", "of the fitted decay"),
        field("cycles", of_mode(&Mode::cycles), "", "", "fitted"),
        field("stiffness_N_m", of_sample(&Sample::stiffness_N_m), "N/m", "",
              "static, adapter included"),
        field("cable_stiffness_N_m", of_sample(&Sample::cable_stiffness_N_m), "N/m", "",
              "static, of the cable"),
        field("EA_N", of_sample(&Sample::EA_N), "N", "EA", "of this record, with the cable alone"),
        field("damping_Ns_m", of_sample(&Sample::damping_Ns_m), "N s/m", "damper",
              "equivalent viscous damper")};
  }
};

struct AxialCampaignResult {
  std::vector<AxialRecord> decays;      ///< in the order of recordings, then of time
  std::optional<AxialTestResult> test;  ///< empty: see `findings`
  /// Refused: "not_uniform", "channel", "no_decay" (a recording, or all of them), "axial",
  /// "lengths_mixed", "length_suspected", "force_mismatch" (inputs that contradict the recordings).
  /// Warnings: "other_mode", and those of the decays and of the test.
  std::vector<Finding> findings;
};

/// Unsuitable recordings become findings; throws std::invalid_argument for an invalid band.
[[nodiscard]] AxialCampaignResult axial_campaign(const AxialInputs& inputs);

}  // namespace rigfit::ident
