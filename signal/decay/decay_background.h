// What a record holds beside the modes of a decay: tones that do not decay (mains hum, a machine)
// and an offset that dies away (an amplifier's high-pass after the tap, a hand let go).
//
//   b_j = sum_k Re(B_k exp(q_k (j - origin))),  q = i w of a tone, q = -b < 0 of an offset, which
//                                               begins at the origin, the window's first sample
//
// A tone within a line's width of a mode cannot be told from it while the mode lasts, but it can
// before the impact and behind the decay: there tones are looked for. They are fitted to all
// samples before the impact and in the window, an offset to the window, both together with the
// modes: the modes are fitted to the window less the background (damped_sinusoids.h), the
// background takes a step of Gauss and Newton's in which the modes follow (Schur's complement), in
// turns. The modes' covariance is that of the fit of all.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "signal/sinusoids/damped_sinusoids.h"

namespace rigfit::signal {

/// Where the background is fitted, samples of the record.
struct BackgroundStretches {
  Eigen::Index quiet = 0;           ///< samples [0, quiet) lie before the impact
  Eigen::Index start = 0, end = 0;  ///< the window of the modes
};

struct DecayBackground {
  struct Term {
    std::complex<double> rate;       ///< q, per sample
    std::complex<double> amplitude;  ///< B, real for an offset
    [[nodiscard]] bool tone() const { return rate.imag() > 0; }
    /// exp(q j) at samples first .. first + count - 1 from the origin.
    [[nodiscard]] Eigen::ArrayXcd at(Eigen::Index first, Eigen::Index count) const;
  };
  Eigen::Index origin = 0;  ///< sample of the record
  std::vector<Term> terms;

  [[nodiscard]] Eigen::Index parameters() const;
  /// At samples [from, to) of the record.
  [[nodiscard]] Eigen::VectorXd at_samples(Eigen::Index from, Eigen::Index to) const;
  /// Derivatives there: Re B, Im B and w of a tone, B and b of an offset.
  [[nodiscard]] Eigen::MatrixXd columns(Eigen::Index from, Eigen::Index to) const;
};

/// Tones of the record `y` (NaN where missing) beside the modes of `fit` to the window. No terms
/// when no tone stands out of the noise where it is alone.
[[nodiscard]] DecayBackground find_tones(const Eigen::Ref<const Eigen::VectorXd>& y,
                                         const BackgroundStretches& stretches,
                                         const DampedSinusoidsFit& fit, double false_alarm);

/// Adds a decaying offset to `background` where it explains more than noise of the residual's
/// colour would with the chance `false_alarm`. `fit`: to the window less `background`.
[[nodiscard]] bool add_offset(const Eigen::Ref<const Eigen::VectorXd>& y,
                              const BackgroundStretches& stretches, const DampedSinusoidsFit& fit,
                              double false_alarm, DecayBackground& background);

/// `unit_covariance` of `fit` when the background is fitted too; empty where they cannot be told
/// apart.
[[nodiscard]] Eigen::MatrixXd covariance_beside(const Eigen::Ref<const Eigen::VectorXd>& y,
                                                const BackgroundStretches& stretches,
                                                const DampedSinusoidsFit& fit,
                                                const DecayBackground& background);

}  // namespace rigfit::signal
