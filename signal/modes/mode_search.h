// Which modes a band of FRFs holds: candidates refined together, weighed by what the fit leaves,
// dropped when they do not stand out; then what is left searched in narrower parts of the band.
#pragma once

#include "signal/modes/modal_band.h"
#include "signal/modes/modal_result.h"

namespace rigfit::signal {

/// Poles of what `H` (lines x FRFs, on the band's lines) holds in `count` lines from `first` on,
/// window not removed. The fewer of responses and inputs serve as references.
[[nodiscard]] LscfResult stabilise(const ModalBand& band, const MatrixXcd& H, const FrfNoise& noise,
                                   const LscfOptions& options, Index first, Index count);

struct FoundModes {
  ModalRefineResult fit;         ///< no residues when the lines determine no mode
  ModalCovariance covariance;    ///< from search_modes(): rank and significance alone
  std::vector<double> presence;  ///< IdentifiedMode::presence, by mode
  FrfNoise noise;                ///< from what the fit leaves
  MatrixXcd model;               ///< lines x FRFs; empty without residues
  double penalty = 0;            ///< the least significance of a mode
  int iterations = 0;
  bool exhausted = false;  ///< given up for its cost before it settled
};

/// Clusters of `H` in overlapping parts of the band, `parts` and a half of them wide.
[[nodiscard]] std::vector<PoleCluster> search_parts(const ModalBand& band, const MatrixXcd& H,
                                                    const FrfNoise& noise,
                                                    const ModalOptions& options, Index parts);

/// From the clusters of the whole band's stabilisation diagram, with the noise `first` that the
/// diagram was weighted by.
[[nodiscard]] FoundModes search_modes(const ModalBand& band,
                                      const std::vector<PoleCluster>& clusters,
                                      const FrfNoise& first, const ModalOptions& options);

}  // namespace rigfit::signal
