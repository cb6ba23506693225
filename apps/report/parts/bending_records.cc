#include "apps/report/parts/bending_records.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "apps/campaign_file/bending_files.h"
#include "apps/report/drawing/html_text.h"
#include "apps/report/figures/recording_blocks.h"
#include "signal/recording/recording_error.h"

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

BendingTests recorded_tests(const CampaignTest& test, const std::function<void()>& file_read,
                            ReportPart& part) {
  BendingTests tests;
  auto loaded = load_recordings(test.recordings, file_read);
  for (auto& entry : loaded) {
    part.inputs.insert(part.inputs.end(), entry.inputs.begin(), entry.inputs.end());
    if (entry.recording) drop_time_notes(*entry.recording);
  }
  add_recordings(part, test, loaded);
  BendingColumns columns{test.tension_channel, test.load_channel, test.deflection_channel,
                         "name it in the campaign, channels = {{ {} = \"...\" }}",
                         test.beam.has_value()};
  for (const auto& entry : loaded) {
    if (!entry.recording) continue;
    std::vector<Warning> warnings;
    try {
      tests.campaign.sources.push_back(bending_source(*entry.recording, columns, warnings));
    } catch (const signal::RecordingError& error) {
      refuse(part, "channel", error.what(), entry.file);
      continue;
    }
    tests.origins.push_back(test.recordings[entry.group].origin());
    for (auto& one : warnings) {
      part.warnings.push_back(
          {std::move(one.code), std::move(one.message), std::move(one.where), false});
    }
  }
  return tests;
}

void add_findings(const ident::BendingCampaign& campaign,
                  const ident::BendingCampaignResult& result, ReportPart& part) {
  for (const auto& one : result.points) {
    if (!one.analysis) continue;
    const auto& file = campaign.sources[one.source].name;
    const std::string where = std::isfinite(one.point.tension_N) && one.point.tension_N > 0
                                  ? fmt::format("{} at {:.4g} N", file, one.point.tension_N)
                                  : file;
    for (const auto& finding : one.analysis->findings) {
      if (finding.refuses) {
        refuse(part, finding.code, finding.message, where);
      } else {
        part.warnings.push_back({finding.code, finding.message, where, false});
      }
    }
  }
}

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
