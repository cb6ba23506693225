// Averaged frequency response functions of one input from hits, with coherence and error bars.
//
// With X_i, Y_i the transforms of force and response of hit i, sums over n hits
//   Gxx = sum |X|^2, Gyy = sum |Y|^2, Gxy = sum conj(X) Y:
//   H1 = Gxy / Gxx (noise on the response), H2 = Gyy / conj(Gxy) (noise on the force),
//   Hv = (Gxy / |Gxy|) sqrt(Gyy / Gxx) (noise shared in proportion; the geometric mean),
//   coherence g2 = |Gxy|^2 / (Gxx Gyy),
// and with e = Y - H1 X of each hit, h = |X|^2 / Gxx its leverage, the random error
//   std(Re H) = std(Im H) = sqrt(sum |X|^2 |e|^2 / (1 - h) / 2) / Gxx,
// which holds for noise that differs between hits or grows with them (White, Econometrica 48 (1980)
// 817; HC2 of MacKinnon and White, J. Econometrics 29 (1985) 305). Where it is the same in all it
// is that of Bendat and Piersol (Random Data, 4th ed., sec. 9.2) with n - 1 in place of n: the
// residual power Gyy (1 - g2) of n hits has n - 1 complex degrees of freedom.
// Noise on the force with mean power P per hit (force_noise.h) adds n P to Gxx and nothing to Gxy:
// H1 uses Gxx - n P, which is free of that bias (Bendat and Piersol, sec. 9.1). At most three
// quarters of Gxx are subtracted: with more noise a line carries no information. Tones (mains hum)
// are not subtracted: over a few hits their cross product with the force does not vanish.
// Transforms are unscaled sums over the block; the ratio needs no scale. A window shared by force
// and response changes no amplitude: see window.h. A ring-down that is cut at the end of the block
// (no window) leaves the poles in place but scales each mode's residue by 1 - exp(p T), p its pole
// and T from the hit to the end. The noise power is averaged over ten lines on either side before
// it becomes an error bar: noise spectra are smooth, and an error bar from few hits alone scatters
// by 1 / (2 sqrt(n - 1)). Under an exponential window neighbouring lines share their noise; the
// width grows by the window's noise bandwidth. Where the average over two lines on either side
// exceeds the wide one beyond chance, as when modes still ring from the previous hit, it is used.
// Where the noise before the hit is known, the part that enters through the force (it peaks where
// |H| does) gives the shape that is scaled.
#pragma once

#include "signal/spectra/force_noise.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

enum class FrfEstimator { h1, h2, hv };
[[nodiscard]] const char* name_of(FrfEstimator estimator);

struct FrfOptions {
  FrfEstimator estimator = FrfEstimator::h1;
  double sample_rate_hz = 0;
  Index block_samples = 0;
  /// Rate a of the window exp(-a t) on force and response; 0: none.
  double exponential_decay_rate_1_s = 0;
  Index by_hit_lines = 0;  ///< lines in `FrfSet::by_hit`; 0: not filled
};

/// Names of points, form, unit, rate, pre-trigger and impulses are left empty; one hit has no
/// coherence (it would be 1).
struct FrfEstimate : FrfSet {
  VectorXd force_power;  ///< mean |X|^2 per hit, unscaled, by line
  VectorXd force_noise;  ///< its part that is noise, by line; empty: unknown
  /// Part of the response power (all responses, each relative to its own) not explained by the
  /// force, per degree of freedom, where the force is within 20 dB of its maximum. 0 and empty for
  /// fewer than three hits.
  double incoherence = 0;
  VectorXd incoherence_without;  ///< `incoherence` without hit i
};

/// All blocks have the same responses (without any, only `force_power` and `force_noise` are
/// filled). One block (n = 1) gives no coherence, and error bars only when the noise is known. A
/// line without force or response gives H = 0, never NaN.
[[nodiscard]] FrfEstimate average_frfs(std::span<const FrfBlock> blocks, const FrfOptions& options);

}  // namespace rigfit::signal
