#include "apps/report/figures/figures.h"

#include <fmt/format.h>

#include <filesystem>

#include "apps/report/drawing/html_text.h"
#include "signal/quality/quality.h"

namespace rigfit::apps {

std::string short_name(const std::string& file) {
  return std::filesystem::path(file).filename().string();
}

void refuse(ReportPart& part, const std::string& code, const std::string& message,
            const std::string& where) {
  part.warnings.push_back({code, message, where, true});
}

namespace {

/// Findings that spoil a result; the others are listed in the table only.
bool serious(const std::string& code) {
  for (const char* known : {"clipped", "missing", "dropouts", "stuck", "one_bit", "mains_hum"}) {
    if (code == known) return true;
  }
  return false;
}

class Listing {
 public:
  Listing(ReportPart& part, const CampaignTest& test) : part_(part), test_(test) {
    table_.id = test.name + "-quality";
    table_.caption =
        "Recordings of this test, channel by channel, and what to know about each. Noise floor: "
        "the "
        "even noise under the signal, root mean square.";
    table_.columns = {
        {"file", {}, false},       {"origin", {}, false},   {"taken at", {}, false},
        {"rate, Hz", {}, true},    {"length, s", {}, true}, {"channel (unit)", {}, false},
        {"lowest", {}, true},      {"highest", {}, true},   {"rms", {}, true},
        {"noise floor", {}, true}, {"clipped", {}, true},   {"missing", {}, true},
        {"remarks", {}, false}};
  }

  void add(const LoadedRecording& entry) {
    const auto& group = test_.recordings[entry.group];
    std::string at;
    if (group.tension_N) at += fmt::format("{:g} N", *group.tension_N);
    if (group.length_m) at += fmt::format("{}{:g} m", at.empty() ? "" : ", ", *group.length_m);
    const Cell origin(name_of(group.origin()), group.origin());
    Json json{{"file", entry.file}, {"origin", word_of(group.origin())}};
    if (!entry.recording) {
      Cell error(entry.error);
      error.doubtful = true;
      table_.rows.push_back({short_name(entry.file), origin, at, "", "", "", "", "", "", "", "", "",
                             std::move(error)});
      json["error"] = entry.error;
      list_.push_back(std::move(json));
      refuse(part_, "recording", entry.error, entry.file);
      ++refused_;
      return;
    }
    const auto& recording = *entry.recording;
    std::string notes;
    for (const auto& note : recording.notes) {
      notes += fmt::format("{}{}{}{}", notes.empty() ? "" : "; ", note.where,
                           note.where.empty() ? "" : ": ", note.message);
      part_.warnings.push_back({note.code, note.message,
                                note.where.empty() ? entry.file : entry.file + ": " + note.where,
                                false});
    }
    json["sample_rate_hz"] = recording.sample_rate_hz;
    json["samples"] = recording.samples();
    json["remarks"] = notes;
    json["channels"] = Json::array();
    const auto quality = signal::check_quality(recording);
    for (std::size_t k = 0; k < recording.channels.size(); ++k) {
      channel(entry, recording.channels[k], quality.channels[k], k == 0, origin, at, notes, json);
    }
    list_.push_back(std::move(json));
  }

  void finish() {
    if (table_.rows.size() > 8) {
      table_.fold = fmt::format("{} channels in {} recordings: {}", channels_, list_.size(),
                                findings_ == 0 && refused_ == 0
                                    ? std::string("no remarks")
                                    : fmt::format("{} remarks, {} refused", findings_, refused_));
    }
    part_.blocks.push_back(std::move(table_));
    part_.json["recordings"] = std::move(list_);
  }

 private:
  void channel(const LoadedRecording& entry, const signal::Channel& channel,
               const signal::ChannelQuality& quality, bool first, const Cell& origin,
               const std::string& at, const std::string& notes, Json& json) {
    ++channels_;
    std::string remarks = first ? notes : "";
    Json findings = Json::array();
    bool bad = !remarks.empty();
    for (const auto& finding : quality.findings) {
      remarks += (remarks.empty() ? "" : "; ") + finding.message;
      findings.push_back(
          {{"code", finding.code}, {"message", finding.message}, {"samples", finding.samples}});
      ++findings_;
      if (!serious(finding.code)) continue;
      bad = true;
      part_.warnings.push_back(
          {finding.code, finding.message, entry.file + ": " + channel.name, false});
    }
    Cell remark(remarks);
    remark.doubtful = bad;
    const auto& recording = *entry.recording;
    table_.rows.push_back({first ? short_name(entry.file) : "", first ? origin : Cell(),
                           first ? at : "", first ? shown(recording.sample_rate_hz, 5) : "",
                           first ? shown(recording.duration_s(), 3) : "",
                           fmt::format("{} ({})", channel.name,
                                       channel.unit.empty() ? "no unit" : unit_words(channel.unit)),
                           shown(quality.min, 3), shown(quality.max, 3), shown(quality.rms, 3),
                           shown(quality.noise_floor, 2),
                           fmt::format("{}", quality.clipped_samples),
                           fmt::format("{}", quality.missing_samples), std::move(remark)});
    json["channels"].push_back({{"name", channel.name},
                                {"unit", channel.unit},
                                {"min", quality.min},
                                {"max", quality.max},
                                {"mean", quality.mean},
                                {"rms", quality.rms},
                                {"noise_floor", quality.noise_floor},
                                {"clipped_samples", quality.clipped_samples},
                                {"missing_samples", quality.missing_samples},
                                {"findings", std::move(findings)}});
  }

  ReportPart& part_;
  const CampaignTest& test_;
  ReportTable table_;
  Json list_ = Json::array();
  int channels_ = 0, findings_ = 0, refused_ = 0;
};

}  // namespace

void add_recordings(ReportPart& part, const CampaignTest& test,
                    const std::vector<LoadedRecording>& loaded) {
  Listing listing(part, test);
  for (const auto& entry : loaded) listing.add(entry);
  listing.finish();
}

}  // namespace rigfit::apps
