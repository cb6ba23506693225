#include "apps/report/modal/recorded_modal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "apps/report/figures/frf_plots.h"
#include "apps/report/html_text.h"
#include "apps/report/modal/modal_files.h"
#include "apps/report/modal/struck_recordings.h"
#include "apps/report/parts/recording_blocks.h"
#include "signal/impact/impact_test.h"
#include "signal/modal/modal_synthesis.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;

class RecordedModalAnalysis {
 public:
  RecordedModalAnalysis(const Campaign& campaign, const CampaignTest& test) : test_(test) {
    part().id = test.name + "-recordings";
    part().title = test.title + ": recordings";
    part().json_key = "recorded_modal";
    part().json["test"] = test.name;
    part().json["states"] = Json::array();
    scene_ = &campaign.scenes[*test.scene].scene;
  }

  RecordedModal run() {
    auto loaded = load_recordings(test_.recordings);
    for (const auto& entry : loaded) {
      part().inputs.insert(part().inputs.end(), entry.inputs.begin(), entry.inputs.end());
    }
    const std::size_t files = loaded.size();
    part().blocks.push_back(Paragraph{fmt::format(
        "The rig is struck with a hammer that measures its force, and what the sensors answer is "
        "recorded. Each hit is judged; the accepted ones are averaged to frequency response "
        "functions, and from these come natural frequencies, damping and shapes.{}",
        test_.hammer.exponential_end_level > 0
            ? fmt::format(" An exponential window, down to {:g} % at the end, acts on force and "
                          "responses alike; its damping is taken out of every mode.",
                          100 * test_.hammer.exponential_end_level)
            : "")});
    add_recordings(part(), test_, loaded);
    hits_.id = test_.name + "-hits";
    hits_.caption = "Every hit, kept or rejected.";
    hits_.columns = {{"state", {}, false},  {"recording", {}, false}, {"time, s", {}, true},
                     {"peak, N", {}, true}, {"pulse, ms", {}, true},  {"usable to, Hz", {}, true},
                     {"verdict", {}, false}};
    modes_.id = test_.name + "-identified";
    modes_.caption =
        "Modes identified from the frequency responses, with standard uncertainties. MPC: 1 for a "
        "shape whose points move in step; misfit: what the mode leaves of the response near it.";
    rejected_columns_.id = test_.name + "-rejected";
    rejected_columns_.caption =
        "Poles that stay over the orders of the stabilisation diagram and yet are no mode, with "
        "the "
        "test that each failed. A mode that the sensor hardly sees (near its node) ends here too.";
    rejected_columns_.columns = {{"state", {}, false},
                                 {"frequency, Hz", {}, true},
                                 {"damping, %", {}, true},
                                 {"in the diagram, %", {}, true},
                                 {"why it is no mode", {}, false}};
    auto states = sorted_recordings(test_, loaded, part());
    for (auto& state : states) analyse(state);
    finish(files);
    return std::move(result_);
  }

 private:
  ReportPart& part() { return result_.part; }

  void analyse(StruckState& state) {
    const std::string label = state_label(state.tension_N);
    const auto responses = response_names(test_, state.struck);
    if (responses.empty()) {
      refuse(part(), "no_response", "the recordings share no channel besides the force",
             place(label));
      return;
    }
    Index block = 0;
    for (int round = 0; round < 2; ++round) {
      for (auto& struck : state.struck) {
        auto options = impact_options(test_);
        if (round == 1) {
          if (struck.test && struck.test->search.block_samples == block) continue;
          options.hits.block_s =
              static_cast<double>(block) / struck.recordings.front().sample_rate_hz;
        }
        struck.test =
            signal::analyse_impact_test(struck.recordings, test_.hammer.force, responses, options);
        const Index own = struck.test->search.block_samples;
        if (struck.test->frfs.averages > 0) block = block == 0 ? own : std::min(block, own);
      }
      if (state.struck.size() < 2) break;
    }
    for (const auto& struck : state.struck) list_hits(label, struck);
    std::erase_if(state.struck, [&](const Struck& one) {
      if (one.test->frfs.averages > 0) return false;
      refuse(part(), "no_hit_accepted",
             one.test->search.hits.empty()
                 ? "no hit rises above the noise of the force"
                 : fmt::format("none of {} hits can be used; first: {}",
                               one.test->search.hits.size(), one.test->search.hits.front().reason),
             place(state_label(state.tension_N)) + (one.load.empty() ? "" : ", " + one.load));
      return true;
    });
    if (state.struck.empty()) return;
    identify(state, label);
  }

