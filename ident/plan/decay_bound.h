// Bounds how well one record of a free decay determines a mode's pole, and the decay's amplitude
// after a hammer hit.
//
//   y(t) = Re(C exp((-a + i w) t)) + e,   0 <= t <= T, fs samples a second, e white of std s
//   var(w) = var(a) = 2 s^2 / (fs |C|^2 (I2 - I1^2 / I0)),   I_k = int_0^T t^k exp(-2 a t) dt
//
// is the Cramer-Rao bound with C unknown, for a mode that is apart from others by more than its
// width and has many periods in T. With x = 2 a T,
//   I2 - I1^2 / I0 = I0 T^2 (1 / x^2 - 1 / (4 sinh^2(x / 2))),   I0 = T (1 - exp(-x)) / x,
// which gives 16 s^2 a^3 / (fs |C|^2) for a long record and 24 s^2 / (fs |C|^2 T^3) without
// damping. Informations of independent records, hits and sensors add up.
// Sources: Yao and Pandit, IEEE Trans. Signal Process. 43 (1995) 878; Rife and Boorstyn, IEEE
// Trans. Inf. Theory 20 (1974) 591.
#pragma once

namespace rigfit::ident {

struct DecayInformation {
  double pole = 0;    ///< 1 / var(w) = 1 / var(a), s^2
  double energy = 0;  ///< sum of the decay's squared samples over s^2
};

/// `signal_to_noise`: |C| / s. `decay_rate_1_s`: a >= 0. `duration_s`: T > 0. `rate_hz`: fs.
[[nodiscard]] DecayInformation decay_information(double signal_to_noise, double decay_rate_1_s,
                                                 double duration_s, double rate_hz);

/// Magnitude of the Fourier transform of a half-sine pulse, N s:
/// 2 P tau / pi |cos(w tau / 2)| / |1 - (w tau / pi)^2|, P its peak (N), tau its duration (s).
[[nodiscard]] double half_sine_impulse(double peak, double duration_s, double omega);

}  // namespace rigfit::ident
