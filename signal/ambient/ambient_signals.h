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
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "signal/ambient/ambient_result.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

class AmbientSignals {
 public:
  /// `low_hz`: where the band begins. Throws RecordingError when there is no constant sample rate,
  /// or a channel is constant or misses more than half of its samples.
  AmbientSignals(const Recording& recording, const std::vector<Eigen::Index>& channels,
                 double low_hz);

  [[nodiscard]] Eigen::Index samples() const { return samples_; }
  [[nodiscard]] Eigen::Index channels() const { return static_cast<Eigen::Index>(x_.size()); }
  [[nodiscard]] double rate_hz() const { return rate_hz_; }
  /// Share of the samples that all channels have.
  [[nodiscard]] double present() const { return present_; }
  /// Standard deviations: units of the channels for 1 of a block.
  [[nodiscard]] const Eigen::VectorXd& scale() const { return scale_; }

  /// Samples first .. first + size - 1 of a channel; 0 outside of the recording.
  void read(Eigen::Index channel, Eigen::Index first, Eigen::Ref<Eigen::VectorXd> samples) const;
  /// All channels: count x channels.
  [[nodiscard]] Eigen::MatrixXd block(Eigen::Index first, Eigen::Index count) const;
  /// 1 where all channels have a sample, else 0.
  [[nodiscard]] Eigen::MatrixXd mask(Eigen::Index first, Eigen::Index count) const;

  /// Takes tones of low_hz .. high_hz out, the strongest 40 at most; gives them by rising
  /// frequency.
  std::vector<AmbientTone> take_out_tones(double low_hz, double high_hz);

 private:
  void blank(Eigen::Index first, Eigen::Ref<Eigen::VectorXd> samples) const;
  void find_drift(double low_hz);

  std::vector<const Eigen::VectorXd*> x_;
  Eigen::Index samples_ = 0;
  double rate_hz_ = 0, present_ = 1;
  Eigen::VectorXd scale_;
  Eigen::MatrixXd drift_;        ///< knots x channels, from one knot before the first sample
  Eigen::Index knot_apart_ = 1;  ///< samples
  std::vector<std::pair<Eigen::Index, Eigen::Index>> gaps_;  ///< first, end
  std::vector<std::pair<double, Eigen::VectorXcd>> tones_;   ///< omega, amplitudes
};

}  // namespace rigfit::signal
