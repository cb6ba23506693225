// The parts of tests, a class for each kind.
#include "apps/campaign_file/bending_files.h"
#include "apps/report/parts/parts.h"
#include "signal/recording/recording.h"
#include "signal/writers/writers.h"

namespace rigfit::apps {
namespace {

class AxialPart : public TestPart {
 public:
  AxialPart(const CampaignTest& test, int threads) : TestPart(test, "axial") {
    std::get<ident::AxialInputs>(inputs_).threads = threads;
  }

  std::vector<ReportPart> show(ident::TestInputs&, ident::TestResult& found) override {
    const auto& result = std::get<ident::AxialCampaignResult>(found);
    tell(result.findings);
    part_.json.update(axial_json(result));
    add(part_.blocks, axial_blocks(test_.name, result, &test_));
    part_.brief = {test_.name + "-EA", test_.name + "-lengths"};
    if (!result.test) return {std::move(part_)};
    const auto& r = *result.test;
    const Origin origin = result.decays.front().origin;
    const std::string how = fmt::format("axial test, {} at {}", counted(r.samples.size(), "record"),
                                        counted(r.lengths.size(), "length"));
    Answer EA = answer("EA", "Cable axial stiffness EA", how, "N", r.EA_N, origin, test_.EA_N);
    if (r.conditional) {
      EA.how += ": a lower bound, as one length cannot separate other compliance";
      if (!std::isfinite(EA.high)) EA.high = EA.std = Answer::kNone;
    }
    Answer damping = answer("damping_ratio", "Axial damping ratio ζ", how, "", r.damping_ratio,
                            origin, test_.damping_ratio);
    add_answer(part_, std::move(EA));
    add_answer(part_, std::move(damping));
    return {std::move(part_)};
  }
};

/// EI of a strand against its tension, or of a beam without tension.
class BendingPart : public TestPart {
 public:
  explicit BendingPart(const CampaignTest& test)
      : TestPart(test, "bending"), kind_(test.as<BendingTest>()) {
    part_.json["span_m"] = kind_.test.span_m.value;
  }

  std::vector<ReportPart> show(ident::TestInputs& given, ident::TestResult& found) override {
    const auto& inputs = std::get<ident::BendingCampaign>(given);
    const auto& result = std::get<ident::BendingCampaignResult>(found);
    const auto& laws = result.curve.laws();
    part_.json.update(describe::json_of(result));
    part_.json["laws_decided"] = !kind_.beam() && laws.decided;
    tell(result.findings);
    for (std::size_t i = 0; i < result.points.size(); ++i) {
      part_.json["tests"][i]["origin"] = word_of(result.points[i].origin);
    }
    const std::string& name = test_.name;
    add(part_.blocks, bending_blocks(name, inputs, result));
    if (!kind_.beam() && !laws.laws.empty() && !laws.decided) {
      part_.warnings.push_back({"law_not_decided", result.curve.sentence(), name});
    }
    add_answers(inputs, result);
    part_.brief = {kind_.beam() ? name + "-load-deflection" : name + "-EI", name + "-results"};
    return {std::move(part_)};
  }

 private:
  void take(LoadedRecording entry, const RecordingGroup& group) override {
    const BendingColumns columns{kind_.channels, kind_.beam(),
                                 "name it in the campaign, channels = {{ {} = \"...\" }}"};
    try {
      auto source = bending_source(*entry.recording, columns, part_.warnings);
      source.origin = group.origin();
      std::get<ident::BendingCampaign>(inputs_).sources.push_back(std::move(source));
    } catch (const signal::RecordingError& error) {
      refuse(part_, "channel", error.what(), entry.file);
    }
  }

