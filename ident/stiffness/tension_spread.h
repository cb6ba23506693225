// The tension that a bending test's EI belongs to.
//
// A cable that is loaded across pulls harder: the tension changes within the test. The friction
// between its wires may be that of the tension at rest, or follow the tension of the moment, so
// that EI belongs to some tension between the lowest and the highest of the test. About the mean
// tension Tm, where a test states its EI, that is a rectangular distribution (GUM 4.3.7):
//   u_T^2 = (T_low + T_high - 2 Tm)^2 / 4 + (T_high - T_low)^2 / 12
// Which of the two it is holds for all tests of a cable: in a fit of EI(T) it is one standard
// normal parameter that moves the EI of all points together by d EI / dT u_T, with dEI/dT by the
// power law through the points, one for all laws, so that their chi-squares compare. Repeats do not
// average it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/stiffness/fitted_law.h"

namespace rigfit::ident {

/// u_T of the tension's samples in a test, N; `noise_N` is that of one sample, whose extremes are
/// taken off the range.
[[nodiscard]] double tension_spread(const Eigen::Ref<const Eigen::VectorXd>& tension_N,
                                    double noise_N);

/// Change of each point's EI, N m2, by its `tension_std_N`: d EI / d T times it. Zero where the
/// tensions lie within 5 % of each other: dEI/dT is not known.
[[nodiscard]] std::vector<double> change_by_tension(const std::vector<StiffnessPoint>& points);

}  // namespace rigfit::ident
