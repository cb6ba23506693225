#include "apps/report/parts/parts.h"

#include "apps/campaign_file/bending_files.h"
#include "signal/quality/quality.h"

namespace rigfit::apps {
namespace {

/// Findings that spoil a result; the others are listed in the table only.
bool serious(const std::string& code) {
  constexpr std::array<std::string_view, 5> kCodes{"clipped", "missing", "dropouts", "stuck",
                                                   "one_bit"};
  return std::find(kCodes.begin(), kCodes.end(), code) != kCodes.end();
}

/// The table of recordings, channel by channel, their notes as warnings, unusable ones as refusals,
/// and the list `recordings` of the document.
void add_recordings(ReportPart& part, const CampaignTest& test,
                    const std::vector<LoadedRecording>& loaded) {
  ReportTable table{test.name + "-quality",
                    "Recordings of this test, channel by channel.",
                    {{"file", {}, false},
                     {"origin", {}, false},
                     {"taken at", {}, false},
                     {"rate, Hz"},
                     {"length, s"}}};
  Json list = Json::array();
  std::vector<Cell> remarks;  // by row
  std::size_t refused = 0, found = 0;
  for (const auto& entry : loaded) {
    const auto& group = test.recordings[entry.group];
    std::string at = label_of(group.tension_N);
    if (group.length_m) at += fmt::format("{}{:g} m", at.empty() ? "" : ", ", *group.length_m);
    std::vector<Cell> front{short_name(entry.file), {name_of(group.origin()), group.origin()}, at};
    Json json{{"file", entry.file}, {"origin", word_of(group.origin())}};
    if (!entry.recording) {
      table.rows.push_back(std::move(front));
      remarks.emplace_back(entry.error).doubtful = true;
      json["error"] = entry.error;
      list.push_back(std::move(json));
      refuse(part, "recording", entry.error, entry.file);
      ++refused;
      continue;
    }
    const auto& recording = *entry.recording;
    std::string said;
    for (const auto& note : recording.notes) {
      const std::string where = note.where.empty() ? "" : ": " + note.where;
      said += (said.empty() ? "" : "; ") + note.message;
      part.warnings.push_back({note.code, note.message, entry.file + where});
    }
    front.emplace_back(shown(recording.sample_rate_hz, 5));
    front.emplace_back(shown(recording.duration_s(), 3));
    const auto channels = signal::check_quality(recording);
    add_rows(table, std::move(front), describe::table_of(channels), std::nullopt);
    json.update(describe::json_of(recording));
    json["remarks"] = said;
    json["channels"] = describe::json_of(channels);
    list.push_back(std::move(json));
    for (const auto& quality : channels) {
      bool bad = !said.empty();
      for (const auto& finding : quality.findings) {
        said += (said.empty() ? "" : "; ") + finding.message;
        ++found;
        if (!serious(finding.code)) continue;
        bad = true;
        part.warnings.push_back(
            {finding.code, finding.message, entry.file + ": " + quality.channel->name});
      }
      remarks.emplace_back(std::exchange(said, "")).doubtful = bad;
    }
  }
  table.columns.push_back({"remarks", {}, false});
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    table.rows[r].resize(table.columns.size() - 1);
    table.rows[r].push_back(std::move(remarks[r]));
  }
  if (table.rows.size() > 8) {
    table.fold =
        fmt::format("{}: {}, {} refused", counted(list.size(), "recording"),
                    found == 0 ? std::string("no remarks") : counted(found, "remark"), refused);
  }
  part.blocks.push_back(std::move(table));
  part.json["recordings"] = std::move(list);
}

/// Frequencies of the models over those of the tests, every mode of every test.
Plot all_modes_plot(const std::vector<ReportPart>& parts) {
  Plot plot{"model-against-test",
            "Model against test, all modes",
            "Frequency error of the model, all matched modes.",
            "measured frequency, Hz",
            "model over test, %",
            true};
  for (const auto& part : parts) {
    for (const auto& mode : part.modes) {
      if (!(mode.measured_hz > 0 && mode.model_hz > 0)) continue;
      plot.named(mode.label, mode.origin)
          .add(mode.measured_hz, 100 * (mode.model_hz / mode.measured_hz - 1));
    }
  }
  return plot;
}

}  // namespace

TestPart::TestPart(const CampaignTest& test, const char* json_key)
    : test_(test),
      inputs_(std::visit([](const auto& kind) { return ident::TestInputs(kind); }, test.kind)) {
  part_.id = test.name;
  part_.title = test.title;
  part_.json_key = json_key;
  part_.json["test"] = test.name;
}

