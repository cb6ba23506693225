// Identifies the tension of a cable from recordings of its motion, from given frequencies, or from
// both: modes of the recordings (ambient_modes.h, all channels together) are merged where they
// agree, and the tension is fitted to them. The verb `tension` and the report call this, so that
// their numbers are the same.
#pragma once

#include "ident/campaign/single_tests/test_recording.h"
#include "ident/tension/cable_tension.h"

namespace rigfit::ident {

struct TensionInputs {
  std::string name;  ///< the cable's
  CableDescription cable;
  std::vector<MeasuredMode> modes;  ///< given frequencies; may be empty
  TensionOptions options = {};
  std::vector<TestRecording> recordings = {};
  std::vector<std::string> channels = {};  ///< empty: all
  double band_low_hz = 0;
  double band_high_hz = 0;                               ///< 0: to the end
  std::optional<model::ModePlane> plane = std::nullopt;  ///< plane of the recorded motion
};

struct TensionPeak {
  std::string file;
  Estimate frequency_hz;
  double damping_ratio = 0;

  static constexpr std::string_view title = "modes of the recordings";
  static constexpr auto fields() {
    using T = TensionPeak;
    return std::tuple{field("file", &T::file, "", "file", "recording"),
                      field("frequency_hz", &T::frequency_hz, "Hz", "frequency", ""),
                      field("damping_ratio", &T::damping_ratio, "", "", "")};
  }
};

struct TensionCampaignResult {
  std::vector<TensionPeak> peaks;   ///< modes of the recordings, in their order
  std::vector<MeasuredMode> modes;  ///< merged modes to which the tension is fitted
  TensionResult tension;            ///< `solved` false: see its message
  std::vector<Finding> findings;    ///< "no_tension" and "no_modes" refuse

  static constexpr auto fields() {
    using namespace describe;
    using T = TensionCampaignResult;
    return std::tuple{part(&T::tension), field("peaks", &T::peaks)};
  }
};

/// Does not throw for unsuitable recordings or inputs: they are refused in the findings.
[[nodiscard]] TensionCampaignResult tension_campaign(const TensionInputs& inputs);

}  // namespace rigfit::ident
