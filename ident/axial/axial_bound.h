// EA where nothing says what gives way beside the cable: one length and no statement on the frame.
//
// The chain's compliance is 1/k = L / EA + 1/km + s with an unknown s >= 0, so that EA is at least
// its value for s = 0, and no frequency of this length says more. The lower end of the interval is
// one-sided for s = 0 and holds for every s. The upper end is what a bar of solid metal with the
// cable's mass per length has,
//   EA <= m E / rho,
// steel's E / rho, which aluminium's equals and no strand exceeds. Between two bounds the standard
// uncertainty is that of a rectangular density, (high - low) / sqrt(12) (GUM, JCGM
// 100:2008, 4.3.7).
#pragma once

#include "ident/axial/axial_fit.h"
#include "ident/axial/axial_result.h"

namespace rigfit::ident {

/// Static stiffness of the whole chain at one length, with what frequency, hung mass and mass per
/// length are known to, and with what the unknown place of a compliance makes of the cable's mass
/// that moves (rectangular, of a third to either side).
[[nodiscard]] signal::Estimate assembly_stiffness(const AxialLengthData& length,
                                                  const AxialSetup& setup);

/// Turns EA of a result for which nothing else gives way into the bound; `low_N`: the one-sided
/// lower end. The budget gets a row for what is not told.
void bound_axial(double low_N, const AxialSetup& setup, const AxialOptions& options,
                 AxialTestResult& result);

}  // namespace rigfit::ident
