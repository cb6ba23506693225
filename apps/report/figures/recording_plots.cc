#include "apps/report/figures/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

namespace rigfit::apps {
namespace {

using Eigen::Index;
constexpr std::size_t kMostClipped = 1000;  // points drawn of clipped samples

void add_point(PlotSeries& series, double x, double y) {
  series.x.push_back(x);
  series.y.push_back(y);
}

double time_of(const signal::Recording& recording, Index i) {
  return recording.time_s.size() > 0
             ? recording.time_s[i]
             : recording.start_time_s + static_cast<double>(i) / recording.sample_rate_hz;
}

/// The extremes of stretches of samples, in the order in which they come; gaps stay gaps.
template <class Time>
void add_extremes(PlotSeries& series, const Eigen::Ref<const Eigen::VectorXd>& samples, Time time,
                  std::size_t most) {
  const auto count = static_cast<std::size_t>(samples.size());
  const std::size_t stretch = count <= most ? 1 : (2 * count + most - 1) / most;
  for (std::size_t first = 0; first < count; first += stretch) {
    Index low = -1, high = -1;
    bool gap = false;
    for (std::size_t k = first; k < std::min(count, first + stretch); ++k) {
      const auto i = static_cast<Index>(k);
      if (!std::isfinite(samples[i])) {
        gap = true;
        continue;
      }
      if (low < 0 || samples[i] < samples[low]) low = i;
      if (high < 0 || samples[i] > samples[high]) high = i;
    }
    if (low >= 0) {
      add_point(series, time(std::min(low, high)), samples[std::min(low, high)]);
      if (low != high) add_point(series, time(std::max(low, high)), samples[std::max(low, high)]);
    }
    if (gap) {
      add_point(series, time(static_cast<Index>(first)), std::numeric_limits<double>::quiet_NaN());
    }
  }
}

Plot channel_plot(const signal::Recording& recording, const signal::Channel& channel,
                  const signal::ChannelQuality& quality, Origin origin) {
  Plot plot;
  plot.title = fmt::format("{}: {}", std::filesystem::path(recording.path).filename().string(),
                           channel.name);
  plot.caption = quality.findings.empty() ? "Nothing was found wrong with this channel." : "Found:";
  plot.x_label = "time, s";
  plot.y_label = fmt::format("{}, {}", channel.name, unit_words(channel.unit));
  const auto time = [&](Index i) { return time_of(recording, i); };
  PlotSeries record;
  record.name = "record";
  record.origin = origin;
  add_extremes(record, channel.samples, time, 6000);
  plot.series.push_back(std::move(record));
  PlotSeries clipped;
  clipped.name = fmt::format("clipped ({} samples)", quality.clipped_samples);
  clipped.origin = Origin::modelled;
  clipped.style = PlotSeries::Style::points;
  clipped.variant = 1;
  for (Index i = 0; quality.clipped_samples > 0 && i < channel.samples.size(); ++i) {
    const double y = channel.samples[i];
    const bool at_end = y == quality.max || y == quality.min;
    if (at_end && clipped.x.size() < kMostClipped) add_point(clipped, time(i), y);
  }
  if (!clipped.x.empty()) plot.series.push_back(std::move(clipped));
  for (const auto& finding : quality.findings) {
    plot.caption += fmt::format(" {}: {}.", finding.code, finding.message);
    if (finding.first < 0 || finding.first >= channel.samples.size()) continue;
    std::string word = finding.code;
    std::replace(word.begin(), word.end(), '_', ' ');
    plot.marks.push_back({time(finding.first), word, Origin::modelled, true});
  }
  std::sort(plot.marks.begin(), plot.marks.end(),
            [](const PlotMark& a, const PlotMark& b) { return a.x < b.x; });
  return plot;
}

}  // namespace

void add_samples(PlotSeries& series, const Eigen::Ref<const Eigen::VectorXd>& samples,
                 double start_s, double rate_hz, std::size_t most) {
  add_extremes(
      series, samples, [&](Index i) { return start_s + static_cast<double>(i) / rate_hz; }, most);
}

std::vector<Plot> recording_plots(const std::string& id, const signal::Recording& recording,
                                  const signal::QualityResult& quality, Origin origin) {
  std::vector<Plot> plots;
  const bool over_time =
      (recording.sample_rate_hz > 0 || recording.time_s.size() > 0) &&
      std::none_of(recording.notes.begin(), recording.notes.end(),
                   [](const auto& note) { return note.code == "not_a_time_history"; });
  if (!over_time) return plots;
  for (std::size_t k = 0; k < recording.channels.size(); ++k) {
    auto plot = channel_plot(recording, recording.channels[k], quality.channels[k], origin);
    plot.id = fmt::format("{}-{}", id, k + 1);
    plot.link = id;
    plots.push_back(std::move(plot));
  }
  return plots;
}

}  // namespace rigfit::apps
