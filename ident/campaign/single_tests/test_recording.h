// A recording of a test, with the state of the rig that it was taken at and where it comes from.
//
// What a sample rate known only to a relative standard uncertainty e (signal::Recording::
// sample_rate_relative_std: its step is printed with few digits) means for what follows from it.
// The rate scales every frequency of its recordings alike:
//
//   u(f)^2 = u0(f)^2 + (e f)^2      common to all frequencies
#pragma once

#include "ident/statistics/finding.h"
#include "signal/recording/recording.h"

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
[[nodiscard]] std::optional<Finding> not_uniform(const signal::Recording& recording,
                                                 const std::string& where = {});

/// With its samples at even places (signal/recording/resample.h), where its times are uneven.
[[nodiscard]] std::optional<TestRecording> placed_evenly(const TestRecording& recorded);

/// Adds e to a frequency and, half by half, to its 95 % interval; null: none.
void add_rate_uncertainty(double relative_std, Estimate& frequency_hz,
                          signal::Interval* interval_95_hz = nullptr);

/// Adds "rate_uncertainty" where it adds half a percent and more to the standard uncertainty of the
/// first frequency, which comes without it; `where`: as of a Finding.
void tell_rate(double relative_std, const Estimate& frequency_hz, const std::string& where,
               std::vector<Finding>& findings);

}  // namespace rigfit::ident
