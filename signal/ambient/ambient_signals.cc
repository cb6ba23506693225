#include "signal/ambient/ambient_signals.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "signal/numerics/power_sums.h"
#include "signal/recording/recording_error.h"

namespace rigfit::signal {

using Eigen::Index;
using Eigen::VectorXd;

AmbientSignals::AmbientSignals(const Recording& recording, const std::vector<Index>& channels)
    : samples_(recording.samples()), rate_hz_(recording.sample_rate_hz) {
  const std::string file = recording.path.string();
  if (!(rate_hz_ > 0) || recording.time_s.size() > 0) {
    throw RecordingError({file},
                         "the samples are not evenly spaced in time, or their rate is unknown",
                         "resample it (rigfit resample), or state the sample rate");
  }
  for (const Index c : channels) {
    x_.push_back(&recording.channels[static_cast<std::size_t>(c)].samples);
  }
  Index missing = 0;
  for (Index i = 0; i < samples_; ++i) {
    const bool gap = std::any_of(x_.begin(), x_.end(),
                                 [&](const VectorXd* x) { return !std::isfinite((*x)[i]); });
    if (!gap) continue;
    if (gaps_.empty() || gaps_.back().second < i) gaps_.emplace_back(i, i);
    ++gaps_.back().second, ++missing;
  }
  const double count = static_cast<double>(samples_ - missing);
  present_ = samples_ > 0 ? count / static_cast<double>(samples_) : 0;
  if (present_ < 0.5) {
    throw RecordingError({file}, "at less than half of the times all channels have a sample",
                         "leave out the channels that miss samples");
  }
  mean_ = VectorXd::Zero(this->channels());
  scale_ = VectorXd::Ones(this->channels());
  VectorXd samples(samples_);
  for (Index c = 0; c < this->channels(); ++c) {
    read(c, 0, samples);
    mean_[c] = samples.sum() / count;
    read(c, 0, samples);
    scale_[c] = samples.norm() / std::sqrt(count);
    if (!(scale_[c] > 1e-12 * std::abs(mean_[c]))) {
      const auto& name = recording.channels[static_cast<std::size_t>(channels[c])].name;
      throw RecordingError({file, 0, 0, name}, "the channel is constant", "leave it out");
    }
  }
}

void AmbientSignals::blank(Index first, Eigen::Ref<VectorXd> samples) const {
  const Index size = samples.size(), end = first + size;
  samples.head(std::clamp<Index>(-first, 0, size)).setZero();
  samples.tail(std::clamp<Index>(end - samples_, 0, size)).setZero();
  for (const auto& [from, to] : gaps_) {
    const Index a = std::max(from, first), b = std::min(to, end);
    if (a < b) samples.segment(a - first, b - a).setZero();
  }
}

void AmbientSignals::read(Index channel, Index first, Eigen::Ref<VectorXd> samples) const {
  const VectorXd& x = *x_[static_cast<std::size_t>(channel)];
  const Index a = std::clamp<Index>(-first, 0, samples.size());
  const Index b = std::clamp<Index>(samples_ - first, a, samples.size());
  samples.segment(a, b - a) = x.segment(first + a, b - a).array() - mean_[channel];
  samples.segment(a, b - a) /= scale_[channel];
  for (const auto& [omega, amplitude] : tones_) {
    const auto begins =
        amplitude[channel] * std::polar(1.0, omega * static_cast<double>(first + a));
    samples.segment(a, b - a) -= (begins * powers({0, omega}, b - a)).real().matrix();
  }
  blank(first, samples);
}

Eigen::MatrixXd AmbientSignals::block(Index first, Index count) const {
  Eigen::MatrixXd result(count, channels());
  for (Index c = 0; c < channels(); ++c) read(c, first, result.col(c));
  return result;
}

Eigen::MatrixXd AmbientSignals::mask(Index first, Index count) const {
  VectorXd result = VectorXd::Ones(count);
  blank(first, result);
  return result;
}

}  // namespace rigfit::signal
