#include "apps/report/figures/figures.h"
#include "model/frfs/frf_synthesis.h"
#include "signal/estimation/groups.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;
using Style = PlotSeries::Style;
// A band whose lower end is not positive is drawn down to this share of the line: a logarithmic
// axis has no zero.
constexpr double kLowestShown = 0.05;

/// "mid-span", or "mid-span / hammer" where several places were struck.
std::string frf_name(const signal::FrfSet& frfs, Index response, Index input) {
  const auto& name = frfs.responses[static_cast<std::size_t>(response)].name;
  if (frfs.inputs.size() < 2) return name;
  return name + " / " + frfs.inputs[static_cast<std::size_t>(input)].name;
}

/// Lines of a set.
struct LineRange {
  Index first = 0, last = -1;
};

LineRange lines_between(const signal::FrfSet& frfs, double low_hz, double high_hz) {
  LineRange range;
  const auto& f = frfs.frequency_hz;
  while (range.first < f.size() && (f[range.first] < low_hz || f[range.first] <= 0)) ++range.first;
  range.last = range.first - 1;
  while (range.last + 1 < f.size() && f[range.last + 1] <= high_hz) ++range.last;
  return range;
}

/// A series for each FRF; `value(line, column)`.
template <class Value>
void add_frfs(Plot& plot, const signal::FrfSet& frfs, const LineRange& range, Origin origin,
              Value value) {
  for (Index r = 0; r < static_cast<Index>(frfs.responses.size()); ++r) {
    for (Index i = 0; i < static_cast<Index>(frfs.inputs.size()); ++i) {
      const Index column = frfs.column(r, i);
      PlotSeries series{frf_name(frfs, r, i), origin, static_cast<int>(column)};
      for (Index k = range.first; k <= range.last; ++k) {
        series.add(frfs.frequency_hz[k], value(k, column));
      }
      plot.series.push_back(std::move(series));
    }
  }
}

/// The phase of one FRF in degrees without jumps; NaN where it is not known.
std::vector<double> unwrapped(const signal::FrfSet& frfs, const LineRange& range, Index column) {
  constexpr double kKnown = 0.35;  // rad, 20 degrees: a jump of half a turn is then no noise
  std::vector<double> degrees;
  double last = std::numeric_limits<double>::quiet_NaN();
  for (Index k = range.first; k <= range.last; ++k) {
    const double size = std::abs(frfs.H(k, column));
    if (!(size > 0) || (frfs.H_std.size() > 0 && frfs.H_std(k, column) >= kKnown * size)) {
      degrees.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const double here = std::arg(frfs.H(k, column)) * 180 / std::numbers::pi;
    last = std::isnan(last) ? here : here + 360 * std::round((last - here) / 360);
    degrees.push_back(last);
  }
  return degrees;
}

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
    series.add(1e3 * static_cast<double>(i - hit.pulse_first) / rate,
               sign * (samples[i] - hit.offset));
  }
}

/// Every hit as its force pulse: all rejected ones and the first accepted ones.
Plot hits_plot(const std::string& id, const std::vector<signal::StruckPoint>& places,
               const ident::HammerTest& test, Origin origin) {
  constexpr std::size_t kMost = 24;
  Plot plot{id, "Hits, kept and rejected", "", "time from the pulse, ms",
            "force, " + places.front().recordings.front().channel(test.force).unit};
  for (const bool accepted : {false, true}) {
    for (std::size_t p = 0; p < test.tests.size() && p < places.size(); ++p) {
      const auto& search = test.tests[p].search;
      for (std::size_t h = 0; h < search.hits.size() && plot.series.size() < kMost; ++h) {
        const auto& hit = search.hits[h];
        if (hit.accepted != accepted || hit.recording >= places[p].recordings.size()) continue;
        const auto& recording = places[p].recordings[hit.recording];
        PlotSeries series{
            fmt::format("{}{}hit {}{}{}", places[p].name, places[p].name.empty() ? "" : ", ", h + 1,
                        hit.reason.empty() ? "" : ": ", hit.reason),
            origin, accepted ? 0 : 1, accepted ? Style::line : Style::dashed,
            accepted ? "kept" : "rejected"};
        add_force(series, recording, recording.channel_index(test.force), hit, search.sign);
        plot.add(std::move(series));
      }
    }
  }
  const std::size_t all = test.hits();
  plot.caption = fmt::format(
      "The force of each hit. {} of {} hits kept{}.", test.accepted_hits(), all,
      all > plot.series.size() ? fmt::format("; {} are shown", plot.series.size()) : std::string());
  return plot;
}

