// How much a mode's frequency and damping differ from hit to hit, and what that makes of them.
//
// Each hit's own FRFs are fitted on the lines around each mode (local_fit.h): its pole and those of
// modes whose resonances overlap with it are free, from the average's on, residues and a quadratic
// background as well, further modes are held. What noise a force window leaves multiplies an FRF by
// a smooth factor and goes into residues and background, not into poles. An overlapping mode that
// the hits together do not show, by a chi-square test of the misfit without it, is left out.
//
// Hits on one point are repetitions: their scatter s has sum (hits - 1) degrees of freedom, their
// mean the uncertainty s / sqrt(n). An F test says whether the average, one hit left out at a time
// (hit_jackknife.h), changes by more than its error bars say, or, of modes of local fits, whether s
// is more than the noise left around them gives. Where it is, the structure, the hammer or the
// place struck changed: the average of the FRFs then is no FRF of one structure (its peaks are
// wider), the mean of the hits' poles is that of the mean structure. The standard deviation is
// widened by Student's t over 1.96, so that +-1.96 of it hold 95 %.
#pragma once

#include <vector>

#include "signal/modes/modal_model.h"
#include "signal/spectra/frf_set.h"
#include "signal/variation/hit_jackknife.h"

namespace rigfit::signal {

/// Frequencies and damping ratios of one mode, by point struck, then hit.
struct ModeOfHits {
  std::vector<std::vector<double>> frequency_hz, damping_ratio;
  std::vector<std::vector<std::size_t>> hit;               ///< place of each in `FrfSet::by_hit`
  double noise_frequency_hz = 0, noise_damping_ratio = 0;  ///< std that noise gives one hit
  /// Variance of the same by noise that is white over lines, as part of it: noise that goes with
  /// |H|, such as that on the force, or a tone beside the mode makes it small.
  double white_part = 1;
  double noise_freedom = 0;         ///< degrees of freedom of these
  JackknifeOfHits average;          ///< from the average's own fit; freedom 0: not known
  std::vector<std::size_t> unseen;  ///< overlapping modes that the hits do not show beside it
};

/// Fits of every hit in `frfs.by_hit`, in the order of `model.modes`. Hits whose fit does not stand
/// are left out.
[[nodiscard]] std::vector<ModeOfHits> modes_of_hits(const FrfSet& frfs, const ModalModel& model);

/// Fills `between_hits` of the modes and widens their standard deviations and those of the shapes
/// where hits differ by more than noise gives (one chance in twenty of the mode, or one in a
/// hundred of all modes; in local fits more than noise that is white over lines). Notes
/// "hits_disagree" where that is so of all modes (in local fits: more than what is left line by
/// line gives). In a test of one point, frequency and damping become the mean over its hits where
/// the average's would be biased: poles that scatter by s widen the average's resonance, so that
/// damping is too large by (s / decay rate)^2 to second order in s, here more than half a standard
/// deviation. Elsewhere the average stays: fits of single hits are the noisier ones, and where they
/// do not show a neighbouring mode they take its share too. A mode that half of the hits or fewer
/// show, or that they show as one with another mode, is called doubtful. Without `by_hit` nothing
/// is done. `hits`: of modes_of_hits().
void allow_for_hits(const FrfSet& frfs, const std::vector<ModeOfHits>& hits, ModalModel& model);

}  // namespace rigfit::signal
