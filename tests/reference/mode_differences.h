// Derivatives of modes by central differences: the second way to `model::ModeSensitivities`, for
// checking the analytic one and where that cannot be had. 2 n analyses for n parameters.
//
// A mode is followed by its plane and its place among the modes of that plane. Step: 1e-4 relative
// (1e-4 of the largest node distance for coordinates, 1e-4 kg for masses that are zero), whose
// truncation error is about 1e-8 and whose rounding error is that of the eigenvalues, 1e-12 / 1e-4.
#pragma once

#include <string>
#include <vector>

#include "model/linear/modal_analysis.h"

namespace rigfit::ident {

/// Modes that vanish from a shifted analysis have NaN derivatives.
[[nodiscard]] model::ModeSensitivities mode_differences(const model::Scene& scene,
                                                        const std::vector<std::string>& parameters,
                                                        const model::ModesOptions& options);

}  // namespace rigfit::ident
