// What a person says about a recording beside its file: names, scales and directions of channels,
// the sample rate. A TOML file beside it (`name.csv` -> `name.toml`) or a table of a campaign.
//
//   sample_rate_hz = 500.0        # where the file gives none, or a wrong one
//   [[channel]]
//   source = "CH8"                # the file's name for it, or "#5" for the fifth
//   name = "hammer"               # to be called so from here on
//   sensitivity = 2.27            # of the transducer, in `sensitivity_unit`
//   sensitivity_unit = "mV/N"     # the file's unit (or one like it) per unit of what is measured
//   direction = [0.0, -1.0, 0.0]  # of positive values, scene axes
//
// Instead of a sensitivity, `unit` says what unit the file's numbers are in, and `scale` (numbers
// times it are in `unit`) and `offset` (added after it, in `unit`) turn the file's numbers into it.
// `range` is the full scale, in the unit that results.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/verb_context.h"
#include "model/scene/toml_table.h"
#include "signal/readers/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::apps {

struct ChannelDescription {
  std::string source;
  std::string name;                   ///< empty: keep
  std::string unit;                   ///< empty: keep
  std::optional<double> scale;        ///< `unit` per number in the file
  double offset = 0;                  ///< `unit`, added after the scale
  std::optional<double> sensitivity;  ///< in `sensitivity_unit`
  std::string sensitivity_unit;       ///< "mV/N"
  std::optional<std::array<double, 3>> direction;
  double range = 0;  ///< full scale in the resulting unit; 0: keep
};

struct RecordingDescription {
  double sample_rate_hz = 0;  ///< 0: as the file says
  std::vector<ChannelDescription> channels;
};

/// Takes the keys `sample_rate_hz` and `channel` of a table (the caller calls finish()). Throws
/// model::SceneError for what makes no sense.
[[nodiscard]] RecordingDescription read_description(model::TomlTable& table);

/// The file's numbers under the description. `table` is for messages only: where the description
/// came from. Throws signal::RecordingError for a channel that is not there.
void apply_description(const RecordingDescription& description, signal::Recording& recording);

/// Reads a recording with the TOML file beside it, if there is one; both become inputs of this run
/// and every note of the reader becomes a warning. `given` adds to (and wins over) the file beside
/// it: what a campaign entry or the command line says.
[[nodiscard]] signal::Recording load_recording(const std::filesystem::path& path,
                                               VerbContext& context,
                                               const signal::ReadOptions& options = {},
                                               const RecordingDescription& given = {});

/// The channel `name`; without a name that of a recording with one channel only. Throws UsageError
/// when the choice is open.
[[nodiscard]] const signal::Channel& chosen_channel(const signal::Recording& recording,
                                                    const std::string& name);

}  // namespace rigfit::apps
