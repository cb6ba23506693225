#include "apps/report/modal_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "apps/report/html_text.h"
#include "apps/report/modal_states.h"
#include "signal/numbers.h"

namespace rigfit::apps {
namespace {

using signal::kNaN;

std::string label_of(const ModalState& state) { return state_label(state.tension_N); }

const std::vector<std::pair<std::string, std::size_t>>& published_models(const CampaignTest& test) {
  static const std::vector<std::pair<std::string, std::size_t>> none;
  return test.results ? test.results->models : none;
}

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

/// Number of a mode among those of its plane: "in 2".
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
                            shown(member.tension_N, 5), fmt::format("{}", member.segments),
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

PlotSeries points_of(const std::string& name, Origin origin, int variant) {
  PlotSeries series;
  series.name = name;
  series.origin = origin;
  series.variant = variant;
  series.style = PlotSeries::Style::points;
  return series;
}

/// Measured and published points, common to both kinds of frequency plot; x as `at` says.
template <class X>
void add_points(Plot& plot, const CampaignTest& test, const std::vector<ModalState>& states, X at) {
  int variant = 0;
  std::size_t k = 0;
  for (const auto& [label, column] : published_models(test)) {
    auto series = points_of(label + " (published model)", Origin::published_model, variant++);
    for (const auto& state : states) {
      for (std::size_t i = 0; i < state.rows.size(); ++i) {
        if (state.rows[i].models_hz.size() <= k || !std::isfinite(state.rows[i].models_hz[k])) {
          continue;
        }
        series.x.push_back(at(state, i));
        series.y.push_back(state.rows[i].models_hz[k]);
      }
    }
    plot.series.push_back(std::move(series));
    ++k;
  }
  for (const Origin origin : {Origin::published, Origin::measured, Origin::synthetic}) {
    auto series = points_of(
        fmt::format("test ({})", origin == Origin::published ? "published" : name_of(origin)),
        origin, 0);
    for (const auto& state : states) {
      for (std::size_t i = 0; i < state.rows.size(); ++i) {
        const auto& row = state.rows[i];
        if (row.origin != origin || !std::isfinite(row.measured_hz)) continue;
        series.x.push_back(at(state, i));
        series.y.push_back(row.measured_hz);
        if (origin == Origin::published) continue;
        series.low.push_back(row.measured_hz - 1.96 * row.std_hz);
        series.high.push_back(row.measured_hz + 1.96 * row.std_hz);
      }
    }
    if (!series.x.empty()) plot.series.push_back(std::move(series));
  }
}

/// Lines of the model between the tensions, one a mode of a plane, and the test's points.
Plot tension_plot(const Campaign& campaign, const CampaignTest& test, const KnownValues& known,
                  const std::vector<ModalState>& states) {
  Plot plot;
  plot.id = test.name + "-frequency";
  plot.title = "Natural frequencies against tension";
  plot.caption =
      "Lines: the model, in plane (full) and out of plane (broken). Where lines cross, the order "
      "of "
      "the modes changes, which is why rows of a table must not be compared by number.";
  plot.x_label = "tension, N";
  plot.y_label = "frequency, Hz";
  const double low = *states.front().tension_N, high = *states.back().tension_N;
  double highest = 0;
  for (const auto& state : states) {
    for (const auto& row : state.rows) {
      if (row.measured_hz > highest) highest = row.measured_hz;
    }
  }
  constexpr int kSteps = 36;
  std::map<std::pair<model::ModePlane, int>, PlotSeries> lines;
  for (int step = 0; step <= kSteps; ++step) {
    const double tension = low + (high - low) * step / kSteps;
    model::ModesOptions options;
    options.band_hz = {{0.0, 1.1 * highest}};
    options.shapes = false;
    options.damped = false;
    const auto analysis = model::analyse_modes(scene_at(campaign, test, known, tension), options);
    std::map<model::ModePlane, int> number;
    for (const auto& mode : analysis.modes) {
      if (mode.plane != model::ModePlane::in && mode.plane != model::ModePlane::out) continue;
      const int k = ++number[mode.plane];
      auto& line = lines[{mode.plane, k}];
      line.x.push_back(tension);
      line.y.push_back(mode.frequency_hz);
    }
  }
  for (auto& [key, line] : lines) {
    const bool in = key.first == model::ModePlane::in;
    line.name = fmt::format("rigfit {} {}", in ? "in" : "out", key.second);
    line.group = in ? "rigfit, in plane" : "rigfit, out of plane";
    line.style = in ? PlotSeries::Style::line : PlotSeries::Style::dashed;
    plot.series.push_back(std::move(line));
  }
  add_points(plot, test, states,
             [](const ModalState& state, std::size_t) { return *state.tension_N; });
  return plot;
}

/// Without tensions: frequency by row.
Plot row_plot(const CampaignTest& test, const std::vector<ModalState>& states) {
  Plot plot;
  plot.id = test.name + "-frequency";
  plot.title = "Natural frequencies";
  plot.caption = "Measured, published and modelled frequencies, one after the other.";
  plot.x_label = "number";
  plot.y_label = "frequency, Hz";
  plot.log_y = true;
  auto series = points_of("rigfit", Origin::modelled, 0);
  for (std::size_t i = 0; i < states.front().rows.size(); ++i) {
    const auto& row = states.front().rows[i];
    if (!row.mode) continue;
    series.x.push_back(static_cast<double>(i + 1));
    series.y.push_back(states.front().analysis.modes[*row.mode].frequency_hz);
  }
  add_points(plot, test, states,
             [](const ModalState&, std::size_t i) { return static_cast<double>(i + 1); });
  plot.series.push_back(std::move(series));
  return plot;
}

Json points_json(const Eigen::Matrix3Xd& points, double scale, int digits) {
  const double unit = std::pow(10, digits);
  Json list = Json::array();
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    Json point = Json::array();
    for (int k = 0; k < 3; ++k) point.push_back(std::round(scale * points(k, i) * unit) / unit);
    list.push_back(std::move(point));
  }
  return list;
}

ShapeViewer shape_viewer(const CampaignTest& test, const std::vector<ModalState>& states) {
  ShapeViewer viewer;
  viewer.id = test.name + "-shapes";
  viewer.caption =
      "Mode shapes about the hanging equilibrium, displacements enlarged. Drag or use the arrow "
      "keys to turn; the colour says what moves: cable, beam or both (hybrid).";
  viewer.states = Json::array();
  for (const auto& state : states) {
    Json modes = Json::array();
    for (std::size_t i = 0; i < state.analysis.modes.size(); ++i) {
      const auto& mode = state.analysis.modes[i];
      double largest = 0;
      for (const auto& shape : mode.shape) {
        if (shape.displacement.size() > 0) {
          largest = std::max(largest, shape.displacement.colwise().norm().maxCoeff());
        }
      }
      if (!(largest > 0)) continue;
      Json members = Json::array();
      for (std::size_t k = 0; k < mode.shape.size(); ++k) {
        members.push_back(
            {{"name", mode.shape[k].member},
             {"rest", points_json(state.analysis.equilibrium.members[k].positions, 1, 4)},
             {"shape", points_json(mode.shape[k].displacement, 1 / largest, 3)}});
      }
      modes.push_back({{"label", mode_name(state.analysis, i)},
                       {"frequency_hz", std::round(1e4 * mode.frequency_hz) / 1e4},
                       {"plane", name_of(mode.plane)},
                       {"family", name_of(mode.family)},
                       {"members", std::move(members)}});
    }
    if (!modes.empty()) {
      viewer.states.push_back({{"label", label_of(state)}, {"modes", std::move(modes)}});
    }
  }
  return viewer;
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
      {SummaryItem::Kind::result, test.title + ", rms error", text, Origin::modelled, part.id});

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
    part.summary.push_back({SummaryItem::Kind::distrust,
                            test.title,
                            "rows that lie at a mode of the other plane, probably leaked into the "
                            "test: " +
                                leaked,
                            {},
                            part.id});
    part.warnings.push_back(
        {"cross-plane", "measured rows at modes of the other plane: " + leaked, test.name, false});
  }
  if (!lonely.empty()) {
    part.summary.push_back({SummaryItem::Kind::distrust,
                            test.title,
                            "measured modes without a mode of the model near them: " + lonely,
                            {},
                            part.id});
    part.warnings.push_back(
        {"unpaired", "measured rows without a modelled mode: " + lonely, test.name, false});
  }
}

}  // namespace