  /// EI of every point on the first page; of specimens the first one.
  void add_answers(const ident::BendingCampaign& inputs,
                   const ident::BendingCampaignResult& result) {
    int found = 0;
    for (const auto& one : result.points) {
      if (!one.usable()) continue;
      const auto& point = one.point;
      const std::string file = short_name(one.file);
      Answer EI = answer(fmt::format("EI/{}", ++found),
                         kind_.beam() ? fmt::format("Beam bending stiffness EI ({})", file)
                                      : fmt::format("Cable bending stiffness EI at {} N",
                                                    shown(point.tension_N, 3)),
                         kind_.published() ? "published"
                         : kind_.beam()    ? "bending test without tension"
                                           : "bending test",
                         "N m²", {{point.EI_Nm2, point.std}, {point.low, point.high}}, one.origin);
      EI.rank = kind_.beam() && found > 1 ? 1 : 0;
      const auto& modulus = one.modulus_Pa;
      if (kind_.beam() && std::isfinite(modulus.value)) {
        Answer E = EI;
        E.key = fmt::format("{}/modulus/{}", test_.name, found);
        E.quantity = fmt::format("Beam bending modulus ({})", file);
        E.unit = "Pa";
        E.value = modulus.value;
        E.std = modulus.std;
        // The section's uncertainty widens the interval of EI.
        const auto I = inputs.section.second_moment();
        const double width = ident::coverage_factor(0.95, 0) * I.std / I.value;
        E.low = modulus.value * (1 - std::hypot(1 - EI.low / EI.value, width));
        E.high = modulus.value * (1 + std::hypot(EI.high / EI.value - 1, width));
        add_answer(part_, std::move(E), false);
      }
      add_answer(part_, std::move(EI));
    }
  }

  const BendingTest& kind_;
};

/// Free decays; where a scene stands for the test, its answer by the same estimator.
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
              {"tension_N", describe::json_of(recorded.tension_N)},
              {"modes", describe::json_of(decay.result.modes)},
              {"decays", describe::json_of(decay.decays)},
              {"law", name_of(decay.result.envelope.law)}};
    const std::string at = label_of(recorded.tension_N);
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
                            {mode.frequency_hz, {}}, decay.origin),
                     answer("damping", test_.title + at + ": damping ratio ζ", how, "",
                            {mode.damping_ratio, {}}, decay.origin)}) {
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

/// The tension of a cable from its frequencies.
class TensionPart : public TestPart {
 public:
  explicit TensionPart(const CampaignTest& test) : TestPart(test, "tension") {}

  std::vector<ReportPart> show(ident::TestInputs&, ident::TestResult& result) override {
    const auto& found = std::get<ident::TensionCampaignResult>(result);
    tell(found.findings);
    const auto& r = found.tension;
    if (!r.solved) return {std::move(part_)};
    part_.json.update(describe::json_of(found));
    const std::string ends = ident::name_of(r.candidates.front().ends);
    add(part_.blocks, tension_blocks(test_.name, r));
    part_.brief = {test_.name + "-frequencies", test_.name + "-ends"};
    Answer tension =
        answer("tension", "Cable tension at mid-span",
               fmt::format("from {} frequencies, {} ends", r.candidates.front().modes.size(), ends),
               "N", r.tension_N,
               test_.recordings.empty() ? Origin::measured : test_.recordings.front().origin(),
               test_.tension_N);
    tension.determined = r.decided;
    add_answer(part_, std::move(tension));
    return {std::move(part_)};
  }
};

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
        {{"tension_N", describe::json_of(state.tension_N)},
         {"origin", word_of(state.origin)},
         {"responses", state.channels},
         {"averages", state.hammer.frfs.averages},
         {"frf_form", name_of(state.hammer.frfs.form)},
         {"units", state.hammer.frfs.unit},
         {"band_hz", {modal.low_hz, modal.high_hz}},
         {"misfit_over_error_bars", describe::json_of(modal.misfit_over_error_bars)},
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

std::unique_ptr<TestPart> test_part(const Campaign& campaign, const CampaignTest& test,
                                    int threads) {
  if (test.is<BendingTest>()) return std::make_unique<BendingPart>(test);
  if (test.is<AxialTest>()) return std::make_unique<AxialPart>(test, threads);
  if (test.is<DecayTest>()) return std::make_unique<DecayPart>(test);
  if (test.is<TensionTest>()) return std::make_unique<TensionPart>(test);
  return std::make_unique<ModalPart>(campaign, test);
}

}  // namespace rigfit::apps
