#include "apps/bench/bench_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace rigfit::apps {
namespace {

using Place = std::pair<double, double>;  // time, error

PlotSeries series_of(std::string name, PlotSeries::Style style, std::vector<Place> places) {
  std::sort(places.begin(), places.end());
  PlotSeries series;
  series.name = std::move(name);
  series.style = style;
  for (const auto& [time, error] : places) series.x.push_back(time), series.y.push_back(error);
  return series;
}

}  // namespace

Plot bench_plot(const BenchStudy& study) {
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
  std::vector<std::string> methods;
  std::map<std::string, std::vector<Place>> places;
  std::vector<Place> front, standard;
  for (const BenchRow& row : study.rows) {
    // What failed has no error of its own.
    if (!(row.wall_s > 0) || !(row.relative_error > 0) || row.relative_error >= 1) continue;
    const Place place{row.wall_s, row.relative_error};
    if (!places.contains(row.method)) methods.push_back(row.method);
    places[row.method].push_back(place);
    if (row.on_front) front.push_back(place);
    if (row.is_default) standard.push_back(place);
  }
  if (methods.empty()) return plot;
  for (std::size_t k = 0; k < methods.size(); ++k) {
    plot.series.push_back(
        series_of(methods[k], PlotSeries::Style::line_and_points, places[methods[k]]));
    plot.series.back().variant = static_cast<int>(k);
    if (methods[k].find("(paper)") != std::string::npos) {
      plot.series.back().origin = Origin::published_model;
    }
  }
  if (front.size() > 1) {
    plot.series.push_back(series_of("Pareto-optimal", PlotSeries::Style::dashed, std::move(front)));
    plot.series.back().origin = Origin::synthetic;
  }
  if (!standard.empty()) {
    plot.series.push_back(series_of("default", PlotSeries::Style::points, std::move(standard)));
    plot.series.back().origin = Origin::measured;
  }
  return plot;
}

}  // namespace rigfit::apps