/// Magnitude of every FRF with its 95 % band.
Plot magnitude_plot(const std::string& id, const signal::FrfSet& frfs, const LineRange& range,
                    Origin origin) {
  Plot plot{id, "Frequency response, magnitude",
            "Response per newton of the hammer, averaged over the accepted hits. The band holds "
            "the true average with 95 %; broken: rebuilt from the modes that were identified.",
            "frequency, Hz", frfs.unit.empty() ? "|H|" : "|H|, " + unit_words(frfs.unit)};
  plot.log_y = true;
  add_frfs(plot, frfs, range, origin, [&](Index k, Index c) { return std::abs(frfs.H(k, c)); });
  if (frfs.H_std.size() == 0) return plot;
  const double k95 = signal::coverage_factor(0.95, 0);
  for (auto& series : plot.series) {
    for (Index k = range.first; k <= range.last; ++k) {
      const double size = series.y[static_cast<std::size_t>(k - range.first)];
      const double half = k95 * frfs.H_std(k, series.variant);
      series.low.push_back(std::max(size - half, kLowestShown * size));
      series.high.push_back(size + half);
    }
  }
  return plot;
}

void add_rebuilt(Plot& plot, const signal::FrfSet& rebuilt) {
  const std::size_t measured = plot.series.size();
  add_frfs(plot, rebuilt, {0, rebuilt.frequency_hz.size() - 1}, Origin::modelled,
           [&](Index k, Index c) { return std::abs(rebuilt.H(k, c)); });
  for (std::size_t i = measured; i < plot.series.size(); ++i) {
    auto& series = plot.series[i];
    series.name += ", from modes";
    series.group = "rebuilt from modes";
    if (rebuilt.H.cols() < 2) series.variant = 1;
  }
}

Plot phase_plot(const std::string& id, const signal::FrfSet& frfs, const LineRange& range,
                Origin origin) {
  Plot plot{id, "Frequency response, phase",
            "By how much the response leads the force, without jumps of a whole turn. It falls by "
            "180° at every mode and rises by as much at every antiresonance. Lines whose phase is "
            "not known to 20° are left out.",
            "frequency, Hz", "phase, degrees"};
  add_frfs(plot, frfs, range, origin, [](Index, Index) { return 0.0; });
  for (auto& series : plot.series) series.y = unwrapped(frfs, range, series.variant);
  return plot;
}

Plot coherence_plot(const std::string& id, const signal::FrfSet& frfs, const LineRange& range,
                    Origin origin) {
  Plot plot{id, "Coherence",
            "The part of the response that the hammer explains, hit for hit alike. It falls where "
            "there is little force, little response, or something else shakes the rig.",
            "frequency, Hz", "coherence"};
  add_frfs(plot, frfs, range, origin, [&](Index k, Index c) { return frfs.coherence(k, c); });
  return plot;
}

void mark(Plot& plot, const signal::IdentifiedMode& mode) {
  const double f = mode.frequency_hz.value;
  plot.marks.push_back({f, fmt::format("{:.4g}", f), mode.doubtful});
}

