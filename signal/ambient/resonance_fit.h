// Poles common to the two-sided auto-spectra of filtered signals, each in its own band.
//
// The lag window exp(-s |k| dt) moves every pole by -s, exactly; with L lags a pole's part of a
// half spectrum is
//
//   b(lambda) = sum over k = 0..L of x^k = (1 - x^(L+1)) / (1 - x),  x = exp((lambda - s - i w) dt)
//
// and its part of an auto-spectrum 2 Re(a (b(lambda) - 1/2) + conj(a) (b(conj lambda) - 1/2)) with
// a complex residue a. Minimised over the poles is the sum over signals q and lines of [(S_q -
// model) / S0_q]^2 with S0 the model of the round before: the score of Whittle's likelihood.
// Residues and a straight background for each signal are eliminated (estimation/pole_steps.h).
// Source: Whittle, Ark. Mat. 2 (1953) 423.
#pragma once

#include "signal/estimation/pole_steps.h"

namespace rigfit::signal {

/// Lines and lag window of the spectra of correlations.
struct LagSpectrum {
  LagSpectrum(double rate_hz, Index lags, double low_hz, double high_hz);

  double dt;       ///< s
  double decay;    ///< s of the window, 1/s: it falls to exp(-4) at the last lag
  Index lags;      ///< L
  Index length;    ///< samples of the transform, at least 2 L
  Index first;     ///< line of omega[0]
  VectorXd omega;  ///< rad/s

  /// Sum over k = 0..L of exp(-(s + i w) k dt) R(k), R(0) halved, on `count` lines from `from` on.
  /// R: lags 0..L x columns.
  [[nodiscard]] MatrixXcd half(const Ref<const MatrixXd>& R, Index from, Index count) const;
  /// b(lambda) and, if asked for, its derivative on those lines.
  [[nodiscard]] VectorXcd basis(Complex pole, Index from, Index count,
                                VectorXcd* slope = nullptr) const;
};

/// The auto-spectrum of one mode's filtered signal in the band around the mode.
struct FilteredSpectrum {
  Index from = 0, count = 0;  ///< lines
  VectorXd S;                 ///< count
  VectorXd S0;                ///< set by the fit; weight is 1 / S0
  std::vector<bool> nulled;   ///< by mode: the filter suppresses it
  std::vector<Index> modes;   ///< set by the fit: those that the model has here
  Index moving = 0;           ///< so many of them move; the others' poles are held
};

struct ResonanceFit : PoleStage {
  /// By signal: times a change of S, adds to the gradient.
  std::vector<MatrixXd> to_gradient;
  std::vector<VectorXd> model;  ///< by signal
  VectorXd own_share;           ///< by mode: its part of its signal's S at its frequency

  /// First-order change of the poles for changes of every signal's S.
  [[nodiscard]] VectorXcd change(const std::vector<VectorXd>& of_S) const;
};

/// One signal a mode, in the order of the poles.
[[nodiscard]] ResonanceFit fit_resonances(const LagSpectrum& spectrum,
                                          std::vector<FilteredSpectrum>& signals, VectorXcd poles);

}  // namespace rigfit::signal
