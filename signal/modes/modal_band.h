// The lines and FRFs of a set that take part in the search for modes.
#pragma once

#include "signal/refinement/modal_refine.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

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

/// Lines within so many half bandwidths of a pole (window removed), `least` spacings at least to
/// either side: the first and how many.
[[nodiscard]] std::pair<Index, Index> lines_around(const ModalBand& band, Complex pole,
                                                   double least = 1, double half_bandwidths = 1);

/// Peak of a mode with residues of this norm over all FRFs, over the rms of the FRFs on the lines
/// within its half bandwidth; `none` where these are 0.
[[nodiscard]] double prominence(const ModalBand& band, Complex pole, double residues, double none);

}  // namespace rigfit::signal
