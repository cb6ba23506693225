#include "apps/report/parts/speed_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "apps/bench/bench_study.h"
#include "apps/bench/model_studies.h"

namespace rigfit::apps {
namespace {

Plot chart(const BenchStudy& study, std::size_t number) {
  Plot plot;
  plot.id = fmt::format("speed-modes-{}", number);
  plot.title = "Speed against error: " + study.scene;
  plot.caption = fmt::format(
      "Equilibrium and natural modes by method, each from few segments (left) to many. Error of "
      "{}, "
      "against the {}, itself good to {:.0e}. What lies lowest and leftmost is the front.",
      study.error_of, study.reference, study.reference_error);
  plot.x_label = "processor time, ms";
  plot.y_label = "relative error";
  plot.log_x = plot.log_y = true;
  int variant = 0;
  for (const BenchRow& row : study.rows) {
    if (row.relative_error >= 1) continue;
    auto series = std::find_if(plot.series.begin(), plot.series.end(),
                               [&](const PlotSeries& one) { return one.name == row.method; });
    if (series == plot.series.end()) {
      PlotSeries fresh;
      fresh.name = row.method;
      fresh.variant = variant++;
      fresh.style = PlotSeries::Style::line_and_points;
      plot.series.push_back(std::move(fresh));
      series = plot.series.end() - 1;
    }
    series->x.push_back(1e3 * row.wall_s);
    series->y.push_back(std::max(row.relative_error, study.reference_error));
  }
  std::vector<const BenchRow*> front;
  for (const BenchRow& row : study.rows) {
    if (row.on_front) front.push_back(&row);
  }
  std::sort(front.begin(), front.end(),
            [](const BenchRow* a, const BenchRow* b) { return a->wall_s < b->wall_s; });
  PlotSeries line;
  line.name = "front";
  line.style = PlotSeries::Style::dashed;
  line.variant = variant;
  for (const BenchRow* row : front) {
    line.x.push_back(1e3 * row->wall_s);
    line.y.push_back(std::max(row->relative_error, study.reference_error));
  }
  if (line.x.size() > 1) plot.series.push_back(std::move(line));
  return plot;
}

}  // namespace

std::vector<Block> speed_blocks(const Campaign& campaign) {
  BenchBudget budget;
  budget.quick = true;
  budget.repeats = 3;
  budget.row_s = 0.01;
  budget.processor_time = true;  // other parts of the report run beside it
  std::vector<Block> blocks;
  ReportTable table;
  table.id = "speed-defaults";
  table.caption =
      "The default: segments = \"auto\", which finds the number of segments for the scene's "
      "accuracy "
      "and shows its error. Errors are measured against the chart's reference.";
  table.columns = {{"scene", {}, false}, {"segments", {}, true}, {"processor time", {}, true},
                   {"asked", {}, true},  {"error", {}, true},    {"on the front", {}, false}};
  std::set<std::vector<std::string>> seen;
  std::size_t number = 0;
  for (const auto& scene : campaign.scenes) {
    std::vector<std::string> members;
    for (const auto& member : scene.scene.members) members.push_back(member.name);
    if (!seen.insert(members).second) continue;
    const BenchStudy study = modes_study(scene.scene, budget);
    if (!study.skipped.empty()) continue;
    blocks.push_back(chart(study, ++number));
    for (const BenchRow& row : study.rows) {
      if (!row.is_default) continue;
      table.rows.push_back({scene.name, std::to_string(row.segments), time_words(row.wall_s),
                            fmt::format("{:.0e}", row.tolerance.value_or(0)),
                            fmt::format("{:.1e}", row.relative_error),
                            row.on_front ? std::string("yes") : "no: " + row.note});
    }
  }
  if (!table.rows.empty()) blocks.push_back(std::move(table));
  return blocks;
}

}  // namespace rigfit::apps
