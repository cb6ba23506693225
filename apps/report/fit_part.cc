#include "apps/report/fit_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>

#include "apps/json_document.h"
#include "apps/report/html_text.h"
#include "apps/report/modal_files.h"
#include "apps/report/model_overlay.h"
#include "apps/report/recording_blocks.h"
#include "signal/mac.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;

struct FitState {
  std::size_t test = 0;
  ModalState modal;
  std::vector<std::size_t> row_of;  ///< by measured mode of the update
};

std::string percent(double ratio) {
  return std::isfinite(ratio) ? shown(100 * ratio, 3) + " %" : std::string("–");
}

class Fit {
 public:
  Fit(const Campaign& campaign, const CampaignFit& fit, const KnownValues& known,
      const std::vector<std::vector<RecordedModalState>>& recorded, int threads, std::uint64_t seed)
      : campaign_(campaign), fit_(fit) {
    part_.id = fit.name;
    part_.title = fit.title;
    part_.json_key = "fits";
    part_.json["fit"] = fit.name;
    options_.starts = fit.starts;
    options_.seed = seed;
    options_.threads = threads;
    for (const auto& parameter : fit.parameters) free_.push_back(parameter.free);
    for (const std::size_t test : fit.tests) {
      for (auto& modal : modal_states(campaign, campaign.tests[test], known, recorded[test])) {
        // What the number of segments costs, as the model itself estimates it, is part of what the
        // model cannot reach.
        segments_error_ = std::max(segments_error_, modal.segments_error);
        add_state(test, std::move(modal));
      }
    }
    options_.model_relative_std = std::hypot(fit.model_std, segments_error_);
  }

  ReportPart run() {
    const std::string what = describe();
    part_.blocks.push_back(Paragraph{what});
    if (states_.empty()) {
      refuse(part_, "nothing_to_fit", "none of its tests gave a mode to fit to", fit_.name);
      return std::move(part_);
    }
    const auto begin = std::chrono::steady_clock::now();
    result_ = ident::update_model(updates_, free_, options_);
    const double wall =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    part_.costs.push_back(
        {fit_.title + ": fit",
         fmt::format("{} model evaluations, {} starts", result_.model_evaluations, result_.starts),
         fmt::format("pairs settled after {} rounds", result_.pairings), wall,
         std::numeric_limits<double>::quiet_NaN()});
    part_.json["status"] = ident::name_of(result_.status);
    if (result_.status != ident::UpdateStatus::converged) {
      refuse(part_, "not_converged",
             result_.message.empty() ? ident::name_of(result_.status) : result_.message, fit_.name);
      if (result_.scenes.empty() || result_.pairs.empty()) return std::move(part_);
    } else if (!result_.message.empty()) {
      part_.warnings.push_back({"doubtful", result_.message, fit_.name, false});
    }
    for (const auto& open : result_.open) {
      part_.warnings.push_back({"not_identifiable", open, fit_.name, false});
      part_.summary.push_back({SummaryItem::Kind::distrust, fit_.title, open, {}, part_.id});
    }
    if (fit_.hold_out && states_.size() > 1) {
      auto options = options_;
      options.starts = 1;  // from the scene's own values: the fit above has looked around
      held_ = ident::hold_out_each(updates_, free_, options);
    }
    parameters();
    errors();
    error_plot();
    pairs();
    shapes();
    overlays();
    summary();
    return std::move(part_);
  }

 private:
  void add_state(std::size_t test, ModalState modal) {
    FitState state;
    state.test = test;
    ident::UpdateState update;
    update.name = campaign_.tests[test].name + ", " + state_label(modal.tension_N);
    update.scene = modal.rig.scene;
    const Origin origin = modal.recorded ? modal.recorded->origin : Origin::published;
    for (std::size_t i = 0; i < modal.rows.size(); ++i) {
      const auto& row = modal.rows[i];
      if (!std::isfinite(row.measured_hz) || row.origin != origin) continue;
      ident::MeasuredMode mode;
      mode.frequency_hz = {row.measured_hz, row.std_hz};
      mode.damping_ratio = {row.damping, row.damping_std};
      mode.plane = campaign_.tests[test].plane();
      mode.shape = row.shape;
      update.measured.push_back(std::move(mode));
      state.row_of.push_back(i);
    }
    if (update.measured.empty()) return;
    measured_ += update.measured.size();
    state.modal = std::move(modal);
    states_.push_back(std::move(state));
    updates_.push_back(std::move(update));
  }

