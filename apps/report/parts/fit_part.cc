#include "apps/report/parts/parts.h"
#include "ident/update/model_update.h"
#include "model/scene/parameters.h"

namespace rigfit::apps {
namespace {

class Fit {
 public:
  Fit(const Campaign& campaign, const CampaignFit& fit, const ident::CampaignFitOutcome& answer)
      : campaign_(campaign), fit_(fit), answer_(answer) {
    part_.id = fit.name;
    part_.title = fit.title;
    part_.json_key = "fits";
    part_.brief = {fit.name + "-parameters", fit.name + "-errors", fit.name + "-errors-by-mode"};
    part_.json["name"] = fit.name;
    for (const auto& state : updates_) measured_ += state.measured.size();
  }

  ReportPart run() {
    part_.blocks.push_back(Paragraph{intro()});
    if (answer_.states.empty()) {
      refuse(part_, "nothing_to_fit", "none of its tests gave a mode to fit to", fit_.name);
      return std::move(part_);
    }
    part_.json["status"] = ident::name_of(result_.status);
    if (result_.status != ident::UpdateStatus::converged) {
      refuse(part_, "not_converged",
             result_.message.empty() ? ident::name_of(result_.status) : result_.message, fit_.name);
      if (result_.scenes.empty() || result_.pairs.empty()) return std::move(part_);
    }
    part_.json.update(describe::json_of(result_));
    for (const auto& finding : ident::fit_findings(result_)) {
      part_.warnings.push_back(
          {finding.code, finding.message,
           finding.where.empty() ? fit_.name : parameter_words(finding.where)});
    }
    add_parameters();
    add_errors();
    add(part_.blocks, fit_blocks(fit_.name, updates_, result_));
    add_pairs();
    add_overlays();
    return std::move(part_);
  }

 private:
  [[nodiscard]] const std::string& state_of(int state) const {
    return updates_[static_cast<std::size_t>(state)].name;
  }

  [[nodiscard]] std::string intro() const {
    std::string tests;
    for (const std::size_t test : fit_.tests) {
      tests += (tests.empty() ? "" : "; ") + campaign_.tests[test].title;
    }
    const double allowed = fit_.options.model_relative_std;
    return fmt::format("Fitted to {} in {} of: {}{}.", counted(measured_, "mode"),
                       counted(answer_.states.size(), "state"), tests,
                       allowed < 1e-5 ? std::string()
                                      : fmt::format("; the model itself is allowed {} in frequency",
                                                    percent_words(allowed)));
  }

  /// Unit of a free parameter, by the first scene that has it.
  [[nodiscard]] std::string unit_of(const std::string& target) const {
    for (const auto& update : updates_) {
      const auto names = model::parameter_names(update.scene);
      if (std::ranges::find(names, target) == names.end()) continue;
      const auto unit = model::parameters_named(update.scene, {target}).front().unit;
      return unit == "1" ? "" : with_signs(unit);
    }
    return {};
  }

  [[nodiscard]] Answer answer_of(const ident::UpdatedParameter& parameter) const {
    const auto spec = std::ranges::find_if(fit_.parameters, [&](const FitParameter& p) {
      return parameter.name == p.name || parameter.name.starts_with(p.name + " [");
    });
    const bool named = spec != fit_.parameters.end();
    const std::string name = named ? spec->name : parameter.name;
    const std::string target = named && !spec->targets.empty() ? spec->targets.front() : name;
    Answer answer;
    answer.key = fit_.name + "/" + parameter.name;
    answer.quantity = parameter_words(name);
    if (parameter.state >= 0) answer.quantity += ", " + state_of(parameter.state);
    answer.how = "fitted to " + counted(measured_, "mode");
    answer.unit = named ? unit_of(target) : "";
    if (answer.unit.empty() && target.ends_with("damping_ratio")) answer.unit = "%";
    answer.value = parameter.value;
    answer.std = parameter.std;
    answer.low = parameter.low;
    answer.high = parameter.high;
    answer.determined = parameter.identifiable && std::isfinite(parameter.std);
    if (named) answer.reference = spec->reference;
    answer.reference_name = fit_.reference_name;
    answer.anchor = part_.id;
    answer.rank = parameter.state < 0 ? 0 : 1;
    // A mass at a node is of the structure that was tested, a stiffness of a member that may stand
    // in several.
    for (const char* end : {".mass", ".x", ".y", ".z"}) {
      answer.of_structure = answer.of_structure || target.ends_with(end);
    }
    for (const std::size_t test : fit_.tests) {
      if (const auto scene = campaign_.tests[test].scene) {
        answer.structure = campaign_.scenes[*scene].name;
      }
    }
    if (!answer.structure.empty()) answer.how += " of the " + answer.structure;
    return answer;
  }

