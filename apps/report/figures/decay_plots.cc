#include "apps/report/figures/figures.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>

namespace rigfit::apps {

std::string unit_words(const std::string& unit) {
  std::string text = unit.empty() ? "no unit" : unit;
  if (const auto at = text.find("^2"); at != std::string::npos) text.replace(at, 2, "²");
  return text;
}

Plot decay_plot(const std::string& id, const AnalysedDecay& decay) {
  Plot plot;
  plot.id = id;
  plot.title = "Decay and fit: " + std::filesystem::path(decay.file).filename().string();
  plot.caption =
      "The record, the damped oscillations fitted to it, and what they leave. A residual that "
      "looks "
      "like noise means that the fit has all there is.";
  plot.x_label = "time, s";
  plot.y_label = fmt::format("{}, {}", decay.channel, unit_words(decay.unit));
  const auto time = [&](Eigen::Index i) {
    return decay.start_s + static_cast<double>(i) / decay.rate_hz;
  };
  PlotSeries record, fit, residual;
  record.name = "record";
  record.origin = decay.origin;
  for (Eigen::Index i = 0; i < decay.samples.size(); ++i) {
    record.x.push_back(time(i));
    record.y.push_back(decay.samples[i]);
  }
  plot.series.push_back(std::move(record));
  const auto& r = decay.result;
  if (r.residual.size() == 0) return plot;
  fit.name = "fit";
  fit.variant = 1;
  fit.origin = Origin::modelled;
  residual.name = "residual";
  residual.origin = decay.origin;
  residual.variant = 2;
  for (Eigen::Index i = 0; i < r.residual.size(); ++i) {
    const double y = decay.samples[r.start + i];
    fit.x.push_back(time(r.start + i));
    fit.y.push_back(y - r.residual[i]);
    residual.x.push_back(time(r.start + i));
    residual.y.push_back(std::isfinite(y) ? r.residual[i]
                                          : std::numeric_limits<double>::quiet_NaN());
  }
  plot.series.push_back(std::move(fit));
  const auto& points = r.envelope.points;
  if (points.size() > 1) {
    for (const double sign : {1.0, -1.0}) {
      PlotSeries envelope;
      envelope.name = sign > 0 ? "envelope of the strongest mode" : "envelope, below";
      envelope.group = "envelope of the strongest mode";
      envelope.origin = Origin::modelled;
      envelope.style = PlotSeries::Style::dashed;
      envelope.variant = 3;
      for (std::size_t i = 0; i + 1 < points.size(); ++i) {  // exponential between the points
        for (int k = 0; k <= 8; ++k) {
          const double part = 0.125 * k,
                       t = points[i].time_s + part * (points[i + 1].time_s - points[i].time_s);
          const double amplitude =
              points[i].amplitude * std::pow(points[i + 1].amplitude / points[i].amplitude, part);
          envelope.x.push_back(time(r.start) + t);
          envelope.y.push_back(r.offset + r.drift_per_s * t + sign * amplitude);
        }
      }
      plot.series.push_back(std::move(envelope));
    }
  }
  plot.series.push_back(std::move(residual));
  return plot;
}

Plot damping_plot(const std::string& id, const std::vector<AnalysedDecay>& decays) {
  Plot plot;
  plot.id = id;
  plot.title = "Damping against amplitude";
  plot.caption =
      "Damping of the strongest mode along each decay. Level: viscous, the same at every size of "
      "motion; rising towards small motion: friction; rising towards large motion: drag.";
  plot.x_label = "amplitude";
  plot.y_label = "damping ratio, %";
  plot.log_x = true;
  int variant = 0;
  for (const auto& decay : decays) {
    const auto& points = decay.result.envelope.points;
    if (points.size() < 2) continue;
    plot.x_label = "amplitude, " + unit_words(decay.unit);
    PlotSeries series;
    series.name = std::filesystem::path(decay.file).filename().string() +
                  (decay.channel.empty() ? "" : ", " + decay.channel);
    series.origin = decay.origin;
    series.variant = variant++;
    series.style = PlotSeries::Style::line_and_points;
    for (const auto& point : points) {
      series.x.push_back(point.amplitude);
      series.y.push_back(100 * point.damping_ratio.value);
      const double half = 100 * decay.result.coverage_factor_95 * point.damping_ratio.std;
      series.low.push_back(series.y.back() - half);
      series.high.push_back(series.y.back() + half);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

}  // namespace rigfit::apps
