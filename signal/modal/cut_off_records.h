// Records that end before a mode has decayed: what their FRFs hold besides modes.
//
// The lines of FRFs are 1 / T apart, T the length of the records, so that a pole p (window
// included) leaves exp(Re p T) of its amplitude at their end. Its FRF then has a residue changed by
// as much, a polynomial in s, and a smooth function that depends on where in the record the hit was
// (cut_off_background(), smooth_background.h). Without them a fit shifts the pole instead.
#pragma once

#include <Eigen/Core>
#include <complex>

#include "signal/modes/modal_band.h"
#include "signal/refinement/modal_noise.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// Amplitude that a pole leaves at the end of the records, of that at the hit. `raw`: window
/// included.
[[nodiscard]] double left_at_the_end(const ModalBand& band, std::complex<double> raw);

/// Sets `band.lines.background` where one of `poles` (window removed) leaves 0.1 to 90 %; more is a
/// steady tone. Where the set does not say how long before the hit its records begin and more than
/// 1 % is left, an eighth of their length is allowed for, or what can be fitted within `max_work`
/// multiplications. Whether it was set.
///
/// FRFs without noise of a force window get what the misfit of the fit without it shows
/// (`misfit_shows`): all of it, s^(n-1) alone, or none, as where FRFs are no transform of cut-off
/// records (computed ones, stepped sines), whose poles it would make less certain.
[[nodiscard]] bool allow_for_cut_off(const FrfSet& frfs,
                                     const Eigen::Ref<const Eigen::VectorXcd>& poles,
                                     const Eigen::Ref<const Eigen::MatrixXcd>& misfit,
                                     const FrfNoise& noise, double max_work, ModalBand& band);

/// Whether `misfit` (lines x FRFs) has more of the span of the orthonormal columns `background`
/// than noise of variance `line` (lines, any scale), uncorrelated between lines: its squares in
/// that span over their mean, which scatters by 1 / sqrt(columns x FRFs), exceed it by so many
/// deviations of that.
[[nodiscard]] bool misfit_shows(const Eigen::Ref<const Eigen::MatrixXcd>& background,
                                const Eigen::Ref<const Eigen::MatrixXcd>& misfit,
                                const Eigen::Ref<const Eigen::VectorXd>& line, double deviations);

}  // namespace rigfit::signal
