// Whether FRFs show by themselves that resonances are not linear: a test on the lines around each,
// and what follows for the modes where sizes of hits do not tell more.
//
// Stiffness or damping that goes with the square of the amplitude A0 exp(-d t) turns the ring-down
// of a mode, pole p = -d + i w, into
//   a exp(p t + b (1 - exp(-2 d t))),   b = (i dw - dd) / (2 d),
// dw, dd: change of frequency and decay rate at the amplitude of the hit. To first order in b its
// transform is a linear resonance and a second pole at the same frequency, three times as damped:
//   H = a (1 + b) / (s - p) - a b / (s - p + 2 d).
// On the lines around the mode, with its neighbours and a polynomial as background, the share of
// that second pole outside of what amplitudes, background and a shift of p explain is tested
// against what the extended model leaves: F = |beta|^2 / var beta, with 2 and 2 (lines - unknowns)
// degrees of freedom; var beta is the larger of that of white noise and that from each line's
// misfit (HC3: MacKinnon and White, J. Econometrics 29 (1985) 305), times the inflation by
// correlated lines (Newey and West 1987). The FRFs in which the mode is strongest, of single hits
// where these are known, are tested with a pole each; twice the median of their chances is the
// chance, whatever they share (Vovk and Wang, Biometrika 107 (2020) 791).
//
// Where a mode is distorted with a chance below 1e-4 over the number of modes, and by 0.1 % of
// the FRFs around it or more, or sizes of hits say so, the structure is not linear. The intervals
// of all modes then reach from the values at the amplitudes of the test to those of p, and a mode
// is doubtful
// - where it is a pole under a mode's resonance and 1.5 times as damped or more: the second pole of
//   above;
// - where its peak is no larger than products of modes make it. The forces of a spring that shifts
//   mode a by dw_a have parts 2 w_a dw_a A_a and, at sums of three different modes' frequencies,
//   twice that, decaying three times as fast; mode s passes them on by 1 / |w_s^2 - w^2|:
//     peak < sum_a (8/3) w_a d_a |b_a| peak_a  max_s 1 / |p_s^2 - p^2|,   peaks: receptances.
// Sources: Simon and Tomlinson, J. Sound Vib. 96 (1984) 275; Ewins, Modal Testing, 2nd ed., sec.
// 4.5; Nayfeh and Mook, Nonlinear Oscillations, ch. 6.
#pragma once

#include <complex>
#include <cstddef>

#include "signal/modes/modal_band.h"
#include "signal/modes/modal_model.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

struct ResonanceDistortion {
  double chance = 1;  ///< of as much where the resonance is linear; 1: not tested
  double share = 0;   ///< of the FRF around it that the second pole explains
  std::complex<double> b;
  std::complex<double> shift;       ///< rad/s: from the linear resonance to p, to first order in b
  std::complex<double> small_pole;  ///< rad/s: p
  double small_std = 0;             ///< rad/s, of p, its real and imaginary part each
};

/// Of mode `r`, medians over FRFs. Neighbours are the other modes, but for doubtful ones under the
/// same resonance, which such a distortion makes.
[[nodiscard]] ResonanceDistortion resonance_distortion(const FrfSet& frfs, const ModalBand& band,
                                                       const ModalModel& model, std::size_t r);

/// Widens intervals and doubts modes as above, with the note "resonances_distorted". Modes at small
/// amplitude by the sizes of hits (`amplitude.found`) keep their values.
void allow_for_distortion(const FrfSet& frfs, const ModalBand& band, ModalModel& model);

}  // namespace rigfit::signal
