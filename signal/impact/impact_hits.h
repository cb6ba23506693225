// Hammer hits in a force signal, each accepted or rejected with its reason.
//
// A hit begins where the force exceeds the trigger level, and everything within a quarter of a
// second belongs to it. Second contacts are looked for in the force correlated with
// the hit's own pulse: this matched filter raises a contact above the noise and suppresses anything
// shorter. Ringing of the hammer or of anti-alias filters and the undershoot of AC-coupled
// amplifiers swing to both sides; a second contact pushes to one side only, which tells them apart.
// Guidance on what makes a hit good: ISO 7626-5 (impact excitation).
#pragma once

#include "signal/recording/recording.h"

namespace rigfit::signal {

enum class HitFault {
  rings,            ///< the force swings to both sides and rings on: it is a response
  missing_samples,  ///< NaN in the force or a response within the block
  overload,         ///< clipped force or response
  /// Too few samples in the pulse, so that its area depends on the logger's filters, or not all.
  unresolved_pulse,
  double_hit,
  cut_off,         ///< the next hit or the end of the record comes before the ring-down ends
  force_spectrum,  ///< too little force somewhere in the band
  outlier,         ///< without it the others agree much better (leave-one-out coherence)
};
[[nodiscard]] const char* name_of(HitFault fault);

struct HitOptions {
  double trigger = 0.1;  ///< a hit exceeds this part of the largest force and ten times the noise
  /// Smallest second contact that is reported, relative to the peak (3 %, so that 5 % are found).
  /// Noise may hide contacts up to `Hit::smallest_second_hit`.
  double double_hit = 0.03;
  /// Samples a pulse needs above a tenth of its peak. A half sine with four lasts 3.2 sample
  /// intervals or more and has at most 0.5 % of its energy above half the sample rate (with
  /// three: 2.2 %, with one or two a quarter), so that its area hardly depends on the logger's
  /// anti-alias filter.
  int min_pulse_samples = 4;
  bool accept_unresolved = false;  ///< keep such hits all the same: frequencies without amplitudes

  double block_s = 0;         ///< 0: the length that uses most of the recordings (see `find_hits`)
  double pre_trigger_s = -1;  ///< before the peak; negative: 1 % of the block, at least two pulses
  std::optional<std::pair<double, double>> band_hz;  ///< band that the force spectrum must cover
};

/// A block cut by the next hit or the end of the record is accepted, and filled with zeros, when
/// the responses have fallen to this part of their largest value (or to the noise before the hit).
inline constexpr double kRungDown = 0.01;

struct Hit {
  std::size_t recording = 0;  ///< index of the recording it is in
  Index peak_sample = 0;
  double time_s = 0;  ///< time of the peak on the recording's time axis
  double peak = 0;    ///< with its sign, unit of the force channel, offset removed
  double offset = 0;  ///< mean force before the hit, removed
  Index pulse_first = 0, pulse_last = 0;  ///< samples above the edge, inclusive
  double pulse_duration_s = 0;            ///< between the edge crossings, interpolated
  Index block_first = 0;                  ///< sample where the block begins
  Index available = 0;                    ///< samples from there to the next hit or the end
  double second_hit = 0;                  ///< largest second contact relative to the peak
  double second_hit_delay_s = 0;          ///< negative: before the peak
  double smallest_second_hit = 0;         ///< smallest visible in the noise, relative to the peak
  double usable_hz = 0;         ///< the force spectrum stays within kMostSpectrumDrop up to here
  double spectrum_drop_db = 0;  ///< largest in the band (0 without a band)
  double end_level = 0;         ///< responses at the end of the block over their largest value
  double level_before = 0;      ///< responses before the hit over their largest value
  bool accepted = true;
  std::vector<HitFault> faults;
  std::string reason;  ///< for a person; empty when accepted
  [[nodiscard]] bool has(HitFault fault) const;
  void reject(HitFault fault, const std::string& why);

  [[nodiscard]] std::optional<describe::ByName> second() const {
    if (!(second_hit > 0)) return {};
    return describe::ByName{{{"ratio", second_hit}, {"delay_s", second_hit_delay_s}}};
  }
  /// "accepted", "kept: ..." or "rejected: ...".
  [[nodiscard]] std::string verdict() const {
    if (!accepted) return "rejected: " + reason;
    return reason.empty() ? "accepted" : "kept: " + reason;
  }

  static constexpr auto fields() {
    using T = Hit;
    return std::tuple{
        field("time_s", &T::time_s, "s", "time", "of the peak"),
        field("peak", &T::peak, "", "peak", "in the unit of the force", 4),
        field("accepted", &T::accepted),
        field("reason", &T::reason),
        field("faults", &T::faults),
        field("pulse_duration_s", &T::pulse_duration_s, "s", "pulse", "", 3),
        field("usable_hz", &T::usable_hz, "Hz", "usable to", "of the force spectrum", 3),
        field("end_level", &T::end_level),
        field("second_hit", &T::second),
        field("", &T::verdict, "", "verdict", "")};
  }
};

struct HitSearch {
  std::vector<Hit> hits;  ///< in the order of recordings and time
  Index block_samples = 0;
  double sample_rate_hz = 0;
  int sign = 1;           ///< direction of the pulses, +1 or -1
  double rest_level = 0;  ///< smallest `level_before` of a hit; 0: unknown
  /// Value at rest (median) of each response, by recording.
  std::vector<std::vector<double>> response_rest;
  std::vector<Note> notes;
};

/// `force` and `responses` are channel indices, the same in every recording. The automatic block is
/// the FFT length that maximises (number of hits that are that long) x (length). Throws
/// RecordingError when sample rates differ or are unknown. Without any hit the list is empty, with
/// a note.
[[nodiscard]] HitSearch find_hits(std::span<const Recording> recordings, Index force,
                                  std::span<const Index> responses, const HitOptions& options = {});

}  // namespace rigfit::signal
