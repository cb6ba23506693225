#include "apps/report/parts/beam_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "apps/report/drawing/html_text.h"
#include "apps/report/figures/bending_plots.h"
#include "apps/report/figures/recording_blocks.h"
#include "apps/report/parts/bending_records.h"
#include "apps/results/bending_json.h"

namespace rigfit::apps {
namespace {

std::string setup_of_beam(const CampaignTest& test) {
  const char* const held =
      test.beam->ends == ident::BeamEnds::cantilever
          ? "clamped at one end and loaded at the other"
          : (test.beam->ends == ident::BeamEnds::pinned ? "laid on two supports and loaded between"
                                                        : "clamped at both ends and loaded between "
                                                          "them");
  return fmt::format(
      "A beam is {}, {:g} m, without tension. From the slope of load over deflection in its "
      "elastic part follows EI = slope span³ / {:g}; shear is left out.",
      held, test.span_m, ident::beam_stiffness_factor(test.beam->ends));
}

ReportTable specimen_table(const CampaignTest& test, const BendingTests& tests,
                           const ident::BendingCampaignResult& result) {
  const bool section = tests.campaign.second_moment_m4.value > 0;
  const Origin origin = tests.origins.empty() ? Origin::measured : tests.origins.front();
  ReportTable table;
  table.id = test.name + "-results";
  table.caption = "EI from each recording with its standard uncertainty and 95 % interval.";
  table.columns = {{"recording", {}, false},
                   {"origin", {}, false},
                   {"slope, N/m", origin},
                   {"EI, N m²", origin},
                   {"95 %, N m²", origin}};
  if (section) table.columns.push_back({"modulus, GPa", origin});
  table.columns.push_back({"remarks", {}, false});
  for (const auto& one : result.points) {
    const Origin from = tests.origins[one.source];
    const auto& point = one.point;
    std::vector<Cell> row{short_name(tests.campaign.sources[one.source].name),
                          Cell(name_of(from), from)};
    if (one.usable() && one.analysis) {
      const auto& slope = one.analysis->compliance_m_N;
      row.emplace_back(shown_estimate(1 / slope.value, slope.std / slope.value / slope.value),
                       from);
      row.emplace_back(shown_estimate(point.EI_Nm2, point.std), from);
      row.emplace_back(std::isfinite(point.low) ? shown_bound(point.low, point.std) + " to " +
                                                      shown_bound(point.high, point.std)
                                                : std::string());
    } else {
      row.insert(row.end(), {Cell("none", from), Cell("none", from), Cell("")});
    }
    if (section) {
      const auto modulus = ident::bending_modulus(tests.campaign, one);
      row.emplace_back(one.usable() ? shown_estimate(1e-9 * modulus.value, 1e-9 * modulus.std)
                                    : std::string());
    }
    Cell remarks;
    const auto findings =
        one.analysis ? one.analysis->findings : std::vector<ident::BendingFinding>();
    for (const auto& finding : findings) {
      remarks.text += (remarks.text.empty() ? "" : "; ") + finding.message;
    }
    remarks.doubtful = !remarks.text.empty();
    row.push_back(std::move(remarks));
    table.rows.push_back(std::move(row));
  }
  return table;
}

class BeamPart : public TestPart {
 public:
  explicit BeamPart(const CampaignTest& test) : test_(test) {
    part_.id = test.name;
    part_.title = test.title;
    part_.json_key = "bending";
    part_.json["test"] = test.name;
    part_.json["span_m"] = test.span_m;
  }

  void read(const FileRead& file_read) override {
    part_.blocks.push_back(Paragraph{setup_of_beam(test_)});
    tests_ = recorded_tests(test_, file_read, part_);
    auto& campaign = tests_.campaign;
    campaign.second_moment_m4 = ident::second_moment(test_.beam->section);
    campaign.test.ends = test_.beam->ends;
    campaign.test.span_m = {test_.span_m, test_.span_std_m};
    campaign.test.load_calibration_std = test_.load_calibration_std;
    campaign.test.deflection_calibration_std = test_.deflection_calibration_std;
  }

  void add_to(ident::CampaignInputs& inputs) override {
    index_ = inputs.bending.size();
    inputs.bending.push_back(std::move(tests_.campaign));
  }

