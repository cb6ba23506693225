// Cross-section of a beam bent without tension, and its second moment of area about the axis of
// bending:
//
//   rectangle  I = w h^3 / 12   (h along the load)
//   round      I = pi d^4 / 64
#pragma once

#include <array>
#include <numbers>
#include <optional>

#include "signal/numerics/estimate.h"

namespace rigfit::ident {

/// A cross-section given in one of three ways, or not at all.
struct BeamSection {
  std::optional<std::array<double, 2>> rectangle_m;  ///< width, height
  double diameter_m = 0;                             ///< round and solid; 0: not given
  double second_moment_m4 = 0;                       ///< 0: not given
  /// Relative standard uncertainty of the second moment: three times that of a height, four times
  /// that of a diameter.
  double relative_std = 0;
};

/// Second moment of area, m^4; NaN where no section is given.
[[nodiscard]] inline signal::Estimate second_moment(const BeamSection& section) {
  double moment = section.second_moment_m4;
  if (section.rectangle_m) {
    const auto [width, height] = *section.rectangle_m;
    moment = width * height * height * height / 12;
  } else if (section.diameter_m > 0) {
    const double square = section.diameter_m * section.diameter_m;
    moment = std::numbers::pi * square * square / 64;
  }
  if (!(moment > 0)) return {};
  return {moment, section.relative_std * moment};
}

}  // namespace rigfit::ident
