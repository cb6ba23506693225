// A recording of a test, with the state of the rig that it was taken at and where it comes from.
#pragma once

#include <optional>
#include <string>

#include "ident/statistics/finding.h"

namespace rigfit::ident {

/// Source of a value of a campaign.
enum class Origin {
  measured,         ///< from recordings of this campaign
  published,        ///< a measurement that was published
  published_model,  ///< a model's result that was published
  synthetic,        ///< from recordings of the virtual laboratory
  modelled,         ///< computed by rigfit
};

struct TestRecording {
  std::string name;  ///< for messages
  signal::Recording recording;
  double length_m = 0;                   ///< in axial tests, between the cable's ends
  std::optional<double> tension_N = {};  ///< its state's; empty: the rig has one state
  std::string place = {};                ///< excitation point; empty: the only one
  Origin origin = Origin::measured;
};

/// Refusal "not_uniform" of a recording whose samples are not evenly spaced in time.
[[nodiscard]] inline std::optional<Finding> not_uniform(const signal::Recording& recording,
                                                        const std::string& where = {}) {
  if (recording.time_s.size() == 0 && recording.sample_rate_hz > 0) return std::nullopt;
  return Finding{"not_uniform",
                 recording.time_s.size() > 0
                     ? "Resample the recording first: its samples are not evenly spaced in time"
                     : "State the sample rate (sample_rate_hz, --sample-rate): the file gives none",
                 where, true};
}

}  // namespace rigfit::ident
