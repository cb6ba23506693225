#include "apps/report/parts/bending_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/drawing/html_text.h"
#include "apps/report/figures/bending_plots.h"
#include "apps/report/figures/recording_blocks.h"
#include "apps/report/parts/beam_part.h"
#include "apps/report/parts/bending_records.h"
#include "apps/results/bending_json.h"
#include "ident/bending/bending_equation.h"
#include "signal/numerics/numbers.h"

namespace rigfit::apps {
namespace {

using signal::kNaN;

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

ReportTable published_table(const CampaignTest& test, const ident::BendingCampaignResult& result) {
  ReportTable table;
  table.id = test.name + "-points";
  table.caption = "Published EI at each tension.";
  table.columns = {{"tension, N", Origin::published}, {"EI, N m²", Origin::published}};
  for (const auto& one : result.points) {
    const auto& point = one.point;
    table.rows.push_back({shown(point.tension_N, 3), std::isfinite(point.std)
                                                         ? shown_estimate(point.EI_Nm2, point.std)
                                                         : shown(point.EI_Nm2, 4)});
  }
  return table;
}

BendingTests published(const CampaignTest& test) {
  BendingTests tests;
  const auto& results = *test.results;
  ident::BendingSource source;
  source.name = results.table.file;
  const auto column = [&](const std::string& beginning) -> std::optional<std::size_t> {
    for (std::size_t i = 0; i < results.table.columns.size(); ++i) {
      if (results.table.columns[i].starts_with(beginning)) return i;
    }
    return std::nullopt;
  };
  const auto std = column("std"), low = column("low"), high = column("high");
  for (const auto& row : results.table.rows) {
    const auto at = [&](std::optional<std::size_t> index) { return index ? row[*index] : kNaN; };
    source.values.push_back({row[*results.tension], row[*results.EI], at(std), at(low), at(high)});
  }
  tests.campaign.sources.push_back(std::move(source));
  tests.origins.push_back(Origin::published);
  return tests;
}

/// Tests' JSON, tables and warnings; a line on the points for the summary.
std::string show_points(const CampaignTest& test, const BendingTests& tests,
                        const ident::BendingCampaignResult& result, ReportPart& part) {
  Json& list = part.json["tests"];
  std::size_t usable = 0;
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    const auto& one = result.points[i];
    usable += one.usable();
    list[i]["origin"] = word_of(tests.origins[one.source]);
    if (!one.analysis) continue;
    list[i]["slope_m_N"] = list[i]["compliance_m_N"];
  }
  add_findings(tests.campaign, result, part);
  if (!test.results) {
    if (!result.points.empty()) {
      part.blocks.push_back(load_deflection_plot(test.name + "-load-deflection", tests.campaign,
                                                 tests.origins, result));
      part.blocks.push_back(bending_records_table(test, tests.campaign, tests.origins, result));
    }
    return fmt::format("{} of {} tests gave one", usable, result.points.size());
  }
  part.blocks.push_back(published_table(test, result));
  return fmt::format("published, {}", counted(result.points.size(), "tension"));
}

void show_laws(const CampaignTest& test, const std::vector<PlotSeries>& series,
               const ident::BendingCampaignResult& result, ReportPart& part) {
  const auto& laws = result.curve.laws();
  const auto& bounds = result.bounds;
  if (!laws.laws.empty()) {
    part.blocks.push_back(stiffness_plot(test.name + "-EI", series, result));
    part.blocks.push_back(
        Paragraph{"For the model: " + result.curve.sentence(), Paragraph::Kind::note});
    part.blocks.push_back(law_table(test, laws));
  }
  if (bounds) {
    part.blocks.push_back(
        Paragraph{fmt::format("Bounds from the strand's geometry: EImin = {} N m² (all wires "
                              "slip), EImax = {} N m² (none "
                              "does).",
                              shown(bounds->EI_min_Nm2, 4), shown(bounds->EI_max_Nm2, 6))});
  }
  if (!laws.laws.empty() && !laws.decided) {
    part.summary.push_back(
        {SummaryItem::Kind::distrust, "Law for EI(T)", result.curve.sentence(), {}, part.id});
  }
}

/// EI at the lowest and the highest tension on the first page, those between where there is room.
void add_answers(const CampaignTest& test, const ident::BendingCampaignResult& result,
                 Origin origin, ReportPart& part) {
  std::vector<const ident::BendingPoint*> points;
  for (const auto& one : result.points) {
    if (one.usable()) points.push_back(&one);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& point = points[i]->point;
    Answer answer;
    answer.key = fmt::format("{}/EI/{}", test.name, i + 1);
    answer.quantity = fmt::format("Cable bending stiffness EI at {} N", shown(point.tension_N, 3));
    answer.how = test.results ? "published" : "bending test";
    answer.unit = "N m²";
    answer.value = point.EI_Nm2;
    answer.std = point.std;
    answer.low = point.low;
    answer.high = point.high;
    if (points[i]->analysis) {  // with what the tests share
      answer.std = points[i]->analysis->stiffness.EI_Nm2.std;
      answer.low = points[i]->analysis->stiffness.low;
      answer.high = points[i]->analysis->stiffness.high;
    }
    answer.origin = origin;
    answer.anchor = part.id;
    answer.rank = i == 0 || i + 1 == points.size() ? 0 : 1;
    part.answers.push_back(std::move(answer));
  }
}

class BendingPart : public TestPart {
 public:
  BendingPart(const Campaign& campaign, const CampaignTest& test) : test_(test) {
    part_.id = test.name;
    part_.title = test.title;
    part_.json_key = "bending";
    part_.json["test"] = test.name;
    part_.json["span_m"] = test.span_m;
    tests_.campaign.strand = campaign.strand;
  }