  std::vector<ReportPart> show(ident::CampaignResult& campaign) override {
    const auto& result = campaign.bending[index_];
    tests_.campaign = std::move(campaign.inputs.bending[index_]);
    part_.json.update(bending_json(tests_.campaign, result));
    part_.json["laws_decided"] = false;
    for (std::size_t i = 0; i < result.points.size(); ++i) {
      auto& entry = part_.json["tests"][i];
      entry["origin"] = word_of(tests_.origins[result.points[i].source]);
      entry["slope_m_N"] = entry["compliance_m_N"];
    }
    add_findings(tests_.campaign, result, part_);
    for (const auto& finding : result.findings) {
      part_.warnings.push_back({finding.code, finding.message, test_.name, false});
    }
    if (!result.points.empty()) {
      part_.blocks.push_back(load_deflection_plot(test_.name + "-load-deflection", tests_.campaign,
                                                  tests_.origins, result));
      part_.blocks.push_back(specimen_table(test_, tests_, result));
    }
    answer(result);
    part_.brief = {test_.name + "-load-deflection", test_.name + "-results"};
    return {std::move(part_)};
  }

 private:
  /// EI of each specimen, on the first page the first one's; with two and more their scatter.
  void answer(const ident::BendingCampaignResult& result) {
    int found = 0;
    for (const auto& one : result.points) {
      if (!one.usable()) continue;
      const Origin origin = tests_.origins[one.source];
      const std::string file = short_name(tests_.campaign.sources[one.source].name);
      Answer EI;
      EI.key = fmt::format("{}/EI/{}", test_.name, found + 1);
      EI.quantity = fmt::format("Beam bending stiffness EI ({})", file);
      EI.how = "bending test without tension";
      EI.unit = "N m²";
      EI.value = one.point.EI_Nm2;
      EI.std = one.point.std;
      EI.low = one.point.low;
      EI.high = one.point.high;
      EI.origin = origin;
      EI.anchor = part_.id;
      EI.rank = found == 0 ? 0 : 1;
      const auto modulus = ident::bending_modulus(tests_.campaign, one);
      std::string text = shown_estimate(EI.value, EI.std) + " N m²";
      if (std::isfinite(modulus.value)) {
        text += fmt::format(", modulus {} GPa",
                            shown_estimate(1e-9 * modulus.value, 1e-9 * modulus.std));
        Answer E = EI;
        E.key = fmt::format("{}/modulus/{}", test_.name, found + 1);
        E.quantity = fmt::format("Beam bending modulus ({})", file);
        E.unit = "Pa";
        E.value = modulus.value;
        E.std = modulus.std;
        // The section's uncertainty widens the interval of EI.
        const auto& I = tests_.campaign.second_moment_m4;
        const double section = 1.959964 * I.std / I.value;
        E.low = modulus.value * (1 - std::hypot(1 - EI.low / EI.value, section));
        E.high = modulus.value * (1 + std::hypot(EI.high / EI.value - 1, section));
        part_.answers.push_back(std::move(E));
      }
      part_.answers.push_back(std::move(EI));
      part_.summary.push_back(
          {SummaryItem::Kind::result, "EI of the beam, " + file, text, origin, part_.id});
      ++found;
    }
    const bool said = std::any_of(result.points.begin(), result.points.end(),
                                  [](const auto& one) { return one.refused(); });
    if (found == 0 && !said) refuse(part_, "no_EI", "no test gives an EI", test_.name);
    if (!result.specimens) return;
    const auto& all = *result.specimens;
    const std::string modulus =
        std::isfinite(all.modulus_Pa)
            ? fmt::format(", modulus {} GPa", shown(1e-9 * all.modulus_Pa, 3))
            : std::string();
    part_.blocks.push_back(Paragraph{
        fmt::format("{} specimens: EI {} N m² on average{}; standard deviation between them {} %.",
                    all.count, shown(all.EI_Nm2, 3), modulus, shown(100 * all.relative_scatter, 2)),
        Paragraph::Kind::note});
  }

  const CampaignTest& test_;
  BendingTests tests_;
  std::size_t index_ = 0;
  ReportPart part_;
};

}  // namespace

std::unique_ptr<TestPart> beam_part(const CampaignTest& test) {
  return std::make_unique<BeamPart>(test);
}

}  // namespace rigfit::apps
