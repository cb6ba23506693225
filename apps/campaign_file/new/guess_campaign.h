// A campaign from recordings: what each file is, its channels, and the text of the campaign.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/cli/verb_context.h"

namespace rigfit::apps {

/// What a person says that no file does.
struct GuessOptions {
  std::string kind;   ///< "bending", "axial", "decay", "modal", "tension"; empty: guessed
  std::string force;  ///< channel of the hammer; empty: guessed
  double span_m = 0, mass_kg = 0;  ///< bending and axial tests; 0: not given
  double mass_per_length = 0;      ///< kg/m, of tension tests; 0: not given
  /// Lengths in axial and tension tests, m: one for all files, one a file in their order, or
  /// "FILE=LENGTH".
  std::vector<std::string> lengths;
  std::map<std::string, std::string> units;          ///< by channel
  std::map<std::string, std::string> sensitivities;  ///< by channel, such as "2.27 mV/N"
};

struct GuessedCampaign {
  std::string text;                  ///< text of campaign.toml
  std::vector<std::string> remarks;  ///< what each file was taken for and why, for the terminal
};

/// Reads the recordings (inputs and notes go to the context). A force channel with short pulses
/// makes hits; loads over deflections, with tension or without, a bending test; what is left a free
/// decay. Units and sensitivities stand in the campaign. What cannot be used is warned of
/// ("data_left_out"). Throws UsageError where a test needs a number that is not given or a number
/// is given that no test takes, signal::RecordingError where no file can be read.
[[nodiscard]] GuessedCampaign guess_campaign(const std::filesystem::path& folder,
                                             const std::vector<std::string>& files,
                                             const GuessOptions& options, VerbContext& context);

}  // namespace rigfit::apps
