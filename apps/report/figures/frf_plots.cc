#include "apps/report/figures/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rigfit::apps {
namespace {

using Eigen::Index;
constexpr double kNormal95 = 1.959963984540054;  // two-sided 95 % of a normal distribution
// A band whose lower end is not positive is drawn down to this share of the line: a logarithmic
// axis has no zero.
constexpr double kLowestShown = 0.05;

template <class Value>
PlotSeries series_of(const signal::FrfSet& frfs, const LineRange& range, Index response,
                     Index input, Origin origin, Value value) {
  PlotSeries series;
  series.name = frf_name(frfs, response, input);
  series.origin = origin;
  series.variant = static_cast<int>(frfs.column(response, input));
  for (Index k = range.first; k <= range.last; ++k) {
    series.x.push_back(frfs.frequency_hz[k]);
    series.y.push_back(value(k, frfs.column(response, input)));
  }
  return series;
}

/// The phase of one FRF in degrees without jumps; NaN where it is not known.
std::vector<double> unwrapped(const signal::FrfSet& frfs, const LineRange& range, Index column) {
  constexpr double kKnown = 0.35;  // rad, 20 degrees: a jump of half a turn is then no noise
  std::vector<double> degrees;
  double last = 0;
  bool any = false;
  for (Index k = range.first; k <= range.last; ++k) {
    const double size = std::abs(frfs.H(k, column));
    const bool known =
        size > 0 && (frfs.H_std.size() == 0 || frfs.H_std(k, column) < kKnown * size);
    if (!known) {
      degrees.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const double here = std::arg(frfs.H(k, column)) * 180 / std::numbers::pi;
    last = any ? here + 360 * std::round((last - here) / 360) : here;
    any = true;
    degrees.push_back(last);
  }
  return degrees;
}

std::vector<PlotMark> marks_of(const signal::ModalResult& modal) {
  std::vector<PlotMark> marks;
  for (const auto& mode : modal.model.modes) {
    marks.push_back({mode.frequency_hz.value, fmt::format("{:.4g}", mode.frequency_hz.value),
                     Origin::modelled, mode.doubtful});
  }
  return marks;
}

template <class Add>
void each_frf(const signal::FrfSet& frfs, Add add) {
  for (Index r = 0; r < static_cast<Index>(frfs.responses.size()); ++r) {
    for (Index i = 0; i < static_cast<Index>(frfs.inputs.size()); ++i) add(r, i);
  }
}

}  // namespace

std::string frf_name(const signal::FrfSet& frfs, Index response, Index input) {
  const auto& name = frfs.responses[static_cast<std::size_t>(response)].name;
  if (frfs.inputs.size() < 2) return name;
  return name + " / " + frfs.inputs[static_cast<std::size_t>(input)].name;
}

std::string magnitude_label(const std::string& unit) {
  std::string text = unit;
  if (const auto at = text.find("^2"); at != std::string::npos) text.replace(at, 2, "²");
  return text.empty() ? "|H|" : "|H|, " + text;
}

LineRange lines_between(const signal::FrfSet& frfs, double low_hz, double high_hz) {
  LineRange range;
  const auto& f = frfs.frequency_hz;
  while (range.first < f.size() && (f[range.first] < low_hz || f[range.first] <= 0)) ++range.first;
  range.last = range.first - 1;
  while (range.last + 1 < f.size() && f[range.last + 1] <= high_hz) ++range.last;
  return range;
}

Plot magnitude_plot(const std::string& id, const signal::FrfSet& frfs, const LineRange& range,
                    Origin origin, const signal::FrfSet* rebuilt) {
  Plot plot;
  plot.id = id;
  plot.title = "Frequency response, magnitude";
  plot.caption =
      "Response per newton of the hammer, averaged over the accepted hits. The band holds the true "
      "average with 95 %; broken: rebuilt from the modes that were identified.";
  plot.x_label = "frequency, Hz";
  plot.y_label = magnitude_label(frfs.unit);
  plot.log_y = true;
  each_frf(frfs, [&](Index r, Index i) {
    auto series = series_of(frfs, range, r, i, origin,
                            [&](Index k, Index c) { return std::abs(frfs.H(k, c)); });
    if (frfs.H_std.size() > 0) {
      for (Index k = range.first; k <= range.last; ++k) {
        const Index c = frfs.column(r, i);
        const double size = std::abs(frfs.H(k, c)), half = kNormal95 * frfs.H_std(k, c);
        series.low.push_back(std::max(size - half, kLowestShown * size));
        series.high.push_back(size + half);
      }
    }
    plot.series.push_back(std::move(series));
  });
  if (rebuilt) {
    each_frf(*rebuilt, [&](Index r, Index i) {
      PlotSeries series;
      series.name = frf_name(*rebuilt, r, i) + ", from modes";
      const auto column = static_cast<int>(rebuilt->column(r, i));
      series.variant = rebuilt->H.cols() > 1 ? column : 1;
      series.group = "rebuilt from modes";
      series.origin = Origin::modelled;
      for (Index k = 0; k < rebuilt->frequency_hz.size(); ++k) {
        series.x.push_back(rebuilt->frequency_hz[k]);
        series.y.push_back(std::abs(rebuilt->H(k, rebuilt->column(r, i))));
      }
      plot.series.push_back(std::move(series));
    });
  }
  return plot;
}

Plot phase_plot(const std::string& id, const signal::FrfSet& frfs, const LineRange& range,
                Origin origin) {
  Plot plot;
  plot.id = id;
  plot.title = "Frequency response, phase";
  plot.caption =
      "By how much the response leads the force, without jumps of a whole turn. It falls by 180° "
      "at "
      "every mode and rises by as much at every antiresonance. Lines whose phase is not known to "
      "20° are left out.";
  plot.x_label = "frequency, Hz";
  plot.y_label = "phase, degrees";
  plot.angle = true;
  each_frf(frfs, [&](Index r, Index i) {
    const auto degrees = unwrapped(frfs, range, frfs.column(r, i));
    plot.series.push_back(series_of(frfs, range, r, i, origin, [&](Index k, Index) {
      return degrees[static_cast<std::size_t>(k - range.first)];
    }));
  });
  return plot;
}

Plot coherence_plot(const std::string& id, const signal::FrfSet& frfs, const LineRange& range,
                    Origin origin) {
  Plot plot;
  plot.id = id;
  plot.title = "Coherence";
  plot.caption =
      "The part of the response that the hammer explains, hit for hit alike. It falls where "
      "there is little force, little response, or something else shakes the rig.";
  plot.x_label = "frequency, Hz";
  plot.y_label = "coherence";
  each_frf(frfs, [&](Index r, Index i) {
    plot.series.push_back(series_of(frfs, range, r, i, origin,
                                    [&](Index k, Index c) { return frfs.coherence(k, c); }));
  });
  return plot;
}

Plot stabilisation_plot(const std::string& id, const signal::ModalResult& found, Origin origin) {
  Plot plot;
  plot.id = id;
  plot.title = "Stabilisation diagram";
  plot.caption =
      "Poles found with models of rising order. A mode of the rig shows as a column of poles that "
      "stay; what wanders is noise. Modes are chosen from the columns without anybody's guess.";
  plot.x_label = "frequency, Hz";
  plot.y_label = "model order";
  PlotSeries stable, other;
  stable.name = "stays in frequency and damping";
  other.name = "wanders";
  stable.origin = other.origin = origin;
  stable.style = other.style = PlotSeries::Style::points;
  other.variant = 1;
  for (const auto& pole : found.stabilisation.poles) {
    auto& series = pole.stable_frequency && pole.stable_damping ? stable : other;
    series.x.push_back(pole.frequency_hz);
    series.y.push_back(pole.order);
  }
  const double highest = found.stabilisation.orders_solved;
  PlotSeries chosen;
  chosen.name = "modes identified";
  chosen.origin = Origin::modelled;
  chosen.variant = 2;
  for (const auto& mode : found.model.modes) {
    const double f = mode.frequency_hz.value;
    chosen.x.insert(chosen.x.end(), {f, f, f});
    chosen.y.insert(chosen.y.end(), {0.0, highest, std::numeric_limits<double>::quiet_NaN()});
  }
  PlotSeries rejected;
  rejected.name = "columns rejected (listed below)";
  rejected.origin = origin;
  rejected.style = PlotSeries::Style::dashed;
  rejected.variant = 2;
  for (const auto& column : found.rejected) {
    const double f = column.frequency_hz;
    rejected.x.insert(rejected.x.end(), {f, f, f});
    rejected.y.insert(rejected.y.end(), {0.0, highest, std::numeric_limits<double>::quiet_NaN()});
  }
  for (auto* series : {&other, &stable, &rejected, &chosen}) {
    if (!series->x.empty()) plot.series.push_back(std::move(*series));
  }
  return plot;
}

std::vector<Plot> frf_figures(const FrfFigures& of, const signal::FrfSet& frfs,
                              const LineRange& range, const signal::ModalResult* modal,
                              const signal::FrfSet* rebuilt) {
  const auto id = [&](const char* what) {
    return fmt::format("{}-{}{}{}", of.test, what, of.state.empty() ? "" : "-", of.state);
  };
  std::vector<Plot> plots;
  plots.push_back(magnitude_plot(id("frf"), frfs, range, of.origin, rebuilt));
  plots.push_back(phase_plot(id("phase"), frfs, range, of.origin));
  if (frfs.coherence.size() > 0) {
    plots.push_back(coherence_plot(id("coherence"), frfs, range, of.origin));
  }
  for (auto& plot : plots) {
    plot.link = id("frf");
    if (modal) plot.marks = marks_of(*modal);
  }
  if (modal && !modal->stabilisation.poles.empty()) {
    plots.push_back(stabilisation_plot(id("stabilisation"), *modal, of.origin));
    plots.back().link = id("frf");
  }
  return plots;
}

}  // namespace rigfit::apps
