// Which modes a band of FRFs holds: candidates refined together, weighed by what the fit leaves,
// dropped when they do not stand out; then what is left searched in narrower parts of the band.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "signal/modes/modal_band.h"
#include "signal/modes/modal_result.h"
#include "signal/poles/lscf.h"
#include "signal/poles/pole_clusters.h"
#include "signal/refinement/modal_noise.h"
#include "signal/refinement/modal_refine.h"

namespace rigfit::signal {

/// Poles of what `H` (lines x FRFs, on the band's lines) holds in `count` lines from `first` on,
/// window not removed. The fewer of responses and inputs serve as references.
[[nodiscard]] LscfResult stabilise(const ModalBand& band, const Eigen::MatrixXcd& H,
                                   const FrfNoise& noise, const LscfOptions& options,
                                   Eigen::Index first, Eigen::Index count);

struct FoundModes {
  ModalRefineResult fit;         ///< no residues when the lines determine no mode
  ModalCovariance covariance;    ///< from search_modes(): rank and significance alone
  std::vector<double> presence;  ///< IdentifiedMode::presence, by mode
  FrfNoise noise;                ///< from what the fit leaves
  Eigen::MatrixXcd model;        ///< lines x FRFs; empty without residues
  double penalty = 0;            ///< the least significance of a mode
  int iterations = 0;
  bool exhausted = false;  ///< given up for its cost before it settled
};

/// Clusters of `H` in overlapping parts of the band, `parts` and a half of them wide.
[[nodiscard]] std::vector<PoleCluster> search_parts(const ModalBand& band,
                                                    const Eigen::MatrixXcd& H,
                                                    const FrfNoise& noise,
                                                    const ModalOptions& options,
                                                    Eigen::Index parts);

/// From the clusters of the whole band's stabilisation diagram, with the noise `first` that the
/// diagram was weighted by.
[[nodiscard]] FoundModes search_modes(const ModalBand& band,
                                      const std::vector<PoleCluster>& clusters,
                                      const FrfNoise& first, const ModalOptions& options);

}  // namespace rigfit::signal
