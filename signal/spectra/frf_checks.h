// Checks measured FRFs against the physics of a passive structure.
//
// Driving point (response and force at the same place and direction): the real part of the mobility
// is nowhere negative (the imaginary part of the receptance nowhere positive), on every line s = a
// + i omega with a >= 0. That is so of no other point: a mode whose residue has the other sign
// turns it over at its resonance. Reciprocity (Maxwell, Betti): H of response j to input k equals H
// of response k to input j. Source: Ewins, Modal Testing, 2nd ed., ch. 2 and 3.
#pragma once

#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

enum class DrivingPointVerdict {
  consistent,
  inverted,      ///< consistent with one signal's sign reversed
  inconsistent,  ///< not at the same place or direction, or a time shift between the channels
  unclear,       ///< too little signal above the noise
};
[[nodiscard]] const char* name_of(DrivingPointVerdict verdict);

struct DrivingPointCheck {
  DrivingPointVerdict verdict = DrivingPointVerdict::unclear;
  /// Part of sum |Re mobility| with the wrong sign, over lines where it exceeds three standard
  /// deviations (all lines when these are not known).
  double wrong_sign_share = 0;

  static constexpr auto fields() {
    using T = DrivingPointCheck;
    return std::tuple{field("verdict", &T::verdict),
                      field("wrong_sign_share", &T::wrong_sign_share)};
  }
};

/// Checks one column of known form within the band. Up to 5 % of wrong sign is consistent, 95 % or
/// more is inverted: resonances dominate the sum, so either limit leaves room for noise between
/// them.
[[nodiscard]] DrivingPointCheck check_driving_point(
    const FrfSet& frfs, Index response, Index input,
    std::optional<std::pair<double, double>> band_hz = {});

/// Note for the user on a failed check (`where` is left empty); nothing when it passed.
[[nodiscard]] std::optional<Note> note_of(const DrivingPointCheck& check);

struct ReciprocityCheck {
  std::vector<std::string> points;  ///< the two
  double difference = 0;  ///< |H_ab - H_ba| over their mean, root mean squares over the lines
  double from_noise = 0;  ///< difference expected from the error bars; 0: unknown

  static constexpr auto fields() {
    using T = ReciprocityCheck;
    return std::tuple{field("points", &T::points), field("difference", &T::difference),
                      field("from_noise", &T::from_noise)};
  }
};

/// Checks every pair of points (by name) measured in both directions.
[[nodiscard]] std::vector<ReciprocityCheck> check_reciprocity(
    const FrfSet& frfs, std::optional<std::pair<double, double>> band_hz = {});

}  // namespace rigfit::signal