Plot stabilisation_plot(const std::string& id, const signal::ModalResult& found, Origin origin) {
  Plot plot{id, "Stabilisation diagram",
            "Poles found with models of rising order. A mode of the rig shows as a column of poles "
            "that stay; scattered poles are noise.",
            "frequency, Hz", "model order"};
  PlotSeries stable{"stays in frequency and damping", origin, 0, Style::points};
  PlotSeries other{"scatters", origin, 1, Style::points};
  for (const auto& pole : found.stabilisation.poles) {
    auto& series = pole.stable_frequency && pole.stable_damping ? stable : other;
    series.add(pole.frequency_hz, pole.order);
  }
  const auto upright = [&](PlotSeries& series, double f) {
    series.add(f, 0);
    series.add(f, found.stabilisation.orders_solved);
    series.add(f, std::numeric_limits<double>::quiet_NaN());
  };
  PlotSeries chosen{"modes identified", Origin::modelled, 2};
  for (const auto& mode : found.model.modes) upright(chosen, mode.frequency_hz.value);
  for (auto* series : {&other, &stable, &chosen}) plot.add(std::move(*series));
  return plot;
}

/// Singular values of the spectral matrix with the modes: three for one record, the first one for
/// each set-up where there are several.
Plot spectra_plot(const std::string& id, const signal::AmbientResult& found, Origin origin) {
  Plot plot{id,
            "Singular values of the spectral matrix",
            "Motion of all channels together, each over its standard deviation. A mode is a peak "
            "of the first singular value; where the second rises with it, two modes are close. "
            "Lines: modes, broken where they are uncertain.",
            "frequency, Hz",
            "singular value",
            false,
            true};
  for (const auto& one : found.modes) mark(plot, one.mode);
  const bool one = found.spectra.size() == 1;
  for (const auto& spectrum : found.spectra) {
    const auto shown = std::min<Index>(one ? 3 : 1, spectrum.singular_values.cols());
    for (Index k = 0; k < shown; ++k) {
      const auto number = plot.series.size();
      PlotSeries series{fmt::format("{} {}", one ? "singular value" : "set-up", number + 1), origin,
                        static_cast<int>(number)};
      for (Index i = 0; i < spectrum.frequency_hz.size(); ++i) {
        series.add(spectrum.frequency_hz[i], spectrum.singular_values(i, k));
      }
      plot.add(std::move(series));
    }
  }
  return plot;
}

/// Shapes of the sure modes over the channels, whose places ambient recordings seldom give.
Plot channel_shapes_plot(const std::string& id, const signal::AmbientResult& found, Origin origin) {
  Plot plot{id, "Mode shapes",
            "Real part of each mode's shape at the channels in the order of the results, named on "
            "top; the largest is 1. Bars: 95 % intervals.",
            "channel", "shape"};
  for (const auto& channel : found.channels) {
    plot.marks.push_back({static_cast<double>(plot.marks.size() + 1), channel, false});
  }
  for (const auto& one : found.modes) {
    const auto& mode = one.mode;
    if (mode.doubtful) continue;
    const double factor = signal::coverage_factor(0.95, one.degrees);
    PlotSeries series{fmt::format("{:.4g} Hz", mode.frequency_hz.value), origin,
                      static_cast<int>(plot.series.size()), Style::line_and_points};
    for (Index c = 0; c < mode.shape.size(); ++c) {
      const double at = mode.shape[c].real(), half = factor * mode.shape_std(c, 0);
      series.add(static_cast<double>(c + 1), at, at - half, at + half);
    }
    plot.add(std::move(series));
  }
  return plot;
}

}  // namespace

