// Tension of a cable, hanger or stay from its natural frequencies; no starting value is needed.
//
// The cable is a scene of one member (cable_scene.h) between ends that are pinned, clamped or held
// by equal rotational springs, and its modes are fitted by `update` (ident/update): orders and
// planes of the measured modes are part of the estimate; modes may be missing or false. Kinds of
// ends are candidates that are weighed by their evidence; the tension's interval is that of the
// mixture (ident/update/model_candidates.h):
//
//   p(T | data) = sum_e w_e p(T | data, e),   w_e = Z_e / sum Z
//
// The tension is the axial force at mid-span. Along the cable it changes with the height, T(s) =
// T_mid + w (y(s) - y_mid), w the weight per length (exact for a flexible cable; Irvine, Cable
// Structures, 1981, ch. 1).
#pragma once

#include <vector>

#include "ident/tension/tension_result.h"
#include "ident/update/problem/update_data.h"

namespace rigfit::ident {

/// Modes found in several recordings or channels as one list by rising frequency: modes that agree
/// within three standard uncertainties are merged into their weighted mean, whose uncertainty is at
/// least that from their scatter. Modes without an uncertainty, or of different planes, stay apart.
[[nodiscard]] std::vector<MeasuredMode> merged_modes(std::vector<MeasuredMode> modes);

/// Throws std::invalid_argument for invalid numbers, or without any mode.
void check_cable(const CableDescription& cable, const std::vector<MeasuredMode>& modes);

/// Throws like check_cable.
[[nodiscard]] TensionResult identify_tension(const CableDescription& cable,
                                             const std::vector<MeasuredMode>& modes,
                                             const TensionOptions& options = {});

}  // namespace rigfit::ident
