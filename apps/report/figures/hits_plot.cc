#include "apps/report/figures/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rigfit::apps {
namespace {

using Eigen::Index;

/// From before the pulse to after a second contact, where there is one.
void add_force(PlotSeries& series, const signal::Recording& recording, Index channel,
               const signal::Hit& hit, int sign) {
  const auto& samples = recording.channels[static_cast<std::size_t>(channel)].samples;
  const double rate = recording.sample_rate_hz;
  const Index width = std::max<Index>(hit.pulse_last - hit.pulse_first + 1, 4);
  Index last = hit.pulse_last + 4 * width;
  if (hit.second_hit > 0) {
    const auto delay = static_cast<Index>(std::lround(hit.second_hit_delay_s * rate));
    last = std::max(last, hit.peak_sample + delay + 2 * width);
  }
  last = std::min<Index>(last, samples.size() - 1);
  for (Index i = std::max<Index>(hit.pulse_first - 2 * width, 0); i <= last; ++i) {
    series.x.push_back(1e3 * static_cast<double>(i - hit.pulse_first) / rate);
    series.y.push_back(sign * (samples[i] - hit.offset));
  }
}

}  // namespace

Plot hits_plot(const std::string& id, const std::vector<ident::StruckPlace>& places,
               const ident::HammerTest& test, Origin origin, std::size_t most) {
  Plot plot;
  plot.id = id;
  plot.title = "Hits, kept and rejected";
  plot.x_label = "time from the pulse, ms";
  plot.y_label = "force, " + test.force_unit;
  for (const bool accepted : {false, true}) {
    for (std::size_t p = 0; p < test.tests.size() && p < places.size(); ++p) {
      const auto& search = test.tests[p].search;
      for (std::size_t h = 0; h < search.hits.size() && plot.series.size() < most; ++h) {
        const auto& hit = search.hits[h];
        if (hit.accepted != accepted || hit.recording >= places[p].recordings.size()) continue;
        const auto& recording = places[p].recordings[hit.recording];
        PlotSeries series;
        series.name =
            fmt::format("{}{}hit {}{}{}", places[p].name, places[p].name.empty() ? "" : ", ", h + 1,
                        hit.reason.empty() ? "" : ": ", hit.reason);
        series.group = accepted ? "kept" : "rejected";
        series.origin = origin;
        series.variant = accepted ? 0 : 1;
        if (!accepted) series.style = PlotSeries::Style::dashed;
        add_force(series, recording, recording.channel_index(test.force), hit, search.sign);
        if (!series.x.empty()) plot.series.push_back(std::move(series));
      }
    }
  }
  const std::size_t all = test.hits();
  plot.caption = fmt::format(
      "The force of each hit. {} of {} hits kept{}.", test.accepted_hits(), all,
      all > plot.series.size() ? fmt::format("; {} are shown", plot.series.size()) : std::string());
  return plot;
}

}  // namespace rigfit::apps
