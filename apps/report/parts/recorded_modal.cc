#include "apps/report/parts/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "apps/report/drawing/html_text.h"
#include "apps/report/figures/figures.h"
#include "apps/report/modal/modal_part.h"
#include "apps/results/modal_files.h"
#include "apps/results/modal_json.h"
#include "signal/modes/modal_synthesis.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;

const std::string kAmbient =
    "The rig moves under forces that nobody measures. Resonances of the correlations between the "
    "sensors give natural frequencies, damping and unscaled shapes.";

class HitsShown {
 public:
  HitsShown(const Campaign& campaign, const CampaignTest& test, ReportPart& part)
      : test_(test), part_(part) {
    if (test.scene) scene_ = &campaign.scenes[*test.scene].scene;
    part_.json["states"] = Json::array();
    hits_.id = test_.name + "-hits";
    hits_.caption = "Every hit, kept or rejected.";
    hits_.columns = {{"state", {}, false},  {"recording", {}, false}, {"time, s", {}, true},
                     {"peak, N", {}, true}, {"pulse, ms", {}, true},  {"usable to, Hz", {}, true},
                     {"verdict", {}, false}};
    modes_.id = test_.name + "-identified";
    modes_.caption =
        "Modes identified from the frequency responses, with standard uncertainties. MPC: 1 for a "
        "shape whose points move in step; misfit: what the mode leaves of the response near it.";
  }

  void run(ident::ModalTest& analysed, std::size_t files) {
    for (const auto& finding : analysed.findings) {
      refuse(part_, finding.code, finding.message, finding.where);
    }
    for (auto& state : analysed.states) show(state);
    finish(files);
  }

 private:
  void show(ident::ModalTestState& state) {
    const std::string label = ident::state_label(state.tension_N);
    for (std::size_t p = 0; p < state.hammer.tests.size(); ++p) {
      list_hits(label, state.places[p], state.hammer.tests[p]);
    }
    tell(state.findings, label);
    if (state.hammer.hits() > 0) {
      tabs_.push_back({label, {}});
      tabs_.back().plots.push_back(
          hits_plot(figure_id("hits", label), state.places, state.hammer, state.origin));
    }
    for (auto& place : state.places) place.recordings.clear();  // not needed any more
    if (!state.modal) return;
    name_points(state.hammer.frfs.responses, state.hammer.frfs.inputs);
    name_points(state.modal->model.responses, state.modal->model.inputs);
    figures(state, label);
    list_modes(state, label);
    add_files(state);
    if (!state.has_modes()) return;
    if (++states_ == 1) origin_ = state.origin;
  }

  /// A place left out is refused here: the campaign asked for it. A mode whose damping is refused
  /// keeps its frequency, and the test goes on.
  void tell(const std::vector<ident::Finding>& findings, const std::string& label) {
    for (const auto& finding : findings) {
      const std::string where = place(label) + (finding.where.empty() ? "" : ", " + finding.where);
      const bool refused =
          finding.code == "point_left_out" || (finding.refused && finding.code != "window_damping");
      if (refused) {
        refuse(part_, finding.code, finding.message, where);
      } else {
        part_.warnings.push_back({finding.code, finding.message, where, false});
      }
    }
  }

  /// Place in the campaign, for warnings: "cable-in-plane, 200 N".
  [[nodiscard]] std::string place(const std::string& label) const {
    return test_.name + ", " + label;
  }

