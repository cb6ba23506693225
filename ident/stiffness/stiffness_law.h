// Laws for a strand's flexural rigidity over its tension, EI(T), fitted to bending tests.
//
//   linear       EI = a + b T
//   square root  EI = a + b sqrt(T)
//   power        EI = a (T / T0)^b,  T0 the geometric mean of the tested tensions
//   saturating   EI = EImin + (EImax - EImin) T / (T + Th): free slip at rest, no slip at T >> Th;
//                EImin and EImax are fixed where the strand's geometry gives them, else fitted
//
// The fit is weighted least squares (Ceres, analytic derivatives) with the points' own standard
// deviations. The tension within a test at which EI holds is one more parameter, common to all
// points, with a prior (tension_spread.h). Points without intervals get equal relative weights, and
// their scatter gives the variance. Ranking: AICc (Burnham and Anderson, Model Selection and
// Multimodel Inference, 2002, 2.4), chi^2 + 2 k + 2 k (k + 1) / (n - k - 1) with known weights, n
// ln(RSS / n) + ... with one parameter more without.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/stiffness/fitted_law.h"

namespace rigfit::ident {

/// EI by a law at a tension > 0, with its bands, which are NaN where a parameter is not determined.
[[nodiscard]] StiffnessPrediction predict(const FittedLaw& law, double tension_N);
/// d EI / d (free parameter), in the order of the covariance, at a tension > 0.
[[nodiscard]] Eigen::VectorXd law_gradient(const FittedLaw& law, double tension_N);

/// Throws std::invalid_argument for fewer than two points, or values that are not positive and
/// finite. `sentence` names laws left out because they have more parameters than points.
[[nodiscard]] StiffnessLaws fit_stiffness_laws(const std::vector<StiffnessPoint>& points,
                                               const StiffnessLawOptions& options = {});

}  // namespace rigfit::ident
