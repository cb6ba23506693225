#include "signal/readers/files/read_formats.h"

#include <fmt/format.h>
#include <sndfile.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "signal/readers/arrays/array_columns.h"
#include "signal/recording/recording_error.h"

namespace rigfit::signal {
namespace {

/// Bytes in memory as the file that libsndfile reads.
struct MemoryFile {
  std::string_view bytes;
  sf_count_t at = 0;

  static sf_count_t length(void* self) {
    return static_cast<sf_count_t>(static_cast<MemoryFile*>(self)->bytes.size());
  }
  static sf_count_t seek(sf_count_t offset, int whence, void* self) {
    auto& file = *static_cast<MemoryFile*>(self);
    const auto size = static_cast<sf_count_t>(file.bytes.size());
    const sf_count_t from = whence == SEEK_SET ? 0 : (whence == SEEK_CUR ? file.at : size);
    // Offsets come from the file: out of its bounds ends at them.
    file.at = offset > size ? size
                            : (offset < -size ? 0 : std::clamp<sf_count_t>(from + offset, 0, size));
    return file.at;
  }
  static sf_count_t read(void* into, sf_count_t count, void* self) {
    auto& file = *static_cast<MemoryFile*>(self);
    const auto size = static_cast<sf_count_t>(file.bytes.size());
    const sf_count_t n = std::clamp<sf_count_t>(count, 0, size - file.at);
    std::memcpy(into, file.bytes.data() + file.at, static_cast<std::size_t>(n));
    file.at += n;
    return n;
  }
  static sf_count_t write(const void*, sf_count_t, void*) { return 0; }
  static sf_count_t tell(void* self) { return static_cast<MemoryFile*>(self)->at; }
};

}  // namespace

Recording read_wav(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options, const std::function<void(std::size_t)>& done_with) {
  const auto refusal = [&](const std::string& problem, const std::string& remedy) {
    return RecordingError({path.string(), 0, 0, "", ""}, problem, remedy);
  };
  MemoryFile memory{bytes};
  SF_VIRTUAL_IO io{&MemoryFile::length, &MemoryFile::seek, &MemoryFile::read, &MemoryFile::write,
                   &MemoryFile::tell};
  SF_INFO info{};
  const std::unique_ptr<SNDFILE, int (*)(SNDFILE*)> file(
      sf_open_virtual(&io, SFM_READ, &info, &memory), &sf_close);
  if (!file) {
    throw refusal(std::string("is no WAV file that can be read: ") + sf_strerror(nullptr),
                  "save it again as PCM or floating point WAV");
  }
  const int coding = info.format & SF_FORMAT_SUBMASK;
  const bool whole = coding == SF_FORMAT_PCM_S8 || coding == SF_FORMAT_PCM_U8 ||
                     coding == SF_FORMAT_PCM_16 || coding == SF_FORMAT_PCM_24 ||
                     coding == SF_FORMAT_PCM_32;
  if (!whole && coding != SF_FORMAT_FLOAT && coding != SF_FORMAT_DOUBLE) {
    throw refusal("holds compressed sound",
                  "save it as PCM or floating point WAV, which keeps the signal");
  }
  if (info.channels < 1 || info.samplerate < 1) {
    throw refusal("states no channel or no rate", "record again");
  }
  const auto channels = static_cast<std::size_t>(info.channels);
  // Every sample takes a byte at least.
  const std::size_t most = bytes.size() / channels;
  std::vector<double> samples(std::min<std::size_t>(1 << 16, most + 1) * channels);
  std::vector<double> data;
  while (data.size() <= most * channels) {
    const sf_count_t got = sf_readf_double(file.get(), samples.data(),
                                           static_cast<sf_count_t>(samples.size() / channels));
    if (got <= 0) break;
    if (done_with) done_with(static_cast<std::size_t>(memory.at));
    data.insert(data.end(), samples.begin(),
                samples.begin() + static_cast<std::ptrdiff_t>(got * info.channels));
  }
  if (data.empty()) throw refusal("holds no samples", "record again");

  std::vector<Note> notes;
  // The size that the file states of its data, chunk "data" behind "fmt ".
  const std::size_t chunk = bytes.substr(0, 1 << 16).find("data");
  if (chunk != std::string_view::npos && chunk + 8 <= bytes.size() &&
      bytes.substr(0, 4) == "RIFF") {
    std::size_t stated = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      stated |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[chunk + 4 + k]))
                << (8 * k);
    }
    const std::size_t held = bytes.size() - chunk - 8;
    if (stated > held && stated < 0xFFFFFF00u) {
      notes.push_back(
          {"incomplete",
           fmt::format(
               "the file states {} bytes of samples and holds {}: cut short, or a wrong size",
               stated, held),
           ""});
    }
  }
  std::vector<ArrayColumn> columns;
  const auto frames = static_cast<Eigen::Index>(data.size() / channels);
  for (std::size_t c = 0; c < channels; ++c) {
    const Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<>> of_channel(
        data.data() + c, frames, Eigen::InnerStride<>(info.channels));
    columns.push_back({fmt::format("channel {}", c + 1), of_channel});
  }
  Recording recording = recording_of_columns(std::move(columns), path, "wav", options,
                                             info.samplerate, std::move(notes));
  for (auto& channel : recording.channels) channel.nominal_range = whole ? 1 : 0;
  if (whole) {
    recording.notes.back().message =
        "samples are fractions of full scale: give scale and unit for physical values";
  }
  return recording;
}

}  // namespace rigfit::signal
