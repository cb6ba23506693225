#include "apps/report/parts/bending_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "apps/report/html_text.h"
#include "apps/report/parts/bending_records.h"
#include "apps/report/parts/recording_blocks.h"
#include "ident/bending/bending_equation.h"
#include "ident/bending/stiffness_law.h"
#include "signal/numerics/numbers.h"

namespace rigfit::apps {
namespace {

using signal::kNaN;

struct Row {
  double tension_N = 0, published_EI = 0, compliance_m_N = 0;
  ident::StiffnessFromBending solved;
};

std::vector<Row> solve_rows(const CampaignTest& test) {
  const auto& results = *test.results;
  std::vector<Row> rows;
  for (const auto& values : results.table.rows) {
    Row row;
    row.tension_N = values[*results.tension];
    row.published_EI = values[*results.EI];
    row.compliance_m_N = ident::midspan_compliance(row.published_EI, row.tension_N, test.span_m);
    row.solved = ident::stiffness_from_compliance(
        {{row.compliance_m_N, kNaN}, {row.tension_N, kNaN}, {test.span_m, kNaN}, 0});
    rows.push_back(row);
  }
  std::sort(rows.begin(), rows.end(),
            [](const Row& a, const Row& b) { return a.tension_N < b.tension_N; });
  return rows;
}

ReportTable points_table(const CampaignTest& test, const std::vector<Row>& rows) {
  ReportTable table;
  table.id = test.name + "-points";
  table.caption =
      "EI at each tension. The slope is what the source's EI means for this span; solving the "
      "bending equation for EI gives the published value back (round trip).";
  table.columns = {
      {"tension, N", Origin::published},           {"EI published, N m²", Origin::published},
      {"slope d/Q, µm/N", Origin::modelled},       {"4Pd/(Ql)", Origin::modelled},
      {"EI solved, N m²", Origin::modelled},       {"round trip", Origin::modelled},
      {"% of EI per % of slope", Origin::modelled}};
  for (const auto& row : rows) {
    table.rows.push_back(
        {shown(row.tension_N, 3), shown(row.published_EI, 4), shown(1e6 * row.compliance_m_N, 4),
         shown(row.solved.ratio, 4), shown(row.solved.EI_Nm2.value, 4),
         fmt::format("{:.0e}", std::abs(row.solved.EI_Nm2.value / row.published_EI - 1)),
         shown(row.solved.log_sensitivity_compliance, 3)});
  }
  return table;
}

Plot law_plot(const CampaignTest& test, const std::vector<PlotSeries>& points,
              const std::vector<ident::FittedLaw>& laws,
              const std::optional<ident::StiffnessBounds>& bounds) {
  Plot plot;
  plot.id = test.name + "-EI";
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
  const double from = std::max(1.0, low - 0.1 * (high - low)), to = high + 0.1 * (high - low);
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
    series.variant = variant;
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

ReportTable law_table(const CampaignTest& test, const ident::StiffnessLaws& laws) {
  ReportTable table;
  table.id = test.name + "-laws";
  const bool ranked =
      std::any_of(laws.laws.begin(), laws.laws.end(),
                  [](const ident::FittedLaw& law) { return std::isfinite(law.akaike_weight); });
  table.caption = ranked ? "Laws for EI(T), best first by AICc (lower is better)."
                         : "Laws for EI(T), best first by their deviation from the points.";
  table.columns = {{"law", {}, false},
                   {"formula (EI in N m², T in N)", {}, false},
                   {"rms deviation", Origin::modelled},
                   {"AICc", Origin::modelled},
                   {"weight", Origin::modelled},
                   {"remark", {}, false}};
  for (const auto& law : laws.laws) {
    const double percent = 100 * law.rms_relative_error;
    table.rows.push_back({name_of(law.kind), law.formula, shown(percent, 2) + " %",
                          ranked ? shown(law.aicc, 4) : "",
                          ranked ? shown(law.akaike_weight, 2) : "", law.message});
  }
  return table;
}

Json law_json(const ident::FittedLaw& law) {
  Json parameters = Json::array();
  for (const auto& parameter : law.parameters) {
    parameters.push_back({{"name", parameter.name},
                          {"value", parameter.value},
                          {"std", parameter.std},
                          {"unit", parameter.unit},
                          {"fixed", parameter.fixed}});
  }
  return {{"law", name_of(law.kind)},
          {"formula", law.formula},
          {"parameters", parameters},
          {"converged", law.converged},
          {"rms_relative_error", law.rms_relative_error},
          {"aicc", law.aicc},
          {"akaike_weight", law.akaike_weight}};
}

}  // namespace

double StiffnessCurve::at(double tension) const {
  const auto above = std::lower_bound(tension_N.begin(), tension_N.end(), tension);
  if (above == tension_N.begin()) return EI_Nm2.front();
  if (above == tension_N.end()) return EI_Nm2.back();
  const auto i = static_cast<std::size_t>(above - tension_N.begin());
  const double t = (tension - tension_N[i - 1]) / (tension_N[i] - tension_N[i - 1]);
  return EI_Nm2[i - 1] + t * (EI_Nm2[i] - EI_Nm2[i - 1]);
}

namespace {

/// What the laws are fitted to, how it is shown, and the blocks above the laws.
struct Points {
  std::vector<ident::StiffnessPoint> points;
  std::vector<PlotSeries> series;
  Origin origin = Origin::published;
  std::string remark;  ///< for the summary
};

Points published_points(const CampaignTest& test, ReportPart& part) {
  Points found;
  const auto rows = solve_rows(test);
  PlotSeries series;
  series.name = "published EI";
  series.origin = Origin::published;
  series.style = PlotSeries::Style::points;
  double worst = 0;
  Json tests = Json::array();
  for (const auto& row : rows) {
    if (!std::isfinite(row.solved.EI_Nm2.value)) {
      refuse(part, "bending-not-solved", row.solved.reason,
             fmt::format("{}, {:g} N", test.name, row.tension_N));
      continue;
    }
    worst = std::max(worst, std::abs(row.solved.EI_Nm2.value / row.published_EI - 1));
    series.x.push_back(row.tension_N);
    series.y.push_back(row.published_EI);
    found.points.push_back({row.tension_N, row.solved.EI_Nm2.value, kNaN, kNaN, kNaN});
    tests.push_back({{"tension_N", row.tension_N},
                     {"EI_Nm2",
                      {{"value", row.solved.EI_Nm2.value},
                       {"std", row.solved.EI_Nm2.std},
                       {"low", row.solved.low},
                       {"high", row.solved.high}}},
                     {"published_EI_Nm2", row.published_EI},
                     {"slope_m_N", row.compliance_m_N},
                     {"ratio", row.solved.ratio},
                     {"lambda", row.solved.lambda}});
  }
  part.blocks.push_back(Paragraph{fmt::format(
      "A length of cable is clamped at both ends, pulled to a tension and pressed sideways at "
      "mid-span. From the slope of deflection over load follows its bending stiffness EI. Here the "
      "EI values themselves are published; no uncertainty was published with them, so none is "
      "shown. The span of {:g} m only sets the slope shown.",
      test.span_m)});
  part.blocks.push_back(points_table(test, rows));
  part.json["tests"] = std::move(tests);
  part.json["round_trip_relative_error"] = worst;
  found.remark =
      fmt::format("the bending equation gives them back to {:.0e}", std::max(worst, 1e-16));
  found.series.push_back(std::move(series));
  return found;
}

Points recorded_points(const CampaignTest& test, ReportPart& part) {
  Points found;
  const auto loaded = load_recordings(test.recordings);
  for (const auto& entry : loaded) {
    part.inputs.insert(part.inputs.end(), entry.inputs.begin(), entry.inputs.end());
  }
  part.blocks.push_back(Paragraph{
      "A length of cable is clamped at both ends, pulled to a tension and pressed sideways at "
      "mid-span. From the slope of deflection over load follows its bending stiffness EI."});
  add_recordings(part, test, loaded);
  const auto records = bending_records(test, loaded, part);
  Json tests = Json::array();
  for (const auto& one : records) {
    tests.push_back(bending_record_json(one));
    const auto& EI = one.result.stiffness;
    if (one.result.refused || !std::isfinite(EI.EI_Nm2.value)) continue;
    auto at = std::find_if(found.series.begin(), found.series.end(),
                           [&](const PlotSeries& series) { return series.origin == one.origin; });
    if (at == found.series.end()) {
      PlotSeries series;
      series.name = fmt::format("EI, {}", name_of(one.origin));
      series.origin = one.origin;
      series.style = PlotSeries::Style::points;
      found.series.push_back(std::move(series));
      at = found.series.end() - 1;
    }
    at->x.push_back(one.result.tension_N.value);
    at->y.push_back(EI.EI_Nm2.value);
    at->low.push_back(EI.low);
    at->high.push_back(EI.high);
    found.points.push_back(
        {one.result.tension_N.value, EI.EI_Nm2.value, EI.EI_Nm2.std, EI.low, EI.high});
    found.origin = one.origin;
  }
  part.json["tests"] = std::move(tests);
  if (!records.empty()) {
    part.blocks.push_back(load_deflection_plot(test, records));
    part.blocks.push_back(bending_records_table(test, records));
  }
  found.remark = fmt::format("{} of {} recordings gave one", found.points.size(), loaded.size());
  return found;
}

/// Means of what was taken at about one tension (within 5 %), so that EI(T) is a function.
StiffnessCurve curve_of(std::vector<ident::StiffnessPoint> points) {
  StiffnessCurve curve;
  std::sort(points.begin(), points.end(),
            [](const auto& a, const auto& b) { return a.tension_N < b.tension_N; });
  for (std::size_t i = 0; i < points.size();) {
    double tension = 0, EI = 0;
    std::size_t k = i;
    for (; k < points.size() && points[k].tension_N <= 1.05 * points[i].tension_N; ++k) {
      tension += points[k].tension_N;
      EI += points[k].EI_Nm2;
    }
    const auto n = static_cast<double>(k - i);
    curve.tension_N.push_back(tension / n);
    curve.EI_Nm2.push_back(EI / n);
    i = k;
  }
  return curve;
}

}  // namespace

BendingPart bending_part(const Campaign& campaign, const CampaignTest& test) {
  BendingPart result;
  ReportPart& part = result.part;
  part.id = test.name;
  part.title = test.title;
  part.json_key = "bending";
  part.json["test"] = test.name;
  part.json["span_m"] = test.span_m;
  const Points found = test.results ? published_points(test, part) : recorded_points(test, part);
  result.curve = curve_of(found.points);

  std::optional<ident::StiffnessBounds> bounds;
  if (campaign.strand) bounds = ident::stiffness_bounds(*campaign.strand);
  ident::StiffnessLaws laws;
  if (found.points.size() >= 2) {
    ident::StiffnessLawOptions options;
    options.bounds = bounds;
    laws = ident::fit_stiffness_laws(found.points, options);
    part.blocks.push_back(law_plot(test, found.series, laws.laws, bounds));
    part.blocks.push_back(Paragraph{laws.sentence, Paragraph::Kind::note});
    part.blocks.push_back(law_table(test, laws));
  }
  if (bounds) {
    part.blocks.push_back(
        Paragraph{fmt::format("Bounds from the strand's geometry: EImin = {} N m² (all wires "
                              "slip), EImax = {} N m² (none "
                              "does).",
                              shown(bounds->EI_min_Nm2, 4), shown(bounds->EI_max_Nm2, 6))});
  }

  const auto& curve = result.curve;
  if (!curve.empty()) {
    part.summary.push_back(
        {SummaryItem::Kind::result, "EI of the cable",
         fmt::format("{} N m² at {} N to {} N m² at {} N ({})", shown(curve.EI_Nm2.front(), 4),
                     shown(curve.tension_N.front(), 3), shown(curve.EI_Nm2.back(), 4),
                     shown(curve.tension_N.back(), 3), found.remark),
         found.origin, part.id});
  }
  if (!laws.laws.empty() && !laws.decided) {
    part.summary.push_back(
        {SummaryItem::Kind::distrust, "Law for EI(T)", laws.sentence, {}, part.id});
  }
  Json law_list = Json::array();
  for (const auto& law : laws.laws) law_list.push_back(law_json(law));
  part.json["laws"] = std::move(law_list);
  part.json["laws_decided"] = laws.decided;
  if (bounds) {
    part.json["bounds"] = {{"EI_min_Nm2", bounds->EI_min_Nm2}, {"EI_max_Nm2", bounds->EI_max_Nm2}};
  }
  return result;
}

}  // namespace rigfit::apps
