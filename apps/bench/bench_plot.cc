#include "apps/bench/bench_plot.h"

#include <fmt/format.h>

#include <algorithm>

namespace rigfit::apps {

Plot bench_plot(const BenchStudy& study) {
  using Style = PlotSeries::Style;
  Plot plot;
  plot.id = study.study.empty() ? study.task : study.task + "-" + study.study;
  plot.title = study.task + (study.study.empty() ? "" : ", by " + study.study);
  plot.caption = fmt::format(
      "{}: time of one core, and error of {}, against {}{}. Further left is faster, further down "
      "is better; the broken line joins what is Pareto-optimal.",
      study.scene, study.error_of, study.reference,
      study.reference_error > 0 ? fmt::format(", itself good to {:.1e}", study.reference_error)
                                : std::string());
  plot.x_label = "time, s";
  plot.y_label = "relative error";
  plot.log_x = plot.log_y = true;
  auto rows = study.rows;
  // What failed has no error of its own.
  std::erase_if(rows, [](const BenchRow& row) {
    return !(row.wall_s > 0) || !(row.relative_error > 0) || row.relative_error >= 1;
  });
  for (const auto& row : rows) plot.named(row.method).style = Style::line_and_points;
  std::stable_sort(rows.begin(), rows.end(),
                   [](const BenchRow& a, const BenchRow& b) { return a.wall_s < b.wall_s; });
  PlotSeries front{"Pareto-optimal", Origin::synthetic, 0, Style::dashed};
  PlotSeries standard{"default", Origin::measured, 0, Style::points};
  for (const auto& row : rows) {
    plot.named(row.method).add(row.wall_s, row.relative_error);
    if (row.on_front) front.add(row.wall_s, row.relative_error);
    if (row.is_default) standard.add(row.wall_s, row.relative_error);
  }
  if (front.x.size() > 1) plot.add(std::move(front));
  plot.add(std::move(standard));
  return plot;
}

}  // namespace rigfit::apps