  /// Of the campaign, for warnings: "cable-in-plane, 200 N".
  [[nodiscard]] std::string place(const std::string& label) const {
    return test_.name + ", " + label;
  }

  void list_hits(const std::string& label, const Struck& struck) {
    Json list = Json::array();
    const auto& test = *struck.test;
    for (const auto& hit : test.search.hits) {
      const std::string file = struck.recordings[hit.recording].path.string();
      Cell verdict(hit.accepted ? (hit.reason.empty() ? "kept" : "kept: " + hit.reason)
                                : "rejected: " + hit.reason);
      verdict.doubtful = !hit.accepted;
      rejected_ += !hit.accepted;
      ++all_hits_;
      hits_.rows.push_back({label == last_label_ ? "" : label, short_name(file),
                            fmt::format("{:.4f}", hit.time_s), shown(hit.peak, 4),
                            shown(1e3 * hit.pulse_duration_s, 3), shown(hit.usable_hz, 3),
                            verdict});
      last_label_ = label;
      list.push_back({{"file", file},
                      {"time_s", hit.time_s},
                      {"peak", hit.peak},
                      {"accepted", hit.accepted},
                      {"reason", hit.reason}});
    }
    for (const auto* notes : {&test.notes, &test.frfs.notes}) {
      for (const auto& note : *notes) {
        part().warnings.push_back({note.code, note.message,
                                   place(label) + (note.where.empty() ? "" : ", " + note.where),
                                   false});
      }
    }
    json_hits_[label].push_back({{"load", struck.load}, {"hits", std::move(list)}});
  }

  void identify(StruckState& state, const std::string& label) {
    RecordedModalState found;
    found.tension_N = state.tension_N;
    found.origin = state.struck.front().origin;
    found.frfs = merged(state.struck);
    name_points(found.frfs);
    double usable = state.struck.front().test->usable_hz;
    for (const auto& struck : state.struck) {
      usable = std::min(usable, struck.test->usable_hz);
      found.amplitudes = found.amplitudes && struck.test->amplitudes;
      found.hits.push_back(recorded_hit(struck, test_.hammer.force));
    }
    for (const auto& response : found.frfs.responses) found.channels.push_back(response.name);
    const auto& recording = state.struck.front().recordings.front();
    for (const auto& name : found.channels) {
      const auto& along = recording.channel(name).direction;
      found.directions.emplace_back(along[0], along[1], along[2]);
    }
    for (const auto& struck : state.struck) {
      const auto& along = struck.recordings.front().channel(test_.hammer.force).direction;
      found.force_directions.emplace_back(along[0], along[1], along[2]);
    }
    signal::ModalOptions options;
    options.low_hz = test_.band_hz ? test_.band_hz->first : 0;
    options.high_hz = test_.band_hz ? test_.band_hz->second : usable;
    if (test_.hammer.max_order > 0) options.lscf.max_order = test_.hammer.max_order;
    signal::ModalResult modal;
    try {
      modal = signal::identify_modes(found.frfs, options);
    } catch (const std::invalid_argument& error) {
      refuse(part(), "no_modes", error.what(), place(label));
      return;
    }
    found.modes = modal.model;
    found.low_hz = modal.low_hz;
    found.high_hz = modal.high_hz;
    for (const auto& note : modal.model.notes) {
      if (note.code == "no_modes" || note.code == "rank_deficient") {
        refuse(part(), note.code, note.message, place(label));
      } else {
        part().warnings.push_back({note.code, note.message, place(label), false});
      }
    }
    if (modal.end != signal::RefineEnd::converged && !modal.model.modes.empty()) {
      part().warnings.push_back(
          {"not_converged",
           fmt::format("the refinement ended by {}: frequencies and damping are near, not at, the "
                       "best fit",
                       name_of(modal.end)),
           place(label), false});
    }
    figures(found, modal, label);
    list_modes(found, modal, label);
    add_files(found);
    if (!found.modes.modes.empty()) result_.states.push_back(std::move(found));
  }

