// MATLAB files (.mat): version 5 to 7 and 7.3, numeric arrays, also inside structs and cells. By
// libmatio.
//
// Arrays whose longer side has the same length are the channels of the recording; a variable named
// as a time ("t", "time") is the time, a scalar named as a rate or step ("fs", "dt") gives the
// rate. Where arrays of several lengths could be meant the file is refused with their names.
#pragma once

#include <filesystem>

#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// `options.variables` names the arrays to take ("data", "run.acc"). Throws RecordingError.
[[nodiscard]] Recording read_mat(const std::filesystem::path& path,
                                 const ReadOptions& options = {});

/// FRFs: complex arrays of lines x points beside a vector of as many frequencies ("freq", "f").
/// Throws RecordingError.
[[nodiscard]] FrfSet read_mat_frfs(const std::filesystem::path& path,
                                   const ReadOptions& options = {});

}  // namespace rigfit::signal