std::vector<Plot> hammer_plots(const HammerFigures& of) {
  const auto id = [&](const char* what) {
    return fmt::format("{}-{}{}{}", of.name, what, of.state.empty() ? "" : "-", of.state);
  };
  std::vector<Plot> plots;
  if (of.test.hits() > 0) plots.push_back(hits_plot(id("hits"), of.places, of.test, of.origin));
  const auto& frfs = of.test.frfs;
  if (frfs.frequency_hz.size() == 0) return plots;
  const double last = frfs.frequency_hz[frfs.frequency_hz.size() - 1];
  const auto [low, high] = of.modal ? std::pair(of.modal->low_hz, of.modal->high_hz)
                                    : std::pair(of.low_hz, of.high_hz > 0 ? of.high_hz : last);
  const auto range = lines_between(frfs, low, high);
  if (range.last < range.first) return plots;
  const auto first = static_cast<std::ptrdiff_t>(plots.size());
  plots.push_back(magnitude_plot(id("frf"), frfs, range, of.origin));
  if (of.modal && !of.modal->model.modes.empty()) {
    add_rebuilt(plots.back(),
                signal::synthesised(
                    *of.modal, frfs.frequency_hz.segment(range.first, range.last - range.first + 1),
                    frfs.form));
  }
  plots.push_back(phase_plot(id("phase"), frfs, range, of.origin));
  if (frfs.coherence.size() > 0) {
    plots.push_back(coherence_plot(id("coherence"), frfs, range, of.origin));
  }
  if (of.modal) {
    for (auto plot = plots.begin() + first; plot != plots.end(); ++plot) {
      for (const auto& mode : of.modal->model.modes) mark(*plot, mode);
    }
    if (!of.modal->stabilisation.poles.empty()) {
      plots.push_back(stabilisation_plot(id("stabilisation"), *of.modal, of.origin));
    }
  }
  for (auto plot = plots.begin() + first; plot != plots.end(); ++plot) plot->link = id("frf");
  return plots;
}

std::vector<Plot> ambient_plots(const std::string& id, const signal::AmbientResult& found,
                                Origin origin) {
  std::vector<Plot> plots{spectra_plot(id + "-spectrum", found, origin)};
  signal::ModalResult sure;
  sure.model = found.sure_modes(), sure.stabilisation = found.stabilisation;
  plots.push_back(stabilisation_plot(id + "-stabilisation", sure, origin));
  for (auto& plot : plots) plot.link = id + "-spectrum";
  if (found.channels.size() > 1) {
    plots.push_back(channel_shapes_plot(id + "-shapes", found, origin));
    plots.back().link = plots.back().id;
  }
  std::erase_if(plots, [](const Plot& plot) { return plot.series.empty(); });
  return plots;
}

Plot frf_overlay_plot(const std::string& id, const ident::ModalTestState& recorded,
                      const ident::Instrumented& rig,
                      const std::vector<ident::ModelVersion>& versions) {
  constexpr Index kMostLines = 1500;  // computed of each version
  const auto& frfs = recorded.hammer.frfs;
  const double window = frfs.exponential_decay_rate_1_s;
  const auto range = lines_between(frfs, recorded.modal->low_hz, recorded.modal->high_hz);
  Eigen::VectorXd lines = frfs.frequency_hz.segment(range.first, range.last - range.first + 1);
  Plot plot = magnitude_plot(id, frfs, range, recorded.origin);
  plot.title = "Frequency response, test and model";
  plot.caption =
      "The test's average with its 95 % band, and the model's response to the same force";
  plot.caption += window > 0 ? ", both under the exponential window." : ".";
  for (auto& series : plot.series) series.name += ", test";
  const std::size_t columns = rig.response.size() * rig.input.size();
  const Index every = 1 + lines.size() / kMostLines;
  lines = lines(Eigen::seq(0, Eigen::last, every)).eval();
  for (std::size_t v = 0; v < versions.size(); ++v) {
    const auto model = model::synthesize_frfs(versions[v].scene, lines, {}, window);
    if (model.H.empty()) continue;
    for (std::size_t c = 0; c < columns; ++c) {
      const auto s = static_cast<Index>(c / rig.input.size()),
                 l = static_cast<Index>(c % rig.input.size());
      // Sensors have a colour each; a single one leaves the colours to the versions. The last
      // version is what the report stands for; those before it are broken lines.
      PlotSeries series{frf_name(frfs, rig.response[static_cast<std::size_t>(s)],
                                 rig.input[static_cast<std::size_t>(l)]) +
                            ", " + versions[v].label,
                        Origin::modelled, static_cast<int>(columns > 1 ? c : v + 1),
                        v + 1 < versions.size() ? Style::dashed : Style::line, versions[v].label};
      for (Index k = 0; k < lines.size(); ++k) {
        series.add(lines[k], std::abs(model.H[static_cast<std::size_t>(k)](s, l)));
      }
      plot.series.push_back(std::move(series));
    }
  }
  return plot;
}

}  // namespace rigfit::apps
