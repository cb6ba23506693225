
#include "apps/report/figures/figures.h"
#include "ident/bending/bending_equation.h"
#include "ident/statistics/uncertainty.h"

namespace rigfit::apps {

using Style = PlotSeries::Style;

std::string short_name(const std::string& file) {
  return std::filesystem::path(file).filename().string();
}

std::string unit_words(const std::string& unit) {
  std::string text = unit.empty() ? "no unit" : unit;
  if (const auto at = text.find("^2"); at != std::string::npos) text.replace(at, 2, "²");
  return text;
}

// Decays ------------------------------------------------------------------------------------------

Plot decay_plot(const std::string& id, const ident::RecordedDecay& decay) {
  Plot plot{id, "Decay and fit: " + short_name(decay.file),
            "The record, the damped oscillations fitted to it, and the residual, both without what "
            "lies far above a band that is given. A residual that looks like noise means that the "
            "fit is complete.",
            "time, s", fmt::format("{}, {}", decay.channel, unit_words(decay.unit))};
  PlotSeries record{"record", decay.origin, 0}, fit{"fit", Origin::modelled, 1},
      residual{"residual", decay.origin, 2};
  for (Eigen::Index i = 0; i < decay.samples.size(); ++i)
    record.add(decay.time_s(i), decay.samples[i]);
  const auto& r = decay.result;
  for (Eigen::Index i = 0; i < r.residual.size(); ++i) {
    const Eigen::Index at = r.start + i * r.step;
    fit.add(decay.time_s(at), r.fitted[i]);
    residual.add(decay.time_s(at),
                 std::isfinite(decay.samples[at]) ? r.residual[i] : Answer::kNone);
  }
  for (auto* series : {&record, &fit, &residual}) plot.add(std::move(*series));
  return plot;
}

Plot damping_plot(const std::string& id, const std::vector<ident::RecordedDecay>& decays) {
  Plot plot{id,
            "Damping against amplitude",
            "Damping of the strongest mode along each decay. Level: viscous, the same at every "
            "size of motion; rising towards small motion: friction; rising towards large motion: "
            "drag.",
            "amplitude",
            "damping ratio, %",
            true};
  for (const auto& decay : decays) {
    const auto& points = decay.result.envelope.points;
    if (points.size() < 2) continue;
    plot.x_label = "amplitude, " + unit_words(decay.unit);
    PlotSeries series{short_name(decay.file) + (decay.channel.empty() ? "" : ", " + decay.channel),
                      decay.origin, static_cast<int>(plot.series.size()), Style::line_and_points};
    for (const auto& point : points) {
      const double y = 100 * point.damping_ratio.value,
                   half = 100 * decay.result.coverage_factor_95 * point.damping_ratio.std;
      series.add(point.amplitude, y, y - half, y + half);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

namespace {

Plot axial_length_plot(const std::string& id, const ident::AxialTestResult& r, Origin origin,
                       const CampaignTest* test) {
  Plot plot{id, "EA by length",
            "EA at each length if only the cable stretches. EA does not depend on the length of "
            "cable that was tested; a trend is a compliance in series (frame, adapter), which the "
            "result leaves out. The band is the result with its 95 % interval.",
            "length, m", "EA, kN"};
  const double k95 = ident::coverage_factor(0.95, 0);
  PlotSeries records{"each record", origin, 2, Style::points};
  for (const auto& one : r.samples) records.add(one.length_m, 1e-3 * one.EA_N.value);
  PlotSeries each{"EA at each length, 95 %", origin, 1, Style::points};
  double low = r.lengths.front().length_m, high = low;
  for (const auto& one : r.lengths) {
    low = std::min(low, one.length_m), high = std::max(high, one.length_m);
    const double y = 1e-3 * one.EA_N.value, half = 1e-3 * k95 * one.EA_N.std;
    each.add(one.length_m, y, y - half, y + half);
  }
  const double margin = high > low ? 0.1 * (high - low) : 0.1 * high;
  PlotSeries all{r.conditional ? "EA, if only the cable stretches" : "EA, all lengths"};
  PlotSeries known;
  if (test && test->EA_N) {
    known = {test->reference_name, test->reference_name == "published" ? Origin::published : origin,
             3, Style::dashed};
  }
  for (const double x : {low - margin, high + margin}) {
    all.add(x, 1e-3 * r.EA_N.value, 1e-3 * (r.conditional ? r.EA_if_rigid_N.low : r.EA_N.low),
            1e-3 * (r.conditional ? r.EA_if_rigid_N.high : r.EA_N.high));
    if (!known.name.empty()) known.add(x, 1e-3 * *test->EA_N);
  }
  for (auto* series : {&all, &records, &each, &known}) plot.add(std::move(*series));
  return plot;
}

Plot load_deflection_plot(const std::string& id, const ident::BendingCampaign& campaign,
                          const ident::BendingCampaignResult& result) {
  const bool tensioned = campaign.test.ends == ident::BeamEnds::tensioned;
  Plot plot{id, "Load against deflection",
            tensioned ? "Each recording loads the cable at mid-span and unloads it again; the "
                        "slope of the straight parts gives EI. The gap between loading and "
                        "unloading is friction between the wires."
                      : "Load against deflection of beams without tension; the slope of the "
                        "elastic part, between a toe and yield or a stop, gives EI.",
            "deflection, mm", "load, N"};
  for (const auto& one : result.points) {
    if (!one.analysis) continue;
    const std::string file = short_name(one.file);
    PlotSeries series{tensioned ? fmt::format("{:.0f} N: {}", one.point.tension_N, file) : file,
                      one.origin, static_cast<int>(plot.series.size())};
    const Eigen::Index n = one.record.load_N.size();
    for (Eigen::Index i = 0; i < n; i += 1 + n / 600) {
      const double d = one.record.deflection_m[i], load = one.record.load_N[i];
      if (std::isfinite(load) && std::isfinite(d)) series.add(1e3 * d, load);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

Plot stiffness_plot(const std::string& id, const ident::BendingCampaignResult& result) {
  const auto& bounds = result.bounds;
  Plot plot{id,
            "Bending stiffness against tension",
            "The tighter the strand is pulled, the more its wires hold on to each other and the "
            "stiffer it bends.",
            "tension, N",
            "EI, N m²",
            false,
            bounds.has_value()};
  double low = std::numeric_limits<double>::infinity(), high = 0;
  std::vector<PlotSeries> points;  // a series an origin
  for (const auto& one : result.points) {
    if (!one.usable()) continue;
    low = std::min(low, one.point.tension_N), high = std::max(high, one.point.tension_N);
    auto at = std::ranges::find(points, one.origin, &PlotSeries::origin);
    if (at == points.end()) {
      const auto name = one.origin == Origin::published
                            ? "published EI"
                            : fmt::format("EI, {}", name_of(one.origin));
      at =
          points.insert(at, {name, one.origin, 2 + static_cast<int>(points.size()), Style::points});
    }
    at->add(one.point.tension_N, one.point.EI_Nm2, one.point.low, one.point.high);
  }
  if (points.empty()) return plot;
  const double from = std::max(0.5 * low, low - 0.1 * (high - low)), to = high + 0.1 * (high - low);
  // The law that lies closest to the points comes first, with its band.
  std::vector<const ident::FittedLaw*> closest;
  for (const auto& law : result.curve.laws().laws) {
    if (law.converged) closest.push_back(&law);
  }
  std::ranges::stable_sort(closest, {}, &ident::FittedLaw::rms_relative_error);
  for (const auto* law : closest) {
    const auto variant = static_cast<int>(plot.series.size());
    PlotSeries series{fmt::format("law: {}", name_of(law->kind)), Origin::modelled,
                      variant < 2 ? variant : variant + 2};
    const bool band = variant == 0 && ident::predict(*law, from).low > 0;
    for (int i = 0; i <= 80; ++i) {
      const double tension = from + (to - from) * i * i / 6400;  // laws bend most where slack
      const auto predicted = ident::predict(*law, tension);
      if (band) {
        series.add(tension, predicted.EI_Nm2, predicted.low, predicted.high);
      } else {
        series.add(tension, predicted.EI_Nm2);
      }
    }
    if (band) plot.caption += " The band is the 95 % band of the law closest to the points.";
    plot.series.push_back(std::move(series));
  }
  if (bounds) {
    plot.caption += " Every strand lies between the bounds (free slip below, no slip above).";
    for (const auto& [name, value] : {std::pair{"EImin, wires slip", bounds->EI_min_Nm2},
                                      std::pair{"EImax, no slip", bounds->EI_max_Nm2}}) {
      PlotSeries series{name, Origin::modelled, 2, Style::dashed};
      for (const double x : {from, to}) series.add(x, value);
      plot.series.push_back(std::move(series));
    }
  }
  for (auto& series : points) plot.series.push_back(std::move(series));
  return plot;
}

}  // namespace

// Axial tests -------------------------------------------------------------------------------------

std::vector<Block> axial_blocks(const std::string& id, const ident::AxialCampaignResult& result,
                                const CampaignTest* test) {
  PlotGroup group{id + "-decays", "Decays", {}};
  std::vector<ident::RecordedDecay> decays;
  double last = -1;
  for (const auto& d : result.decays) {
    if (!d.mode || d.length_m == last) continue;  // the first of each length
    last = d.length_m;
    decays.push_back(d);
    group.tabs.push_back({fmt::format("{:g} m", last),
                          {decay_plot(fmt::format("{}-decay-{:g}m", id, last), decays.back())}});
  }
  std::vector<Block> blocks;
  if (result.test) {
    const Origin origin = decays.front().origin;
    add(blocks, axial_length_plot(id + "-EA", *result.test, origin, test));
    add(blocks, described_table(id + "-lengths",
                                "EA, damping ratio and equivalent damper by length, with standard "
                                "uncertainties.",
                                describe::table_of(result.test->lengths), origin));
    add(blocks, described_table(id + "-values", "Result of all lengths, with 95 % intervals.",
                                describe::sheet_of(*result.test).lines, origin));
    add(blocks, described_table(id + "-budget", "Where the uncertainty of EA comes from.",
                                describe::table_of(result.test->budget)));
  }
  add(blocks, std::move(group));
  add(blocks, damping_plot(id + "-damping", decays));
  return blocks;
}

// Bending tests -----------------------------------------------------------------------------------

std::vector<Block> bending_blocks(const std::string& id, const ident::BendingCampaign& campaign,
                                  const ident::BendingCampaignResult& result) {
  const bool tensioned = campaign.test.ends == ident::BeamEnds::tensioned;
  std::vector<Block> blocks;
  if (result.points.empty()) return blocks;
  if (tensioned) add(blocks, stiffness_plot(id + "-EI", result));
  auto rows = result.points;
  for (auto& row : rows) row.file = short_name(row.file);
  add(blocks,
      described_table(id + "-results", "EI with its standard uncertainty and 95 % interval.",
                      describe::table_of(std::move(rows)), campaign.sources.front().origin));
  add(blocks, load_deflection_plot(id + "-load-deflection", campaign, result));
  if (const auto& laws = result.curve.laws().laws; tensioned && !laws.empty()) {
    add(blocks, Paragraph{"For the model: " + result.curve.sentence(), Paragraph::Kind::note});
    add(blocks, described_table(id + "-laws", "Laws for EI(T), the closest first.",
                                describe::table_of(laws), Origin::modelled));
  }
  if (result.bounds && tensioned) {
    add(blocks, described_table(id + "-bounds", "Bounds from the strand's geometry.",
                                describe::sheet_of(*result.bounds).lines));
  }
  if (result.specimens) {
    add(blocks, described_table(id + "-specimens", "All specimens.",
                                describe::sheet_of(*result.specimens).lines));
  }
  return blocks;
}

// Tension from frequencies ------------------------------------------------------------------------

std::vector<Block> tension_blocks(const std::string& id, const ident::TensionResult& result) {
  const auto& best = result.candidates.front();
  Plot frequencies{id + "-frequencies", "Frequencies over mode number",
                   "Measured, and the model's with each kind of ends.", "mode number",
                   "frequency, Hz"};
  Plot errors{id + "-errors", "Model over test, mode by mode",
              "A trend over the mode number means that bending stiffness, ends or sag are not "
              "those of the cable.",
              "mode number", "model over test, %"};
  frequencies.link = errors.link = id;
  PlotSeries measured{"measured", Origin::measured, 0, Style::points};
  for (const auto& mode : best.modes) {
    if (mode.order > 0) measured.add(mode.order, mode.measured_hz);
  }
  frequencies.add(std::move(measured));
  int variant = 0;
  for (const auto& one : result.candidates) {
    if (!one.solved) continue;
    PlotSeries model{fmt::format("{} ends, weight {:.2g}", ident::name_of(one.ends), one.weight),
                     Origin::modelled, ++variant, Style::points};
    PlotSeries error = model;
    for (const auto& mode : one.modes) {
      if (mode.order <= 0) continue;
      model.add(mode.order, mode.model_hz);
      error.add(mode.order, 100 * mode.relative_error);
    }
    frequencies.add(std::move(model)), errors.add(std::move(error));
  }
  std::vector<Block> blocks;
  add(blocks, described_table(id + "-ends",
                              "Tension at mid-span by kind of ends; the result is the average by "
                              "weight. p: probability of a larger misfit if the model were right.",
                              describe::table_of(result.candidates), Origin::modelled));
  add(blocks, std::move(frequencies));
  add(blocks, std::move(errors));
  add(blocks, described_table(id + "-budget", "Where the uncertainty of the tension comes from.",
                              describe::table_of(result.budget)));
  add(blocks, described_table(id + "-values",
                              "Results over all kinds of ends, and closed forms from the lowest "
                              "mode.",
                              describe::sheet_of(result).lines, Origin::modelled));
  add(blocks, described_table(id + "-modes",
                              fmt::format("Measured frequencies and those of the model, {} ends.",
                                          ident::name_of(best.ends)),
                              describe::table_of(best.modes)));
  return blocks;
}

// Fits --------------------------------------------------------------------------------------------

std::vector<Block> fit_blocks(const std::string& id, const std::vector<ident::UpdateState>& states,
                              const ident::UpdateResult& result) {
  Plot plot{id + "-errors-by-mode", "Model against test, mode by mode",
            "How far the model's frequency lies above the test's.", "frequency of the test, Hz",
            "model over test, %"};
  if (!result.held.empty()) plot.caption += " Held out: predicted from the other states.";
  PlotSeries before{"before the fit", Origin::modelled, 2, Style::points},
      held{"held out, predicted", Origin::modelled, 1, Style::points},
      fitted{"fitted", Origin::modelled, 0, Style::points};
  const auto add_pairs = [](PlotSeries& series, const std::vector<ident::UpdatedPair>& pairs) {
    for (const auto& pair : pairs) {
      if (!pair.cross_plane) series.add(pair.measured_hz, 100 * pair.relative_error);
    }
  };
  add_pairs(before, result.pairs_before);
  for (const auto& one : result.held) add_pairs(held, one.pairs);
  bool bars = false;
  const double k95 = ident::coverage_factor(0.95, 0);
  for (const auto& pair : result.pairs) {
    if (pair.cross_plane) continue;
    const auto& mode = states[static_cast<std::size_t>(pair.state)]
                           .measured[static_cast<std::size_t>(pair.measured)];
    const double error = 100 * pair.relative_error,
                 half = 100 * k95 * mode.frequency_hz.std / pair.measured_hz;
    bars = bars || std::isfinite(half);
    fitted.add(pair.measured_hz, error, error - half, error + half);
  }
  if (bars) plot.caption += " Bars: the test's own 95 % interval.";
  for (auto* series : {&before, &held, &fitted}) plot.add(std::move(*series));
  std::vector<Block> blocks;
  add(blocks, std::move(plot));
  ReportTable budgets{id + "-budget",
                      "Where the uncertainty of each parameter comes from; the squares of the "
                      "contributions add up. Those under 0.5 % of the variance are left out.",
                      {{"parameter", {}, false}}};
  for (const auto& parameter : result.parameters) {
    auto terms = parameter.budget;
    std::erase_if(terms, [&](const auto& term) { return term.std < 0.07 * parameter.std; });
    for (auto& term : terms) term.source = with_parameter_words(term.source);
    add_rows(budgets, {parameter_words(parameter.name)}, describe::table_of(std::move(terms)),
             Origin::modelled);
  }
  add(blocks, std::move(budgets));
  return blocks;
}

}  // namespace rigfit::apps
