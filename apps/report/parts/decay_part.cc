#include "apps/report/parts/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/describe/json_of.h"
#include "apps/report/drawing/html_text.h"
#include "apps/report/figures/figures.h"
#include "apps/report/modal/modal_part.h"

namespace rigfit::apps {
namespace {

class DecayPart : public TestPart {
 public:
  DecayPart(const Campaign& campaign, const CampaignTest& test)
      : campaign_(campaign), test_(test), inputs_(test.as<DecayTest>().inputs) {
    part_.id = test.name;
    part_.title = test.title;
    part_.json_key = "decays";
    part_.json["test"] = test.name;
    table_.id = test.name + "-modes";
    table_.caption =
        "Oscillations found in each record, strongest first, with standard uncertainties.";
    compared_.id = test.name + "-compared";
    compared_.caption =
        "The same oscillations in the model's answer, by the same estimator over the same time. "
        "Decay rate: damping "
        "ratio times angular frequency, how fast the oscillation dies away.";
    compared_.columns = {{"record", {}, false},
                         {"model", {}, false},
                         {"test, Hz", {}, true},
                         {"model, Hz", Origin::modelled},
                         {"error", Origin::modelled},
                         {"test damping, %", {}, true},
                         {"model damping, %", Origin::modelled},
                         {"test decay rate, 1/s", {}, true},
                         {"model decay rate, 1/s", Origin::modelled}};
  }

  void read(const FileRead& file_read) override {
    auto loaded = load_recordings(test_.recordings, file_read);
    for (const auto& entry : loaded) {
      part_.inputs.insert(part_.inputs.end(), entry.inputs.begin(), entry.inputs.end());
    }
    files_ = loaded.size();
    part_.blocks.push_back(Paragraph{
        "The rig is set free (a string is cut, or it is tapped) and rings. Damped oscillations are "
        "fitted to what it rings, without anybody's guess of frequency or window."});
    add_recordings(part_, test_, loaded);
    for (auto& entry : loaded) {
      if (!entry.recording) continue;
      const auto& group = test_.recordings[entry.group];
      inputs_.recordings.push_back({entry.file, std::move(*entry.recording), group.tension_N});
      groups_.push_back(&group);
    }
  }

  void add_to(ident::CampaignInputs& inputs) override {
    index_ = inputs.decays.size();
    for (std::size_t f = 0; f < campaign_.fits.size(); ++f) {
      for (const std::size_t test : campaign_.fits[f].predicts) {
        if (&campaign_.tests[test] == &test_) inputs_.fits.push_back(f);
      }
    }
    inputs.decays.push_back(std::move(inputs_));
  }

  std::vector<ReportPart> show(ident::CampaignResult& campaign) override {
    const auto& recordings = campaign.inputs.decays[index_].recordings;
    auto& outcome = campaign.decays[index_];
    for (const auto& finding : outcome.findings) {
      refuse(part_, finding.code, finding.message, finding.where);
    }
    Json list = Json::array();
    PlotTab tab;
    auto& channels = outcome.channels;
    for (std::size_t i = 0; i < channels.size(); ++i) {
      const std::size_t r = channels[i].recording;
      if (i == 0 || r != channels[i - 1].recording) tab.label = short_name(recordings[r].name);
      tell(channels[i], recordings[r], *groups_[r], tab, list);
      if (i + 1 < channels.size() && channels[i + 1].recording == r) continue;
      if (!tab.plots.empty()) group_.tabs.push_back(std::move(tab));
      tab = {};
    }
    part_.json["records"] = std::move(list);
    if (!table_.rows.empty()) part_.blocks.push_back(std::move(table_));
    part_.brief = {compared_.rows.empty() ? table_.id : compared_.id};
    if (!compared_.rows.empty()) part_.blocks.push_back(std::move(compared_));
    if (!group_.tabs.empty()) {
      group_.id = test_.name + "-decays";
      group_.title = "Decays";
      part_.blocks.push_back(std::move(group_));
    }
    auto damping = damping_plot(test_.name + "-damping", decays_);
    if (!damping.series.empty()) part_.blocks.push_back(std::move(damping));
    part_.summary.push_back(
        {test_.scene ? SummaryItem::Kind::error : SummaryItem::Kind::recorded, test_.title,
         fmt::format("{} in {}{}", counted(decays_.size(), "decay"), counted(files_, "recording"),
                     best_),
         decays_.empty() ? std::optional<Origin>() : decays_.front().origin, part_.id});
    return {std::move(part_)};
  }

 private:
  void tell(ident::DecayOutcome& outcome, const ident::DecayRecording& recorded,
            const RecordingGroup& group, PlotTab& tab, Json& list) {
    AnalysedDecay decay;
    decay.file = recorded.name;
    decay.channel = outcome.found.channel;
    decay.unit = outcome.found.unit;
    decay.origin = group.origin();
    decay.rate_hz = recorded.recording.sample_rate_hz;
    decay.start_s = recorded.recording.start_time_s;
    decay.samples = std::move(outcome.found.samples);
    decay.result = outcome.found.strongest;
    const std::string where = decay.file + ": " + decay.channel;
    for (const auto& finding : outcome.found.findings) {
      if (finding.refused) {
        refuse(part_, finding.code, finding.message, where);
      } else {
        part_.warnings.push_back({finding.code, finding.message, where, false});
      }
    }
    if (decay.result.modes.empty()) return;
    const std::string id = fmt::format("{}-{}", test_.name, decays_.size() + 1);
    tab.plots.push_back(decay_plot(id, decay));
    Json json{{"file", decay.file},
              {"channel", decay.channel},
              {"origin", word_of(decay.origin)},
              {"tension_N", group.tension_N ? Json(*group.tension_N) : Json(nullptr)},
              {"modes", describe::json_of(decay.result.modes)},
              {"decays", describe::json_of(outcome.found.decays)},
              {"law", name_of(decay.result.envelope.law)},
              {"frequency_drift_hz", describe::json_of(decay.result.envelope.frequency_drift_hz)}};
    list_modes(decay, group);
    add_answers(decay, group);
    if (outcome.modelled) overlay(decay, outcome.answers, id, tab, json);
    list.push_back(std::move(json));
    decays_.push_back(std::move(decay));
  }

