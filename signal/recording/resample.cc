#include "signal/recording/resample.h"

#include <fmt/format.h>
#include <gsl/gsl_interp.h>
#include <gsl/gsl_sf_bessel.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "signal/estimation/robust.h"
#include "signal/recording/clipping.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/time_axis.h"

namespace rigfit::signal {
namespace {
using Eigen::Index;

constexpr double kGap = 3;          // steps of the usual size that count as a gap
constexpr double kStopBand = 1e-4;  // 80 dB
// Pass band's and stop band's edges over the lower rate.
constexpr double kFlat = 0.4, kClosed = 0.5;
constexpr double kMostSamples = 1e9;

RecordingError refusal(const Recording& recording, std::string channel, std::string problem,
                       std::string remedy) {
  return {{recording.path.string(), 0, 0, std::move(channel), ""},
          std::move(problem),
          std::move(remedy)};
}

class Spline {
 public:
  Spline(const Eigen::VectorXd& x, const Eigen::VectorXd& y)
      : x_(x),
        y_(y),
        spline_(gsl_interp_alloc(gsl_interp_cspline, static_cast<std::size_t>(x.size())),
                &gsl_interp_free),
        place_(gsl_interp_accel_alloc(), &gsl_interp_accel_free) {
    gsl_interp_init(spline_.get(), x_.data(), y_.data(), static_cast<std::size_t>(x.size()));
  }
  double at(double t) const {
    return gsl_interp_eval(spline_.get(), x_.data(), y_.data(),
                           std::clamp(t, x_[0], x_[x_.size() - 1]), place_.get());
  }