  /// UFF node numbers and directions from the scene's sensors and loads.
  void name_points(signal::FrfSet& frfs) const {
    for (auto& response : frfs.responses) {
      const auto other = test_.hammer.sensors.find(response.name);
      const std::string& name = other == test_.hammer.sensors.end() ? response.name : other->second;
      response = uff_point(*scene_, name, response.name);
    }
    for (auto& input : frfs.inputs) input = uff_point(*scene_, input.name, input.name);
  }

  [[nodiscard]] std::string figure_id(const char* what, const std::string& label) const {
    return fmt::format("{}-{}-{}", test_.name, what, file_word(label));
  }

  void figures(const RecordedModalState& found, const signal::ModalResult& modal,
               const std::string& label) {
    const LineRange range = lines_between(found.frfs, found.low_hz, found.high_hz);
    if (range.last < range.first) return;
    std::optional<signal::FrfSet> rebuilt;
    if (!found.modes.modes.empty()) {
      rebuilt = signal::synthesised(
          found.modes, found.frfs.frequency_hz.segment(range.first, range.last - range.first + 1),
          found.frfs.form, found.frfs.exponential_decay_rate_1_s);
    }
    PlotTab tab{label, {}};
    tab.plots.push_back(magnitude_plot(figure_id("frf", label), found.frfs, range, found.origin,
                                       rebuilt ? &*rebuilt : nullptr));
    tab.plots.push_back(phase_plot(figure_id("phase", label), found.frfs, range, found.origin));
    if (found.frfs.coherence.size() > 0) {
      tab.plots.push_back(
          coherence_plot(figure_id("coherence", label), found.frfs, range, found.origin));
    }
    if (!modal.stabilisation.poles.empty()) {
      tab.plots.push_back(
          stabilisation_plot(figure_id("stabilisation", label), modal, found.origin));
    }
    tabs_.push_back(std::move(tab));
  }

  void list_modes(const RecordedModalState& found, const signal::ModalResult& modal,
                  const std::string& label) {
    if (modes_.columns.empty()) {
      modes_.columns = {{"state", {}, false},         {"frequency, Hz", found.origin},
                        {"damping, %", found.origin}, {"MPC", found.origin},
                        {"misfit, %", found.origin},  {"in the diagram, %", found.origin},
                        {"remarks", {}, false}};
    }
    Json list = Json::array();
    bool first = true;
    for (const auto& mode : found.modes.modes) {
      const bool no_damping = mode.damping_dominated_by_window;
      Cell remark(mode.doubtful ? mode.doubt : "");
      remark.doubtful = mode.doubtful;
      modes_.rows.push_back(
          {first ? label : "",
           Cell(shown_estimate(mode.frequency_hz.value, mode.frequency_hz.std), found.origin),
           no_damping
               ? Cell("refused")
               : Cell(shown_estimate(100 * mode.damping_ratio.value, 100 * mode.damping_ratio.std),
                      found.origin),
           fmt::format("{:.3f}", mode.modal_phase_collinearity),
           shown(100 * mode.reconstruction_error, 2), fmt::format("{:.0f}", 100 * mode.presence),
           remark});
      first = false;
      if (mode.doubtful) {
        part().warnings.push_back(
            {"doubtful_mode", mode.doubt,
             fmt::format("{}, {:.4g} Hz", place(label), mode.frequency_hz.value), false});
      }
      Json shape = Json::array();
      for (Index r = 0; r < mode.shape.size(); ++r) {
        shape.push_back({{"re", mode.shape[r].real()}, {"im", mode.shape[r].imag()}});
      }
      list.push_back(
          {{"frequency_hz", {{"value", mode.frequency_hz.value}, {"std", mode.frequency_hz.std}}},
           {"damping_ratio",
            {{"value", no_damping ? Json(nullptr) : Json(mode.damping_ratio.value)},
             {"std", no_damping ? Json(nullptr) : Json(mode.damping_ratio.std)}}},
           {"shape", std::move(shape)},
           {"modal_phase_collinearity", mode.modal_phase_collinearity},
           {"reconstruction_error", mode.reconstruction_error},
           {"doubtful", mode.doubtful},
           {"doubt", mode.doubt}});
      ++modes_found_;
    }
    Json rejected = Json::array();
    for (const auto& column : modal.rejected) {
      rejected.push_back({{"frequency_hz", column.frequency_hz},
                          {"damping_ratio", column.damping_ratio},
                          {"presence", column.presence},
                          {"code", column.code},
                          {"reason", column.reason}});
      rejected_columns_.rows.push_back(
          {label == last_column_label_ ? "" : label, shown(column.frequency_hz, 4),
           shown(100 * column.damping_ratio, 2), fmt::format("{:.0f}", 100 * column.presence),
           column.reason});
      last_column_label_ = label;
    }
    Json state;
    state["tension_N"] = found.tension_N ? Json(*found.tension_N) : Json(nullptr);
    state["origin"] = word_of(found.origin);
    state["responses"] = found.channels;
    state["averages"] = found.frfs.averages;
    state["frf_form"] = name_of(found.frfs.form);
    state["units"] = found.frfs.unit;
    state["band_hz"] = {found.low_hz, found.high_hz};
    state["misfit_over_error_bars"] =
        modal.misfit_over_error_bars ? Json(*modal.misfit_over_error_bars) : Json(nullptr);
    state["struck"] = json_hits_[label];
    state["modes"] = std::move(list);
    state["rejected_columns"] = std::move(rejected);
    state["uff"] = {uff_path("frf", label), uff_path("modes", label)};
    part().json["states"].push_back(std::move(state));
  }

