#include "apps/report/figures/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "ident/bending/bending_equation.h"

namespace rigfit::apps {
namespace {

std::string file_of(const ident::BendingCampaign& campaign, const ident::BendingPoint& point) {
  return std::filesystem::path(campaign.sources[point.source].name).filename().string();
}

std::string series_name(const ident::BendingCampaign& campaign, const ident::BendingPoint& point) {
  if (campaign.test.ends != ident::BeamEnds::tensioned) return file_of(campaign, point);
  return fmt::format("{:.0f} N: {}", point.point.tension_N, file_of(campaign, point));
}

}  // namespace

Plot load_deflection_plot(const std::string& id, const ident::BendingCampaign& campaign,
                          const std::vector<Origin>& origins,
                          const ident::BendingCampaignResult& result) {
  Plot plot;
  plot.id = id;
  plot.title = "Load against deflection";
  plot.caption =
      "Each recording loads the cable at mid-span and lets it go again; the slope of the straight "
      "parts gives EI. The gap between loading and unloading is friction between the wires.";
  if (campaign.test.ends != ident::BeamEnds::tensioned) {
    plot.caption =
        "Load against deflection of beams without tension; the slope of the elastic part, between "
        "a toe and yield or a stop, gives EI.";
  }
  plot.x_label = "deflection, mm";
  plot.y_label = "load, N";
  int variant = 0;
  for (const auto& one : result.points) {
    if (!one.analysis) continue;
    PlotSeries series;
    series.name = series_name(campaign, one);
    series.origin = origins[one.source];
    series.variant = variant++;
    const Eigen::Index n = one.record.load_N.size();
    const Eigen::Index every = 1 + n / 600;
    for (Eigen::Index i = 0; i < n; i += every) {
      if (!std::isfinite(one.record.load_N[i]) || !std::isfinite(one.record.deflection_m[i])) {
        continue;
      }
      series.x.push_back(1e3 * one.record.deflection_m[i]);
      series.y.push_back(one.record.load_N[i]);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

std::vector<PlotSeries> stiffness_series(const ident::BendingCampaignResult& result,
                                         const std::vector<Origin>& origins) {
  std::vector<PlotSeries> list;
  for (const auto& one : result.points) {
    if (!one.usable()) continue;
    const Origin origin = origins[one.source];
    auto at = std::find_if(list.begin(), list.end(),
                           [&](const PlotSeries& series) { return series.origin == origin; });
    if (at == list.end()) {
      PlotSeries series;
      series.name = origin == Origin::published ? std::string("published EI")
                                                : fmt::format("EI, {}", name_of(origin));
      series.origin = origin;
      series.style = PlotSeries::Style::points;
      series.variant = 2 + static_cast<int>(list.size());
      list.push_back(std::move(series));
      at = list.end() - 1;
    }
    at->x.push_back(one.point.tension_N);
    at->y.push_back(one.point.EI_Nm2);
    at->low.push_back(one.point.low);
    at->high.push_back(one.point.high);
  }
  for (auto& series : list) {
    const bool known = std::all_of(series.low.begin(), series.low.end(),
                                   [](double low) { return std::isfinite(low); });
    if (!known) series.low.clear(), series.high.clear();
  }
  return list;
}

Plot stiffness_plot(const std::string& id, const std::vector<PlotSeries>& points,
                    const ident::BendingCampaignResult& result) {
  const auto& laws = result.curve.laws().laws;
  const auto& bounds = result.bounds;
  Plot plot;
  plot.id = id;
  plot.title = "Bending stiffness against tension";
  plot.caption =
      "The tighter the strand is pulled, the more its wires hold on to each other and the stiffer "
      "it bends.";
  plot.x_label = "tension, N";
  plot.y_label = "EI, N m²";
  plot.log_y = bounds.has_value();
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const auto& series : points) {
    for (const double tension : series.x) {
      low = std::min(low, tension);
      high = std::max(high, tension);
    }
  }
  const double from = std::max(0.5 * low, low - 0.1 * (high - low)), to = high + 0.1 * (high - low);
  // The law that lies closest to the points is drawn full, with its band.
  std::vector<ident::FittedLaw> closest;
  for (const auto& law : laws) {
    if (law.converged) closest.push_back(law);
  }
  std::stable_sort(closest.begin(), closest.end(), [](const auto& a, const auto& b) {
    return a.rms_relative_error < b.rms_relative_error;
  });
  int variant = 0;
  for (const auto& law : closest) {
    PlotSeries series;
    series.name = fmt::format("law: {}", name_of(law.kind));
    series.origin = Origin::modelled;
    series.variant = variant < 2 ? variant : variant + 2;
    for (int i = 0; i <= 80; ++i) {
      const double tension = from + (to - from) * i * i / 6400;  // laws bend most where slack
      const auto predicted = ident::predict(law, tension);
      series.x.push_back(tension);
      series.y.push_back(predicted.EI_Nm2);
      if (variant == 0 && predicted.low > 0) {
        series.low.push_back(predicted.low);
        series.high.push_back(predicted.high);
      }
    }
    if (series.low.size() != series.x.size()) {
      series.low.clear();
      series.high.clear();
    }
    if (!series.low.empty()) {
      plot.caption += " The band is the 95 % band of the law closest to the points.";
    }
    ++variant;
    plot.series.push_back(std::move(series));
  }
  if (bounds) {
    plot.caption += " Between the bounds every strand must lie (free slip below, no slip above).";
    for (const auto& [name, value] : {std::pair{"EImin, wires slip", bounds->EI_min_Nm2},
                                      std::pair{"EImax, no slip", bounds->EI_max_Nm2}}) {
      PlotSeries series;
      series.name = name;
      series.variant = 2;
      series.origin = Origin::modelled;
      series.style = PlotSeries::Style::dashed;
      series.x = {from, to};
      series.y = {value, value};
      plot.series.push_back(std::move(series));
    }
  }
  plot.series.insert(plot.series.end(), points.begin(), points.end());
  return plot;
}

}  // namespace rigfit::apps