 private:
  const Eigen::VectorXd &x_, &y_;
  std::unique_ptr<gsl_interp, void (*)(gsl_interp*)> spline_;
  std::unique_ptr<gsl_interp_accel, void (*)(gsl_interp_accel*)> place_;
};

/// rms of the odd samples against the spline through the even ones, and the other way round.
double left_out_error(const Eigen::VectorXd& t, const Eigen::VectorXd& y) {
  double sum = 0;
  Index count = 0;
  for (const Index parity : {0, 1}) {
    const Index kept = (t.size() - parity + 1) / 2;
    if (kept < 4) continue;
    Eigen::VectorXd t_kept(kept), y_kept(kept);
    for (Index k = 0; k < kept; ++k) {
      t_kept[k] = t[2 * k + parity];
      y_kept[k] = y[2 * k + parity];
    }
    const Spline spline(t_kept, y_kept);
    for (Index k = 1 - parity; k < t.size(); k += 2) {
      if (t[k] <= t_kept[0] || t[k] >= t_kept[kept - 1]) continue;
      const double e = y[k] - spline.at(t[k]);
      sum += e * e;
      ++count;
    }
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0;
}

/// Which samples of each channel are clipped, or lean on one that is.
using Masks = std::vector<std::vector<bool>>;

/// Uneven samples at even times of `rate_hz`.
Recording made_even(const Recording& recording, double rate_hz, std::vector<double>& errors,
                    Masks& clipped) {
  const Eigen::VectorXd& t = recording.time_s;
  const Index n = t.size();
  if (!t.allFinite() || !(t.tail(n - 1).array() > t.head(n - 1).array()).all()) {
    throw refusal(recording, "", "the times do not rise throughout",
                  "take out samples whose time goes back or repeats");
  }
  const Eigen::VectorXd steps = t.tail(n - 1) - t.head(n - 1);
  const double usual = median({steps.begin(), steps.end()});
  const double span = t[n - 1] - t[0];
  if (span * rate_hz > kMostSamples) {
    throw refusal(recording, "", fmt::format("{:.3g} samples at that rate", span * rate_hz),
                  "ask for a lower rate");
  }
  Recording even = recording;
  even.time_s.resize(0);
  even.sample_rate_hz = rate_hz;
  even.start_time_s = t[0];
  even.time_jitter_s = 0;
  const auto samples = static_cast<Index>(std::floor(span * rate_hz + 1e-9)) + 1;
  Index in_gaps = 0;
  for (std::size_t c = 0; c < even.channels.size(); ++c) {
    auto& channel = even.channels[c];
    std::vector<bool> mask(static_cast<std::size_t>(samples), false);
    const Eigen::VectorXd y = channel.samples;
    const Spline spline(t, y);
    channel.samples.resize(samples);
    channel.missing_samples = 0;
    in_gaps = 0;
    Index before = 0;
    for (Index k = 0; k < samples; ++k) {
      const double at = t[0] + static_cast<double>(k) / rate_hz;
      while (before + 2 < n && t[before + 1] <= at) ++before;
      const bool gap =
          t[before + 1] - t[before] > kGap * usual && at > t[before] && at < t[before + 1];
      channel.samples[k] = gap ? std::numeric_limits<double>::quiet_NaN() : spline.at(at);
      in_gaps += gap ? 1 : 0;
      const auto j = static_cast<std::size_t>(before);
      mask[static_cast<std::size_t>(k)] = clipped[c][j] || clipped[c][j + 1];
    }
    clipped[c] = std::move(mask);
    channel.missing_samples = static_cast<long>(in_gaps);
    errors.push_back(left_out_error(t, y));
  }
  if (in_gaps > 0) {
    even.notes.push_back({"gaps_left_open",
                          fmt::format("{} samples inside gaps of the times have no value", in_gaps),
                          ""});
  }
  return even;
}

double kaiser(double x, double beta) {
  return std::abs(x) >= 1 ? 0
                          : gsl_sf_bessel_I0(beta * std::sqrt(1 - x * x)) / gsl_sf_bessel_I0(beta);
}

/// Even samples at another rate.
void filter_to(double rate_hz, Recording& recording, Masks& clipped) {
  const double from = recording.sample_rate_hz;
  const double lower = std::min(from, rate_hz);
  const double cut = 0.5 * (kFlat + kClosed) * lower, width = (kClosed - kFlat) * lower;
  const double attenuation = -20 * std::log10(kStopBand);
  const double beta = 0.1102 * (attenuation - 8.7);
  // Kaiser's length of the design.
  const double half_s = 0.5 * (attenuation - 7.95) / (2.285 * 2 * std::numbers::pi * width);
  const Index n = recording.samples();
  const auto samples =
      static_cast<Index>(std::floor(static_cast<double>(n - 1) * rate_hz / from + 1e-9)) + 1;
  std::vector<Eigen::VectorXd> out(recording.channels.size(), Eigen::VectorXd(samples));
  std::vector<double> weights;
  Masks masks(out.size(), std::vector<bool>(static_cast<std::size_t>(samples), false));
  for (Index k = 0; k < samples; ++k) {
    const double t = static_cast<double>(k) / rate_hz;
    const auto first = std::max<Index>(0, static_cast<Index>(std::ceil((t - half_s) * from)));
    const auto last = std::min<Index>(n - 1, static_cast<Index>(std::floor((t + half_s) * from)));
    weights.assign(static_cast<std::size_t>(last - first + 1), 0);
    double sum = 0;
    for (Index j = first; j <= last; ++j) {
      const double d = t - static_cast<double>(j) / from;
      const double x = 2 * std::numbers::pi * cut * d;
      const double w = (std::abs(x) < 1e-12 ? 1 : std::sin(x) / x) * kaiser(d / half_s, beta);
      weights[static_cast<std::size_t>(j - first)] = w;
      sum += w;
      if (std::abs(x) >= std::numbers::pi) continue;  // beside the kernel's main lobe
      for (std::size_t c = 0; c < out.size(); ++c) {
        if (clipped[c][static_cast<std::size_t>(j)]) masks[c][static_cast<std::size_t>(k)] = true;
      }
    }
    const Eigen::Map<const Eigen::VectorXd> kernel(weights.data(),
                                                   static_cast<Index>(weights.size()));
    for (std::size_t c = 0; c < out.size(); ++c) {
      out[c][k] = kernel.dot(recording.channels[c].samples.segment(first, last - first + 1)) / sum;
    }
  }
  for (std::size_t c = 0; c < out.size(); ++c) recording.channels[c].samples = std::move(out[c]);
  clipped = std::move(masks);
  recording.sample_rate_hz = rate_hz;
  recording.notes.push_back(
      {"resampled",
       fmt::format("from {:.9g} Hz to {:.9g} Hz: kept to {:.6g} Hz, nothing above {:.6g} Hz; the "
                   "first and last {:.3g} s lean on fewer samples",
                   from, rate_hz, kFlat * lower, kClosed * lower, half_s),
       ""});
}

/// Takes the values at and beside clipped samples out.
void hide(const Masks& clipped, Recording& recording) {
  for (std::size_t c = 0; c < clipped.size(); ++c) {
    Channel& channel = recording.channels[c];
    long count = 0;
    for (std::size_t k = 0; k < clipped[c].size(); ++k) {
      double& x = channel.samples[static_cast<Index>(k)];
      if (!clipped[c][k] || std::isnan(x)) continue;
      x = std::numeric_limits<double>::quiet_NaN();
      ++count;
    }
    if (count == 0) continue;
    channel.missing_samples += count;
    recording.notes.push_back(
        {"data_left_out", fmt::format("{} samples at or beside clipped ones have no value", count),
         channel.name});
  }
}

}  // namespace

ResampleResult resampled(const Recording& recording, double rate_hz) {
  if (!(recording.sample_rate_hz > 0)) {
    throw refusal(recording, "", "gives no sample rate", "give it: --sample-rate");
  }
  if (recording.samples() < 8) {
    throw refusal(recording, "", "has fewer than 8 samples", "give a longer recording");
  }
  for (const auto& channel : recording.channels) {
    if (!channel.samples.allFinite()) {
      throw refusal(recording, channel.name,
                    fmt::format("{} samples are missing", channel.missing_samples),
                    "take the channel or those lines out");
    }
  }
  ResampleResult result;
  result.from_hz = recording.sample_rate_hz;
  Masks clipped;
  for (const auto& channel : recording.channels) {
    clipped.push_back(clipped_samples(channel.samples, channel.nominal_range).at);
  }
  if (recording.time_s.size() > 0) {
    const Index n = recording.time_s.size();
    const Eigen::VectorXd steps = recording.time_s.tail(n - 1) - recording.time_s.head(n - 1);
    const double usual = median({steps.begin(), steps.end()});
    result.from_hz = usual > 0 ? 1 / usual : recording.sample_rate_hz;
    // At the times' own rate at least: what is lower is filtered from there.
    const double own = round_rate(result.from_hz, 1e-3);
    const double even = rate_hz > own || rate_hz == 0 ? (rate_hz > 0 ? rate_hz : own) : own;
    result.recording = made_even(recording, even, result.error_rms, clipped);
    result.recording.notes.push_back(
        {"assumed",
         fmt::format("uneven times, usual step {:.6g} s, to even ones at {:.9g} Hz by a "
                     "cubic spline",
                     usual, even),
         ""});
    if (rate_hz == 0 || rate_hz == even) {
      hide(clipped, result.recording);
      return result;
    }
    if (result.recording.channels.front().missing_samples > 0) {
      throw refusal(recording, "", "has gaps, across which nothing can be filtered",
                    "resample the parts between the gaps, or ask for the rate of the times");
    }
  } else {
    result.recording = recording;
    if (rate_hz == 0 || rate_hz == recording.sample_rate_hz) {
      result.error_rms.assign(recording.channels.size(), 0);
      return result;
    }
    if (recording.duration_s() * rate_hz > kMostSamples) {
      throw refusal(recording, "", "would have too many samples at that rate",
                    "ask for a lower rate");
    }
    result.error_rms.assign(recording.channels.size(), 0);
  }
  if (static_cast<double>(result.recording.samples() - 1) * rate_hz <
      7 * result.recording.sample_rate_hz) {
    throw refusal(recording, "", "would have fewer than 8 samples at that rate",
                  "ask for a higher rate");
  }
  for (std::size_t c = 0; c < recording.channels.size(); ++c) {
    const auto& x = result.recording.channels[c].samples;
    const double rms = std::sqrt(x.squaredNorm() / static_cast<double>(x.size()));
    result.error_rms[c] = std::hypot(result.error_rms[c], kStopBand * rms);
  }
  filter_to(rate_hz, result.recording, clipped);
  hide(clipped, result.recording);
  return result;
}

}  // namespace rigfit::signal
