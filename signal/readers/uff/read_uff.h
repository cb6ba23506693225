// Universal files to what the rest takes: time histories to a Recording, frequency response
// functions (with coherence and, where we wrote it, their standard deviation) to an FrfSet.
//
// The sample rate is one over the printed step; where a whole number of hertz lies within half of
// the step's last digit, it is that. Channels are called by their entity name, else by the first
// identification line, else by label, else by node and direction ("5+Z").
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string_view>

#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// `done_with` is told how far the file has been read. Throws RecordingError; also when the file
/// holds functions but no time history.
[[nodiscard]] Recording read_uff(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {},
                                 const std::function<void(std::size_t)>& done_with = {});

/// Throws RecordingError; also when there is no FRF, when FRFs between some points are absent, or
/// when they do not share their frequencies.
[[nodiscard]] FrfSet read_uff_frfs(std::string_view bytes, const std::filesystem::path& path);
/// Reads a file. Throws RecordingError.
[[nodiscard]] FrfSet read_uff_frfs(const std::filesystem::path& path);

/// As read_uff where there is a time history; else functions of any type as channels, for looking
/// at: `sample_rate_hz` stays 0, complex ones are given by magnitude (both noted).
[[nodiscard]] Recording read_uff_functions(std::string_view bytes,
                                           const std::filesystem::path& path);

}  // namespace rigfit::signal
