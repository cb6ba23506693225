// What every reader owes for any bytes: a sound recording or a RecordingError with a message.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include "signal/readers/read_recording.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// Throws std::logic_error when a recording breaks what recording.h promises.
inline void require_sound(const Recording& recording) {
  const auto require = [](bool good, const char* what) {
    if (!good) throw std::logic_error(what);
  };
  require(!recording.channels.empty(), "a recording without channels");
  require(std::isfinite(recording.sample_rate_hz) && recording.sample_rate_hz >= 0, "rate");
  require(std::isfinite(recording.start_time_s), "start");
  require(std::isfinite(recording.time_jitter_s) && recording.time_jitter_s >= 0, "jitter");
  const auto n = recording.samples();
  require(recording.time_s.size() == 0 || recording.time_s.size() == n, "length of times");
  for (const auto& channel : recording.channels) {
    require(channel.samples.size() == n, "channels of different lengths");
    require(!channel.name.empty(), "a channel without a name");
    long missing = 0;
    for (const double x : channel.samples) {
      require(!std::isinf(x), "an infinite sample");
      missing += std::isnan(x) ? 1 : 0;
    }
    require(missing == channel.missing_samples, "missing samples counted wrongly");
  }
}

/// As above, of modes.
inline void require_sound(const UffModes& file) {
  const auto require = [](bool good, const char* what) {
    if (!good) throw std::logic_error(what);
  };
  require(!file.modes.empty(), "a file without modes");
  double before = 0;
  for (const auto& mode : file.modes) {
    require(std::isfinite(mode.frequency_hz) && mode.frequency_hz > 0, "frequency");
    require(mode.frequency_hz >= before, "order of modes");
    before = mode.frequency_hz;
    require(!std::isinf(mode.damping_ratio) && mode.damping_ratio != 0, "damping ratio");
    for (const auto& [node, translation] : mode.shape) {
      for (const auto& value : translation) {
        require(std::isfinite(value.real()) && std::isfinite(value.imag()), "shape");
      }
    }
  }
  for (const auto& [number, node] : file.nodes) {
    for (const double x : node.position_m) require(std::isfinite(x), "coordinate");
  }
}

/// Runs `read`; a RecordingError is fine when it says something.
template <typename Read>
void read_or_refuse(Read&& read) {
  try {
    read();
  } catch (const RecordingError& error) {
    if (error.problem().empty() || error.remedy().empty()) {
      throw std::logic_error("a refusal without a reason or a remedy");
    }
  }
}

}  // namespace rigfit::signal
