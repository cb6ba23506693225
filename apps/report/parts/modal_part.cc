#include "apps/report/parts/parts.h"
#include "signal/writers/writers.h"

namespace rigfit::apps {
namespace {

/// Recordings of hits and their modes, then the model's modes against them: a part each.
class ModalPart : public TestPart {
 public:
  ModalPart(const Campaign& campaign, const CampaignTest& test)
      : TestPart(test, "recorded_modal"), campaign_(campaign) {
    part_.id = test.name + "-recordings";
    part_.test = test.name;
  }

  std::vector<ReportPart> show(ident::TestInputs&, ident::TestResult& result) override {
    auto& outcome = std::get<ident::ModalOutcome>(result);
    std::vector<ReportPart> parts;
    if (!test_.recordings.empty()) {
      show_recorded(outcome.test);
      parts.push_back(std::move(part_));
    }
    if (test_.scene) {
      parts.push_back(model_part(campaign_, test_, outcome.model));
    }
    return parts;
  }

 private:
  void show_recorded(ident::ModalTest& analysed) {
    for (const auto& finding : analysed.findings) {
      refuse(part_, finding.code, finding.message, finding.where);
    }
    part_.json["states"] = Json::array();
    hits_ = {test_.name + "-hits",
             "Every hit, kept or rejected.",
             {{"state", {}, false}, {"recording", {}, false}}};
    modes_ = {
        test_.name + "-identified",
        "Modes identified, with standard uncertainties. MPC: 1 for a shape whose points move in "
        "phase; misfit: residual near the mode.",
        {{"state", {}, false}}};
    std::optional<Origin> origin;
    std::size_t states = 0, hits = 0, rejected = 0;
    for (auto& state : analysed.states) {
      hits += state.hammer.hits(), rejected += state.hammer.hits() - state.hammer.accepted_hits();
      if (state.has_modes() && ++states == 1) origin = state.origin;
      show(state);
    }
    if (hits_.rows.size() > 12)
      hits_.fold = fmt::format("All {} hits, {} rejected", hits, rejected);
    add(part_.blocks, std::move(hits_));
    if (!test_.scene) short_report();
    add(part_.blocks, PlotGroup{test_.name + "-frfs", "Spectra and poles", std::move(tabs_)});
    part_.json["hits"] = hits;
    part_.json["hits_rejected"] = rejected;
    part_.summary.push_back(
        {SummaryItem::Kind::recorded, test_.title,
         fmt::format("{} in {} from {}", counted(modes_.rows.size(), "mode"),
                     counted(states, "state"), counted(files_, "recording")) +
             (hits > 0 ? fmt::format("; {} of {} hits rejected", rejected, hits) : ""),
         origin});
    add(part_.blocks, std::move(modes_));
  }

  /// Without a model: the first state's response or spectrum and the modes.
  void short_report() {
    part_.brief = {modes_.id};
    if (tabs_.empty()) return;
    auto& plots = tabs_.front().plots;
    const auto frf = std::ranges::find_if(plots, [](const Plot& one) { return one.log_y; });
    if (frf == plots.end()) return;
    part_.brief.push_back(frf->id);
    part_.blocks.push_back(std::move(*frf));
    plots.erase(frf);
  }

