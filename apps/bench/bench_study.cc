#include "apps/bench/bench_study.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>
#include "signal/estimation/robust.h"

namespace rigfit::apps {

double median_time(const BenchBudget& budget, const std::function<void()>& work) {
  std::vector<double> times;
  double spent = 0;
  while (times.empty() ||
         (static_cast<int>(times.size()) < budget.repeats && spent < budget.row_s)) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    times.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    spent += times.back();
  }
  return signal::median(std::move(times));
}

void mark_front(BenchStudy& study) {
  constexpr double kClearly = 0.9;      // a ratio of times or errors beyond scatter
  constexpr double kAsAccurate = 1.01;  // the same discretisation in other unknowns differs by less
  const auto beats = [&](const BenchRow& a, const BenchRow& b) {
    const double ea = std::max(a.relative_error, study.reference_error),
                 eb = std::max(b.relative_error, study.reference_error);
    return a.wall_s <= b.wall_s && ea <= kAsAccurate * eb &&
           (a.wall_s < kClearly * b.wall_s || ea < kClearly * eb);
  };
  for (BenchRow& row : study.rows) {
    row.on_front = row.relative_error < 1 &&
                   std::none_of(study.rows.begin(), study.rows.end(),
                                [&](const BenchRow& other) { return beats(other, row); });
  }
}

Plot bench_plot(const BenchStudy& study) {
  using Style = PlotSeries::Style;
  Plot plot;
  plot.id = study.task + "-" + study.study;
  plot.title = study.task + ", by " + study.study;
  plot.caption = fmt::format(
      "{}: time of one core, and error of {}, against {}, itself good to {:.1e}. Further left is "
      "faster, further down is better; the broken line joins what is Pareto-optimal.",
      study.scene, study.error_of, study.reference, study.reference_error);
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
