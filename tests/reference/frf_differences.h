// Rates of a scene's FRFs by central differences of FRFs synthesised anew: slow, for checking the
// model's own.
#pragma once

#include "model/frfs/frf_sensitivities.h"

namespace rigfit::ident {

/// As model::synthesize_frf_sensitivities; a parameter at zero moves up only.
[[nodiscard]] model::FrfSensitivities frf_differences(const model::Scene& scene,
                                                      const Eigen::VectorXd& frequency_hz,
                                                      const std::vector<std::string>& parameters,
                                                      double decay_rate_1_s = 0);

}  // namespace rigfit::ident
