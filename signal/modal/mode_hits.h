// What single hits say of the modes of their average: hits are groups (estimation/groups.h).
//
// Uncertainty of the average: the difference of a hit's FRFs from it goes through the linear filter
// of the average's own fit (pole_errors()), one Gauss-Newton step to the poles that the hit would
// have given; leaving out one hit at a time (weighed by their squared impulses, as H1 weighs them)
// gives the variance. Hits differ where that variance is more than the fit's noise gives. Then
// every hit's own poles are fitted on the lines around each mode (local_modes.h): where those
// differ by more than their own errors the mode becomes their random-effects mean, since the
// average of FRFs that differ is no FRF of one structure (its peaks are wider). Points struck one
// after the other are independent. Where several were struck and resonances of two modes touch, a
// hit by itself may show both as one: there the average's poles stay.
//
// Shapes: size and phase of each hit's FRFs around a mode, over the fit's, scatter with the
// hammer's gain and with the place that is met; their jackknife variance is added.
#pragma once

#include "signal/modes/mode_search.h"

namespace rigfit::signal {

/// Fills `between_hits` and, where hits differ (chance 5 % for a mode, 1 % for all), widens the
/// standard deviations of poles and shapes, takes means over the hits, and doubts
/// modes that fewer than two thirds of the hits show within their half bandwidth. Notes
/// "hits_disagree" where they differ in all modes together. Without two hits over the whole band
/// nothing is done. `found`: the fit of the average; `local`: its modes are of local fits.
void allow_for_hits(const FrfSet& frfs, const ModalBand& band, const FoundModes& found, bool local,
                    const ModalOptions& options, ModalModel& model);

// Why a person should not rely on an identified mode, or on the error bars of all: each reason with
// its figure.

/// Variance of what a fit takes from lines of a misfit over that of noise: 1 and twice the sum of
/// its correlations beyond noise's, by Bartlett's weights to 8 lines (Newey and West, Econometrica
/// 55 (1987) 703). `misfit`: lines x FRFs.
[[nodiscard]] double misfit_inflation(const FrfNoise& noise, const Ref<const MatrixXcd>& misfit);

/// Rms of what a model leaves of the FRFs around a mode beyond noise, over the rms of the FRFs.
///
/// Lines within its half bandwidth, two on either side at least. What noise leaves: the error bars'
/// power where there are some, else what does not correlate between neighbouring lines beyond the
/// noise's own correlation (line_correlation(), under a window). 0 where chance may give as
/// much (four standard deviations). `misfit`: lines x FRFs.
[[nodiscard]] double misfit_beyond_noise(const ModalBand& band, const FrfNoise& noise,
                                         const IdentifiedMode& mode,
                                         const Ref<const MatrixXcd>& misfit);

/// Fills `doubtful` and adds to `doubt` of every mode. Notes modes around which the model leaves
/// more than noise, modes whose residues of several inputs are of more than one shape, and what the
/// record's length costs the residues. `misfit`: lines x FRFs; `of_one_shape_each`: that of the
/// modes as they are given, each with one shape.
void judge_modes(ModalResult& result, const ModalBand& band, const Ref<const MatrixXcd>& misfit,
                 const Ref<const MatrixXcd>& of_one_shape_each);

}  // namespace rigfit::signal