  [[nodiscard]] const std::string& name_of_state(int state) const {
    return updates_[static_cast<std::size_t>(state)].name;
  }
  [[nodiscard]] Origin origin_of(std::size_t state) const {
    const auto* recorded = states_[state].modal.recorded;
    return recorded ? recorded->origin : Origin::published;
  }

  [[nodiscard]] std::string describe() const {
    std::string tests, parameters;
    for (const std::size_t test : fit_.tests) {
      tests += (tests.empty() ? "" : "; ") + campaign_.tests[test].title;
    }
    for (const auto& parameter : fit_.parameters) {
      parameters += (parameters.empty() ? "" : ", ") + parameter.free.name;
      if (parameter.free.per_state) parameters += " (at each state its own)";
    }
    return fmt::format(
        "Fitted: {}. To: {} modes in {} states of: {}. Each measured mode is paired with the one "
        "of the model that it is, and the parameters move until the differences, weighed by their "
        "uncertainties, are least; the model itself is allowed {} % in frequency. A model fitted "
        "to everything explains nothing: where states are "
        "held out, they are predicted from the others.",
        parameters, measured_, states_.size(), tests, shown(100 * options_.model_relative_std, 2));
  }

  void parameters() {
    ReportTable table;
    table.id = fit_.name + "-parameters";
    table.caption =
        "What was found, with 95 % intervals (SI units). Data alone: the standard uncertainty "
        "without what was known before.";
    table.columns = {{"parameter", {}, false},
                     {"state", {}, false},
                     {"start", Origin::modelled},
                     {"found", Origin::modelled},
                     {"95 % interval", Origin::modelled},
                     {"data alone ±", Origin::modelled},
                     {fit_.reference_name, {}, true},
                     {"remark", {}, false}};
    Json list = Json::array();
    for (const auto& parameter : result_.parameters) {
      const auto spec =
          std::find_if(fit_.parameters.begin(), fit_.parameters.end(), [&](const FitParameter& p) {
            return parameter.name == p.free.name || parameter.name.starts_with(p.free.name + " [");
          });
      const std::string name = spec == fit_.parameters.end() ? parameter.name : spec->free.name;
      const std::optional<double> reference =
          spec == fit_.parameters.end() ? std::nullopt : spec->reference;
      const bool known = parameter.identifiable && std::isfinite(parameter.std);
      const double half = result_.coverage_factor * parameter.std;
      std::string remark;
      if (!parameter.identifiable) {
        remark = "these data cannot tell it";
      } else if (!std::isfinite(parameter.std_from_data)) {
        remark = "known from before only, not from these data";
      }
      if (parameter.at_bound) remark += std::string(remark.empty() ? "" : "; ") + "at its bound";
      Cell remark_cell(remark);
      remark_cell.doubtful = !remark.empty();
      table.rows.push_back(
          {name, parameter.state < 0 ? "all" : name_of_state(parameter.state),
           shown(parameter.start, 4),
           Cell(known ? shown_estimate(parameter.value, parameter.std) : shown(parameter.value, 4),
                Origin::modelled),
           known ? shown(parameter.value - half, 4) + " to " + shown(parameter.value + half, 4)
                 : std::string("–"),
           std::isfinite(parameter.std_from_data) ? shown(parameter.std_from_data, 2) : "–",
           reference ? shown(*reference, 4) : std::string(), remark_cell});
      list.push_back({{"name", parameter.name},
                      {"start", parameter.start},
                      {"value", parameter.value},
                      {"std", json_number(parameter.std)},
                      {"identifiable", parameter.identifiable},
                      {"std_from_data", json_number(parameter.std_from_data)},
                      {"at_bound", parameter.at_bound},
                      {"reference", reference ? Json(*reference) : Json(nullptr)}});
      if (!known) continue;
      if (parameter.state >= 0) continue;
      part_.summary.push_back(
          {SummaryItem::Kind::result, fit_.title + ": " + name,
           shown_estimate(parameter.value, parameter.std) +
               fmt::format(" (95 %: {} to {})", shown(parameter.value - half, 4),
                           shown(parameter.value + half, 4)) +
               (reference ? fmt::format("; {} {}", fit_.reference_name, shown(*reference, 4)) : ""),
           Origin::modelled, part_.id});
    }
    part_.json["parameters"] = std::move(list);
    part_.blocks.push_back(std::move(table));
    if (result_.starts > 1) {
      part_.blocks.push_back(Paragraph{
          fmt::format(
              "{} of {} starts, spread widely about the first values, ended in this answer.",
              result_.starts_agreeing, result_.starts),
          result_.starts_agreeing == result_.starts ? Paragraph::Kind::plain
                                                    : Paragraph::Kind::note});
    }
  }

