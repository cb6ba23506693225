#include "apps/report/parts/parts.h"

namespace rigfit::apps {
namespace {

using ident::MeasuredRow, ident::ModalState;
using ModalStates = std::vector<ModalState>;
using Style = PlotSeries::Style;

/// Number of a mode among those of its plane: "in 2".
std::string mode_name(const model::ModalAnalysis& analysis, std::size_t index) {
  const auto plane = analysis.modes[index].plane;
  const auto number = std::ranges::count(std::span(analysis.modes).first(index + 1), plane,
                                         &model::NaturalMode::plane);
  return fmt::format("{} {}", name_of(plane), number);
}

/// Frequencies of test, published models and model against tension.
Plot frequency_plot(const CampaignTest& test, const ModalStates& states) {
  Plot plot{test.name + "-frequency", "Natural frequencies against tension",
            "Lines: the model, in plane (full) and out of plane (broken), by number in the plane.",
            "tension, N", "frequency, Hz"};
  double highest = 0;
  for (const auto& state : states) {
    for (const auto& row : state.rows) {
      if (row.frequency_hz.value > highest) highest = row.frequency_hz.value;
    }
  }
  for (const auto& state : states) {
    for (std::size_t i = 0; i < state.analysis.modes.size(); ++i) {
      const auto& mode = state.analysis.modes[i];
      if (mode.frequency_hz > 1.1 * highest) break;
      const bool in = mode.plane == model::ModePlane::in;
      auto& line = plot.named("rigfit " + mode_name(state.analysis, i), Origin::modelled,
                              in ? Style::line : Style::dashed);
      line.variant = 0;
      line.group = in ? "rigfit, in plane" : "rigfit, out of plane";
      line.add(*state.tension_N, mode.frequency_hz);
    }
  }
  /// Points of every state: `value(row)`, NaN where there is none.
  const auto points = [&](PlotSeries series, auto value) {
    series.style = Style::points;
    const bool recorded = series.origin == Origin::measured || series.origin == Origin::synthetic;
    for (const auto& state : states) {
      for (const auto& row : state.rows) {
        const double hz = value(row), half = recorded ? 1.96 * row.frequency_hz.std : Answer::kNone;
        if (std::isfinite(hz)) series.add(*state.tension_N, hz, hz - half, hz + half);
      }
    }
    plot.add(std::move(series));
  };
  const auto& published = test.as<ModalTest>().models;
  for (std::size_t k = 0; k < published.size(); ++k) {
    points({published[k] + " (published model)", Origin::published_model, 2 + static_cast<int>(k)},
           [&](const MeasuredRow& row) {
             return k < row.models_hz.size() ? row.models_hz[k] : Answer::kNone;
           });
  }
  for (const Origin origin : {Origin::published, Origin::measured, Origin::synthetic}) {
    points({fmt::format("test ({})", origin == Origin::published ? "published" : name_of(origin)),
            origin, 1},
           [&](const MeasuredRow& row) {
             return row.origin == origin ? row.frequency_hz.value : Answer::kNone;
           });
  }
  return plot;
}

/// Each measured mode beside the model's and the published models' values of that row.
ReportTable pairs_table(const CampaignTest& test, const ModalStates& states) {
  ReportTable table{test.name + "-pairs",
                    "Each measured frequency beside the model's mode, found by pairing (not by row "
                    "number), and beside the published models' values of that row.",
                    {{"state", {}, false},
                     {"test, Hz"},
                     {"model, Hz", Origin::modelled},
                     {"error", Origin::modelled},
                     {"mode", {}, false}}};
  const auto& published = test.as<ModalTest>().models;
  for (const auto& name : published) {
    table.columns.push_back({name + ", Hz", Origin::published_model});
    table.columns.push_back({"error", Origin::published_model});
  }
  table.columns.push_back({"remark", {}, false});
  for (const auto& state : states) {
    std::string label = label_of(state.tension_N);
    for (const auto& row : state.rows) {
      const bool of_table = row.origin == Origin::published,
                 known = std::isfinite(row.frequency_hz.value);
      if (of_table && state.recorded && !known && row.models_hz.empty()) continue;
      std::vector<Cell> cells{
          std::exchange(label, ""),
          Cell(describe::is_known_to(row.frequency_hz.value, row.frequency_hz.std)
                   ? with_signs(
                         describe::estimate_text(row.frequency_hz.value, row.frequency_hz.std, ""))
                   : shown(row.frequency_hz.value, 4),
               row.origin)};
      const auto add = [&](double hz) {
        cells.emplace_back(shown(hz, 4));
        cells.emplace_back(shown_percent(hz / row.frequency_hz.value - 1));
      };
      const auto* mode = row.mode ? &state.analysis.modes[*row.mode] : nullptr;
      add(mode ? mode->frequency_hz : Answer::kNone);
      cells.emplace_back(
          mode ? fmt::format("{} ({})", mode_name(state.analysis, *row.mode), name_of(mode->family))
               : "");
      for (std::size_t k = 0; k < published.size(); ++k) {
        add(k < row.models_hz.size() ? row.models_hz[k] : Answer::kNone);
      }
      auto& remark =
          cells.emplace_back(row.other_plane  ? "a mode of the other plane: leaked into this test"
                             : !mode && known ? "no mode of the model is near"
                                              : "");
      remark.doubtful = !remark.text.empty();
      table.rows.push_back(std::move(cells));
    }
  }
  return table;
}

/// Root-mean-square errors of this model and of the published ones, state by state.
ReportTable error_table(const CampaignTest& test, const ModalStates& states) {
  ReportTable table{test.name + "-errors",
                    "Root-mean-square relative error in frequency against the test (modes "
                    "compared).",
                    {{"state", {}, false}, {"rigfit", Origin::modelled}}};
  const auto& published = test.as<ModalTest>().models;
  for (const auto& name : published) table.columns.push_back({name, Origin::published_model});
  const auto add = [&](const std::string& label, const ModalStates& some) {
    const auto cell = [](const ident::RmsError& error) {
      return error.rows == 0 ? Cell("–")
                             : Cell(fmt::format("{} ({})", percent_words(error.value), error.rows));
    };
    std::vector<Cell> cells{label, cell(rms_error(some))};
    for (std::size_t k = 0; k < published.size(); ++k) {
      cells.push_back(cell(rms_error(some, k)));
    }
    table.rows.push_back(std::move(cells));
  };
  for (const auto& state : states) add(label_of(state.tension_N), {state});
  if (states.size() > 1) add("all", states);
  return table;
}

Json state_json(const ModalState& state, const std::vector<std::string>& published) {
  const auto& analysis = state.analysis;
  Json pairs = Json::array();
  for (const auto& row : state.rows) {
    Json pair{{"origin", word_of(row.origin)},
              {"measured_hz", row.frequency_hz.value},
              {"measured_std_hz", row.frequency_hz.std},
              {"model_hz", nullptr},
              {"relative_error", nullptr}};
    if (row.mode) {
      const auto& mode = analysis.modes[*row.mode];
      pair["model_hz"] = mode.frequency_hz;
      pair["relative_error"] = mode.frequency_hz / row.frequency_hz.value - 1;
      pair["other_plane"] = row.other_plane;
      pair["mac"] = row.mac;
      pair["plane"] = name_of(mode.plane);
      pair["family"] = name_of(mode.family);
    }
    for (std::size_t k = 0; k < std::min(row.models_hz.size(), published.size()); ++k) {
      pair["published_hz"][published[k]] = row.models_hz[k];
    }
    pairs.push_back(std::move(pair));
  }
  return {{"tension_N", describe::json_of(state.tension_N)},
          {"EI_Nm2", describe::json_of(state.EI_Nm2)},
          {"equilibrium", describe::json_of(analysis.equilibrium)},
          {"modes", describe::json_of(analysis.modes)},
          {"relative_error_estimate", state.segments_error},
          {"pairs", std::move(pairs)}};
}

void tell(ReportPart& part, const CampaignTest& test, const ModalStates& states) {
  double worst = 0;
  std::string leaked, lonely;
  for (const auto& state : states) {
    const auto& equilibrium = state.analysis.equilibrium;
    if (equilibrium.status != model::EquilibriumStatus::converged) {
      refuse(part, "equilibrium",
             fmt::format("{}: {} ({})", ident::state_label(state.tension_N),
                         name_of(equilibrium.status), equilibrium.reason),
             test.name);
    }
    worst = std::max(worst, state.segments_error);
    for (const auto& row : state.rows) {
      if (!std::isfinite(row.frequency_hz.value) || (row.mode && !row.other_plane)) continue;
      std::string& list = row.mode ? leaked : lonely;
      list += fmt::format("{}{} Hz ({})", list.empty() ? "" : ", ",
                          shown(row.frequency_hz.value, 4), ident::state_label(state.tension_N));
    }
  }
  // A tenth of what a good test resolves (about 1 %) is all that segments may cost.
  if (worst > 1e-3) {
    part.warnings.push_back(
        {"segments",
         fmt::format("Give the scene's members more segments, or segments = \"auto\": their number "
                     "changes frequencies by an estimated {}",
                     percent_words(worst)),
         test.name});
  }
  if (!leaked.empty()) {
    part.warnings.push_back({"cross-plane",
                             "Check the direction of the test: measured modes lie at modes of the "
                             "model in the other plane and are left out: " +
                                 leaked,
                             test.name});
  }
  if (!lonely.empty()) {
    part.warnings.push_back({"unpaired",
                             "Look at measured modes that no mode of the model is near: " + lonely,
                             test.name});
  }
}

}  // namespace

ReportPart model_part(const Campaign& campaign, const CampaignTest& test,
                      const ModalStates& states) {
  const auto& published = test.as<ModalTest>().models;
  const auto& scene = campaign.scenes[*test.scene].name;
  const auto& plane = test.as<ModalTest>().plane;
  ReportPart part;
  part.id = part.test = test.name;
  part.title = test.title;
  part.json_key = "modal";
  tell(part, test, states);
  part.blocks.push_back(Paragraph{fmt::format(
      "Hammer test, {}; scene \"{}\". The values of the model are those given for the scene, "
      "nothing was fitted to these frequencies here.",
      !plane                           ? "in and out of the plane of gravity"
      : *plane == model::ModePlane::in ? "in the plane of gravity"
                                       : "out of the plane of gravity",
      scene)});
  part.blocks.push_back(error_table(test, states));
  if (states.size() > 1 && states.front().tension_N) {
    add(part.blocks, frequency_plot(test, states));
  }
  ReportTable pairs = pairs_table(test, states);
  part.brief = {test.name + "-frequency",
                pairs.rows.size() <= 14 ? pairs.id : test.name + "-errors"};
  part.blocks.push_back(std::move(pairs));

  part.json = {{"test", test.name}, {"scene", scene}, {"states", Json::array()}};
  for (const auto& state : states) {
    for (const auto& row : state.rows) {
      if (row.other_plane) continue;
      if (row.mode) {
        part.modes.push_back({"model as given", Origin::modelled, row.frequency_hz.value,
                              state.analysis.modes[*row.mode].frequency_hz});
      }
      for (std::size_t k = 0; k < row.models_hz.size(); ++k) {
        part.modes.push_back({"published model, " + published[k], Origin::published_model,
                              row.frequency_hz.value, row.models_hz[k]});
      }
    }
    add(part.blocks,
        shapes_pictures(
            fmt::format("{}-shapes-{}", test.name, file_word(ident::state_label(state.tension_N))),
            label_of(state.tension_N), state.rig.scene, state.analysis, state.rows));
    part.json["states"].push_back(state_json(state, published));
  }
  const auto ours = rms_error(states);
  part.json["rms_relative_error"] = ours.value;
  part.json["paired_rows"] = ours.rows;
  part.json["published_models"] = Json::object();
  std::string text =
      ours.rows > 0 ? fmt::format("rigfit {} over {} modes", percent_words(ours.value), ours.rows)
                    : std::string("no mode could be paired");
  for (std::size_t k = 0; k < published.size(); ++k) {
    const auto theirs = rms_error(states, k);
    part.json["published_models"][published[k]] = {{"rms_relative_error", theirs.value},
                                                   {"rows", theirs.rows}};
    if (theirs.rows == 0) continue;
    text += fmt::format("; published {} {} over {}", published[k], percent_words(theirs.value),
                        theirs.rows);
  }
  part.summary.push_back(
      {SummaryItem::Kind::error, test.title + ", rms error", text, Origin::modelled});
  return part;
}

}  // namespace rigfit::apps
