#include "signal/readers/files/read_formats.h"

#include <fmt/format.h>
#include <sndfile.h>
#include <Eigen/Core>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "signal/readers/arrays/array_columns.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/recording_time.h"

namespace rigfit::signal {

Recording read_wav(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options) {
  SF_INFO info{};
  const std::unique_ptr<SNDFILE, int (*)(SNDFILE*)> file(sf_open(path.c_str(), SFM_READ, &info),
                                                         &sf_close);
  if (!file) {
    throw file_error(path, std::string("is no WAV file that can be read: ") + sf_strerror(nullptr),
                     "save it again as PCM or floating point WAV");
  }
  const int coding = info.format & SF_FORMAT_SUBMASK;
  const bool whole = coding == SF_FORMAT_PCM_S8 || coding == SF_FORMAT_PCM_U8 ||
                     coding == SF_FORMAT_PCM_16 || coding == SF_FORMAT_PCM_24 ||
                     coding == SF_FORMAT_PCM_32;
  if (!whole && coding != SF_FORMAT_FLOAT && coding != SF_FORMAT_DOUBLE) {
    throw file_error(path, "holds compressed sound",
                     "save it as PCM or floating point WAV, which keeps the signal");
  }
  // Every sample takes a byte at least.
  const auto held = static_cast<sf_count_t>(bytes.size()) / info.channels;
  Eigen::MatrixXd data(info.channels, std::clamp<sf_count_t>(info.frames, 0, held));
  const auto frames =
      static_cast<Eigen::Index>(sf_readf_double(file.get(), data.data(), data.cols()));
  if (frames <= 0) throw file_error(path, "holds no samples", "record again");

  CsvTable table;
  // The size that the file states of its data, chunk "data" behind "fmt ".
  const std::size_t chunk = bytes.substr(0, 1 << 16).find("data");
  if (chunk != std::string_view::npos && chunk + 8 <= bytes.size() &&
      bytes.substr(0, 4) == "RIFF") {
    std::uint32_t stated = 0;
    for (std::size_t k = 4; k > 0; --k) {
      stated = stated << 8 | static_cast<unsigned char>(bytes[chunk + 3 + k]);
    }
    const std::size_t behind = bytes.size() - chunk - 8;
    if (stated > behind && stated < 0xFFFFFF00u) {
      add_note(table.notes, "incomplete", "",
               "the file states {} bytes of samples and holds {}: cut short, or a wrong size",
               stated, behind);
    }
  }
  for (Eigen::Index c = 0; c < data.rows(); ++c) {
    add_array(data.row(c).head(frames).transpose(), fmt::format("channel {}", c + 1), false, table);
  }
  Recording recording =
      recording_of_arrays(std::move(table), path, "wav", options, info.samplerate);
  for (auto& channel : recording.channels) channel.nominal_range = whole ? 1 : 0;
  if (whole) {
    recording.notes.back().message =
        "samples are fractions of full scale: give scale and unit for physical values";
  }
  return recording;
}

}  // namespace rigfit::signal
