// The uncertainty of EA by Monte Carlo (JCGM 101), by closed forms instead of the fit: every draw
// takes a candidate by its weight and what all lengths share (mass, mass per length, adapter, place
// of the compliance) from its uncertainty, inverts the rod of each length (rod_stiffness.h), takes
// the weighted mean of EA or the weighted line 1/kc = L / EA + s, and adds what the lengths' own
// uncertainties make of it. A draw counts as much as the lengths agree under it, which is what they
// say about the shared inputs. Where the compliance lies changes what part of the cable's mass
// moves, to first order in it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ident/axial/axial_average.h"
#include "ident/axial/axial_result.h"

namespace rigfit::ident {

/// Values of EA, evenly weighted and sorted, as many as `draws`; empty when less than 100 draws
/// carry all the weight.
[[nodiscard]] std::vector<double> axial_monte_carlo(std::span<const AxialLengthData> lengths,
                                                    const AxialSetup& setup,
                                                    std::span<const AxialCandidate> candidates,
                                                    double repeat_degrees, int draws,
                                                    std::uint64_t seed);

}  // namespace rigfit::ident
