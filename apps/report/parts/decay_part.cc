#include "apps/report/parts/parts.h"

namespace rigfit::apps {
namespace {

class DecayPart : public TestPart {
 public:
  explicit DecayPart(const CampaignTest& test) : TestPart(test, "decays") {}

  std::vector<ReportPart> show(ident::TestInputs& inputs, ident::TestResult& result) override {
    const auto& recordings = std::get<ident::DecayInputs>(inputs).recordings;
    auto& outcome = std::get<ident::DecayTest>(result);
    tell(outcome.findings);
    table_ = {test_.name + "-modes",
              "Oscillations found in each record, strongest first; those of the model by the same "
              "estimator over the same time.",
              {{"record", {}, false},
               {"channel", {}, false},
               {"taken at", {}, false},
               {"of", {}, false}}};
    part_.json["records"] = Json::array();
    PlotGroup group{test_.name + "-decays", "Decays", {}};
    std::optional<std::size_t> last;
    for (auto& channel : outcome.channels) {
      const std::size_t r = channel.recording;
      if (last != r) group.tabs.push_back({short_name(recordings[r].name), {}});
      last = r;
      tell_channel(channel, recordings[r], group.tabs.back());
    }
    std::erase_if(group.tabs, [](const PlotTab& tab) { return tab.plots.empty(); });
    part_.brief = {table_.id};
    add(part_.blocks, std::move(table_));
    add(part_.blocks, std::move(group));
    add(part_.blocks, damping_plot(test_.name + "-damping", decays_));
    part_.summary.push_back({test_.scene ? SummaryItem::Kind::error : SummaryItem::Kind::recorded,
                             test_.title,
                             fmt::format("{} in {}{}", counted(decays_.size(), "decay"),
                                         counted(files_, "recording"), best_),
                             decays_.empty() ? std::optional<Origin>() : decays_.front().origin});
    return {std::move(part_)};
  }

 private:
  void tell_channel(ident::ChannelDecays& decay, const ident::TestRecording& recorded,
                    PlotTab& tab) {
    if (decay.result.modes.empty()) return;
    const std::string id = fmt::format("{}-{}", test_.name, decays_.size() + 1);
    tab.plots.push_back(decay_plot(id, decay));
    Json json{{"file", decay.file},
              {"channel", decay.channel},
              {"origin", word_of(decay.origin)},
              {"tension_N", recorded.tension_N ? Json(*recorded.tension_N) : Json(nullptr)},
              {"modes", describe::json_of(decay.result.modes)},
              {"decays", describe::json_of(decay.decays)},
              {"law", name_of(decay.result.envelope.law)}};
    const std::string at = recorded.tension_N ? fmt::format("{:g} N", *recorded.tension_N) : "";
    add_answers(decay, at.empty() ? at : ", " + at);
    add_rows(table_, {short_name(decay.file), decay.channel, at, "record"},
             describe::table_of(decay.result.modes), decay.origin);
    if (!decay.answers.empty()) {
      tab.plots.push_back(release_plot(id, decay));
      if (tab.plots.back().series.empty()) tab.plots.pop_back();
      json["models"] = Json::array();
      for (const auto& answer : decay.answers) {
        if (!answer.failure.empty()) {
          refuse(part_, "no_model", answer.failure,
                 fmt::format("{}: {}, {}", test_.title, short_name(decay.file), answer.label));
          continue;
        }
        json["models"].push_back({{"version", answer.label},
                                  {"nonlinear", answer.response.nonlinear},
                                  {"frequency_shift", answer.response.frequency_shift},
                                  {"modes", describe::json_of(answer.found.modes)}});
        list_model(decay, answer);
      }
    }
    part_.json["records"].push_back(std::move(json));
    decays_.push_back(std::move(decay));
  }

  /// Adds frequency and damping of the strongest oscillation.
  void add_answers(const ident::RecordedDecay& decay, const std::string& at) {
    const auto& mode = decay.result.modes.front();
    const std::string how = "decay of " + decay.channel;
    for (auto one : {answer("frequency", test_.title + at + ": frequency", how, "Hz",
                            mode.frequency_hz, decay.origin),
                     answer("damping", test_.title + at + ": damping ratio ζ", how, "",
                            mode.damping_ratio, decay.origin)}) {
      one.key.insert(test_.name.size(), at);
      one.rank = test_.scene ? 2 : 0;
      add_answer(part_, std::move(one), false);
    }
  }

  /// The model's oscillations that are those of the record.
  void list_model(const ident::RecordedDecay& decay, const ident::ReleaseAnswer& model) {
    std::vector<signal::DecayMode> modes;
    for (const auto& mode : decay.result.modes) {
      const auto* same = ident::same_mode(mode, model.found);
      if (!same) continue;
      modes.push_back(*same);
      if (&mode != &decay.result.modes.front()) continue;
      best_ = fmt::format("; strongest {} Hz, {} {} Hz", shown(mode.frequency_hz.value, 5),
                          model.label, shown(same->frequency_hz.value, 5));
    }
    add_rows(table_, {"", "", "", model.label}, describe::table_of(std::move(modes)),
             Origin::modelled);
  }

  ReportTable table_;
  std::vector<ident::RecordedDecay> decays_;
  std::string best_;  ///< the last model against the strongest oscillation of the last record
};

}  // namespace

TestPartPtr decay_part(const CampaignTest& test) { return std::make_unique<DecayPart>(test); }

}  // namespace rigfit::apps
