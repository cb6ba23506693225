// Reads universal files: time histories into a Recording, frequency response functions (with
// coherence and, if rigfit wrote the file, their standard deviation) into an FrfSet.
//
// The sample rate is one over the printed step, rounded to a whole number of hertz where that lies
// within half of the step's last digit. A channel gets its entity name, else the first
// identification line, else the label, else node and direction ("5+Z") as its name.
#pragma once

#include <filesystem>
#include <string_view>

#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// Throws RecordingError, also when the file holds functions but no time history.
[[nodiscard]] Recording read_uff(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {});

/// Throws RecordingError, also when there is no FRF, when FRFs between some points are absent, or
/// when their frequencies differ.
[[nodiscard]] FrfSet read_uff_frfs(std::string_view bytes, const std::filesystem::path& path);
/// Reads a file. Throws RecordingError.
[[nodiscard]] FrfSet read_uff_frfs(const std::filesystem::path& path);

/// Like read_uff for a file with time histories. Otherwise functions of any type become channels,
/// to be looked at: `sample_rate_hz` stays 0 and complex values become magnitudes (both are noted).
[[nodiscard]] Recording read_uff_functions(std::string_view bytes,
                                           const std::filesystem::path& path);

}  // namespace rigfit::signal
