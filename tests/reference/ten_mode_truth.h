// An impact test whose answer is known exactly: ten modes, twenty accelerometers, hammer hits in
// one continuous record, as a logger with anti-alias filters would write it.
//
// Structure: mass-normalised real modes, receptance
//   alpha_jk(s) = sum_r phi_jr phi_kr / (s^2 + 2 zeta_r w_r s + w_r^2),   accelerance s^2 alpha(s).
// Hits: half sines F sin(pi t / T). Every channel passes the same Butterworth low-pass G(s). Force
// and acceleration are samples of the continuous signals: G(s) and s^2 alpha(s) G(s) are sums of
// simple poles, and the convolution of exp(p t) with a half sine is known in closed form. Nothing
// is integrated numerically, nothing aliases above 5e-6 of the channel's content in the band.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "signal/recording/recording.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::testing {

struct TenModeTruth {
  Eigen::VectorXd frequency_hz;   ///< undamped, rising
  Eigen::VectorXd damping_ratio;  ///< 0.0025 to 0.01
  Eigen::MatrixXd shapes;         ///< responses x modes, kg^-1/2
  Eigen::Index driving_point = 0;

  /// Upper poles -zeta w + i w sqrt(1 - zeta^2), rad/s.
  [[nodiscard]] Eigen::VectorXcd poles() const;
  /// Receptance residues of the upper poles, responses x modes: phi_jr phi_kr / (2 i w_d).
  [[nodiscard]] Eigen::MatrixXcd residues() const;
  /// Exact accelerance at s = i 2 pi f + decay_rate, lines x responses; `decay_rate_1_s` is that of
  /// an exponential window shared by force and response.
  [[nodiscard]] Eigen::MatrixXcd accelerance(const Eigen::VectorXd& lines_hz,
                                             double decay_rate_1_s = 0) const;
  /// The same as an FrfSet without error bars; responses "a1".."a20", input at the driving point.
  [[nodiscard]] signal::FrfSet frfs(const Eigen::VectorXd& lines_hz,
                                    double decay_rate_1_s = 0) const;
};

/// 25, 68, 132, 221, 312, 318, 437, 590, 905, 1240 Hz; damping falling from 1 % to 0.25 %.
[[nodiscard]] TenModeTruth ten_mode_truth(Eigen::Index responses = 20);

struct HammerHit {
  double time_s = 0;  ///< start of contact
  double peak = 100;  ///< N
  double duration_s = 0.6e-3;
};

struct ImpactRecordOptions {
  double sample_rate_hz = 8192;
  Eigen::Index block_samples = 32768;  ///< at least this much after each hit
  int hits = 5;
  double noise = 0.005;        ///< std of white Gaussian noise over the noise-free channel's rms
  bool noise_of_peak = false;  ///< over the channel's largest absolute value instead
  std::uint64_t seed = 1;      ///< times, peaks, durations and noise
  double filter_hz = 2500;     ///< Butterworth cut-off of every channel
  int filter_order = 10;
  double force_sign = 1;
  double offset = 0;  ///< added to every channel, of its rms
  /// Ringing of the hammer's own force signal: peak relative to the hit, frequency and damping.
  double ringing = 0;
  double ringing_hz = 1800;
  double ringing_damping = 0.04;
};

/// The hits that a seed gives: peaks 70 to 130 N, durations 0.55 to 0.65 ms, spaced by the block
/// and up to 0.3 s.
[[nodiscard]] std::vector<HammerHit> hammer_hits(const ImpactRecordOptions& options);

/// Force channel "force" (N) and accelerations "a1".. (m/s^2). Second contacts are hits like
/// others: add them to `hits`.
[[nodiscard]] signal::Recording impact_recording(const TenModeTruth& truth,
                                                 const std::vector<HammerHit>& hits,
                                                 const ImpactRecordOptions& options,
                                                 std::optional<double> duration_s = {});
[[nodiscard]] inline signal::Recording impact_recording(const TenModeTruth& truth,
                                                        const ImpactRecordOptions& options = {}) {
  return impact_recording(truth, hammer_hits(options), options);
}

}  // namespace rigfit::testing
