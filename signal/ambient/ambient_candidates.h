// Candidates of modes from half spectra of the correlations of all channels with a few references:
// LSCF over orders, clusters of poles and participation vectors, shapes from the residues.
#pragma once

#include "signal/ambient/ambient_signals.h"
#include "signal/ambient/resonance_fit.h"
#include "signal/poles/pole_clusters.h"

namespace rigfit::signal {

/// A band needs as many: a pole, a residue and a line have six parameters.
inline constexpr Index kFewestLines = 8;

/// `shape` at length 1, turned to be as real as it can be.
[[nodiscard]] VectorXcd phase_real(VectorXcd shape);

struct AmbientCandidates {
  std::optional<LagSpectrum> spectrum;  ///< its lags follow from the narrowest candidate
  MatrixXcd pairs;  ///< half spectra of all pairs: lines x channels^2; column j n + i: y_i x_j
  VectorXcd poles;  ///< by rising frequency, window taken off; none: nothing stands out
  VectorXd presence;
  MatrixXcd shapes;  ///< channels x candidates, of the scaled channels
};

/// `result`: has the band, gets the stabilisation diagram and the longest lag.
[[nodiscard]] AmbientCandidates find_candidates(const AmbientSignals& signals,
                                                const AmbientOptions& options,
                                                AmbientResult& result,
                                                std::vector<Index> references);

}  // namespace rigfit::signal
