// FRFs that an analyser exported: universal files (dataset 58), MATLAB files, tables over frequency
// as text.
#pragma once

#include <filesystem>
#include <vector>

#include "signal/readers/files/read_options.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// FRFs of a universal or MATLAB file, or of text tables over the same lines (one file a response,
/// or all in one). Throws RecordingError.
[[nodiscard]] FrfSet read_frfs(const std::vector<std::filesystem::path>& files,
                               const ReadOptions& options = {});

}  // namespace rigfit::signal