  [[nodiscard]] static double rms(const std::vector<ident::UpdatedPair>& pairs, int state) {
    double sum = 0;
    int n = 0;
    for (const auto& pair : pairs) {
      if (pair.state != state || pair.cross_plane) continue;
      sum += pair.relative_error * pair.relative_error;
      ++n;
    }
    return n > 0 ? std::sqrt(sum / n) : std::numeric_limits<double>::quiet_NaN();
  }

  void errors() {
    ReportTable table;
    table.id = fit_.name + "-errors";
    table.caption = "Root-mean-square relative error in frequency.";
    table.columns = {
        {"state", {}, false}, {"before", Origin::modelled}, {"fitted", Origin::modelled}};
    if (!held_.empty()) table.columns.push_back({"held out, predicted", Origin::modelled});
    Json list = Json::array();
    double held_sum = 0;
    int held_count = 0;
    for (std::size_t s = 0; s < states_.size(); ++s) {
      const int state = static_cast<int>(s);
      const double before = rms(result_.pairs_before, state), after = rms(result_.pairs, state);
      std::vector<Cell> cells{updates_[s].name, percent(before), percent(after)};
      Json json{{"state", updates_[s].name},
                {"rms_relative_error_before", json_number(before)},
                {"rms_relative_error", json_number(after)}};
      for (const auto& held : held_) {
        if (held.state != state) continue;
        cells.emplace_back(held.status == ident::UpdateStatus::converged
                               ? percent(held.rms_predicted)
                               : std::string(ident::name_of(held.status)));
        json["rms_relative_error_held_out"] = json_number(held.rms_predicted);
        for (const auto& pair : held.pairs) {
          if (pair.cross_plane) continue;
          held_sum += pair.relative_error * pair.relative_error;
          ++held_count;
        }
      }
      table.rows.push_back(std::move(cells));
      list.push_back(std::move(json));
    }
    held_rms_ = held_count > 0 ? std::sqrt(held_sum / held_count)
                               : std::numeric_limits<double>::quiet_NaN();
    std::vector<Cell> all{"all", percent(result_.rms_relative_error_before),
                          percent(result_.rms_relative_error)};
    if (!held_.empty()) all.emplace_back(percent(held_rms_));
    table.rows.push_back(std::move(all));
    part_.json["states"] = std::move(list);
    part_.json["rms_relative_error_before"] = json_number(result_.rms_relative_error_before);
    part_.json["rms_relative_error"] = json_number(result_.rms_relative_error);
    part_.json["rms_relative_error_held_out"] = json_number(held_rms_);
    part_.blocks.push_back(std::move(table));
  }

  void error_plot() {
    Plot plot;
    plot.id = fit_.name + "-errors-by-mode";
    plot.title = "Model against test, mode by mode";
    plot.caption =
        "How far the model's frequency lies above the test's. Bars: the test's own 95 % interval. "
        "Held out: predicted from the other states.";
    plot.x_label = "frequency of the test, Hz";
    plot.y_label = "model over test, %";
    const auto series_of = [&](const char* name, int variant) {
      PlotSeries series;
      series.name = name;
      series.origin = Origin::modelled;
      series.variant = variant;
      series.style = PlotSeries::Style::points;
      return series;
    };
    const auto add = [&](PlotSeries& series, const ident::UpdatedPair& pair) {
      if (pair.cross_plane) return;
      series.x.push_back(pair.measured_hz);
      series.y.push_back(100 * pair.relative_error);
    };
    PlotSeries before = series_of("before", 2), after = series_of("fitted", 0),
               held = series_of("held out", 1);
    for (const auto& pair : result_.pairs_before) add(before, pair);
    for (const auto& pair : result_.pairs) {
      if (pair.cross_plane) continue;
      add(after, pair);
      const auto& mode = updates_[static_cast<std::size_t>(pair.state)]
                             .measured[static_cast<std::size_t>(pair.measured)];
      const double half = std::isfinite(mode.frequency_hz.std)
                              ? 196 * mode.frequency_hz.std / mode.frequency_hz.value
                              : std::numeric_limits<double>::quiet_NaN();
      after.low.push_back(after.y.back() - half);
      after.high.push_back(after.y.back() + half);
    }
    for (const auto& one : held_) {
      for (const auto& pair : one.pairs) add(held, pair);
    }
    for (auto* series : {&before, &held, &after}) {
      if (!series->x.empty()) plot.series.push_back(std::move(*series));
    }
    if (!plot.series.empty()) part_.blocks.push_back(std::move(plot));
  }

