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
// records: omega^2 = 0.0174), and 0.2 or more for 16 independent powers; for a decay that nothing
// drives u^2 /
// 12. Half of the least of a damping ratio of 1e-4, lower than cables have, is the limit below
// which a line is a tone. Where v is no larger than a tone's but the limit is lower still, the
// record cannot tell them apart.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace rigfit::signal {

enum class LineNature {
  varies,     ///< its power changes as that of no tone
  undecided,  ///< as steady as a tone, and as a resonance of little damping may be in this record
  steady      ///< a tone
};

struct SteadyTone {
  double frequency_hz = 0;
  double amplitude = 0;  ///< in the unit of the samples
  double variation = 0;  ///< v
  double limit = 0;      ///< v below which no resonance is, in 99.9 % of records
  /// What lies nearer to the tone is its own where its frequency wanders (a twentieth of its power
  /// or more is left by one sinusoid; a resonance below it leaves less): modes there are not seen.
  /// Else 0.
  double reach_hz = 0;
};

/// Twice the resolution of a block, Hz: nearer to a tone its remainder cannot be told from a mode.
[[nodiscard]] double tone_resolution_hz(double samples, double sample_rate_hz);

/// What a line of a record is, with its measures; `varies` where fewer than 8 of its periods are in
/// a block.
[[nodiscard]] LineNature nature_of_line(const Eigen::Ref<const Eigen::VectorXd>& samples,
                                        double sample_rate_hz, double frequency_hz,
                                        SteadyTone& measures);

/// Steady tones in lines of the record's own periodogram that stand out of their neighbours by what
/// noise shows once in a thousand records, strongest first, and the samples without them (least
/// squares over frequency, amplitude and phase). `samples`: finite, at least 256.
struct TonesRemoved {
  std::vector<SteadyTone> tones;
  Eigen::VectorXd samples;
};
[[nodiscard]] TonesRemoved remove_steady_tones(const Eigen::Ref<const Eigen::VectorXd>& samples,
                                               double sample_rate_hz, double low_hz,
                                               double high_hz);

}  // namespace rigfit::signal
