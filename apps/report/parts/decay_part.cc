#include <fmt/format.h>

#include "apps/describe/json_of.h"
#include "apps/report/drawing/html_text.h"
#include "apps/report/figures/figures.h"
#include "apps/report/parts/parts.h"

namespace rigfit::apps {
namespace {

class DecayPart : public TestPart {
 public:
  DecayPart(const Campaign& campaign, const CampaignTest& test)
      : TestPart(test, "decays"), campaign_(campaign), inputs_(test.as<DecayTest>().inputs) {}

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
    table_ = {test_.name + "-modes",
              "Oscillations found in each record, strongest first, with standard uncertainties; "
              "those of the model by the same estimator over the same time.",
              {{"record", {}, false},
               {"channel", {}, false},
               {"taken at", {}, false},
               {"frequency, Hz"},
               {"damping, %"},
               {"R²"},
               {"cycles"},
               {"model", {}, false},
               {"frequency, Hz", Origin::modelled},
               {"error", Origin::modelled},
               {"damping, %", Origin::modelled}}};
    part_.json["records"] = Json::array();
    PlotGroup group{test_.name + "-decays", "Decays", {}};
    PlotTab tab;
    for (std::size_t i = 0; i < outcome.channels.size(); ++i) {
      const std::size_t r = outcome.channels[i].recording;
      tab.label = short_name(recordings[r].name);
      tell_channel(outcome.channels[i], recordings[r], origins_[r], tab);
      if (i + 1 < outcome.channels.size() && outcome.channels[i + 1].recording == r) continue;
      if (!tab.plots.empty()) group.tabs.push_back(std::move(tab));
      tab = {};
    }
    part_.brief = {table_.id};
    if (!table_.rows.empty()) part_.blocks.push_back(std::move(table_));
    if (!group.tabs.empty()) part_.blocks.push_back(std::move(group));
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
  [[nodiscard]] std::string intro() const override {
    return "The rig is released (a string is cut) or tapped and vibrates freely. Damped "
           "oscillations are fitted to the records; frequencies and time window are found, not "
           "given.";
  }

  void take(LoadedRecording entry, const RecordingGroup& group) override {
    inputs_.recordings.push_back({entry.file, std::move(*entry.recording), group.tension_N});
  }

  void tell_channel(ident::DecayOutcome& outcome, const ident::DecayRecording& recorded,
                    Origin origin, PlotTab& tab) {
    AnalysedDecay decay{recorded.name,
                        outcome.found.channel,
                        outcome.found.unit,
                        origin,
                        recorded.recording.sample_rate_hz,
                        recorded.recording.start_time_s,
                        std::move(outcome.found.samples),
                        outcome.found.strongest};
    tell(outcome.found.findings, decay.file + ": " + decay.channel);
    if (decay.result.modes.empty()) return;
    const std::string id = fmt::format("{}-{}", test_.name, decays_.size() + 1);
    tab.plots.push_back(decay_plot(id, decay));
    Json json{{"file", decay.file},
              {"channel", decay.channel},
              {"origin", word_of(origin)},
              {"tension_N", recorded.tension_N ? Json(*recorded.tension_N) : Json(nullptr)},
              {"modes", describe::json_of(decay.result.modes)},
              {"decays", describe::json_of(outcome.found.decays)},
              {"law", name_of(decay.result.envelope.law)}};
    add_answers(decay, recorded.tension_N);
    std::vector<const ident::ReleaseAnswer*> models;
    if (outcome.modelled) {
      for (auto& plot : release_plots(id, decay, outcome.answers,
                                      test_.as<DecayTest>().inputs.options.decay.band_high_hz)) {
        tab.plots.push_back(std::move(plot));
      }
      json["models"] = Json::array();
      for (const auto& answer : outcome.answers) {
        if (!answer.failure.empty()) {
          refuse(part_, "no_model", answer.failure,
                 fmt::format("{}: {}, {}", test_.title, short_name(decay.file), answer.label));
          continue;
        }
        models.push_back(&answer);
        json["models"].push_back({{"version", answer.label},
                                  {"nonlinear", answer.response.nonlinear},
                                  {"frequency_shift", answer.response.frequency_shift},
                                  {"modes", describe::json_of(answer.found.modes)}});
      }
    }
    list_modes(decay, recorded.tension_N, models);
    part_.json["records"].push_back(std::move(json));
    decays_.push_back(std::move(decay));
  }

  /// Adds frequency and damping of the strongest oscillation.
  void add_answers(const AnalysedDecay& decay, std::optional<double> tension_N) {
    const auto& mode = decay.result.modes.front();
    const std::string at = tension_N ? fmt::format(", {:g} N", *tension_N) : "";
    const std::string how = "decay of " + decay.channel;
    for (auto one : {answer("frequency", test_.title + at + ": frequency", how, "Hz",
                            mode.frequency_hz, decay.origin),
                     answer("damping", test_.title + at + ": damping ratio ζ", how, "",
                            mode.damping_ratio, decay.origin)}) {
      one.key.insert(test_.name.size(), at);
      one.rank = test_.scene ? 2 : 0;
      part_.answers.push_back(std::move(one));
    }
  }

  /// A row a mode; of several models one below the other.
  void list_modes(const AnalysedDecay& decay, std::optional<double> tension_N,
                  const std::vector<const ident::ReleaseAnswer*>& models) {
    bool first = true;
    for (const auto& mode : decay.result.modes) {
      std::vector<Cell> row{
          first ? short_name(decay.file) : "",
          first ? decay.channel : "",
          first && tension_N ? fmt::format("{:g} N", *tension_N) : "",
          Cell(shown_estimate(mode.frequency_hz.value, mode.frequency_hz.std), decay.origin),
          Cell(shown_estimate(100 * mode.damping_ratio.value, 100 * mode.damping_ratio.std),
               decay.origin),
          shown(mode.r_squared, 4),
          shown(mode.cycles, 3)};
      for (const auto* model : models) {
        const auto* same = ident::same_oscillation(mode, *model);
        const double f = same ? same->frequency_hz.value : Answer::kNone;
        for (const auto& cell :
             {model->label, shown(f, 5), shown_percent(f / mode.frequency_hz.value - 1),
              same ? shown(100 * same->damping_ratio.value, 3) : std::string("–")}) {
          row.emplace_back(cell);
        }
        if (same && first) {
          best_ = fmt::format("; strongest {} Hz, {} {} Hz", shown(mode.frequency_hz.value, 5),
                              model->label, shown(f, 5));
        }
        table_.rows.push_back(std::move(row));
        row.assign(7, Cell());
      }
      if (models.empty()) table_.rows.push_back(std::move(row));
      first = false;
    }
  }

  const Campaign& campaign_;
  ident::DecayInputs inputs_;
  ReportTable table_;
  std::vector<AnalysedDecay> decays_;
  std::string best_;  ///< the last model against the strongest oscillation of the last record
};

}  // namespace

TestPartPtr decay_part(const Campaign& campaign, const CampaignTest& test) {
  return std::make_unique<DecayPart>(campaign, test);
}

}  // namespace rigfit::apps
