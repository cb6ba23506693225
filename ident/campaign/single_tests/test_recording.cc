#include "ident/campaign/single_tests/test_recording.h"

#include <gsl/gsl_cdf.h>

#include "signal/recording/add_note.h"
#include "signal/recording/resample.h"

namespace rigfit::ident {

std::optional<Finding> not_uniform(const signal::Recording& recording, const std::string& where) {
  if (recording.time_s.size() == 0 && recording.sample_rate_hz > 0) return std::nullopt;
  return Finding{"not_uniform",
                 recording.time_s.size() > 0
                     ? "Resample the recording first: its samples are not evenly spaced in time"
                     : "State the sample rate (sample_rate_hz, --sample-rate): the file gives none",
                 where, true};
}

std::optional<TestRecording> placed_evenly(const TestRecording& recorded) {
  auto even = signal::placed_evenly(recorded.recording);
  if (!even) return {};
  TestRecording placed = recorded;
  placed.recording = std::move(*even);
  return placed;
}

void add_rate_uncertainty(double relative_std, Estimate& frequency_hz,
                          signal::Interval* interval_95_hz) {
  const double more = relative_std * frequency_hz.value;
  frequency_hz.std = std::hypot(frequency_hz.std, more);
  if (interval_95_hz == nullptr) return;
  const double half = gsl_cdf_ugaussian_Pinv(0.975) * more;
  interval_95_hz->low =
      frequency_hz.value - std::hypot(frequency_hz.value - interval_95_hz->low, half);
  interval_95_hz->high =
      frequency_hz.value + std::hypot(interval_95_hz->high - frequency_hz.value, half);
}

void tell_rate(double relative_std, const Estimate& frequency_hz, const std::string& where,
               std::vector<Finding>& findings) {
  const double more = relative_std * frequency_hz.value;
  if (!(more > 0.1 * frequency_hz.std)) return;
  signal::add_note(
      findings, "rate_uncertainty", where,
      "State the sample rate with more digits: it is known to {:.2g} %, which adds {:.2g} Hz to "
      "the uncertainty of the first frequency and is counted in all results",
      100 * relative_std, more);
}

}  // namespace rigfit::ident
