#include "apps/report/cost_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "apps/report/html_text.h"
#include "model/modal_analysis.h"

namespace rigfit::apps {
namespace {

std::string time_words(double seconds) {
  return seconds < 1e-3 ? fmt::format("{:.0f} µs", 1e6 * seconds)
         : seconds < 1  ? fmt::format("{:.3g} ms", 1e3 * seconds)
                        : fmt::format("{:.3g} s", seconds);
}

/// Median time of three and the estimated error of the first modes at several numbers of segments.
PlotSeries segments_series(const CampaignScene& scene, int variant) {
  PlotSeries series;
  series.name = scene.name;
  series.origin = Origin::modelled;
  series.variant = variant;
  series.style = PlotSeries::Style::line_and_points;
  for (const int segments : {10, 20, 40, 80}) {
    model::ModesOptions options;
    options.count = 6;
    options.segments = segments;
    options.shapes = false;
    const double error = model::analyse_modes(scene.scene, options).relative_error_estimate;
    options.error_estimate = false;
    std::vector<double> times;
    for (int i = 0; i < 3; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      const auto analysis = model::analyse_modes(scene.scene, options);
      times.push_back(
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      if (analysis.equilibrium.status != model::EquilibriumStatus::converged) return series;
    }
    std::sort(times.begin(), times.end());
    if (!(error > 0)) continue;
    series.x.push_back(1e3 * times[1]);
    series.y.push_back(error);
  }
  return series;
}

}  // namespace

ReportPart cost_part(const Campaign& campaign, const std::vector<ReportPart>& parts) {
  ReportPart part;
  part.id = "solvers";
  part.title = "What the model did, and what it cost";
  part.blocks.push_back(
      Paragraph{"Every computation chooses what to model and how, by the error that it estimates, "
                "and says what "
                "it left out. Times are of this run on this machine."});
  Plot plot;
  plot.id = "solvers-segments";
  plot.title = "Speed against error: number of segments";
  plot.caption =
      "Equilibrium and the first six modes of each scene with 10, 20, 40 and 80 segments a member "
      "(from the left). Error: the largest relative error of these frequencies, estimated from "
      "three "
      "numbers of segments.";
  plot.x_label = "time, ms";
  plot.y_label = "relative error in frequency";
  plot.log_x = plot.log_y = true;
  int variant = 0;
  for (const auto& scene : campaign.scenes) {
    auto series = segments_series(scene, variant++);
    if (series.x.size() > 1) plot.series.push_back(std::move(series));
  }
  if (!plot.series.empty()) part.blocks.push_back(std::move(plot));

  ReportTable table;
  table.id = "solver-costs";
  table.caption =
      "Computations of this report. Estimated error: of frequencies for modes; of a linear answer, "
      "what the size of the motion would change; of a large motion, the drift of its energy.";
  table.columns = {{"computation", {}, false},
                   {"how", {}, false},
                   {"choice", {}, false},
                   {"time", {}, true},
                   {"estimated error", {}, true}};
  std::size_t rows = 0;
  for (const auto& one : parts) {
    for (const auto& cost : one.costs) {
      ++rows;
      table.rows.push_back({cost.what, cost.method, cost.choices, time_words(cost.wall_s),
                            std::isfinite(cost.relative_error)
                                ? fmt::format("{:.1e}", cost.relative_error)
                                : std::string("–")});
    }
  }
  if (rows > 10) table.fold = fmt::format("All {} computations", rows);
  if (rows > 0) part.blocks.push_back(std::move(table));
  return part;
}

}  // namespace rigfit::apps