  void list_hits(const std::string& label, const ident::StruckPlace& struck,
                 const signal::ImpactTest& test) {
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
    }
    json_hits_[label].push_back({{"load", struck.name}, {"hits", hits_json(struck, test)}});
  }

  /// UFF node numbers and directions from the scene's sensors and loads.
  void name_points(std::vector<signal::MeasuredPoint>& responses,
                   std::vector<signal::MeasuredPoint>& inputs) const {
    if (!scene_) return;
    for (auto& response : responses) {
      const auto& sensors = test_.as<ModalTest>().inputs.setup.sensors;
      const auto other = sensors.find(response.name);
      const std::string& name = other == sensors.end() ? response.name : other->second;
      response = uff_point(*scene_, name, response.name);
    }
    for (auto& input : inputs) input = uff_point(*scene_, input.name, input.name);
  }

  [[nodiscard]] std::string figure_id(const char* what, const std::string& label) const {
    return fmt::format("{}-{}-{}", test_.name, what, file_word(label));
  }

  void figures(const ident::ModalTestState& found, const std::string& label) {
    const auto& modal = *found.modal;
    const auto& frfs = found.hammer.frfs;
    const LineRange range = lines_between(frfs, modal.low_hz, modal.high_hz);
    if (range.last < range.first) return;
    std::optional<signal::FrfSet> rebuilt;
    if (found.has_modes()) {
      rebuilt = signal::synthesised(
          modal, frfs.frequency_hz.segment(range.first, range.last - range.first + 1), frfs.form);
    }
    for (auto& plot : frf_figures({test_.name, file_word(label), found.origin}, frfs, range, &modal,
                                  rebuilt ? &*rebuilt : nullptr)) {
      tabs_.back().plots.push_back(std::move(plot));
    }
  }

  void list_modes(const ident::ModalTestState& found, const std::string& label) {
    const auto& modal = *found.modal;
    const auto& frfs = found.hammer.frfs;
    if (modes_.columns.empty()) {
      modes_.columns = {{"state", {}, false},         {"frequency, Hz", found.origin},
                        {"damping, %", found.origin}, {"MPC", found.origin},
                        {"misfit, %", found.origin},  {"in the diagram, %", found.origin},
                        {"remarks", {}, false}};
    }
    add_answers(found, label);
    Json list = Json::array();
    bool first = true;
    for (const auto& mode : modal.model.modes) {
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
      list.push_back(mode_json(mode));
      ++modes_found_;
    }
    Json rejected = Json::array();
    for (const auto& column : modal.rejected) {
      rejected.push_back({{"frequency_hz", column.frequency_hz},
                          {"damping_ratio", column.damping_ratio},
                          {"presence", column.presence},
                          {"code", column.code},
                          {"reason", column.reason}});
    }
    Json state;
    state["tension_N"] = found.tension_N ? Json(*found.tension_N) : Json(nullptr);
    state["origin"] = word_of(found.origin);
    state["responses"] = found.channels;
    state["averages"] = frfs.averages;
    state["frf_form"] = name_of(frfs.form);
    state["units"] = frfs.unit;
    state["band_hz"] = {modal.low_hz, modal.high_hz};
    state["misfit_over_error_bars"] =
        modal.misfit_over_error_bars ? Json(*modal.misfit_over_error_bars) : Json(nullptr);
    state["force_window"] = force_window_json(found.hammer);
    state["struck"] = json_hits_[label];
    state["modes"] = std::move(list);
    state["rejected_columns"] = std::move(rejected);
    state["uff"] = {uff_path("modes", label)};
    if (frfs.averages > 0) state["uff"].insert(state["uff"].begin(), uff_path("frf", label));
    part_.json["states"].push_back(std::move(state));
  }

  /// Frequencies and damping; on the first page only where no model says more.
  void add_answers(const ident::ModalTestState& found, const std::string& label) {
    int number = 0;
    for (const auto& mode : found.modal->model.modes) {
      Answer answer;
      answer.key = fmt::format("{}/{}/frequency", test_.name, label);
      answer.quantity = fmt::format("{}, {}: natural frequency {}", test_.title, label, ++number);
      const auto hits = static_cast<std::size_t>(found.hammer.frfs.averages);
      answer.how = hits > 0 ? counted(hits, "hit") : "ambient motion";
      answer.unit = "Hz";
      answer.value = mode.frequency_hz.value;
      answer.std = mode.frequency_hz.std;
      answer.mode_hz = mode.frequency_hz.value;
      // A refused damping is a doubt about the damping only.
      if (mode.doubtful && !mode.damping_dominated_by_window) answer.verdict = "doubtful mode";
      answer.origin = found.origin;
      answer.anchor = part_.id;
      answer.rank = scene_ ? 2 : 0;
      part_.answers.push_back(answer);
      if (mode.damping_dominated_by_window) continue;
      answer.key = fmt::format("{}/{}/damping", test_.name, label);
      answer.quantity = fmt::format("{}, {}: damping ratio ζ {}", test_.title, label, number);
      answer.unit.clear();
      answer.percent = true;
      answer.value = mode.damping_ratio.value;
      answer.std = mode.damping_ratio.std;
      part_.answers.push_back(std::move(answer));
    }
  }

  [[nodiscard]] std::string uff_path(const char* what, const std::string& label) const {
    return "uff/" + figure_id(what, label) + ".uff";
  }

  void add_files(const ident::ModalTestState& found) {
    const std::string label = ident::state_label(found.tension_N);
    if (found.hammer.accepted_hits() > 0) {
      part_.files.push_back({uff_path("frf", label), frf_file(found.hammer.frfs)});
    }
    part_.files.push_back({uff_path("modes", label), mode_file(scene_, found.modal->model)});
  }

  void finish(std::size_t files) {
    if (!hits_.rows.empty()) {
      if (hits_.rows.size() > 12) {
        hits_.fold = fmt::format("All {} hits, {} rejected", all_hits_, rejected_);
      }
      part_.blocks.push_back(std::move(hits_));
    }
    // Hits alone: the first state's response stands in the short report.
    if (!scene_ && !tabs_.empty()) {
      auto& plots = tabs_.front().plots;
      const auto frf = std::find_if(plots.begin(), plots.end(), [](const Plot& plot) {
        return plot.title == "Frequency response, magnitude";
      });
      if (frf != plots.end()) {
        part_.brief = {frf->id};
        part_.blocks.push_back(std::move(*frf));
        plots.erase(frf);
      }
    }
    if (!tabs_.empty()) {
      part_.blocks.push_back(
          PlotGroup{test_.name + "-frfs", "Frequency responses and poles", std::move(tabs_)});
    }
    if (!scene_) part_.brief.push_back(modes_.id);
    if (!modes_.rows.empty()) part_.blocks.push_back(std::move(modes_));
    part_.json["hits"] = all_hits_;
    part_.json["hits_rejected"] = rejected_;
    part_.summary.push_back(
        {SummaryItem::Kind::recorded, test_.title,
         fmt::format("{} in {} from {}", counted(static_cast<std::size_t>(modes_found_), "mode"),
                     counted(states_, "state"), counted(files, "recording")) +
             (all_hits_ > 0 ? fmt::format("; {} of {} hits rejected", rejected_, all_hits_) : ""),
         origin_, part_.id});
  }

  const CampaignTest& test_;
  ReportPart& part_;
  const model::Scene* scene_ = nullptr;  ///< null: points keep their numbers
  std::size_t states_ = 0;               ///< that gave modes
  std::optional<Origin> origin_;         ///< origin of the first of them
  ReportTable hits_, modes_;
  std::vector<PlotTab> tabs_;
  std::map<std::string, Json> json_hits_;
  std::string last_label_;
  int rejected_ = 0, all_hits_ = 0, modes_found_ = 0;
};

