// The channels of a recording of ambient motion, read in blocks: less their means and the tones
// taken out, over their standard deviations, 0 where any channel misses a sample. Nothing is
// copied: a day of many channels is held once, by the recording, which has to outlive this.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "signal/recording/recording.h"

namespace rigfit::signal {

class AmbientSignals {
 public:
  /// Throws RecordingError when there is no constant sample rate, or a channel is constant or
  /// misses more than half of its samples.
  AmbientSignals(const Recording& recording, const std::vector<Eigen::Index>& channels);

  [[nodiscard]] Eigen::Index samples() const { return samples_; }
  [[nodiscard]] Eigen::Index channels() const { return static_cast<Eigen::Index>(x_.size()); }
  [[nodiscard]] double rate_hz() const { return rate_hz_; }
  [[nodiscard]] bool complete() const { return gaps_.empty(); }
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

  /// Takes Re(amplitude exp(i omega n)), n the sample, out of every channel: one amplitude each.
  void subtract(double omega, const Eigen::VectorXcd& amplitude) {
    tones_.emplace_back(omega, amplitude);
  }

 private:
  void blank(Eigen::Index first, Eigen::Ref<Eigen::VectorXd> samples) const;

  std::vector<const Eigen::VectorXd*> x_;
  Eigen::Index samples_ = 0;
  double rate_hz_ = 0, present_ = 1;
  Eigen::VectorXd mean_, scale_;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> gaps_;  ///< first, end
  std::vector<std::pair<double, Eigen::VectorXcd>> tones_;
};

}  // namespace rigfit::signal
