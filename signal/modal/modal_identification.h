// Identifies modes from FRFs without initial guesses: stabilisation over orders, clusters of poles,
// maximum likelihood, a test of every mode, covariance, synthesis from the exported modes.
//
// Candidates come from the stabilisation diagram of the whole band first. The fitted modes'
// residual is then searched in overlapping parts of the band, each time four times narrower, to
// find modes that are close together or weak beside others. A candidate is kept when it lies in the
// band, is damped less than `LscfOptions::max_damping_ratio`, is as prominent as `min_prominence`,
// and its residues stand out of the noise of all FRFs by more than what the Bayesian information
// criterion asks for its 2 + 2 FRFs parameters (Schwarz, Ann. Stat. 6 (1978) 461). An exponential
// window's decay rate is part of the frequency axis (modal_basis.h): poles come out without it.
#pragma once

#include "signal/modes/modal_result.h"

namespace rigfit::signal {

/// Throws std::invalid_argument when the set is inconsistent in size, holds no FRF or fewer than 8
/// usable lines in the band. A set without any mode gives an empty list and a note.
[[nodiscard]] ModalResult identify_modes(const FrfSet& frfs, const ModalOptions& options = {});

}  // namespace rigfit::signal
