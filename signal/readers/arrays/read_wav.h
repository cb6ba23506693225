// Sound files (.wav, also RF64 and big-endian RIFX): 8 to 32 bit integers, 32 and 64 bit floating
// point, any number of channels. By libsndfile.
//
// Samples are fractions of full scale (-1 to 1); what a volt or a m/s^2 is, the file does not say:
// give `scale` and `unit` of each channel beside it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string_view>

#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// Channels are called "channel 1" and so on; their range is full scale where the file holds whole
/// numbers. A file cut short is read as far as it goes, which is noted. `done_with` is
/// told how far it has been read. Throws RecordingError.
[[nodiscard]] Recording read_wav(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {},
                                 const std::function<void(std::size_t)>& done_with = {});

}  // namespace rigfit::signal