ReportPart modal_part(const Campaign& campaign, const CampaignTest& test, const KnownValues& known,
                      const std::vector<RecordedModalState>& recorded) {
  ReportPart part;
  part.id = test.name;
  part.title = test.title;
  part.json_key = "modal";
  const auto states = modal_states(campaign, test, known, recorded);
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
        "the number of segments costs an estimated {} % in frequency; give the "
        "scene's members more, or segments = \"auto\"",
        shown(100 * worst, 2));
    part.warnings.push_back({"segments", message, test.name, false});
    part.summary.push_back(
        {SummaryItem::Kind::distrust, test.title, message, Origin::modelled, part.id});
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
  const std::string planes = test.in_plane && test.out_of_plane
                                 ? "in and out of the plane of gravity"
                             : test.in_plane ? "in the plane of gravity"
                                             : "out of the plane of gravity";
  part.blocks.push_back(
      Paragraph{fmt::format("Hammer test, {}; scene \"{}\". The values of the model are those "
                            "given for the scene, nothing "
                            "was fitted to these frequencies here.",
                            planes, campaign.scenes[*test.scene].name)});
  part.blocks.push_back(error_table(test, states));
  if (any) {
    part.blocks.push_back(states.front().tension_N && states.size() > 1
                              ? tension_plot(campaign, test, known, states)
                              : row_plot(test, states));
  }
  part.blocks.push_back(pairs_table(test, states));
  part.blocks.push_back(equilibrium_table(test, states));
  if (any) part.blocks.push_back(shape_viewer(test, states));
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