  void pairs() {
    ReportTable table;
    table.id = fit_.name + "-pairs";
    table.caption = "Every measured mode and the model's, before and after.";
    table.columns = {{"state", {}, false},
                     {"test, Hz", {}, true},
                     {"mode", {}, false},
                     {"before", Origin::modelled},
                     {"fitted, Hz", Origin::modelled},
                     {"error", Origin::modelled},
                     {"MAC", Origin::modelled},
                     {"remark", {}, false}};
    Json list = Json::array();
    for (std::size_t s = 0; s < updates_.size(); ++s) {
      const int state = static_cast<int>(s);
      bool first = true;
      for (std::size_t m = 0; m < updates_[s].measured.size(); ++m) {
        const auto& mode = updates_[s].measured[m];
        const auto find = [&](const std::vector<ident::UpdatedPair>& pairs) {
          return std::find_if(pairs.begin(), pairs.end(), [&](const auto& pair) {
            return pair.state == state && pair.measured == static_cast<int>(m);
          });
        };
        const auto before = find(result_.pairs_before), after = find(result_.pairs);
        const bool was = before != result_.pairs_before.end(), is = after != result_.pairs.end();
        Json json{{"state", updates_[s].name},
                  {"measured_hz", mode.frequency_hz.value},
                  {"model_hz", is ? Json(after->model_hz) : Json(nullptr)},
                  {"relative_error", is ? Json(after->relative_error) : Json(nullptr)},
                  {"relative_error_before", was ? Json(before->relative_error) : Json(nullptr)},
                  {"mac", is ? json_number(after->mac) : Json(nullptr)},
                  {"leakage", is && after->cross_plane}};
        list.push_back(std::move(json));
        Cell remark(
            is ? (after->cross_plane ? "of the other plane: leaked into the test, not fitted" : "")
               : "no mode of the model is near");
        remark.doubtful = !remark.text.empty();
        table.rows.push_back(
            {first ? updates_[s].name : "",
             Cell(std::isfinite(mode.frequency_hz.std)
                      ? shown_estimate(mode.frequency_hz.value, mode.frequency_hz.std)
                      : shown(mode.frequency_hz.value, 4),
                  origin_of(s)),
             is ? fmt::format("{} {}", model::name_of(after->plane), after->order + 1) : "",
             was ? shown_percent(before->relative_error) : "–",
             is ? shown(after->model_hz, 5) : "–", is ? shown_percent(after->relative_error) : "–",
             is && std::isfinite(after->mac) ? shown(after->mac, 3) : "", remark});
        first = false;
      }
    }
    for (const auto& lone : result_.unpaired) {
      if (lone.measured) continue;
      list.push_back({{"state", name_of_state(lone.state)},
                      {"measured_hz", nullptr},
                      {"model_hz", lone.frequency_hz},
                      {"reason", lone.reason}});
    }
    if (table.rows.size() > 16) table.fold = fmt::format("All {} pairs", table.rows.size());
    part_.json["pairs"] = std::move(list);
    part_.blocks.push_back(std::move(table));
  }

