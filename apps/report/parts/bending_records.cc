#include "apps/report/parts/bending_records.h"

#include <fmt/format.h>

#include <cmath>

#include "apps/report/page/html_text.h"
#include "apps/report/parts/recording_blocks.h"

namespace rigfit::apps {
namespace {

std::string findings_of(const ident::BendingTestResult& result) {
  std::string text;
  for (const auto& finding : result.findings) {
    text += (text.empty() ? "" : "; ") + finding.message;
  }
  return text;
}

}  // namespace

ReportTable bending_records_table(const CampaignTest& test, const ident::BendingCampaign& campaign,
                                  const std::vector<Origin>& origins,
                                  const ident::BendingCampaignResult& result) {
  ReportTable table;
  table.id = test.name + "-results";
  table.caption =
      "EI from each recording with its standard uncertainty and 95 % interval. Hysteresis: half "
      "the "
      "distance between loading and unloading.";
  const Origin origin = origins.empty() ? Origin::measured : origins.front();
  table.columns = {{"recording", {}, false},    {"origin", {}, false}, {"tension, N", origin},
                   {"slope d/Q, µm/N", origin}, {"EI, N m²", origin},  {"95 % interval", origin},
                   {"hysteresis, N", origin},   {"remarks", {}, false}};
  for (const auto& one : result.points) {
    if (!one.analysis) continue;
    const auto& r = *one.analysis;
    const auto& file = campaign.sources[one.source].name;
    const Origin from = origins[one.source];
    const auto& EI = r.stiffness;
    const bool solved = !r.refused && std::isfinite(EI.EI_Nm2.value);
    Cell remarks(findings_of(r).empty() ? EI.reason : findings_of(r));
    remarks.doubtful = !remarks.text.empty();
    table.rows.push_back(
        {short_name(file), Cell(name_of(from), from),
         shown_estimate(r.tension_N.value, r.tension_N.std),
         shown_estimate(1e6 * r.compliance_m_N.value, 1e6 * r.compliance_m_N.std),
         Cell(solved ? shown_estimate(EI.EI_Nm2.value, EI.EI_Nm2.std) : "none", from),
         solved ? shown(EI.low, 3) + " to " + shown(EI.high, 3) : "", shown(r.hysteresis_N, 2),
         remarks});
  }
  return table;
}

}  // namespace rigfit::apps
