#include "apps/report/bending_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "apps/report/html_text.h"
#include "ident/bending_equation.h"
#include "ident/stiffness_law.h"

namespace rigfit::apps {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

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

Plot law_plot(const CampaignTest& test, const std::vector<Row>& rows,
              const std::vector<ident::FittedLaw>& laws,
              const std::optional<ident::StiffnessBounds>& bounds) {
  Plot plot;
  plot.id = test.name + "-EI";
  plot.title = "Bending stiffness against tension";
  plot.caption =
      "The tighter the strand is pulled, the more its wires hold on to each other and the stiffer "
      "it bends. The band is the 95 % band of the law closest to the points; between the bounds "
      "every strand must "
      "lie (free slip below, no slip above).";
  plot.x_label = "tension, N";
  plot.y_label = "EI, N m²";
  plot.log_y = bounds.has_value();
  const double low = rows.front().tension_N, high = rows.back().tension_N;
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
      const double tension = from + (to - from) * i / 80;
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
    ++variant;
    plot.series.push_back(std::move(series));
  }
  if (bounds) {
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
  PlotSeries points;
  points.name = "published EI";
  points.origin = Origin::published;
  points.style = PlotSeries::Style::points;
  for (const auto& row : rows) {
    points.x.push_back(row.tension_N);
    points.y.push_back(row.published_EI);
  }
  plot.series.push_back(std::move(points));
  return plot;
}

ReportTable law_table(const CampaignTest& test, const ident::StiffnessLaws& laws) {
  ReportTable table;
  table.id = test.name + "-laws";
  table.caption = "Laws for EI(T), best first by AICc (lower is better).";
  table.columns = {{"law", {}, false},
                   {"formula (EI in N m², T in N)", {}, false},
                   {"rms deviation", Origin::modelled},
                   {"AICc", Origin::modelled},
                   {"weight", Origin::modelled},
                   {"remark", {}, false}};
  for (const auto& law : laws.laws) {
    const double percent = 100 * law.rms_relative_error;
    table.rows.push_back({name_of(law.kind), law.formula, shown(percent, 2) + " %",
                          shown(law.aicc, 4), shown(law.akaike_weight, 2), law.message});
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

BendingPart bending_part(const Campaign& campaign, const CampaignTest& test) {
  BendingPart result;
  ReportPart& part = result.part;
  part.id = test.name;
  part.title = test.title;
  part.json_key = "bending";
  const auto rows = solve_rows(test);
  double worst = 0;
  Json tests = Json::array();
  for (const auto& row : rows) {
    if (row.solved.status != ident::BendingStatus::solved) {
      part.warnings.push_back({"bending-not-solved",
                               fmt::format("{} N: {}", row.tension_N, row.solved.reason), test.name,
                               true});
      continue;
    }
    worst = std::max(worst, std::abs(row.solved.EI_Nm2.value / row.published_EI - 1));
    result.curve.tension_N.push_back(row.tension_N);
    result.curve.EI_Nm2.push_back(row.solved.EI_Nm2.value);
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

  std::optional<ident::StiffnessBounds> bounds;
  if (campaign.strand) bounds = ident::stiffness_bounds(*campaign.strand);
  std::vector<ident::StiffnessPoint> points;
  for (std::size_t i = 0; i < result.curve.tension_N.size(); ++i) {
    points.push_back({result.curve.tension_N[i], result.curve.EI_Nm2[i], kNaN, kNaN, kNaN});
  }
  ident::StiffnessLaws laws;
  if (points.size() >= 2) {
    ident::StiffnessLawOptions options;
    options.bounds = bounds;
    laws = ident::fit_stiffness_laws(points, options);
  }

  part.blocks.push_back(Paragraph{fmt::format(
      "A length of cable is clamped at both ends, pulled to a tension and pressed sideways at "
      "mid-span. From the slope of deflection over load follows its bending stiffness EI. Here the "
      "EI values themselves are published; no uncertainty was published with them, so none is "
      "shown. "
      "The span of {:g} m only sets the slope shown.",
      test.span_m)});
  part.blocks.push_back(points_table(test, rows));
  if (!laws.laws.empty()) {
    part.blocks.push_back(law_plot(test, rows, laws.laws, bounds));
    part.blocks.push_back(Paragraph{laws.sentence, Paragraph::Kind::note});
    part.blocks.push_back(law_table(test, laws));
  }
  if (bounds) {
    part.blocks.push_back(Paragraph{fmt::format(
        "Bounds from the strand's geometry: EImin = {} N m² (all wires slip), EImax = {} "
        "N m² (none does).",
        shown(bounds->EI_min_Nm2, 4), shown(bounds->EI_max_Nm2, 6))});
  }

  if (!result.curve.empty()) {
    part.summary.push_back(
        {SummaryItem::Kind::result, "EI of the cable",
         fmt::format("{} N m² at {:g} N to {} N m² at {:g} N (round trip within {:.0e})",
                     shown(result.curve.EI_Nm2.front(), 4), result.curve.tension_N.front(),
                     shown(result.curve.EI_Nm2.back(), 4), result.curve.tension_N.back(),
                     std::max(worst, 1e-16)),
         Origin::published, part.id});
  }
  if (!laws.laws.empty() && !laws.decided) {
    part.summary.push_back(
        {SummaryItem::Kind::distrust, "Law for EI(T)", laws.sentence, {}, part.id});
  }

  part.json["test"] = test.name;
  part.json["span_m"] = test.span_m;
  part.json["tests"] = std::move(tests);
  Json law_list = Json::array();
  for (const auto& law : laws.laws) law_list.push_back(law_json(law));
  part.json["laws"] = std::move(law_list);
  part.json["laws_decided"] = laws.decided;
  if (bounds) {
    part.json["bounds"] = {{"EI_min_Nm2", bounds->EI_min_Nm2}, {"EI_max_Nm2", bounds->EI_max_Nm2}};
  }
  part.json["round_trip_relative_error"] = worst;
  return result;
}

}  // namespace rigfit::apps
