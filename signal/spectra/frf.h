// Averaged frequency response functions of one input from hits, with coherence and error bars.
//
// With X_i, Y_i the transforms of force and response of hit i, sums over n hits
//   Gxx = sum |X|^2, Gyy = sum |Y|^2, Gxy = sum conj(X) Y:
//   H1 = Gxy / Gxx (noise on the response), H2 = Gyy / conj(Gxy) (noise on the force),
//   Hv = (Gxy / |Gxy|) sqrt(Gyy / Gxx) (noise shared in proportion; the geometric mean),
//   coherence g2 = |Gxy|^2 / (Gxx Gyy), and the random error (Bendat and Piersol, Random Data, 4th
//   ed., sec. 9.2) std(|H|) = |H| sqrt((1 - g2) / (2 n g2)), here with n - 1 in place of n: the
//   residual power Gyy (1 - g2) of n hits has n - 1 complex degrees of freedom, and std(Re H) =
//   std(Im H) = sqrt(Gyy (1 - g2) / (2 (n - 1) Gxx)) is then free of bias from n = 2 on.
// Noise on the force with mean power P per hit (force_noise.h) adds n P to Gxx and nothing to Gxy:
// H1 uses Gxx - n P, which is free of that bias (Bendat and Piersol, sec. 9.1), unless
// `subtract_force_noise` is off. At most three quarters of Gxx are subtracted: with more noise a
// line carries no information. Tones (mains hum) are not subtracted: over a few hits their cross
// product with the force does not vanish. Transforms are unscaled sums over the block; the ratio
// needs no scale. A window shared by force and response changes no amplitude: see window.h. A
// ring-down that is cut at the end of the block (no window) leaves the poles in place but scales
// each mode's residue by 1 - exp(p T), p its pole and T from the hit to the end.
#pragma once

#include <span>

#include "signal/spectra/frf_estimate.h"

namespace rigfit::signal {

/// All blocks have the same responses (without any, only `force_power` and `force_noise` are
/// filled). One block (n = 1) gives no coherence, and error bars only when the noise is known. A
/// line without force or response gives H = 0, never NaN.
[[nodiscard]] FrfEstimate average_frfs(std::span<const FrfBlock> blocks, const FrfOptions& options);

}  // namespace rigfit::signal
