// What a person adds to a recording that its file does not say.
#pragma once

namespace rigfit::signal {

/// What the person who reads a recording knows of it.
struct ReadOptions {
  /// Hz; for a file without times or rate. Where the file says otherwise, this is taken and the
  /// disagreement noted. 0: as the file says.
  double sample_rate_hz = 0;
};

}  // namespace rigfit::signal
