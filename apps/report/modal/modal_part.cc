#include "apps/report/modal/modal_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/report/drawing/html_text.h"
#include "apps/report/figures/figures.h"
#include "apps/results/modal_files.h"

namespace rigfit::apps {
namespace {

/// The shapes of one state with what was measured of them.
std::vector<Picture> state_shapes(const CampaignTest& test, const ModalState& state) {
  std::vector<MeasuredShape> measured;
  for (const auto& row : state.rows) {
    if (!row.mode || !std::isfinite(row.measured_hz)) continue;
    measured.push_back({*row.mode, row.measured_hz, row.shape, row.mac, row.origin});
  }
  return shapes_pictures(fmt::format("{}-shapes-{}", test.name, file_word(label_of(state))),
                         label_of(state), state.rig.scene, state.analysis, measured);
}

Json state_json(const CampaignTest& test, const ModalState& state) {
  const auto& analysis = state.analysis;
  Json json;
  json["tension_N"] = state.tension_N ? Json(*state.tension_N) : Json(nullptr);
  json["EI_Nm2"] = state.EI_Nm2 ? Json(*state.EI_Nm2) : Json(nullptr);
  Json members = Json::array();
  for (const auto& member : analysis.equilibrium.members) {
    members.push_back({{"member", member.member},
                       {"sag_m", member.sag_m},
                       {"tension_N", member.tension_N},
                       {"unstretched_length_m", member.unstretched_length_m},
                       {"segments", member.segments}});
  }
  json["equilibrium"] = {{"status", name_of(analysis.equilibrium.status)},
                         {"reason", analysis.equilibrium.reason},
                         {"residual", analysis.equilibrium.residual},
                         {"members", std::move(members)}};
  Json modes = Json::array();
  for (const auto& mode : analysis.modes) {
    modes.push_back({{"frequency_hz", mode.frequency_hz},
                     {"damping_ratio", mode.damping_ratio},
                     {"plane", name_of(mode.plane)},
                     {"family", name_of(mode.family)}});
  }
  json["modes"] = std::move(modes);
  json["relative_error_estimate"] = analysis.relative_error_estimate;
  json["complete"] = analysis.complete;
  Json pairs = Json::array();
  for (const auto& row : state.rows) {
    Json pair;
    pair["origin"] = word_of(row.origin);
    pair["measured_hz"] = row.measured_hz;
    pair["measured_std_hz"] = row.std_hz;
    pair["measured_damping_ratio"] = row.damping;
    if (row.mode) {
      const auto& mode = analysis.modes[*row.mode];
      pair["model_hz"] = mode.frequency_hz;
      pair["relative_error"] = mode.frequency_hz / row.measured_hz - 1;
      pair["plane"] = name_of(mode.plane);
      pair["family"] = name_of(mode.family);
      pair["other_plane"] = row.other_plane;
      pair["mac"] = row.mac;
    } else {
      pair["model_hz"] = nullptr;
      pair["relative_error"] = nullptr;
    }
    Json published = Json::object();
    for (std::size_t k = 0; k < std::min(row.models_hz.size(), published_models(test).size());
         ++k) {
      published[published_models(test)[k].first] = row.models_hz[k];
    }
    pair["published_hz"] = std::move(published);
    pairs.push_back(std::move(pair));
  }
  json["pairs"] = std::move(pairs);
  return json;
}

void add_summary(ReportPart& part, const CampaignTest& test,
                 const std::vector<ModalState>& states) {
  const RmsError ours = rms_of_model(states);
  std::string text = ours.rows > 0 ? fmt::format("rigfit {} % over {} paired rows",
                                                 shown(100 * ours.value, 3), ours.rows)
                                   : std::string("no row could be paired");
  for (std::size_t k = 0; k < published_models(test).size(); ++k) {
    const RmsError theirs = rms_of_published(states, k);
    if (theirs.rows == 0) continue;
    text += fmt::format("; published {} {} % over {}", published_models(test)[k].first,
                        shown(100 * theirs.value, 3), theirs.rows);
  }
  part.summary.push_back(
      {SummaryItem::Kind::error, test.title + ", rms error", text, Origin::modelled, part.id});

  std::string leaked, lonely;
  for (const auto& state : states) {
    for (const auto& row : state.rows) {
      if (!std::isfinite(row.measured_hz)) continue;
      std::string& list = row.mode ? leaked : lonely;
      if (row.mode && !row.other_plane) continue;
      list += fmt::format("{}{} Hz ({})", list.empty() ? "" : ", ", shown(row.measured_hz, 4),
                          label_of(state));
    }
  }
  if (!leaked.empty()) {
    part.warnings.push_back({"cross-plane",
                             "Check the direction of the test: measured modes lie at modes of the "
                             "model in the other plane and are left out: " +
                                 leaked,
                             test.name, false});
  }
  if (!lonely.empty()) {
    part.warnings.push_back({"unpaired",
                             "Look at measured modes that no mode of the model is near: " + lonely,
                             test.name, false});
  }
}

}  // namespace

ReportPart modal_part(const Campaign& campaign, const CampaignTest& test,
                      const ident::KnownValues& known, const std::vector<ModalState>& states) {
  ReportPart part;
  for (const auto& state : states) {
    for (const auto& row : state.rows) {
      if (row.other_plane) continue;
      if (row.mode) {
        part.modes.push_back({"model as given", Origin::modelled, row.measured_hz,
                              state.analysis.modes[*row.mode].frequency_hz});
      }
      for (std::size_t k = 0; k < row.models_hz.size(); ++k) {
        part.modes.push_back({"published model, " + published_models(test)[k].first,
                              Origin::published_model, row.measured_hz, row.models_hz[k]});
      }
    }
  }
  part.id = test.name;
  part.title = test.title;
  part.test = test.name;
  part.json_key = "modal";
  bool any = false;
  for (const auto& state : states) {
    const auto& equilibrium = state.analysis.equilibrium;
    any = any || !state.analysis.modes.empty();
    if (equilibrium.status != model::EquilibriumStatus::converged) {
      part.warnings.push_back({"equilibrium",
                               fmt::format("{}: {} ({})", label_of(state),
                                           name_of(equilibrium.status), equilibrium.reason),
                               test.name, true});
    }
  }
  // A tenth of what a good test resolves (about 1 %) is all that segments may cost.
  double worst = 0;
  for (const auto& state : states) worst = std::max(worst, state.segments_error);
  if (worst > 1e-3) {
    const std::string message = fmt::format(
        "Give the scene's members more segments, or segments = \"auto\": their number changes "
        "frequencies by an estimated {} %",
        shown(100 * worst, 2));
    part.warnings.push_back({"segments", message, test.name, false});
  }
  for (const auto& state : states) {
    std::string left;
    for (const auto& one : state.analysis.left_out) {
      left += fmt::format("{}left out: {} ({:.0e})", left.empty() ? "" : "; ", one.what,
                          one.relative_error);
    }
    part.costs.push_back({fmt::format("{}, {}: equilibrium and {} modes", test.title,
                                      label_of(state), state.analysis.modes.size()),
                          fmt::format("{} unknowns", state.analysis.unknowns),
                          left.empty() ? "nothing left out" : left, state.wall_s,
                          state.segments_error});
  }
  const auto& inputs = test.as<ModalTest>().inputs;
  const auto& plane = inputs.setup.plane;
  const std::string planes = !plane                           ? "in and out of the plane of gravity"
                             : *plane == model::ModePlane::in ? "in the plane of gravity"
                                                              : "out of the plane of gravity";
  part.blocks.push_back(
      Paragraph{fmt::format("Hammer test, {}; scene \"{}\". The values of the model are those "
                            "given for the scene, nothing "
                            "was fitted to these frequencies here.",
                            planes, campaign.scenes[*test.scene].name)});
  part.blocks.push_back(error_table(test, states));
  if (any) {
    if (states.front().tension_N && states.size() > 1) {
      auto lines = tension_plot(test, *inputs.scene, known, states);
      part.blocks.push_back(std::move(lines.plot));
      part.json["crossings"] = std::move(lines.crossings);
    } else {
      part.blocks.push_back(row_plot(test, states));
    }
  }
  ReportTable pairs = pairs_table(test, states);
  part.brief = {test.name + "-frequency"};
  part.brief.push_back(pairs.rows.size() <= 14 ? pairs.id : test.name + "-errors");
  part.blocks.push_back(std::move(pairs));
  part.blocks.push_back(equilibrium_table(test, states));
  for (const auto& state : states) {
    for (auto& picture : state_shapes(test, state)) part.blocks.push_back(std::move(picture));
  }
  add_summary(part, test, states);

  part.json["test"] = test.name;
  part.json["scene"] = campaign.scenes[*test.scene].name;
  Json list = Json::array();
  for (const auto& state : states) list.push_back(state_json(test, state));
  part.json["states"] = std::move(list);
  const RmsError ours = rms_of_model(states);
  part.json["rms_relative_error"] = ours.value;
  part.json["paired_rows"] = ours.rows;
  Json published = Json::object();
  for (std::size_t k = 0; k < published_models(test).size(); ++k) {
    const RmsError theirs = rms_of_published(states, k);
    published[published_models(test)[k].first] = {{"rms_relative_error", theirs.value},
                                                  {"rows", theirs.rows}};
  }
  part.json["published_models"] = std::move(published);
  return part;
}

}  // namespace rigfit::apps
