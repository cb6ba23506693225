#include "apps/report/recording_blocks.h"

#include <fmt/format.h>

#include <filesystem>

#include "apps/report/html_text.h"

namespace rigfit::apps {

std::string short_name(const std::string& file) {
  return std::filesystem::path(file).filename().string();
}

void refuse(ReportPart& part, const std::string& code, const std::string& message,
            const std::string& where) {
  part.warnings.push_back({code, message, where, true});
  part.summary.push_back({SummaryItem::Kind::distrust,
                          part.title + ": refused",
                          short_name(where) + ": " + message,
                          {},
                          part.id});
}

void add_recordings(ReportPart& part, const CampaignTest& test,
                    const std::vector<LoadedRecording>& loaded) {
  ReportTable table;
  table.id = test.name + "-recordings";
  table.caption = "Recordings of this test, and what to know about each.";
  table.columns = {{"file", {}, false},    {"origin", {}, false},   {"taken at", {}, false},
                   {"rate, Hz", {}, true}, {"length, s", {}, true}, {"channels (unit)", {}, false},
                   {"remarks", {}, false}};
  Json list = Json::array();
  for (const auto& entry : loaded) {
    const auto& group = test.recordings[entry.group];
    std::string at;
    if (group.tension_N) at += fmt::format("{:g} N", *group.tension_N);
    if (group.length_m) at += fmt::format("{}{:g} m", at.empty() ? "" : ", ", *group.length_m);
    Json json{{"file", entry.file}, {"origin", word_of(group.origin())}};
    if (!entry.recording) {
      Cell error(entry.error);
      error.doubtful = true;
      table.rows.push_back({short_name(entry.file), Cell(name_of(group.origin()), group.origin()),
                            at, "", "", "", error});
      json["error"] = entry.error;
      list.push_back(std::move(json));
      refuse(part, "recording", entry.error, entry.file);
      continue;
    }
    const auto& recording = *entry.recording;
    std::string channels, remarks;
    for (const auto& channel : recording.channels) {
      channels += fmt::format("{}{} ({})", channels.empty() ? "" : ", ", channel.name,
                              channel.unit.empty() ? "no unit" : channel.unit);
    }
    for (const auto& note : recording.notes) {
      remarks += fmt::format("{}{}{}{}", remarks.empty() ? "" : "; ", note.where,
                             note.where.empty() ? "" : ": ", note.message);
      part.warnings.push_back({note.code, note.message,
                               note.where.empty() ? entry.file : entry.file + ": " + note.where,
                               false});
    }
    Cell remark_cell(remarks);
    remark_cell.doubtful = !remarks.empty();
    table.rows.push_back({short_name(entry.file), Cell(name_of(group.origin()), group.origin()), at,
                          shown(recording.sample_rate_hz, 5), shown(recording.duration_s(), 3),
                          channels, remark_cell});
    json["sample_rate_hz"] = recording.sample_rate_hz;
    json["samples"] = recording.samples();
    json["remarks"] = remarks;
    list.push_back(std::move(json));
  }
  part.blocks.push_back(std::move(table));
  part.json["recordings"] = std::move(list);
}

}  // namespace rigfit::apps