  [[nodiscard]] std::string uff_path(const char* what, const std::string& label) const {
    return "uff/" + figure_id(what, label) + ".uff";
  }

  void add_files(const RecordedModalState& found) {
    const std::string label = state_label(found.tension_N);
    part().files.push_back({uff_path("frf", label), frf_file(found.frfs)});
    part().files.push_back({uff_path("modes", label), mode_file(*scene_, found.modes)});
  }

  void finish(std::size_t files) {
    if (!hits_.rows.empty()) {
      if (hits_.rows.size() > 12) {
        hits_.fold = fmt::format("All {} hits, {} rejected", all_hits_, rejected_);
      }
      part().blocks.push_back(std::move(hits_));
    }
    if (!tabs_.empty()) {
      part().blocks.push_back(
          PlotGroup{test_.name + "-frfs", "Frequency responses and poles", std::move(tabs_)});
    }
    if (!modes_.rows.empty()) part().blocks.push_back(std::move(modes_));
    if (!rejected_columns_.rows.empty()) {
      rejected_columns_.fold = fmt::format("Columns of the diagram that are no mode: {}, and why",
                                           rejected_columns_.rows.size());
      part().blocks.push_back(std::move(rejected_columns_));
    }
    part().json["hits"] = all_hits_;
    part().json["hits_rejected"] = rejected_;
    const auto origin =
        result_.states.empty() ? std::optional<Origin>() : result_.states.front().origin;
    part().summary.push_back({SummaryItem::Kind::recorded, test_.title,
                              fmt::format("{} in {} from {}; {} of {} hits rejected",
                                          counted(static_cast<std::size_t>(modes_found_), "mode"),
                                          counted(result_.states.size(), "state"),
                                          counted(files, "recording"), rejected_, all_hits_),
                              origin, part().id});
  }

  const CampaignTest& test_;
  const model::Scene* scene_ = nullptr;
  RecordedModal result_;
  ReportTable hits_, modes_, rejected_columns_;
  std::vector<PlotTab> tabs_;
  std::map<std::string, Json> json_hits_;
  std::string last_label_, last_column_label_;
  int rejected_ = 0, all_hits_ = 0, modes_found_ = 0;
};

}  // namespace

std::string state_label(std::optional<double> tension_N) {
  return tension_N ? fmt::format("{:g} N", *tension_N) : std::string("as built");
}

RecordedModal recorded_modal(const Campaign& campaign, const CampaignTest& test) {
  return RecordedModalAnalysis(campaign, test).run();
}

}  // namespace rigfit::apps
