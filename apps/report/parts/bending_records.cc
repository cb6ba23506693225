#include "apps/report/parts/bending_records.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/report/html_text.h"
#include "apps/report/parts/recording_blocks.h"
#include "signal/recording/recording_error.h"

namespace rigfit::apps {
namespace {

/// A channel in the unit that the test needs; RecordingError when it is something else.
const signal::Channel& channel_in(const signal::Recording& recording, const std::string& file,
                                  const std::string& name, const std::string& unit) {
  const auto& channel = recording.channel(name);
  if (channel.unit != unit) {
    throw signal::RecordingError(
        {file, 0, 0, name, ""},
        channel.unit.empty() ? "has no unit" : "is in " + channel.unit + ", not in " + unit,
        "say its unit in a TOML file beside the recording, or name another channel in the "
        "campaign");
  }
  return channel;
}

std::string findings_of(const ident::BendingTestResult& result) {
  std::string text;
  for (const auto& finding : result.findings) {
    text += (text.empty() ? "" : "; ") + finding.message;
  }
  return text;
}

}  // namespace

std::vector<BendingRecordResult> bending_records(const CampaignTest& test,
                                                 const std::vector<LoadedRecording>& loaded,
                                                 ReportPart& part) {
  std::vector<BendingRecordResult> results;
  for (const auto& entry : loaded) {
    if (!entry.recording) continue;
    BendingRecordResult one;
    one.file = entry.file;
    one.origin = test.recordings[entry.group].origin();
    try {
      const auto& recording = *entry.recording;
      one.record.tension_N = channel_in(recording, entry.file, test.tension_channel, "N").samples;
      one.record.load_N = channel_in(recording, entry.file, test.load_channel, "N").samples;
      one.record.deflection_m =
          channel_in(recording, entry.file, test.deflection_channel, "m").samples;
    } catch (const signal::RecordingError& error) {
      refuse(part, "channel", error.what(), entry.file);
      continue;
    }
    ident::BendingTestOptions options;
    options.span_m = {test.span_m, test.span_std_m};
    options.tension_zero_std_N = test.tension_zero_std_N;
    options.tension_calibration_std = test.tension_calibration_std;
    options.load_calibration_std = test.load_calibration_std;
    options.deflection_calibration_std = test.deflection_calibration_std;
    one.result = ident::analyse_bending_test(one.record, options);
    for (const auto& finding : one.result.findings) {
      if (finding.refuses) {
        refuse(part, finding.code, finding.message, entry.file);
      } else {
        part.warnings.push_back({finding.code, finding.message, entry.file, false});
      }
    }
    results.push_back(std::move(one));
  }
  std::stable_sort(results.begin(), results.end(), [](const auto& a, const auto& b) {
    return a.result.tension_N.value < b.result.tension_N.value;
  });
  return results;
}

Plot load_deflection_plot(const CampaignTest& test,
                          const std::vector<BendingRecordResult>& records) {
  Plot plot;
  plot.id = test.name + "-load-deflection";
  plot.title = "Load against deflection";
  plot.caption =
      "Each recording loads the cable at mid-span and lets it go again; the slope of the straight "
      "parts gives EI. The gap between loading and unloading is friction between the wires.";
  plot.x_label = "deflection, mm";
  plot.y_label = "load, N";
  int variant = 0;
  for (const auto& one : records) {
    PlotSeries series;
    series.name = fmt::format("{:.0f} N: {}", one.result.tension_N.value, short_name(one.file));
    series.origin = one.origin;
    series.variant = variant++;
    const Eigen::Index n = one.record.load_N.size();
    const Eigen::Index every = 1 + n / 600;
    for (Eigen::Index i = 0; i < n; i += every) {
      if (!std::isfinite(one.record.load_N[i]) || !std::isfinite(one.record.deflection_m[i])) {
        continue;
      }
      series.x.push_back(1e3 * one.record.deflection_m[i]);
      series.y.push_back(one.record.load_N[i]);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

ReportTable bending_records_table(const CampaignTest& test,
                                  const std::vector<BendingRecordResult>& records) {
  ReportTable table;
  table.id = test.name + "-results";
  table.caption =
      "EI from each recording with its standard uncertainty and 95 % interval. Hysteresis: half "
      "the "
      "distance between loading and unloading.";
  const Origin origin = records.empty() ? Origin::measured : records.front().origin;
  table.columns = {{"recording", {}, false},    {"origin", {}, false}, {"tension, N", origin},
                   {"slope d/Q, µm/N", origin}, {"EI, N m²", origin},  {"95 % interval", origin},
                   {"hysteresis, N", origin},   {"remarks", {}, false}};
  for (const auto& one : records) {
    const auto& r = one.result;
    const auto& EI = r.stiffness;
    const bool solved = !r.refused && std::isfinite(EI.EI_Nm2.value);
    Cell remarks(findings_of(r).empty() ? EI.reason : findings_of(r));
    remarks.doubtful = !remarks.text.empty();
    table.rows.push_back(
        {short_name(one.file), Cell(name_of(one.origin), one.origin),
         shown_estimate(r.tension_N.value, r.tension_N.std),
         shown_estimate(1e6 * r.compliance_m_N.value, 1e6 * r.compliance_m_N.std),
         Cell(solved ? shown_estimate(EI.EI_Nm2.value, EI.EI_Nm2.std) : "none", one.origin),
         solved ? shown(EI.low, 3) + " to " + shown(EI.high, 3) : "", shown(r.hysteresis_N, 2),
         remarks});
  }
  return table;
}

Json bending_record_json(const BendingRecordResult& one) {
  const auto& r = one.result;
  Json findings = Json::array();
  for (const auto& finding : r.findings) {
    findings.push_back(
        {{"code", finding.code}, {"message", finding.message}, {"refuses", finding.refuses}});
  }
  return {{"file", one.file},
          {"origin", word_of(one.origin)},
          {"tension_N", r.tension_N.value},
          {"EI_Nm2",
           {{"value", r.refused ? Json(nullptr) : Json(r.stiffness.EI_Nm2.value)},
            {"std", r.refused ? Json(nullptr) : Json(r.stiffness.EI_Nm2.std)},
            {"low", r.refused ? Json(nullptr) : Json(r.stiffness.low)},
            {"high", r.refused ? Json(nullptr) : Json(r.stiffness.high)}}},
          {"slope_m_N", {{"value", r.compliance_m_N.value}, {"std", r.compliance_m_N.std}}},
          {"hysteresis_N", r.hysteresis_N},
          {"refused", r.refused},
          {"findings", std::move(findings)}};
}

}  // namespace rigfit::apps