void TestPart::read(const std::function<void()>& file_read) {
  if (test_.recordings.empty()) return;
  auto loaded = load_recordings(test_.recordings, file_read);
  files_ = loaded.size();
  for (auto& entry : loaded) {
    if (entry.recording && test_.is<BendingTest>()) drop_time_notes(*entry.recording);
  }
  add_recordings(part_, test_, loaded);
  for (auto& entry : loaded) {
    if (!entry.recording) continue;
    const auto& group = test_.recordings[entry.group];
    take(std::move(entry), group);
  }
}

void TestPart::take(LoadedRecording entry, const RecordingGroup& group) {
  std::visit(
      [&](auto& inputs) {
        if constexpr (requires { inputs.recordings; }) {
          inputs.recordings.push_back({entry.file, std::move(*entry.recording),
                                       group.length_m.value_or(0), group.tension_N, group.load,
                                       group.origin()});
        }
      },
      inputs_);
}

void TestPart::tell(std::vector<ident::Finding> findings) {
  for (auto& one : findings) {
    if (one.where.empty()) one.where = test_.name;
    part_.warnings.push_back(std::move(one));
  }
}

Answer TestPart::answer(const std::string& name, std::string quantity, std::string how,
                        std::string unit, const ident::BoundedEstimate& value, Origin origin,
                        std::optional<double> reference) const {
  return {.key = test_.name + "/" + name,
          .quantity = std::move(quantity),
          .how = std::move(how),
          .unit = unit.empty() ? "%" : std::move(unit),
          .value = value.value,
          .std = value.std,
          .low = value.low,
          .high = value.high,
          .reference = reference,
          .reference_name = reference ? test_.reference_name : "",
          .origin = origin,
          .anchor = part_.id};
}

void refuse(ReportPart& part, const std::string& code, const std::string& message,
            const std::string& where) {
  part.warnings.push_back({code, message, where, true});
}

void add_answer(ReportPart& part, Answer answer, bool told) {
  if (told) {
    const auto [unit, per_si] = describe::shown_unit(answer.unit);
    const std::string interval = interval_words(answer);
    std::string text = value_words(answer) + (unit.empty() ? "" : " ") + std::string(unit);
    if (!interval.empty()) text += fmt::format(" (95 %: {})", interval);
    if (answer.reference) {
      text += fmt::format("; {} {}", answer.reference_name, shown(per_si * *answer.reference, 5));
    }
    part.summary.push_back({SummaryItem::Kind::result, answer.quantity, text, answer.origin});
  }
  part.answers.push_back(std::move(answer));
}

std::string percent_words(double ratio) {
  return std::isfinite(ratio) ? shown(100 * ratio, 3) + " %" : std::string("–");
}

std::string file_word(std::string label) {
  std::erase_if(label, [](unsigned char c) { return !std::isalnum(c) && c != '.' && c != '-'; });
  return label.empty() ? "state" : label;
}

std::string label_of(std::optional<double> tension_N) {
  return state_words(ident::state_label(tension_N));
}

ReportPart overview_part(const Campaign& campaign, const std::vector<ReportPart>& parts) {
  ReportPart part;
  const auto largest = std::ranges::max_element(
      campaign.scenes, {}, [](const auto& one) { return one.scene.members.size(); });
  if (largest != campaign.scenes.end()) part.blocks.push_back(rig_picture(largest->scene));
  add(part.blocks, all_modes_plot(parts));
  return part;
}

ReportPart scenes_part(const Campaign& campaign) {
  ReportPart part;
  part.id = "scenes";
  part.title = "What the model was given";
  part.json_key = "scenes";
  ReportTable table{
      "scene-values", "Values of the scenes, and how each is known.", {{"scene", {}, false}}};
  Json scenes = Json::array();
  std::array<std::size_t, 3> count{};  // by kind
  for (const auto& scene : campaign.scenes) {
    add_rows(table, {scene.name}, describe::table_of(scene.origins), std::nullopt);
    for (const auto& origin : scene.origins) ++count[static_cast<std::size_t>(origin.kind)];
    scenes.push_back(
        {{"name", scene.name}, {"file", scene.file}, {"values", describe::json_of(scene.origins)}});
  }
  part.json = std::move(scenes);
  if (campaign.scenes.empty()) return part;
  add(part.blocks, std::move(table));
  if (count[1] + count[2] > 0) {
    part.warnings.push_back(
        {"read_as",
         fmt::format("{} of the model are not measured but inferred ({}) or assumed ({}); each is "
                     "listed with how",
                     counted(count[1] + count[2], "value"), count[1], count[2]),
         ""});
  }
  return part;
}

}  // namespace rigfit::apps
