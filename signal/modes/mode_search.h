// Which modes a band of FRFs holds: candidates refined together, weighed by what the fit leaves,
// dropped when they do not stand out; then what is left searched in narrower parts of the band.
#pragma once

#include "signal/modes/modal_result.h"

namespace rigfit::signal {

/// The lines and FRFs of a set that take part in the search.
struct ModalBand {
  VectorXd frequency_hz;
  std::vector<Index> rows;  ///< indices of the band's lines in the set
  MatrixXd H_std;           ///< empty: not known or not usable
  FrfLines lines;
  double spacing_hz = 0;                   ///< median step between lines
  double window = 0;                       ///< decay rate of the exponential window, 1/s
  double correlation_lines = 0, lead = 0;  ///< FrfNoise's
  VectorXcd beside;  ///< poles beyond its ends (signal/modal/band_background.h)
};

/// Lines from `low_hz` (never 0 Hz) to `high_hz` (0: the last) with finite values. What is left out
/// is noted. Throws std::invalid_argument for sizes that do not fit, frequencies that do not rise,
/// or fewer than 8 lines.
[[nodiscard]] ModalBand select_band(const FrfSet& frfs, double low_hz, double high_hz,
                                    std::vector<Note>& notes);

/// What the noise of its FRFs is taken for before any fit: error bars where there are some.
[[nodiscard]] FrfNoise first_noise(const ModalBand& band);

/// Least significance of a mode: what the Bayesian information criterion asks for its 2 + 2 FRFs
/// parameters. `H`: lines x FRFs.
[[nodiscard]] double least_significance(const Ref<const MatrixXcd>& H);

/// Lines within so many half bandwidths of a pole (window removed), `least` spacings at least to
/// either side: the first and how many.
[[nodiscard]] std::pair<Index, Index> lines_around(const ModalBand& band, Complex pole,
                                                   double least = 1, double half_bandwidths = 1);

/// Peak of a mode with residues of this norm over all FRFs, over the rms of the FRFs on the lines
/// within its half bandwidth; `none` where these are 0.
[[nodiscard]] double prominence(const ModalBand& band, Complex pole, double residues, double none);

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