  /// MAC of every measured mode with every modelled one, where two sensors or more make shapes.
  void shapes() {
    for (std::size_t s = 0; s < states_.size(); ++s) {
      if (states_[s].modal.rig.response.size() < 2) continue;
      double highest = 0;
      for (const auto& mode : updates_[s].measured) {
        highest = std::max(highest, mode.frequency_hz.value);
      }
      model::ModesOptions options;
      options.band_hz = {{0.0, 1.15 * highest}};
      options.error_estimate = false;
      const auto analysis = model::analyse_modes(result_.scenes[s], options);
      ReportTable table;
      table.id = fmt::format("{}-mac-{}", fit_.name, s + 1);
      table.caption = fmt::format(
          "{}: likeness of shapes (MAC, 1: the same) at the {} sensors, measured modes in rows, "
          "fitted model's in columns. Few sensors cannot tell every shape from every other.",
          updates_[s].name, states_[s].modal.rig.response.size());
      table.columns = {{"test \\ model, Hz", {}, false}};
      std::vector<const model::NaturalMode*> columns;
      const auto plane = campaign_.tests[states_[s].test].plane();
      for (const auto& mode : analysis.modes) {
        if (!(mode.frequency_hz > 0) || (plane && mode.plane != *plane)) continue;
        columns.push_back(&mode);
        table.columns.push_back({shown(mode.frequency_hz, 4), Origin::modelled});
      }
      Json matrix = Json::array();
      for (const auto& mode : updates_[s].measured) {
        if (mode.shape.size() == 0) continue;
        std::vector<Cell> row{Cell(shown(mode.frequency_hz.value, 4), origin_of(s))};
        Json json = Json::array();
        for (const auto* natural : columns) {
          const double value =
              signal::mac(mode.shape, natural->sensor_shape.cast<std::complex<double>>());
          Cell cell(fmt::format("{:.2f}", value));
          cell.shade = value;
          row.push_back(std::move(cell));
          json.push_back(value);
        }
        table.rows.push_back(std::move(row));
        matrix.push_back(std::move(json));
      }
      if (table.rows.empty() || columns.empty()) continue;
      part_.json["mac"].push_back({{"state", updates_[s].name}, {"matrix", std::move(matrix)}});
      part_.blocks.push_back(std::move(table));
      part_.files.push_back(
          {fmt::format("uff/{}-model-{}.uff", fit_.name, file_word(updates_[s].name)),
           model_mode_file(analysis)});
    }
  }

  void overlays() {
    PlotGroup group{fit_.name + "-overlays", "Test and model, laid over each other", {}};
    for (std::size_t s = 0; s < states_.size(); ++s) {
      const auto& modal = states_[s].modal;
      if (!modal.recorded || modal.rig.response.empty() || modal.rig.input.empty() ||
          !modal.recorded->amplitudes) {
        continue;
      }
      const std::vector<ModelVersion> versions{{"before", updates_[s].scene},
                                               {"fitted", result_.scenes[s]}};
      const std::string id = fmt::format("{}-{}", fit_.name, file_word(updates_[s].name));
      PlotTab tab{updates_[s].name, {}};
      tab.plots.push_back(frf_overlay_plot(id + "-frf", *modal.recorded, modal.rig, versions));
      for (auto& plot :
           hit_overlay_plots(id + "-hit", *modal.recorded, modal.rig, versions, part_.costs)) {
        tab.plots.push_back(std::move(plot));
      }
      group.tabs.push_back(std::move(tab));
    }
    if (!group.tabs.empty()) part_.blocks.push_back(std::move(group));
  }

  void summary() {
    std::string text =
        fmt::format("{} before, {} fitted", percent(result_.rms_relative_error_before),
                    percent(result_.rms_relative_error));
    if (std::isfinite(held_rms_)) text += fmt::format(", {} held out", percent(held_rms_));
    part_.summary.push_back(
        {SummaryItem::Kind::result, fit_.title + ", rms error", text, Origin::modelled, part_.id});
    // An error held out that is much larger than the fitted one: too much freedom.
    if (std::isfinite(held_rms_) && held_rms_ > 3 * result_.rms_relative_error &&
        held_rms_ > 0.005) {
      part_.summary.push_back(
          {SummaryItem::Kind::distrust, fit_.title,
           fmt::format("predicts states that it has not seen {:.1f} times worse than those it was "
                       "fitted to",
                       held_rms_ / result_.rms_relative_error),
           Origin::modelled, part_.id});
    }
  }

  const Campaign& campaign_;
  const CampaignFit& fit_;
  ReportPart part_;
  ident::UpdateOptions options_;
  std::vector<ident::FreeParameter> free_;
  std::vector<FitState> states_;
  std::vector<ident::UpdateState> updates_;
  std::size_t measured_ = 0;
  double segments_error_ = 0;
  ident::UpdateResult result_;
  std::vector<ident::HeldOut> held_;
  double held_rms_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace

ReportPart fit_part(const Campaign& campaign, const CampaignFit& fit, const KnownValues& known,
                    const std::vector<std::vector<RecordedModalState>>& recorded, int threads,
                    std::uint64_t seed) {
  return Fit(campaign, fit, known, recorded, threads, seed).run();
}

}  // namespace rigfit::apps
