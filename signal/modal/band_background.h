// What the FRFs of a band hold besides its modes: smooth terms, and modes just beyond its ends.
//
// Noise on the force: a force window keeps the noise n(t) within a time T of the hit. The transform
// of the measured force is F (1 + e), e = N / F smooth over lines, since n lies within T. With H =
// sum_r R_r / (s - p_r) + ... the measured FRFs are
//   H (1 - e + e^2 ..) = sum_r R_r' / (s - p_r) + B(s):
// poles stay in place, residues change by some parts of 1, and B has no pole: its inverse transform
// lies within T of the hit as well (an impulse response convolved with a signal of that length is a
// sum of the same damped sinusoids outside of it). B is spanned by exp(-i w t), |t| <= T, of which
// a band of width b needs about 2 T b + some (Slepian, Bell Syst. Tech. J. 57 (1978) 1371).
//
// Records that end a time T - t0 after the hit, T their length, lack of each mode what follows,
//   p^n R exp(p (T - t0)) exp(s t0) / (s - p) + conj   (n derivatives of the motion recorded),
// since exp(-s (T - t0)) = exp(s t0) at their lines. exp(s t0) - exp(p t0), over s - p, is the
// integral of exp(s t) exp(p (t0 - t)) over 0 <= t <= t0: no pole, spanned by exp(i w t) with
// these t. What remains is a mode of residue R (1 - exp(p T)) and polynomials in s up to
// s^(n-1), whose sum over modes is no longer zero: for an accelerance a line in s.
//
// The lines of FRFs are 1 / T apart, T the length of the records, so that a pole p (window
// included) leaves exp(Re p T) of its amplitude at their end. Its FRF then has a residue changed by
// as much, a polynomial in s, and a smooth function that depends on where in the record the hit was
// (cut_off_background()). Without them a fit shifts the pole instead.
//
// Residual terms s^(n-2) and s^n are the first of two series, of modes below and above the band, in
// (frequency / distance)^2. The next two of both, to s^(n-6) and s^(n+4), are always fitted, as far
// as the band tells them apart: without them modes 5 % damped are up to 5 standard deviations off,
// without a word, beside one at 1.6 times the band's end or at 0.4 times its beginning (tests of
// ModesBeside).
// A resonance within a quarter of the band's width beyond its end leaves more, which the fit takes
// for a change of the last mode inside (0.5 % of its damping where the distance of both is 17 %).
// Such modes are fitted to the lines around the end of the band; in the band each then is
// s^n / (s - p) and s^n / (s - conj p) with free complex factors, p held. An error dp of p enters
// as dp / |s - p| of what the mode adds.
// A fit that does not converge beside such poles is made without them. Source: Ewins, Modal
// Testing, 2nd ed., sec. 4.5 (residuals, pseudo-modes).
#pragma once

#include "signal/modes/mode_search.h"

namespace rigfit::signal {

/// Orthonormal columns over the lines `s` that span these functions to 1 part in 1000, outside of
/// the residual terms s^power and s^(power - 2). None for `span_s` 0, and where a quarter of the
/// lines' freedom or more would be needed: the noise then differs from line to line nearly as white
/// noise does.
[[nodiscard]] MatrixXcd smooth_background(const Ref<const VectorXcd>& s, int power, double span_s);

/// The same with t between -`before_s` and `after_s` (t0 and 0, or the span of noise on the force
/// where that is more) and with s^(power - 1), for records that end before modes have decayed. The
/// latter alone where t spans nothing or too much.
[[nodiscard]] MatrixXcd cut_off_background(const Ref<const VectorXcd>& s, int power,
                                           double before_s, double after_s);

/// Poles (window removed) of the modes that the lines of `frfs` within a quarter of the width of
/// `band` beyond its ends show. Empty where there are fewer than 16 such lines.
[[nodiscard]] VectorXcd poles_beside(const FrfSet& frfs, const ModalBand& band,
                                     const ModalOptions& options);

/// Sets `band.lines.background` to the orthonormal columns `background`, and what the next of the
/// residual terms and `band.beside` add to them, as far as it is more than 1 part in 1000.
void set_background(const Ref<const MatrixXcd>& background, ModalBand& band);

/// Amplitude that a pole leaves at the end of the records, of that at the hit. `raw`: window
/// included.
[[nodiscard]] double left_at_the_end(const ModalBand& band, Complex raw);

/// Sets `band.lines.background` where one of `poles` (window removed) leaves 0.1 to 90 %; more is a
/// steady tone. Where the set does not say how long before the hit its records begin, t0, and more
/// than 1 % is left, an eighth of their length is allowed for, or what can be fitted within
/// `max_work` multiplications. Where t0 is known and its span takes more, each such pole p (window
/// included) adds (exp(i w t0) - exp(p t0)) / (i w - p), held there. Whether it was set.
///
/// FRFs without noise of a force window get what the misfit of the fit without it shows
/// (`misfit_shows`): all of it, s^(n-1) alone, or none, as where FRFs are no transform of cut-off
/// records (computed ones, stepped sines), whose poles it would make less certain.
[[nodiscard]] bool allow_for_cut_off(const FrfSet& frfs, const Ref<const VectorXcd>& poles,
                                     const Ref<const MatrixXcd>& misfit, const FrfNoise& noise,
                                     double max_work, ModalBand& band);

/// Whether `misfit` (lines x FRFs) has more of the span of the orthonormal columns `background`
/// than noise of variance `line` (lines, any scale), uncorrelated between lines: its squares in
/// that span over their mean, which scatters by 1 / sqrt(columns x FRFs), exceed it by so many
/// deviations of that.
[[nodiscard]] bool misfit_shows(const Ref<const MatrixXcd>& background,
                                const Ref<const MatrixXcd>& misfit, const Ref<const VectorXd>& line,
                                double deviations);

}  // namespace rigfit::signal