  void show(ident::ModalTestState& state) {
    const std::string label = ident::state_label(state.tension_N);
    for (std::size_t p = 0; p < state.hammer.tests.size(); ++p) {
      list_hits(state.places[p], state.hammer.tests[p], state.tension_N);
    }
    Json hits = hits_json(state.places, state.hammer);
    tell_state(state.findings, label);
    const std::string word = file_word(label);
    auto plots = state.ambient
                     ? ambient_plots(test_.name + "-" + word, *state.ambient, state.origin)
                     : hammer_plots({.places = state.places,
                                     .test = state.hammer,
                                     .modal = state.modal ? &*state.modal : nullptr,
                                     .name = test_.name,
                                     .state = word,
                                     .origin = state.origin});
    if (!plots.empty()) tabs_.push_back({label, std::move(plots)});
    for (auto& place : state.places) place.recordings.clear();  // not needed any more
    if (!state.modal) return;
    add_answers(state, label);
    add_rows(modes_, {label_of(state.tension_N)}, describe::table_of(state.modal->model.modes),
             state.origin);
    const auto& modal = *state.modal;
    const auto give = [&](const char* what, std::string content) {
      part_.files.emplace_back(fmt::format("uff/{}-{}-{}.uff", test_.name, what, word),
                               std::move(content));
    };
    if (state.hammer.accepted_hits() > 0) give("frf", signal::uff_text(state.hammer.frfs));
    give("modes", signal::uff_text(modal.model));
    part_.json["states"].push_back(
        {{"tension_N", state.tension_N ? Json(*state.tension_N) : Json(nullptr)},
         {"origin", word_of(state.origin)},
         {"responses", state.channels},
         {"averages", state.hammer.frfs.averages},
         {"frf_form", name_of(state.hammer.frfs.form)},
         {"units", state.hammer.frfs.unit},
         {"band_hz", {modal.low_hz, modal.high_hz}},
         {"misfit_over_error_bars",
          modal.misfit_over_error_bars ? Json(*modal.misfit_over_error_bars) : Json(nullptr)},
         {"hits", std::move(hits)},
         {"modes", describe::json_of(modal.model.modes)}});
  }

  /// A place left out is refused here: the campaign asked for it. A mode whose damping is refused
  /// keeps its frequency, and the test goes on.
  void tell_state(const std::vector<ident::Finding>& findings, const std::string& label) {
    for (const auto& finding : findings) {
      part_.warnings.push_back({finding.code, finding.message,
                                fmt::format("{}, {}{}{}", test_.name, label,
                                            finding.where.empty() ? "" : ", ", finding.where),
                                finding.code == "point_left_out" ||
                                    (finding.refused && finding.code != "window_damping")});
    }
  }

  void list_hits(const signal::StruckPoint& struck, const signal::ImpactTest& test,
                 std::optional<double> tension_N) {
    std::string label = label_of(tension_N);
    for (std::size_t r = 0; r < struck.recordings.size(); ++r) {
      auto hits = test.search.hits;
      std::erase_if(hits, [&](const auto& hit) { return hit.recording != r; });
      if (hits.empty()) continue;
      add_rows(hits_, {std::exchange(label, ""), short_name(struck.recordings[r].path.string())},
               describe::table_of(std::move(hits)), std::nullopt);
    }
  }

  /// Frequencies and damping; on the first page only where no model says more.
  void add_answers(const ident::ModalTestState& found, const std::string& label) {
    const auto hits = static_cast<std::size_t>(found.hammer.frfs.averages);
    const std::string how = hits > 0 ? counted(hits, "hit") : "ambient motion";
    int number = 0;
    for (const auto& mode : found.modal->model.modes) {
      Answer f = answer(label + "/frequency",
                        fmt::format("{}, {}: natural frequency {}", test_.title, label, ++number),
                        how, "Hz", {mode.frequency_hz, {}}, found.origin);
      Answer damping = answer(label + "/damping",
                              fmt::format("{}, {}: damping ratio ζ {}", test_.title, label, number),
                              how, "", {mode.damping_ratio, {}}, found.origin);
      for (auto* one : {&f, &damping}) {
        one->mode_hz = mode.frequency_hz.value;
        one->rank = test_.scene ? 2 : 0;
        // A refused damping is a doubt about the damping only.
        if (mode.doubtful && !mode.damping_dominated_by_window) one->verdict = "doubtful mode";
      }
      part_.answers.push_back(std::move(f));
      if (!mode.damping_dominated_by_window) part_.answers.push_back(std::move(damping));
    }
  }

  const Campaign& campaign_;
  ReportTable hits_, modes_;
  std::vector<PlotTab> tabs_;
};

}  // namespace

std::unique_ptr<TestPart> modal_part(const Campaign& campaign, const CampaignTest& test) {
  return std::make_unique<ModalPart>(campaign, test);
}

}  // namespace rigfit::apps
