// Adds to a recording what its file does not say: names, scales and directions of channels, the
// sample rate. It is a TOML file beside the recording (`name.csv` -> `name.toml`) or a table of a
// campaign, with the keys of `rigfit help sidecar` (apps/README.md).
#pragma once

#include "signal/recording/recording.h"

namespace rigfit::document {
class TomlTable;
}

namespace rigfit::signal {

/// Facts about a recording that its file does not state, or states wrongly.
struct ReadOptions {
  /// Hz, for a file without times or rate. Where the file states another rate, this one is used and
  /// the difference is noted. 0: the file's.
  double sample_rate_hz = 0;
  double time_unit_s = 0;  ///< seconds per number of the time column; 0: the file's
  char decimal = 0;        ///< decimal sign of a table, '.' or ','; 0: detected
  char separator = 0;      ///< between columns, ',', ';', tab or ' '; 0: detected
  std::string format{};    ///< one of `format_names()`; empty: detected from the content
  std::vector<std::string> variables{};  ///< arrays to take of a file that names several
  /// If given, called now and then with the bytes read so far (never for MATLAB's arrays and
  /// sounds, which are read whole). What it throws ends the reading.
  std::function<void(std::size_t)> done_with{};
};

/// One `[[channel]]` table.
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

/// A whole description.
struct RecordingDescription {
  ReadOptions reading;
  std::vector<ChannelDescription> channels;
  bool of_folder = false;  ///< channels that one of its recordings lacks are ignored
};

/// Of `channels.toml` in a recording's folder, which describes all recordings there, and the TOML
/// file of its own name, those that there are. The latter counts where both say something.
[[nodiscard]] std::vector<std::filesystem::path> descriptions_of(
    const std::filesystem::path& recording);

/// Names of the formats that are read.
[[nodiscard]] std::vector<std::string> format_names();

/// Separator or decimal sign by its sign or name ("tab", "comma", "point"); 0: not known.
[[nodiscard]] char sign_named(const std::string& text);

/// The options of `first`; where `first` leaves one open, that of `second`.
[[nodiscard]] ReadOptions merged(ReadOptions first, const ReadOptions& second);

/// Reads a whole file. Throws document::DocumentError for unknown keys and invalid values.
[[nodiscard]] RecordingDescription read_description(const std::filesystem::path& file);
/// Reads the keys above from a table of a larger document; the caller then calls finish().
[[nodiscard]] RecordingDescription read_description(document::TomlTable& table);

/// Renames, rescales and orients the recording's channels as described; its notes of missing units
/// follow. Notes values that hardly any laboratory measures ("unit_suspected"). Throws
/// RecordingError for a unit that does not fit, or a channel that is not there, unless the
/// description is of the folder.
void apply_description(const RecordingDescription& description, Recording& recording);

}  // namespace rigfit::signal
