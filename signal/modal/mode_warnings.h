// Why a person should not rely on an identified mode, or on the error bars of all: each reason with
// its figure.
#pragma once

#include "signal/modes/modal_band.h"
#include "signal/modes/modal_result.h"

namespace rigfit::signal {

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
