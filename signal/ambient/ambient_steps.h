// The steps of ambient modes: signals without drift and tones (ambient_signals.cc), candidates
// (ambient_candidates.cc), the fit of their poles (resonance_fit.cc).
#pragma once

#include "signal/ambient/ambient_modes.h"
#include "signal/estimation/pole_steps.h"
#include "signal/poles/pole_clusters.h"

namespace rigfit::signal {

// The channels of a recording of ambient motion, read in blocks: less their drift and the tones
// taken out, over their standard deviations, 0 where any channel misses a sample. No samples are
// copied: a day of many channels is held once, by the recording, which has to outlive this.
//
// The drift is the value in the middle of straight lines fitted to 6 / low_hz s under Hann's window
// squared, which pass nothing from low_hz / 2 on (-47 dB). It is held at a sixteenth of half the
// window, and cubic between (Catmull and Rom).
//
// Steady sinusoids (hum, machines) are found, fitted and taken out.
//
// A line k of the Hann-windowed transform of the whole recording is tested against the lines 3 to
// 14 beside it, in every channel: F = P_k / mean P. The 24 Hann lines count as 12 independent ones
// of two degrees of freedom each, so that noise exceeds F with the chance (1 + F / 12)^-12. One
// frequency and an amplitude and phase for each channel are fitted to the lines near k. It is a
// tone only when the lines within 2 of it then fall to the level of their neighbours: a narrow mode
// keeps its lines. The amplitude is constant over the recording; a machine whose speed drifts by
// more than a line spacing stays.
//
// Correlations of the signals with linear combinations of them, by groups of the recording:
//
//   R_g(k) = 1 / N(k) sum over t in group g of y(t + k) x(t)^T,   -L <= k <= L,   x = F^T y
//
// with N(k) the number of products of all groups. A product belongs to the group of t, and y is
// read over the group's edges: the groups add up to the mean over the recording exactly, which has
// no bias of a window or of leakage. Missing samples are missing products, which N(k) does not
// count. Computed by transforms of segments, whose cross-spectra are added up before they go back
// to lags.

class AmbientSignals {
 public:
  /// `low_hz`: where the band begins. Throws RecordingError when there is no constant sample rate,
  /// or a channel is constant or misses more than half of its samples.
  AmbientSignals(const Recording& recording, const std::vector<Index>& channels, double low_hz);

  [[nodiscard]] Index samples() const { return samples_; }
  [[nodiscard]] Index channels() const { return static_cast<Index>(x_.size()); }
  [[nodiscard]] double rate_hz() const { return rate_hz_; }
  /// Share of the samples that all channels have.
  [[nodiscard]] double present() const { return present_; }
  /// Standard deviations: units of the channels for 1 of a block.
  [[nodiscard]] const VectorXd& scale() const { return scale_; }

  /// Samples first .. first + size - 1 of a channel; 0 outside of the recording.
  void read(Index channel, Index first, Ref<VectorXd> samples) const;
  /// All channels: count x channels.
  [[nodiscard]] MatrixXd block(Index first, Index count) const;
  /// 1 where all channels have a sample, else 0.
  [[nodiscard]] MatrixXd mask(Index first, Index count) const;

  /// Takes tones of low_hz .. high_hz out, the strongest 40 at most; gives them by rising
  /// frequency.
  std::vector<AmbientTone> take_out_tones(double low_hz, double high_hz);

 private:
  void blank(Index first, Ref<VectorXd> samples) const;
  void find_drift(double low_hz);

  std::vector<const VectorXd*> x_;
  Index samples_ = 0;
  double rate_hz_ = 0, present_ = 1;
  VectorXd scale_;
  MatrixXd drift_;        ///< knots x channels, from one knot before the first sample
  Index knot_apart_ = 1;  ///< samples
  std::vector<std::pair<Index, Index>> gaps_;        ///< first, end
  std::vector<std::pair<double, VectorXcd>> tones_;  ///< omega, amplitudes
};

/// `receive` gets R_g of all channels with the `filters` (channels x signals) for every group in
/// turn: (2 L + 1) x (channels signals), column signal * channels + channel.
void group_correlations(const AmbientSignals& signals, const MatrixXd& filters, Index lags,
                        int groups, int threads,
                        const std::function<void(int group, const MatrixXd& R)>& receive);

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

// Candidates of modes from half spectra of the correlations of all channels with a few references:
// LSCF over orders, clusters of poles and participation vectors, shapes from the residues.

/// A band needs as many: a pole, a residue and a line have six parameters.
inline constexpr Index kFewestLines = 8;

/// `shape` at length 1, turned to be as real as it can be.
[[nodiscard]] VectorXcd phase_real(VectorXcd shape);

struct AmbientCandidates {
  std::optional<LagSpectrum> spectrum;  ///< its lags follow from the narrowest candidate
  MatrixXcd pairs;  ///< half spectra of all pairs: lines x channels^2; column j n + i: y_i x_j
  VectorXcd poles;  ///< by rising frequency, window taken off; none: nothing stands out
  VectorXd presence;
  MatrixXcd shapes;  ///< channels x candidates, of the scaled channels
};

/// `result`: has the band, gets the stabilisation diagram and the longest lag.
[[nodiscard]] AmbientCandidates find_candidates(const AmbientSignals& signals,
                                                const AmbientOptions& options,
                                                AmbientResult& result,
                                                std::vector<Index> references);

}  // namespace rigfit::signal
