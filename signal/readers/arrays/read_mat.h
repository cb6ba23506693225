// Reads MATLAB files (.mat), versions 5 to 7 and 7.3, by libmatio: numeric arrays, also inside
// structs and cells.
//
// Arrays whose longer side has the same length are the channels of the recording; a variable with a
// name for time ("t", "time") holds the times, and a scalar named like a rate or step ("fs", "dt")
// gives the rate. Where arrays of several lengths could be meant the file is refused, with their
// names.
#pragma once

#include <filesystem>

#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// `options.variables` names the arrays to take ("data", "run.acc"). Throws RecordingError.
[[nodiscard]] Recording read_mat(const std::filesystem::path& path,
                                 const ReadOptions& options = {});

/// Reads FRFs: complex arrays (lines x points) beside a frequency vector of as many lines ("freq",
/// "f").
/// Throws RecordingError.
[[nodiscard]] FrfSet read_mat_frfs(const std::filesystem::path& path,
                                   const ReadOptions& options = {});

}  // namespace rigfit::signal
