#include "apps/report/modal/modal_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/report/drawing/html_text.h"
#include "apps/report/page/parameter_words.h"
#include "signal/numerics/numbers.h"

namespace rigfit::apps {
namespace {

using signal::kNaN;

bool any_recorded(const std::vector<ModalState>& states) {
  return std::any_of(states.begin(), states.end(),
                     [](const ModalState& state) { return state.recorded != nullptr; });
}

std::string plane_words(model::ModePlane plane) {
  switch (plane) {
    case model::ModePlane::in:
      return "in plane";
    case model::ModePlane::out:
      return "out of plane";
    default:
      return name_of(plane);
  }
}

}  // namespace

std::string label_of(const ModalState& state) {
  return state_words(ident::state_label(state.tension_N));
}

const PublishedModels& published_models(const CampaignTest& test) {
  return test.as<ModalTest>().models;
}

std::string mode_name(const model::ModalAnalysis& analysis, std::size_t index) {
  int number = 0;
  for (std::size_t i = 0; i <= index; ++i) {
    if (analysis.modes[i].plane == analysis.modes[index].plane) ++number;
  }
  return fmt::format("{} {}", name_of(analysis.modes[index].plane), number);
}

ReportTable equilibrium_table(const CampaignTest& test, const std::vector<ModalState>& states) {
  ReportTable table;
  table.id = test.name + "-equilibrium";
  table.caption =
      "Static equilibrium under gravity, found first: the modes are those about this shape.";
  table.columns = {{"state", {}, false},
                   {"EI, N m²", Origin::modelled},
                   {"member", {}, false},
                   {"sag, mm", Origin::modelled},
                   {"tension, N", Origin::modelled},
                   {"segments", Origin::modelled},
                   {"unbalanced force", Origin::modelled},
                   {"frequency error", Origin::modelled}};
  for (const auto& state : states) {
    const auto& equilibrium = state.analysis.equilibrium;
    if (equilibrium.status != model::EquilibriumStatus::converged) {
      table.rows.push_back({label_of(state), "", "", "", "", "", "",
                            std::string(name_of(equilibrium.status)) + ": " + equilibrium.reason});
      continue;
    }
    bool first = true;
    for (const auto& member : equilibrium.members) {
      table.rows.push_back({first ? label_of(state) : "",
                            first && state.EI_Nm2 ? shown(*state.EI_Nm2, 4) : "", member.member,
                            member.sag_m < 1e-9 ? std::string("0") : shown(1e3 * member.sag_m, 3),
                            shown(member.tension_N, 4), fmt::format("{}", member.segments),
                            first ? fmt::format("{:.0e}", equilibrium.residual) : "",
                            first ? fmt::format("{:.0e}", state.segments_error) : ""});
      first = false;
    }
  }
  return table;
}

ReportTable pairs_table(const CampaignTest& test, const std::vector<ModalState>& states) {
  ReportTable table;
  table.id = test.name + "-pairs";
  table.caption =
      "Each measured frequency beside the mode of the model that stands for it, found by pairing "
      "(not "
      "by row number), and beside the published models' values of that row.";
  table.columns = {
      {"state", {}, false},
      {"test, Hz", any_recorded(states) ? std::nullopt : std::optional(Origin::published)},
      {"rigfit, Hz", Origin::modelled},
      {"error", Origin::modelled},
      {"mode", {}, false}};
  for (const auto& [label, column] : published_models(test)) {
    table.columns.push_back({label + ", Hz", Origin::published_model});
    table.columns.push_back({"error", Origin::published_model});
  }
  table.columns.push_back({"remark", {}, false});
  for (const auto& state : states) {
    bool first = true;
    for (const auto& row : state.rows) {
      if (row.origin == Origin::published && state.recorded && !std::isfinite(row.measured_hz) &&
          row.models_hz.empty()) {
        continue;
      }
      std::vector<Cell> cells{
          first ? label_of(state) : "",
          Cell(std::isfinite(row.std_hz) ? shown_estimate(row.measured_hz, row.std_hz)
                                         : shown(row.measured_hz, 4),
               row.origin)};
      first = false;
      std::string remark;
      if (row.mode) {
        const auto& mode = state.analysis.modes[*row.mode];
        cells.emplace_back(shown(mode.frequency_hz, 4), Origin::modelled);
        cells.emplace_back(shown_percent(mode.frequency_hz / row.measured_hz - 1));
        cells.emplace_back(
            fmt::format("{} ({})", mode_name(state.analysis, *row.mode), name_of(mode.family)));
        if (row.other_plane) {
          remark = fmt::format("an {} mode: leaked into this test", plane_words(mode.plane));
          cells.back().doubtful = true;
        }
      } else {
        cells.insert(cells.end(), {Cell("–"), Cell("–"), Cell("none")});
        if (std::isfinite(row.measured_hz)) remark = "no mode of the model is near";
      }
      if (state.recorded && row.origin == Origin::published && remark.empty()) {
        remark = "published";
      }
      for (std::size_t k = 0; k < published_models(test).size(); ++k) {
        const double value = k < row.models_hz.size() ? row.models_hz[k] : kNaN;
        if (state.recorded && row.origin != Origin::published) {
          cells.insert(cells.end(), {Cell(""), Cell("")});
          continue;
        }
        cells.emplace_back(shown(value, 4), Origin::published_model);
        cells.emplace_back(shown_percent(value / row.measured_hz - 1));
        if (!std::isfinite(value) && remark.empty()) remark = "missed by a published model";
      }
      cells.emplace_back(remark);
      table.rows.push_back(std::move(cells));
    }
  }
  return table;
}

ReportTable error_table(const CampaignTest& test, const std::vector<ModalState>& states) {
  ReportTable table;
  table.id = test.name + "-errors";
  table.caption = "Root-mean-square relative error in frequency against the test (rows compared).";
  table.columns = {{"state", {}, false}, {"rigfit", Origin::modelled}};
  for (const auto& [label, column] : published_models(test)) {
    table.columns.push_back({label, Origin::published_model});
  }
  const auto cell = [](const RmsError& error, Origin origin) {
    return error.rows == 0
               ? Cell("–")
               : Cell(fmt::format("{} % ({})", shown(100 * error.value, 3), error.rows), origin);
  };
  const auto add = [&](const std::string& label, const std::vector<ModalState>& some) {
    std::vector<Cell> cells{label, cell(rms_of_model(some), Origin::modelled)};
    for (std::size_t k = 0; k < published_models(test).size(); ++k) {
      cells.push_back(cell(rms_of_published(some, k), Origin::published_model));
    }
    table.rows.push_back(std::move(cells));
  };
  for (const auto& state : states) add(label_of(state), {state});
  if (states.size() > 1) add("all", states);
  return table;
}

}  // namespace rigfit::apps
