// A campaign from a folder of recordings: what each file is, its channels, and the texts of the
// campaign and of the `channels.toml` beside them.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/cli/verb_context.h"

namespace rigfit::apps {

/// What a person says that no file does.
struct GuessOptions {
  std::string kind;   ///< "bending", "axial", "decay", "modal"; empty: guessed
  std::string force;  ///< channel of the hammer; empty: guessed
  double span_m = 0, mass_kg = 0, length_m = 0;      ///< of bending and axial tests; 0: not given
  std::map<std::string, std::string> units;          ///< by channel
  std::map<std::string, std::string> sensitivities;  ///< by channel, such as "2.27 mV/N"
};

/// A file to write.
struct TextFile {
  std::filesystem::path path;
  std::string content;
};

struct GuessedCampaign {
  std::vector<TextFile> files;       ///< the campaign first, then a channels.toml a folder
  std::vector<std::string> remarks;  ///< what each file was taken for and why, for the terminal
};

/// Reads the recordings (inputs and notes go to the context). A force channel with short pulses
/// makes hits; tension, load and deflection a bending test; what is left a free decay. Spectra and
/// FRFs are named and left out. Throws UsageError where a test needs a number that is not given,
/// signal::RecordingError for files that cannot be read.
[[nodiscard]] GuessedCampaign guess_campaign(const std::filesystem::path& folder,
                                             const std::vector<std::string>& files,
                                             const GuessOptions& options, VerbContext& context);

}  // namespace rigfit::apps
