#include "signal/recording/recording_time.h"

#include <fmt/format.h>

#include <cmath>

namespace rigfit::signal {

void take_stated_rate(double rate_hz, Recording& recording) {
  if (!(rate_hz > 0)) return;
  const double of_file = recording.sample_rate_hz;
  if (of_file > 0 && std::abs(of_file / rate_hz - 1) > 1e-4) {
    recording.notes.push_back(
        {"rate_overridden",
         fmt::format("the file gives {:.9g} Hz; {:.9g} Hz is taken as asked", of_file, rate_hz),
         ""});
    recording.time_s.resize(0);
  }
  recording.sample_rate_hz = rate_hz;
  recording.sample_rate_relative_std = 0;
}

Note not_uniform_note(const TimeAxis& axis) {
  return {"time_not_uniform",
          fmt::format("sampling is not uniform: times go back {} times, repeat {} times, {} gaps",
                      axis.backward, axis.repeated, axis.gaps),
          ""};
}

}  // namespace rigfit::signal
