// Reads sound files (.wav, also RF64 and big-endian RIFX) by libsndfile: 8 to 32 bit integers, 32
// and 64 bit floating point, any number of channels.
//
// Samples are fractions of full scale (-1 to 1). The file does not say what full scale means: give
// `scale` and `unit` of each channel in a description beside it (recording_description.h).
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string_view>

#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// Channels are called "channel 1" and so on; their range is full scale where the file holds whole
/// numbers. A truncated file is read as far as it goes, with a note. `done_with`, if given,
/// is called with the bytes read so far. Throws RecordingError.
[[nodiscard]] Recording read_wav(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {},
                                 const std::function<void(std::size_t)>& done_with = {});

}  // namespace rigfit::signal
