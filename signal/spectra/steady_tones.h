// Tones of constant amplitude (mains hum, a machine) among the peaks of a random vibration.
//
// The complex amplitude z of a resonance that noise drives wanders: its power |z|^2 changes by its
// own size within 1 / (2 pi B), B the half-power bandwidth. A tone's does not. Over 16 blocks of
// the record, each under a Hann window, with A^2 the mean power less that of the noise n beside the
// line,
//
//   v = var |z|^2 / A^4;   a tone: v = (2 A^2 n + n^2) / A^4
//
// and for a resonance with u = 2 pi B T, T the record's length, v is that of a random walk about
// its mean for small u (Cramer and von Mises' distribution, 2 u omega^2; exceeded in 99.9 % of
// records: omega^2 = 0.0174), and 0.2 or more for 16 independent powers; for a free decay it is
// u^2 / 12. A line is a tone when v is below half of the smallest of these for a damping ratio of
// 1e-4, which is lower than that of cables. Where v is no larger than a tone's but not below this
// limit, the record cannot tell tone and resonance apart.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace rigfit::signal {

enum class LineNature {
  varies,     ///< its power changes more than a tone's
  undecided,  ///< a tone or, in so short a record, a lightly damped resonance
  steady      ///< a tone
};

struct SteadyTone {
  double frequency_hz = 0;
  double amplitude = 0;  ///< in the unit of the samples
  double variation = 0;  ///< v
  double limit = 0;      ///< v that a resonance exceeds in 99.9 % of records
  /// Distance within which everything belongs to a tone whose frequency varies (a single sinusoid
  /// leaves 5 % or more of its power), so that modes there cannot be seen. 0: a constant tone.
  double reach_hz = 0;
};

/// Twice the resolution of a block, Hz: closer to a tone, a mode and the tone's remainder look
/// alike.
[[nodiscard]] double tone_resolution_hz(double samples, double sample_rate_hz);

/// Nature of a spectral line, with its `measures`; `varies` where a block holds fewer than 8 of its
/// periods.
[[nodiscard]] LineNature nature_of_line(const Eigen::Ref<const Eigen::VectorXd>& samples,
                                        double sample_rate_hz, double frequency_hz,
                                        SteadyTone& measures);

/// Steady tones, strongest first, among the periodogram's lines that exceed their neighbours by
/// what noise shows once in a thousand records; and the samples without these tones (least squares
/// over frequency, amplitude and phase). Needs at least 256 finite `samples`.
struct TonesRemoved {
  std::vector<SteadyTone> tones;
  Eigen::VectorXd samples;
};
[[nodiscard]] TonesRemoved remove_steady_tones(const Eigen::Ref<const Eigen::VectorXd>& samples,
                                               double sample_rate_hz, double low_hz,
                                               double high_hz);

}  // namespace rigfit::signal
