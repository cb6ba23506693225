// A recording in SI units: every reader returns it and every estimator takes it.
//
// Units are converted once, by the reader; a channel whose unit is unknown keeps its numbers and
// has an empty `unit`. Missing samples (empty fields, NaN) are NaN in `samples` and counted;
// nothing is repaired here.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>

#include "document/describe.h"
#include "document/document_error.h"
#include "signal/numerics/numbers.h"
#include "signal/recording/units.h"

namespace rigfit::signal {

/// One channel of a recording, in SI units.
struct Channel {
  std::string name;
  std::string unit;          ///< SI symbol ("m/s^2", "N", "V"), empty: the file gives none
  std::string source_unit;   ///< as written in the file
  double si_per_source = 1;  ///< factor applied to the file's numbers
  double si_offset = 0;      ///< added after the factor (temperatures)
  Quantity quantity = Quantity::unknown;
  /// Axis of positive values in the scene; zero: not known.
  std::array<double, 3> direction{0, 0, 0};
  double nominal_range = 0;  ///< SI, full scale stated by the file; 0: not stated
  VectorXd samples;          ///< SI; NaN where missing
  long missing_samples = 0;

  static constexpr auto fields() {
    using T = Channel;
    return std::tuple{field("name", &T::name, "", "channel", ""),
                      field("unit", &T::unit, "", "unit", "SI"),
                      field("source_unit", &T::source_unit), field("quantity", &T::quantity),
                      field("nominal_range", describe::positive(&T::nominal_range))};
  }
};

/// Something about a recording, or about what was made of it, that a person should know.
struct Note {
  std::string code;        ///< stable, for programs
  std::string message;     ///< for a person, with figures
  std::string where = {};  ///< file, line, channel, point, mode ...; may be empty
  bool refused = false;    ///< a result is missing because of it

  static constexpr auto fields() {
    using T = Note;
    return std::tuple{field("code", &T::code), field("message", &T::message),
                      field("where", &T::where)};
  }
};

/// Where in a recording.
struct RecordingPlace {
  std::string file;
  long line = 0;          ///< 1-based; 0: not tied to a line
  long column = 0;        ///< 1-based column of the table or character position; 0: none
  std::string channel{};  ///< empty: none
  std::string value{};    ///< the offending text, empty: none

  [[nodiscard]] std::string before() const {
    return document::place_text(file, line, column) +
           (channel.empty() ? "" : "channel \"" + channel + "\": ");
  }
  [[nodiscard]] std::string behind() const { return value.empty() ? "" : " (\"" + value + "\")"; }
};

/// A recording that cannot be read.
using RecordingError = document::InputError<RecordingPlace>;

/// About the whole file.
[[nodiscard]] inline RecordingError file_error(const std::filesystem::path& file,
                                               std::string problem, std::string remedy,
                                               std::string value = "") {
  return {{file.string(), 0, 0, "", std::move(value)}, std::move(problem), std::move(remedy)};
}

/// Channels sampled together at a constant rate.
struct Recording {
  std::filesystem::path path;
  std::string format;         ///< "csv", "lvm", "uff58-ascii", "uff58-binary", "wav", "npy", "mat"
  double sample_rate_hz = 0;  ///< from the time column where there is one; 0: not known
  /// Relative uncertainty of a rate that the file states rounded, and so of every frequency. 0: the
  /// rate is exact.
  double sample_rate_relative_std = 0;
  double start_time_s = 0;
  double time_jitter_s = 0;  ///< rms departure of the time column from uniform sampling
  VectorXd time_s;           ///< kept only when sampling is not uniform, else empty
  VectorXd late;  ///< as DecayOptions::late, of uneven times placed evenly (resample.h); else empty
  std::vector<Channel> channels;  ///< all of the same length
  std::vector<Note> notes;

  /// Samples of each channel.
  [[nodiscard]] Index samples() const {
    return channels.empty() ? 0 : channels.front().samples.size();
  }
  /// Samples over rate, of uneven times from the first to the last, s; 0 without a rate.
  [[nodiscard]] double duration_s() const {
    if (time_s.size() > 0) return time_s[time_s.size() - 1] - time_s[0];
    return sample_rate_hz > 0 ? static_cast<double>(samples()) / sample_rate_hz : 0;
  }
  /// Time of a sample, s, of a recording with times or a rate.
  [[nodiscard]] double time_at(Index sample) const {
    if (time_s.size() > 0) return time_s[sample];
    return start_time_s + static_cast<double>(sample) / sample_rate_hz;
  }
  /// Index of the channel of that name (exact, then case-insensitive, then 1-based "#k").
  /// Throws RecordingError, which lists the recording's channels.
  [[nodiscard]] Index channel_index(const std::string& name) const;
  /// The channel of this name or number ("#5"). Throws RecordingError, which lists the channels.
  [[nodiscard]] const Channel& channel(const std::string& name) const {
    return channels[static_cast<std::size_t>(channel_index(name))];
  }

  static constexpr auto fields() {
    using T = Recording;
    return std::tuple{field("path", [](const T& r) { return r.path.string(); }),
                      field("format", &T::format),
                      field("sample_rate_hz", describe::positive(&T::sample_rate_hz)),
                      field("sample_rate_relative_std", &T::sample_rate_relative_std),
                      field("samples", &T::samples),
                      field("duration_s", describe::positive(&T::duration_s)),
                      field("start_time_s", &T::start_time_s),
                      field("time_jitter_s", &T::time_jitter_s),
                      field("uniform", [](const T& r) { return r.time_s.size() == 0; })};
  }
};

/// Largest number of names in a list, or of notes with one code, that is shown.
inline constexpr std::size_t kMostListed = 20;

/// The first 20 names in quotes, separated by commas, and the number of names.
[[nodiscard]] std::string listed(const std::vector<std::string>& names);
[[nodiscard]] std::string listed_names(const std::vector<Channel>& channels);

}  // namespace rigfit::signal
