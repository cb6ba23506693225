#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/cli/json_document.h"
#include "apps/report/drawing/html_text.h"
#include "apps/report/figures/figures.h"
#include "apps/report/page/parameter_words.h"
#include "apps/report/parts/parts.h"
#include "apps/results/modal_files.h"
#include "apps/results/update_result.h"
#include "ident/campaign/fit_campaign.h"
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
    part_.json["fit"] = fit.name;
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
    part_.json.update(update_json(result_, updates_));
    part_.json["misfit"] = part_.json["fit"];  // "fit" is its name here
    part_.json["fit"] = fit_.name;
    if (!held_.empty()) part_.json["hold_out"] = held_out_json(held_, updates_);
    for (const auto& finding : answer_.outcome.findings) {
      part_.warnings.push_back(
          {finding.code, finding.message,
           finding.where.empty() ? fit_.name : parameter_words(finding.where)});
    }
    add_parameters();
    add_errors();
    for (auto& block : fit_blocks(fit_.name, updates_, result_, held_)) {
      part_.blocks.push_back(std::move(block));
    }
    add_pairs();
    add_overlays();
    return std::move(part_);
  }

 private:
  [[nodiscard]] const std::string& state_of(int state) const {
    return updates_[static_cast<std::size_t>(state)].name;
  }

  [[nodiscard]] std::string intro() const {
    std::string tests, parameters;
    for (const std::size_t test : fit_.tests) {
      tests += (tests.empty() ? "" : "; ") + campaign_.tests[test].title;
    }
    for (const auto& parameter : fit_.parameters) {
      parameters += (parameters.empty() ? "" : ", ") + parameter_words(parameter.free.name);
      if (parameter.free.per_state) parameters += " (one value for each state)";
    }
    const double allowed = answer_.task.options.model_relative_std;
    return fmt::format(
        "Fitted: {}, to {} in {} of: {}. Each measured mode is paired with one of the model, and "
        "the parameters minimise the differences over their uncertainties{}.{}",
        parameters, counted(measured_, "mode"), counted(answer_.states.size(), "state"), tests,
        allowed < 1e-5
            ? std::string()
            : fmt::format("; the model itself is allowed {} in frequency", percent_words(allowed)),
        held_.empty() ? "" : " Each state held out is predicted from the others.");
  }

  /// Unit of a free parameter, by the first scene that has it.
  [[nodiscard]] std::string unit_of(const std::string& target) const {
    for (const auto& update : updates_) {
      const auto names = model::parameter_names(update.scene);
      if (std::find(names.begin(), names.end(), target) != names.end()) {
        return parameter_unit(update.scene, target);
      }
    }
    return {};
  }

  [[nodiscard]] Answer answer_of(const ident::UpdatedParameter& parameter) const {
    const auto spec =
        std::find_if(fit_.parameters.begin(), fit_.parameters.end(), [&](const FitParameter& p) {
          return parameter.name == p.free.name || parameter.name.starts_with(p.free.name + " [");
        });
    const bool named = spec != fit_.parameters.end();
    const std::string name = named ? spec->free.name : parameter.name;
    const std::string target =
        named && !spec->free.targets.empty() ? spec->free.targets.front() : name;
    Answer answer;
    answer.key = fit_.name + "/" + parameter.name;
    answer.quantity = parameter_words(name);
    if (parameter.state >= 0) answer.quantity += ", " + state_of(parameter.state);
    answer.how = "fitted to " + counted(measured_, "mode");
    answer.unit = named ? unit_of(target) : "";
    answer.percent = answer.unit.empty() && shown_in_percent(target);
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
    const bool priors =
        std::any_of(fit_.parameters.begin(), fit_.parameters.end(), [](const FitParameter& one) {
          return one.free.prior.has_value() || one.free.prior_relative_std > 0;
        });
    ReportTable table{fit_.name + "-parameters",
                      std::string("What was found, ± its standard uncertainty, with 95 % "
                                  "intervals.") +
                          (priors ? " Data alone: the standard uncertainty without what was known "
                                    "before."
                                  : ""),
                      {{"parameter", {}, false},
                       {"state", {}, false},
                       {"start", Origin::modelled},
                       {"found", Origin::modelled},
                       {"95 % interval", Origin::modelled},
                       {"data alone ±", Origin::modelled},
                       {fit_.reference_name},
                       {"remark", {}, false}}};
    for (std::size_t i = 0; i < result_.parameters.size(); ++i) {
      const auto& parameter = result_.parameters[i];
      Answer answer = answer_of(parameter);
      const double scale = answer.percent ? 100 : 1;
      const std::string unit = shown_unit(answer),
                        words = answer.quantity.substr(0, answer.quantity.find(", "));
      std::string remark;
      if (!parameter.identifiable) {
        remark = "not identifiable from these data";
      } else if (!std::isfinite(parameter.std_from_data)) {
        remark = "the data add nothing to what was known before";
      }
      if (parameter.at_bound) remark += std::string(remark.empty() ? "" : "; ") + "at its bound";
      Cell remark_cell(remark);
      remark_cell.doubtful = !remark.empty();
      table.rows.push_back(
          {unit.empty() ? words : words + ", " + unit,
           parameter.state < 0 ? "all" : state_words(state_of(parameter.state)),
           shown(scale * parameter.start, 4),
           answer.determined ? value_words(answer) : shown(scale * parameter.value, 4),
           answer.determined ? interval_words(answer) : std::string("–"),
           priors && std::isfinite(parameter.std_from_data)
               ? shown(scale * parameter.std_from_data, 2)
               : "",
           answer.reference ? shown(scale * *answer.reference, 4) : std::string(), remark_cell});
      part_.json["parameters"][i]["reference"] =
          answer.reference ? Json(*answer.reference) : Json(nullptr);
      if (answer.determined && parameter.state < 0) part_.summary.push_back(summary_of(answer));
      part_.answers.push_back(std::move(answer));
    }
    part_.blocks.push_back(std::move(table));
    part_.blocks.push_back(
        Paragraph{"Fit: " + ident::fit_text(result_.fit) + ".",
                  result_.fit.ruled_out() ? Paragraph::Kind::note : Paragraph::Kind::plain});
    add_exact();
    if (result_.alternatives.size() > 1) add_alternatives();
  }

  /// What is taken as exact and moves a parameter by more than a tenth of its standard uncertainty.
  void add_exact() {
    constexpr double kMatters = 0.1;
    const auto& parameters = result_.parameters;
    ReportTable table{fit_.name + "-exact",
                      "Taken as exact: neither fitted nor given an uncertainty. Change of each "
                      "parameter when the input changes, in its standard uncertainties.",
                      {{"input", {}, false}, {"changed by"}}};
    for (const auto& one : parameters) table.columns.push_back({parameter_words(one.name)});
    for (const auto& input : result_.exact_inputs) {
      std::vector<Cell> cells{parameter_words(input.name), shown_percent(input.relative_change)};
      bool matters = false;
      for (std::size_t p = 0; p < parameters.size(); ++p) {
        const double stds = input.shift[static_cast<Eigen::Index>(p)] / parameters[p].std;
        matters = matters || std::abs(stds) > kMatters;
        cells.emplace_back(std::isfinite(stds) ? fmt::format("{:+.1f}", stds) : "–");
        cells.back().doubtful = std::abs(stds) > 1;
      }
      if (matters) table.rows.push_back(std::move(cells));
    }
    if (!table.rows.empty()) part_.blocks.push_back(std::move(table));
  }

  /// The answers that the data support, each with its weight and what decides.
  void add_alternatives() {
    ReportTable table{fit_.name + "-alternatives",
                      "All answers that the data support, by which measured mode is which of the "
                      "model's.",
                      {{"weight", Origin::modelled},
                       {"parameters", Origin::modelled, false},
                       {"rms error", Origin::modelled},
                       {"why", {}, false}}};
    const auto texts = ident::alternative_texts(result_);
    for (std::size_t k = 0; k < result_.alternatives.size(); ++k) {
      const auto& one = result_.alternatives[k];
      std::string values;
      for (const auto& parameter : one.parameters) {
        values += (values.empty() ? "" : ", ") + parameter_words(parameter.name) + " " +
                  shown(parameter.value, 4);
      }
      table.rows.push_back({fmt::format("{:.3f}", one.weight), values,
                            percent_words(one.rms_relative_error),
                            k == 0 ? "" : with_parameter_words(texts[k - 1])});
    }
    part_.blocks.push_back(std::move(table));
  }

  /// Errors before, fitted and held out, by state.
  void add_errors() {
    const double held_rms = answer_.outcome.rms_held_out;
    const auto rms = [](const std::vector<ident::UpdatedPair>& pairs, int state) {
      double sum = 0;
      int n = 0;
      for (const auto& pair : pairs) {
        if (pair.state != state || pair.cross_plane) continue;
        sum += pair.relative_error * pair.relative_error;
        ++n;
      }
      return n > 0 ? std::sqrt(sum / n) : Answer::kNone;
    };
    ReportTable table{fit_.name + "-errors",
                      "Root-mean-square relative error in frequency.",
                      {{"state", {}, false},
                       {"before", Origin::modelled},
                       {"fitted", Origin::modelled},
                       {"held out, predicted", Origin::modelled}}};
    for (std::size_t s = 0; s < updates_.size(); ++s) {
      const int state = static_cast<int>(s);
      std::string predicted;
      for (const auto& held : held_) {
        if (held.state != state) continue;
        predicted = held.status == ident::UpdateStatus::converged
                        ? percent_words(held.rms_predicted)
                        : ident::name_of(held.status);
      }
      table.rows.push_back({state_words(updates_[s].name),
                            percent_words(rms(result_.pairs_before, state)),
                            percent_words(rms(result_.pairs, state)), predicted});
    }
    const bool held = std::isfinite(held_rms);
    const std::string before = percent_words(result_.rms_relative_error_before),
                      fitted = percent_words(result_.rms_relative_error);
    table.rows.push_back({"all", before, fitted, held ? percent_words(held_rms) : ""});
    part_.json["rms_relative_error_held_out"] = json_number(held_rms);
    part_.blocks.push_back(std::move(table));
    part_.summary.push_back(
        {SummaryItem::Kind::error, fit_.title + ", rms error",
         fmt::format("{} before, {} fitted", before, fitted) +
             (held ? fmt::format(", {} held out", percent_words(held_rms)) : ""),
         Origin::modelled, part_.id});
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
    std::vector<PairRow> rows;
    std::string lonely;
    for (std::size_t s = 0; s < updates_.size(); ++s) {
      const auto* recorded = answer_.states[s].modal->recorded;
      for (std::size_t m = 0; m < updates_[s].measured.size(); ++m) {
        const auto& f = updates_[s].measured[m].frequency_hz;
        const auto find = [&](const std::vector<ident::UpdatedPair>& pairs) {
          const auto at = std::find_if(pairs.begin(), pairs.end(), [&](const auto& pair) {
            return pair.state == static_cast<int>(s) && pair.measured == static_cast<int>(m);
          });
          return at == pairs.end() ? nullptr : &*at;
        };
        PairRow row{state_words(updates_[s].name), f.value, f.std,
                    recorded ? recorded->origin : Origin::published};
        if (const auto* before = find(result_.pairs_before)) row.before_hz = before->model_hz;
        if (const auto* pair = find(result_.pairs)) {
          row.model_hz = pair->model_hz;
          row.mac = pair->mac;
          row.mode = fmt::format("{} {}", model::name_of(pair->plane), pair->order + 1);
          if (pair->cross_plane) {
            row.remark = "a mode of the other plane: leaked into the test, not fitted";
          } else {
            part_.modes.push_back({"model fitted", Origin::modelled, f.value, pair->model_hz});
          }
        } else {
          row.remark = "no mode of the model is near";
          lonely +=
              fmt::format("{}{} Hz ({})", lonely.empty() ? "" : ", ", shown(f.value, 5), row.state);
        }
        rows.push_back(std::move(row));
      }
    }
    ReportTable table = pairs_table(fit_.name + "-pairs",
                                    "Every measured mode and the model's, before and after.", rows);
    if (rows.size() > 16) table.fold = fmt::format("All {} pairs", rows.size());
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
      const auto& modal = *answer_.states[s].modal;
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
    if (!group.tabs.empty()) part_.blocks.push_back(std::move(group));
  }

  const Campaign& campaign_;
  const CampaignFit& fit_;
  const ident::CampaignFitOutcome& answer_;
  const std::vector<ident::UpdateState>& updates_ = answer_.task.states;
  const ident::UpdateResult& result_ = answer_.outcome.result;
  const std::vector<ident::HeldOut>& held_ = answer_.outcome.held;  ///< may be empty
  ReportPart part_;
  std::size_t measured_ = 0;
};

}  // namespace

ident::FitInputs fit_inputs(const CampaignFit& fit, const std::vector<std::size_t>& modal_tests,
                            int threads) {
  ident::FitInputs inputs;
  inputs.title = fit.title;
  for (const std::size_t test : fit.tests) {
    const auto at = std::find(modal_tests.begin(), modal_tests.end(), test);
    inputs.tests.push_back(static_cast<std::size_t>(at - modal_tests.begin()));
  }
  for (const auto& parameter : fit.parameters) inputs.free.push_back(parameter.free);
  inputs.options.starts = fit.starts;
  inputs.options.threads = threads;
  inputs.options.model_relative_std = fit.model_std;
  inputs.hold_out = fit.hold_out;
  return inputs;
}

ReportPart fit_part(const Campaign& campaign, const CampaignFit& fit,
                    const ident::CampaignFitOutcome& answer) {
  return Fit(campaign, fit, answer).run();
}

}  // namespace rigfit::apps
