#include "signal/recording/resample.h"

#include <gsl/gsl_spline.h>

#include <memory>

#include "signal/estimation/robust.h"
#include "signal/numerics/low_pass.h"
#include "signal/recording/clipping.h"
#include "signal/recording/recording_time.h"

namespace rigfit::signal {
namespace {

constexpr double kGap = 3;          // steps of the usual size that count as a gap
constexpr double kStopBand = 1e-4;  // 80 dB
// Pass band's and stop band's edges over the lower rate.
constexpr double kFlat = 0.4, kClosed = 0.5;

void check_size(const Recording& recording, double rate_hz) {
  constexpr double kMostSamples = 1e9;
  if (const double samples = recording.duration_s() * rate_hz; samples > kMostSamples) {
    throw file_error(recording.path, fmt::format("would have {:.3g} samples at that rate", samples),
                     "ask for a lower rate");
  }
}

/// The cubic spline of natural ends through y(x) at other places; beyond the ends as there.
VectorXd splined(const VectorXd& x, const VectorXd& y, const VectorXd& at) {
  const auto n = static_cast<std::size_t>(x.size());
  const std::unique_ptr<gsl_spline, void (*)(gsl_spline*)> spline(
      gsl_spline_alloc(gsl_interp_cspline, n), &gsl_spline_free);
  gsl_spline_init(spline.get(), x.data(), y.data(), n);
  return at.unaryExpr([&](double t) {
    return gsl_spline_eval(spline.get(), std::clamp(t, x[0], x[x.size() - 1]), nullptr);
  });
}

/// rms of every second sample against the spline through the others.
double left_out_error(const VectorXd& t, const VectorXd& y) {
  const auto kept = Eigen::seq(0, Eigen::last, 2);
  const auto between = Eigen::seqN(1, (t.size() - 1) / 2, 2);
  const VectorXd left = y(between) - splined(t(kept), y(kept), t(between));
  return std::sqrt(left.squaredNorm() / static_cast<double>(left.size()));
}

/// Uneven samples, whose times rise, at even times of `rate_hz`.
Recording made_even(const Recording& recording, double rate_hz,
                    std::vector<ResampledChannel>& channels) {
  const VectorXd& t = recording.time_s;
  Recording even = recording;
  even.time_s.resize(0);
  even.sample_rate_hz = rate_hz;
  even.start_time_s = t[0];
  even.time_jitter_s = 0;
  const auto samples = static_cast<Index>(std::floor(recording.duration_s() * rate_hz + 1e-9)) + 1;
  const auto at = VectorXd::NullaryExpr(samples, [&](Index k) {
                    return t[0] + static_cast<double>(k) / rate_hz;
                  }).eval();
  for (std::size_t c = 0; c < channels.size(); ++c) {
    auto& channel = even.channels[c];
    channels[c].error_rms = left_out_error(t, channel.samples);
    channel.samples = splined(t, channel.samples, at);
  }
  return even;
}

/// Even samples at another rate.
void filter_to(double rate_hz, Recording& recording) {
  const double from = recording.sample_rate_hz;
  const double lower = std::min(from, rate_hz);
  const LowPass filter(kFlat * lower, kClosed * lower, -20 * std::log10(kStopBand));
  const double half_s = filter.half_length();
  const Index n = recording.samples();
  const auto samples =
      static_cast<Index>(std::floor(static_cast<double>(n - 1) * rate_hz / from + 1e-9)) + 1;
  std::vector<VectorXd> out(recording.channels.size(), VectorXd(samples));
  for (Index k = 0; k < samples; ++k) {
    const double t = static_cast<double>(k) / rate_hz;
    const auto first = std::max<Index>(0, static_cast<Index>(std::ceil((t - half_s) * from)));
    const auto last = std::min<Index>(n - 1, static_cast<Index>(std::floor((t + half_s) * from)));
    const auto kernel = VectorXd::NullaryExpr(last - first + 1, [&](Index j) {
                          return filter.at(t - static_cast<double>(first + j) / from);
                        }).eval();
    for (std::size_t c = 0; c < out.size(); ++c) {
      out[c][k] =
          kernel.dot(recording.channels[c].samples.segment(first, kernel.size())) / kernel.sum();
    }
  }
  for (std::size_t c = 0; c < out.size(); ++c) recording.channels[c].samples = std::move(out[c]);
  recording.sample_rate_hz = rate_hz;
  add_note(recording.notes, "resampled", "",
           "from {:.9g} Hz to {:.9g} Hz: kept to {:.6g} Hz, nothing above {:.6g} Hz; the first and "
           "last {:.3g} s lean on fewer samples",
           from, rate_hz, kFlat * lower, kClosed * lower, half_s);
}

}  // namespace

ResampleResult resampled(const Recording& recording, double rate_hz) {
  if (!(recording.sample_rate_hz > 0)) {
    throw file_error(recording.path, "gives no sample rate", "give it: --sample-rate");
  }
  if (recording.samples() < 8) {
    throw file_error(recording.path, "has fewer than 8 samples", "give a longer recording");
  }
  for (const auto& channel : recording.channels) {
    const long missing = channel.samples.array().isNaN().count();
    const long clipped =
        missing > 0 ? 0 : clipped_samples(channel.samples, channel.nominal_range).count;
    if (missing + clipped == 0) continue;
    throw RecordingError(
        {recording.path.string(), 0, 0, channel.name},
        fmt::format("{} samples are {}", missing + clipped, missing > 0 ? "missing" : "clipped"),
        "take the channel or those lines out");
  }
  ResampleResult result{recording, recording.sample_rate_hz, {}};
  for (const auto& one : recording.channels) result.channels.push_back({one.name, one.unit, 0});
  if (const Index n = recording.time_s.size(); n > 0) {
    const VectorXd steps = recording.time_s.tail(n - 1) - recording.time_s.head(n - 1);
    const double usual = median({steps.begin(), steps.end()});
    if (usual > 0) result.from_hz = 1 / usual;
    // At the times' own rate at least: what is lower is filtered from there.
    const double even = std::max(round_rate(result.from_hz, 1e-3), rate_hz);
    if (steps.maxCoeff() > kGap * usual) {
      throw file_error(recording.path, "has gaps in its times, across which nothing is known",
                       "resample the parts between the gaps");
    }
    if (!(steps.array() > 0).all()) {
      throw file_error(recording.path, "the times do not rise throughout",
                       "take out samples whose time goes back or repeats");
    }
    check_size(recording, even);
    result.recording = made_even(recording, even, result.channels);
    add_note(result.recording.notes, "assumed", "",
             "uneven times, usual step {:.6g} s, to even ones at {:.9g} Hz by a cubic spline",
             usual, even);
    if (rate_hz == 0) rate_hz = even;
  } else {
    if (rate_hz == 0 || rate_hz == recording.sample_rate_hz) return result;
    check_size(recording, rate_hz);
  }
  if (rate_hz != result.recording.sample_rate_hz) {
    if (static_cast<double>(result.recording.samples() - 1) * rate_hz <
        7 * result.recording.sample_rate_hz) {
      throw file_error(recording.path, "would have fewer than 8 samples at that rate",
                       "ask for a higher rate");
    }
    for (std::size_t c = 0; c < recording.channels.size(); ++c) {
      const auto& x = result.recording.channels[c].samples;
      const double rms = std::sqrt(x.squaredNorm() / static_cast<double>(x.size()));
      result.channels[c].error_rms = std::hypot(result.channels[c].error_rms, kStopBand * rms);
    }
    filter_to(rate_hz, result.recording);
  }
  return result;
}

std::optional<Recording> placed_evenly(const Recording& recording) {
  const Index n = recording.time_s.size();
  if (n < 2 || !(recording.sample_rate_hz > 0) || !recording.time_s.allFinite()) return {};
  const ArrayXd steps = (recording.time_s.array() - recording.time_s[0]) * recording.sample_rate_hz;
  const ArrayXd places = steps.round();
  if (!(places.tail(n - 1) > places.head(n - 1)).all() ||
      places[n - 1] > 2 * static_cast<double>(n)) {
    return {};
  }
  const auto size = static_cast<Index>(places[n - 1]) + 1;
  Recording placed = recording;
  placed.time_s.resize(0);
  placed.start_time_s = recording.time_s[0];
  placed.late = VectorXd::Zero(size);
  for (auto& channel : placed.channels) channel.samples = VectorXd::Constant(size, kNaN);
  const std::vector<Index> at(places.begin(), places.end());
  placed.late(at) = steps - places;
  for (std::size_t c = 0; c < placed.channels.size(); ++c) {
    placed.channels[c].samples(at) = recording.channels[c].samples;
  }
  return placed;
}

}  // namespace rigfit::signal