/// Recordings of hits and their modes, then the model's modes against them: a part each.
class ModalTestPart : public TestPart {
 public:
  ModalTestPart(const Campaign& campaign, const CampaignTest& test)
      : campaign_(campaign), test_(test), inputs_(test.as<ModalTest>().inputs) {
    part_.id = test.name + "-recordings";
    part_.title = test.title + ": recordings";
    part_.test = test.name;
    part_.json_key = "recorded_modal";
    part_.json["test"] = test.name;
  }

  void read(const FileRead& file_read) override {
    if (test_.recordings.empty()) return;
    auto loaded = load_recordings(test_.recordings, file_read);
    for (const auto& entry : loaded) {
      part_.inputs.insert(part_.inputs.end(), entry.inputs.begin(), entry.inputs.end());
    }
    files_ = loaded.size();
    const double end_level = inputs_.options.hammer.impact.exponential_end_level;
    const bool ambient = inputs_.options.ambient;
    part_.blocks.push_back(Paragraph{
        ambient
            ? kAmbient
            : fmt::format(
                  "The rig is struck with a hammer that measures its force, and what the sensors "
                  "answer is "
                  "recorded. Each hit is judged; the accepted ones are averaged to frequency "
                  "response "
                  "functions, and from these come natural frequencies, damping and shapes.{}",
                  end_level > 0
                      ? fmt::format(
                            " An exponential window, down to {:g} % at the end, acts on force and "
                            "responses alike; its damping is taken out of every mode.",
                            100 * end_level)
                      : "")});
    add_recordings(part_, test_, loaded);
    for (auto& entry : loaded) {
      if (!entry.recording) continue;
      const auto& group = test_.recordings[entry.group];
      inputs_.recordings.push_back(
          {std::move(*entry.recording), group.tension_N, group.load, group.origin()});
    }
  }

  void add_to(ident::CampaignInputs& inputs) override {
    index_ = inputs.modal.size();
    inputs.modal.push_back(std::move(inputs_));
  }

  std::vector<ReportPart> show(ident::CampaignResult& campaign) override {
    auto& outcome = campaign.modal[index_];
    std::vector<ReportPart> parts;
    if (!test_.recordings.empty()) {
      HitsShown(campaign_, test_, part_).run(outcome.test, files_);
      parts.push_back(std::move(part_));
    }
    if (test_.scene) {
      parts.push_back(modal_part(campaign_, test_, campaign.known, outcome.model));
    }
    return parts;
  }

 private:
  const Campaign& campaign_;
  const CampaignTest& test_;
  ident::ModalInputs inputs_;
  std::size_t index_ = 0, files_ = 0;
  ReportPart part_;
};

}  // namespace

std::unique_ptr<TestPart> modal_test_part(const Campaign& campaign, const CampaignTest& test) {
  return std::make_unique<ModalTestPart>(campaign, test);
}

}  // namespace rigfit::apps
