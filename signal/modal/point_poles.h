// Poles of each measured point by itself: the points of a roving test are measured one after the
// other, and what is warm, loaded or touched differently has other frequencies at each of them.
//
// Points are the struck ones (inputs) or those with a sensor (responses), whichever are more. Each
// candidate is fitted on the lines around it (LocalFit in the source), neighbours that overlap
// jointly, the others held, and given up when it does not stand out of the misfit around it, or
// when its pole moves by more than half its half bandwidth with another window and background: such
// a pole describes the background. The misfit counts as noise, correlated between lines as a window
// makes it.
#pragma once

#include "signal/modes/modal_band.h"
#include "signal/modes/modal_result.h"

namespace rigfit::signal {

/// A mode as one point shows it.
struct PointPole {
  Index point = 0;
  Complex pole;          ///< rad/s, window removed
  double std = 0;        ///< std of the decay rate and of the damped frequency, each, rad/s
  VectorXcd residues;    ///< receptance, one a column of the point
  VectorXd residue_std;  ///< std of the real and the imaginary part, each
  /// Twice the fall of the misfit with this pole over the misfit's variance, correlated lines
  /// counted once: chi-square of 2 columns for a pole that is not there.
  double significance = 0;
  double explained = 0;  ///< share of what the background leaves that this pole explains
  double misfit = 0;     ///< rms misfit over rms FRF within the half bandwidth
};

/// Whether struck points vary (they are more than one and no fewer than the responses).
[[nodiscard]] bool points_are_inputs(const ModalBand& band);

/// Columns of `H` of every point, in the order in which the file lists the points.
[[nodiscard]] std::vector<std::vector<Index>> columns_of_points(const ModalBand& band);

/// `H`: FRFs of the point (or of a hit) on the lines of the band; `common`: starting poles, window
/// removed; `twin_misfit`: rms misfit over rms FRF that one pole must leave before a second within
/// its resonance counts. By rising frequency.
[[nodiscard]] std::vector<PointPole> point_poles(const ModalBand& band, const MatrixXcd& H,
                                                 Index point, const VectorXcd& common,
                                                 double twin_misfit, const ModalOptions& options);

}  // namespace rigfit::signal
