// The unit of an FRF as text, "(m/s^2)/N" or "g/N", to its form and factor.
#pragma once

#include <optional>
#include <string>

#include "signal/recording/recording.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

struct FrfUnit {
  double factor = 1;  ///< to SI
  FrfForm form = FrfForm::unknown;
  std::string unit;  ///< SI, such as "(m/s^2)/N"
};

/// Receptance of a displacement, mobility of a velocity, accelerance of an acceleration.
[[nodiscard]] FrfForm frf_form_of(Quantity response);

/// Parted at the last slash between two units of which the second is a force. Empty: none is.
[[nodiscard]] std::optional<FrfUnit> parse_frf_unit(const std::string& text);

}  // namespace rigfit::signal
