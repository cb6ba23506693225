#include "apps/report/figures/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/report/drawing/html_text.h"
#include "ident/statistics/uncertainty.h"

namespace rigfit::apps {

Plot axial_length_plot(const std::string& id, const ident::AxialTestResult& r, Origin origin,
                       const std::optional<ReferenceValue>& reference) {
  Plot plot;
  plot.id = id;
  plot.title = "EA by length";
  plot.caption =
      "EA at each length as if the cable alone gave way. EA does not depend on the length of "
      "cable that was tested; a trend is a compliance in series (frame, adapter), which the "
      "result leaves out. The band is the result with its 95 % interval.";
  plot.x_label = "length, m";
  plot.y_label = "EA, kN";
  PlotSeries all, each, records;
  double low = r.lengths.front().length_m, high = low;
  const double k95 = ident::coverage_factor(0.95, 0);
  each.name = "EA at each length, 95 %";
  each.origin = records.origin = origin;
  each.style = records.style = PlotSeries::Style::points;
  records.name = "each record";
  each.variant = 1;
  records.variant = 2;
  for (const auto& sample : r.samples) {
    records.x.push_back(sample.length_m);
    records.y.push_back(1e-3 * sample.EA_N.value);
  }
  for (const auto& length : r.lengths) {
    low = std::min(low, length.length_m);
    high = std::max(high, length.length_m);
    each.x.push_back(length.length_m);
    each.y.push_back(1e-3 * length.EA_N.value);
    each.low.push_back(1e-3 * (length.EA_N.value - k95 * length.EA_N.std));
    each.high.push_back(1e-3 * (length.EA_N.value + k95 * length.EA_N.std));
  }
  const double margin = high > low ? 0.1 * (high - low) : 0.1 * high;
  all.name = r.conditional ? "EA, if nothing else gives way" : "EA, all lengths";
  all.origin = Origin::modelled;
  all.x = {low - margin, high + margin};
  all.y.assign(2, 1e-3 * r.EA_N.value);
  all.low.assign(2, 1e-3 * (r.conditional ? r.EA_if_rigid_low_N : r.EA_low_N));
  all.high.assign(2, 1e-3 * (r.conditional ? r.EA_if_rigid_high_N : r.EA_high_N));
  plot.series = {std::move(all), std::move(records), std::move(each)};
  if (reference) {
    PlotSeries line;
    line.name = reference->name;
    line.origin = reference->origin;
    line.variant = 3;
    line.style = PlotSeries::Style::dashed;
    line.x = {low - margin, high + margin};
    line.y.assign(2, 1e-3 * reference->value);
    plot.series.push_back(std::move(line));
  }
  return plot;
}

std::vector<Block> axial_decay_blocks(const std::string& id, const ident::AxialInputs& inputs,
                                      const ident::AxialCampaignResult& result,
                                      const std::vector<Origin>& origins) {
  PlotGroup group{id + "-decays", "Decays", {}};
  std::vector<AnalysedDecay> decays;
  double last = -1;
  for (const auto& d : result.decays) {
    const auto& recording = inputs.recordings[d.recording];
    if (!d.mode || recording.length_m == last) continue;  // the first of each length
    last = recording.length_m;
    decays.push_back({recording.name, d.channel, d.unit, origins[d.recording], d.rate_hz,
                      d.samples_start_s, d.samples, d.result});
    group.tabs.push_back({fmt::format("{:g} m", last),
                          {decay_plot(fmt::format("{}-decay-{:g}m", id, last), decays.back())}});
  }
  std::vector<Block> blocks;
  if (!group.tabs.empty()) blocks.emplace_back(std::move(group));
  auto damping = damping_plot(id + "-damping", decays);
  if (!damping.series.empty()) blocks.emplace_back(std::move(damping));
  return blocks;
}

}  // namespace rigfit::apps
