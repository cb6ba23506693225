// What an FRF is called that two channels make.
#pragma once

#include <array>
#include <string>

#include "signal/recording/recording.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// UFF direction (+-1, 2, 3) of an axis vector; 0 when it is along none.
[[nodiscard]] int uff_direction(const std::array<double, 3>& direction);

/// By the units of both; unknown where they are no SI units of motion and force.
[[nodiscard]] FrfForm form_of(const Channel& response, const Channel& force);

/// "(m/s^2)/N"; "?" for a unit that is not known, empty where neither is.
[[nodiscard]] std::string ratio_of_units(const std::string& response, const std::string& force);

}  // namespace rigfit::signal
