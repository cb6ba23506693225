// Reads FRFs that an analyser exported: universal files (dataset 58), MATLAB files, or text tables
// over frequency.
#pragma once

#include <filesystem>
#include <vector>

#include "signal/readers/files/read_options.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// FRFs from a universal or MATLAB file, or from text tables over the same lines (one file per
/// response, or one for all). Throws RecordingError.
[[nodiscard]] FrfSet read_frfs(const std::vector<std::filesystem::path>& files,
                               const ReadOptions& options = {});

}  // namespace rigfit::signal
