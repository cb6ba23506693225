#include "apps/report/fit/fit_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/drawing/html_text.h"
#include "apps/report/figures/figures.h"
#include "apps/report/fit/fit_outcome.h"
#include "apps/report/modal/modal_part.h"
#include "apps/report/page/parameter_words.h"
#include "apps/results/modal_files.h"
#include "apps/results/update_result.h"
#include "ident/campaign/fit_campaign.h"

namespace rigfit::apps {
namespace {

/// FRFs, a tab a state; no tab when nothing was recorded.
PlotGroup fit_overlays(const FitOutcome& of) {
  PlotGroup group{of.fit.name + "-overlays", "Test and model, laid over each other", {}};
  for (std::size_t s = 0; s < of.states.size(); ++s) {
    const auto& modal = *of.states[s].modal;
    if (!modal.recorded || modal.rig.response.empty() || modal.rig.input.empty() ||
        !modal.recorded->hammer.amplitudes) {
      continue;
    }
    std::vector<ModelVersion> versions{{"before", of.updates[s].scene}};
    for (const auto& held : of.held) {
      if (held.state == static_cast<int>(s) && held.scene) {
        versions.push_back({"held out", *held.scene});
      }
    }
    versions.push_back({"fitted", of.result.scenes[s]});
    const std::string id = fmt::format("{}-{}", of.fit.name, file_word(of.updates[s].name));
    PlotTab tab{state_words(of.updates[s].name), {}};
    tab.plots.push_back(frf_overlay_plot(id + "-frf", *modal.recorded, modal.rig, versions));
    group.tabs.push_back(std::move(tab));
  }
  return group;
}

class Fit {
 public:
  explicit Fit(const FitOutcome& of) : of_(of) {
    part_.id = of.fit.name;
    part_.title = of.fit.title;
    part_.json_key = "fits";
    part_.brief = {of.fit.name + "-parameters", of.fit.name + "-errors",
                   of.fit.name + "-errors-by-mode"};
    part_.json["fit"] = of.fit.name;
    for (const auto& state : of.updates) measured_ += state.measured.size();
  }

  ReportPart run() {
    const std::string what = describe();
    part_.blocks.push_back(Paragraph{what});
    if (of_.states.empty()) {
      refuse(part_, "nothing_to_fit", "none of its tests gave a mode to fit to", of_.fit.name);
      return std::move(part_);
    }
    part_.costs.push_back({of_.fit.title + ": fit",
                           fmt::format("{} model evaluations, {} starts",
                                       of_.result.model_evaluations, of_.result.starts),
                           fmt::format("pairs settled after {} rounds", of_.result.pairings),
                           of_.answer.wall_s, std::numeric_limits<double>::quiet_NaN()});
    part_.json["status"] = ident::name_of(of_.result.status);
    if (of_.result.status != ident::UpdateStatus::converged) {
      refuse(part_, "not_converged",
             of_.result.message.empty() ? ident::name_of(of_.result.status) : of_.result.message,
             of_.fit.name);
      if (of_.result.scenes.empty() || of_.result.pairs.empty()) return std::move(part_);
    }
    part_.json.update(update_json(of_.result, of_.updates));
    part_.json["misfit"] = part_.json["fit"];  // "fit" is its name here
    part_.json["fit"] = of_.fit.name;
    if (!of_.held.empty()) part_.json["hold_out"] = held_out_json(of_.held, of_.updates);
    for (const auto& finding : of_.answer.outcome.findings) {
      part_.warnings.push_back(
          {finding.code, finding.message,
           finding.where.empty() ? of_.fit.name : parameter_words(finding.where), false});
    }
    add_parameters(part_, of_);
    held_rms_ = add_errors(part_, of_);
    add_figures();
    add_pairs(part_, of_);
    add_shapes(part_, of_);
    if (auto group = fit_overlays(of_); !group.tabs.empty()) {
      part_.blocks.push_back(std::move(group));
    }
    summary();
    return std::move(part_);
  }

 private:
  void add_figures() {
    const FitFigures fit{of_.updates, of_.result, of_.held};
    const std::string& name = of_.fit.name;
    if (auto plot = error_by_mode_plot(name + "-errors-by-mode", fit); !plot.series.empty()) {
      part_.blocks.push_back(std::move(plot));
    }
    if (auto budget = budget_table(name + "-budget", of_.result)) {
      part_.blocks.push_back(std::move(*budget));
    }
  }

  [[nodiscard]] std::string describe() const {
    std::string tests, parameters;
    for (const std::size_t test : of_.fit.tests) {
      tests += (tests.empty() ? "" : "; ") + of_.campaign.tests[test].title;
    }
    for (const auto& parameter : of_.fit.parameters) {
      parameters += (parameters.empty() ? "" : ", ") + parameter_words(parameter.free.name);
      if (parameter.free.per_state) parameters += " (at each state its own)";
    }
    return fmt::format(
        "Fitted: {}. To: {} in {} of: {}. Each measured mode is paired with one of the model, and "
        "the parameters minimise the differences over their uncertainties; {}. A state held out is "
        "predicted from the others.",
        parameters, counted(measured_, "mode"), counted(of_.states.size(), "state"), tests,
        of_.answer.task.options.model_relative_std < 1e-5
            ? std::string("the model's own error is less than 0.001 % of a frequency")
            : fmt::format("the model itself is allowed {} % in frequency",
                          shown(100 * of_.answer.task.options.model_relative_std, 2)));
  }

  void summary() {
    std::string text =
        fmt::format("{} before, {} fitted", percent_words(of_.result.rms_relative_error_before),
                    percent_words(of_.result.rms_relative_error));
    if (std::isfinite(held_rms_)) text += fmt::format(", {} held out", percent_words(held_rms_));
    part_.summary.push_back({SummaryItem::Kind::error, of_.fit.title + ", rms error", text,
                             Origin::modelled, part_.id});
    // An error held out that is much larger than the fitted one: too much freedom.
    if (std::isfinite(held_rms_) && held_rms_ > 3 * of_.result.rms_relative_error &&
        held_rms_ > 0.005) {
      part_.warnings.push_back(
          {"held_out_worse",
           fmt::format(
               "Free fewer parameters or measure more modes: states that it has not seen are "
               "predicted {:.1f} times worse than those it was fitted to",
               held_rms_ / of_.result.rms_relative_error),
           of_.fit.name, false});
    }
  }

  const FitOutcome& of_;
  ReportPart part_;
  std::size_t measured_ = 0;
  double held_rms_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace

ident::FitInputs fit_inputs(const CampaignFit& fit, const std::vector<std::size_t>& modal_tests,
                            std::uint64_t seed, int threads) {
  ident::FitInputs inputs;
  inputs.title = fit.title;
  for (const std::size_t test : fit.tests) {
    const auto at = std::find(modal_tests.begin(), modal_tests.end(), test);
    inputs.tests.push_back(static_cast<std::size_t>(at - modal_tests.begin()));
  }
  for (const auto& parameter : fit.parameters) inputs.free.push_back(parameter.free);
  inputs.options.starts = fit.starts;
  inputs.options.seed = seed;
  inputs.options.threads = threads;
  inputs.options.model_relative_std = fit.model_std;
  inputs.hold_out = fit.hold_out;
  return inputs;
}

ReportPart fit_part(const Campaign& campaign, const CampaignFit& fit,
                    const std::vector<std::size_t>& modal_tests,
                    const ident::CampaignFitOutcome& answer) {
  const FitOutcome of{campaign, fit, modal_tests, answer};
  return Fit(of).run();
}

}  // namespace rigfit::apps