  void overlay(const AnalysedDecay& decay, const std::vector<ReleaseAnswer>& answers,
               const std::string& id, PlotTab& tab, Json& json) {
    for (auto& plot : release_plots(id, decay, answers,
                                    test_.as<DecayTest>().inputs.options.decay.band_high_hz)) {
      tab.plots.push_back(std::move(plot));
    }
    Json list = Json::array();
    for (const auto& answer : answers) {
      const std::string what =
          fmt::format("{}: {}, {}", test_.title, short_name(decay.file), answer.label);
      if (!answer.failure.empty()) {
        refuse(part_, "no_model", answer.failure, what);
        continue;
      }
      part_.costs.push_back(response_cost(what, answer.response));
      compare(decay, answer);
      list.push_back({{"version", answer.label},
                      {"solver", name_of(answer.response.solver)},
                      {"nonlinear", answer.response.nonlinear},
                      {"frequency_shift", answer.response.frequency_shift},
                      {"modes", describe::json_of(answer.found.modes)}});
    }
    json["models"] = std::move(list);
  }

  void compare(const AnalysedDecay& decay, const ReleaseAnswer& answer) {
    bool first = true;
    for (const auto& mode : decay.result.modes) {
      const auto rate = [](const signal::DecayMode& m) {
        return 2 * std::numbers::pi * m.frequency_hz.value * m.damping_ratio.value;
      };
      const auto* same = ident::same_oscillation(mode, answer);
      const double error = same ? same->frequency_hz.value / mode.frequency_hz.value - 1 : 0;
      compared_.rows.push_back(
          {first ? short_name(decay.file) : "", first ? answer.label : "",
           Cell(shown_estimate(mode.frequency_hz.value, mode.frequency_hz.std), decay.origin),
           same ? shown(same->frequency_hz.value, 5) : "–", same ? shown_percent(error) : "–",
           Cell(shown_estimate(100 * mode.damping_ratio.value, 100 * mode.damping_ratio.std),
                decay.origin),
           same ? shown(100 * same->damping_ratio.value, 3) : "–",
           Cell(shown(rate(mode), 3), decay.origin), same ? shown(rate(*same), 3) : "–"});
      if (same && first) {
        last_best_ = fmt::format("; strongest {} Hz, {} {} Hz", shown(mode.frequency_hz.value, 5),
                                 answer.label, shown(same->frequency_hz.value, 5));
      }
      first = false;
    }
    if (best_.empty() || decays_.empty()) best_ = last_best_;
  }

  /// Adds frequency and damping of the strongest oscillation.
  void add_answers(const AnalysedDecay& decay, const RecordingGroup& group) {
    const auto& mode = decay.result.modes.front();
    const std::string at = group.tension_N ? fmt::format(", {:g} N", *group.tension_N) : "";
    Answer answer;
    answer.key = fmt::format("{}{}/frequency", test_.name, at);
    answer.quantity = fmt::format("{}{}: frequency", test_.title, at);
    answer.how = fmt::format("decay of {}", decay.channel);
    answer.unit = "Hz";
    answer.value = mode.frequency_hz.value;
    answer.std = mode.frequency_hz.std;
    answer.origin = decay.origin;
    answer.anchor = part_.id;
    answer.rank = test_.scene ? 2 : 0;
    part_.answers.push_back(answer);
    answer.key = fmt::format("{}{}/damping", test_.name, at);
    answer.quantity = fmt::format("{}{}: damping ratio ζ", test_.title, at);
    answer.unit.clear();
    answer.percent = true;
    answer.value = mode.damping_ratio.value;
    answer.std = mode.damping_ratio.std;
    part_.answers.push_back(std::move(answer));
  }

  void list_modes(const AnalysedDecay& decay, const RecordingGroup& group) {
    if (table_.columns.empty()) {
      table_.columns = {{"record", {}, false},        {"channel", {}, false},
                        {"taken at", {}, false},      {"frequency, Hz", decay.origin},
                        {"damping, %", decay.origin}, {"R²", decay.origin},
                        {"cycles", decay.origin}};
    }
    bool first = true;
    for (const auto& mode : decay.result.modes) {
      table_.rows.push_back(
          {first ? short_name(decay.file) : "", first ? decay.channel : "",
           first && group.tension_N ? fmt::format("{:g} N", *group.tension_N) : "",
           Cell(shown_estimate(mode.frequency_hz.value, mode.frequency_hz.std), decay.origin),
           Cell(shown_estimate(100 * mode.damping_ratio.value, 100 * mode.damping_ratio.std),
                decay.origin),
           shown(mode.r_squared, 4), shown(mode.cycles, 3)});
      first = false;
    }
  }

  const Campaign& campaign_;
  const CampaignTest& test_;
  ident::DecayInputs inputs_;
  std::size_t index_ = 0, files_ = 0;
  std::vector<const RecordingGroup*> groups_;  ///< group of each recording
  ReportPart part_;
  ReportTable table_, compared_;
  PlotGroup group_;
  std::vector<AnalysedDecay> decays_;
  std::string best_, last_best_;
};

}  // namespace

std::unique_ptr<TestPart> decay_part(const Campaign& campaign, const CampaignTest& test) {
  return std::make_unique<DecayPart>(campaign, test);
}

}  // namespace rigfit::apps