  void read(const FileRead& file_read) override {
    std::string words =
        "A length of cable is clamped at both ends, pulled to a tension and pressed sideways at "
        "mid-span. From the slope of deflection over load follows its bending stiffness EI.";
    if (test_.results) {
      words += fmt::format(
          " Here the EI values themselves are published; what uncertainty was published with them "
          "is shown. The span of {:g} m only sets the slope shown.",
          test_.span_m);
    }
    part_.blocks.push_back(Paragraph{std::move(words)});
    const auto strand = tests_.campaign.strand;
    tests_ = test_.results ? published(test_) : recorded_tests(test_, file_read, part_);
    tests_.campaign.strand = strand;
    auto& options = tests_.campaign.test;
    options.span_m = {test_.span_m, test_.span_std_m};
    options.tension_zero_std_N = test_.tension_zero_std_N;
    options.clamp_stiffness_Nm_rad = test_.clamp_stiffness_Nm_rad;
    options.tension_calibration_std = test_.tension_calibration_std;
    options.load_calibration_std = test_.load_calibration_std;
    options.deflection_calibration_std = test_.deflection_calibration_std;
  }

  void add_to(ident::CampaignInputs& inputs) override {
    index_ = inputs.bending.size();
    inputs.bending.push_back(std::move(tests_.campaign));
  }

  std::vector<ReportPart> show(ident::CampaignResult& campaign) override {
    const auto& result = campaign.bending[index_];
    tests_.campaign = std::move(campaign.inputs.bending[index_]);
    part_.json.update(bending_json(tests_.campaign, result));
    part_.json["laws_decided"] = result.curve.laws().decided;
    for (const auto& finding : result.findings) {
      part_.warnings.push_back({finding.code, finding.message, test_.name, false});
    }
    const std::string remark = show_points(test_, tests_, result, part_);
    const auto series = stiffness_series(result, tests_.origins);
    show_laws(test_, series, result, part_);
    if (result.curve.empty()) return {std::move(part_)};
    const Origin origin = series.back().origin;
    const auto &first = result.curve.points().front(), &last = result.curve.points().back();
    add_answers(test_, result, origin, part_);
    part_.brief = {test_.name + "-EI", test_.name + "-points", test_.name + "-results"};
    part_.summary.push_back({SummaryItem::Kind::result, "EI of the cable",
                             fmt::format("{} N m² at {} N to {} N m² at {} N ({})",
                                         shown(first.EI_Nm2, 4), shown(first.tension_N, 3),
                                         shown(last.EI_Nm2, 4), shown(last.tension_N, 3), remark),
                             origin, part_.id});
    return {std::move(part_)};
  }

 private:
  const CampaignTest& test_;
  BendingTests tests_;
  std::size_t index_ = 0;
  ReportPart part_;
};

}  // namespace

std::unique_ptr<TestPart> bending_part(const Campaign& campaign, const CampaignTest& test) {
  if (test.beam) return beam_part(test);
  return std::make_unique<BendingPart>(campaign, test);
}

}  // namespace rigfit::apps