  void add_parameters() {
    ReportTable table =
        described_table(fit_.name + "-parameters", "What was found, ± its standard uncertainty.",
                        describe::table_of(result_.parameters), Origin::modelled);
    table.columns.push_back({fit_.reference_name});
    for (std::size_t i = 0; i < result_.parameters.size(); ++i) {
      Answer answer = answer_of(result_.parameters[i]);
      const std::string unit = answer.unit == "%" ? "" : answer.unit;
      table.rows[i].front() = answer.quantity + (unit.empty() ? "" : ", " + unit);
      table.rows[i].emplace_back(answer.reference ? shown(*answer.reference, 4) : "");
      part_.json["parameters"][i]["reference"] = describe::json_of(answer.reference);
      const bool told = answer.determined && result_.parameters[i].state < 0;
      add_answer(part_, std::move(answer), told);
    }
    part_.blocks.push_back(std::move(table));
    part_.blocks.push_back(
        Paragraph{"Fit: " + result_.fit.text() + ".",
                  result_.fit.ruled_out() ? Paragraph::Kind::note : Paragraph::Kind::plain});
    if (result_.alternatives.size() < 2) return;
    std::string others = fmt::format("This answer has a weight of {:.3f}; the data also support:",
                                     result_.alternatives.front().weight);
    for (const auto& text : ident::alternative_texts(result_)) {
      others += " " + with_parameter_words(text) + ".";
    }
    part_.blocks.push_back(Paragraph{others, Paragraph::Kind::note});
  }

  /// Errors before, fitted and held out.
  void add_errors() {
    const double held_rms = result_.rms_held_out;
    const bool held = std::isfinite(held_rms);
    const std::string before = percent_words(result_.rms_relative_error_before),
                      fitted = percent_words(result_.rms_relative_error);
    part_.summary.push_back(
        {SummaryItem::Kind::error, fit_.title + ", rms error",
         fmt::format("{} before, {} fitted", before, fitted) +
             (held ? fmt::format(", {} held out", percent_words(held_rms)) : ""),
         Origin::modelled});
    if (held_.empty()) return;
    ReportTable table = described_table(
        fit_.name + "-errors",
        "Root-mean-square relative error in frequency: before, of the states fitted, of the state "
        "held out.",
        describe::table_of(held_), Origin::modelled);
    for (auto& row : table.rows) row.front() = state_words(row.front().text);
    table.rows.push_back({"all", before, fitted, percent_words(held_rms)});
    part_.blocks.push_back(std::move(table));
    // An error held out that is much larger than the fitted one: too much freedom.
    if (held && held_rms > 3 * result_.rms_relative_error && held_rms > 0.005) {
      part_.warnings.push_back(
          {"held_out_worse",
           fmt::format("Free fewer parameters or measure more modes: the errors of states that are "
                       "predicted are {:.1f} times those of fitted ones",
                       held_rms / result_.rms_relative_error),
           fit_.name});
    }
  }

  /// Every measured mode and the model's; one without a partner is always a warning.
  void add_pairs() {
    std::vector<ident::UpdatedPair> alone;
    std::string lonely;
    for (const auto& one : result_.unpaired) {
      if (one.missing()) continue;
      alone.push_back(one);
      lonely += fmt::format("{}{} Hz ({})", lonely.empty() ? "" : ", ", shown(one.measured_hz, 5),
                            state_words(state_of(one.state)));
    }
    for (const auto& pair : result_.pairs) {
      if (pair.cross_plane) continue;
      part_.modes.push_back({"model fitted", Origin::modelled, pair.measured_hz, pair.model_hz});
    }
    auto rows = result_.pairs;
    rows.insert(rows.end(), alone.begin(), alone.end());
    ReportTable table =
        described_table(fit_.name + "-pairs", "Every measured mode and the model's.",
                        describe::table_of(rows), Origin::modelled);
    if (table.rows.size() > 16) table.fold = fmt::format("All {} pairs", table.rows.size());
    part_.blocks.push_back(std::move(table));
    if (lonely.empty()) return;
    part_.warnings.push_back(
        {"unpaired",
         "Check these measured modes: the fitted model has no partner for them and they do not "
         "enter the fit: " +
             lonely,
         fit_.name});
  }

  /// FRFs, a tab a state; none where nothing was recorded.
  void add_overlays() {
    PlotGroup group{fit_.name + "-overlays", "Test and model, overlaid", {}};
    for (std::size_t s = 0; s < answer_.states.size(); ++s) {
      const auto& modal = *answer_.states[s];
      if (!modal.recorded || modal.rig.response.empty() || modal.rig.input.empty() ||
          !modal.recorded->hammer.amplitudes) {
        continue;
      }
      std::vector<ident::ModelVersion> versions{{"before", updates_[s].scene}};
      for (const auto& held : held_) {
        if (held.state == static_cast<int>(s) && held.scene) {
          versions.push_back({"held out", *held.scene});
        }
      }
      versions.push_back({"fitted", result_.scenes[s]});
      group.tabs.push_back(
          {state_words(updates_[s].name),
           {frf_overlay_plot(fmt::format("{}-{}-frf", fit_.name, file_word(updates_[s].name)),
                             *modal.recorded, modal.rig, versions)}});
    }
    add(part_.blocks, std::move(group));
  }

  const Campaign& campaign_;
  const CampaignFit& fit_;
  const ident::CampaignFitOutcome& answer_;
  const std::vector<ident::UpdateState>& updates_ = answer_.given;
  const ident::UpdateResult& result_ = answer_.result;
  const std::vector<ident::HeldOut>& held_ = answer_.result.held;  ///< may be empty
  ReportPart part_;
  std::size_t measured_ = 0;
};

}  // namespace

ReportPart fit_part(const Campaign& campaign, const CampaignFit& fit,
                    const ident::CampaignFitOutcome& answer) {
  return Fit(campaign, fit, answer).run();
}

}  // namespace rigfit::apps
