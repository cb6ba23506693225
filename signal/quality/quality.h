// What is wrong with a recording's channels, found without changing a sample.
//
// Each finding has a code for programs, a sentence for people and the samples that it concerns:
// `clipped` (flat tops at the extremes, at or below the nominal range), `missing` (NaN, empty),
// `dropouts` (runs of exactly the same value, mostly zero, inside a moving signal), `stuck` (no
// motion at all, or only in a part), `one_bit`, `coarse_quantisation`. The readers check the times.
#pragma once

#include "signal/recording/recording.h"

namespace rigfit::signal {

/// Something found wrong, with its code in JSON.
struct QualityFinding {
  std::string code;
  std::string message;  ///< with numbers and units
  long samples = 0;     ///< number concerned; 0: not countable
  Index first = -1;     ///< sample where it begins; -1: everywhere

  static constexpr auto fields() {
    using T = QualityFinding;
    return std::tuple{field("code", &T::code), field("message", &T::message),
                      field("samples", &T::samples)};
  }
};

/// Figures and findings of one channel.
struct ChannelQuality {
  const Channel* channel = nullptr;  ///< in the recording
  double min = 0, max = 0, mean = 0,
         rms = 0;  ///< SI, without missing samples; NaN when there are none
  long missing_samples = 0;
  long clipped_samples = 0;
  std::vector<QualityFinding> findings;

  static constexpr auto fields() {
    using T = ChannelQuality;
    return std::tuple{
        describe::part([](const T& q) -> const Channel& { return *q.channel; }),
        field("min", &T::min, "", "min", "without missing samples", 4),
        field("max", &T::max, "", "max", "", 4),
        field("mean", &T::mean, "", "mean", "", 4),
        field("rms", &T::rms, "", "rms", "", 4),
        field("clipped_samples", &T::clipped_samples, "", "clipped", "flat tops at the extremes"),
        field("missing_samples", &T::missing_samples, "", "missing", ""),
        field("findings", &T::findings)};
  }
};

/// Checks every channel of a recording, in its order.
[[nodiscard]] std::vector<ChannelQuality> check_quality(const Recording& recording);

}  // namespace rigfit::signal
