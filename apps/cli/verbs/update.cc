// rigfit update: a scene's uncertain parameters fitted to measured modes.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "apps/campaign_file/update_data.h"
#include "apps/campaign_file/update_inputs.h"
#include "apps/cli/at_hand.h"
#include "apps/cli/plots/plot_option.h"
#include "apps/cli/verbs/all.h"
#include "apps/cli/verbs/update_candidates.h"
#include "apps/describe/sheet.h"
#include "apps/report/figures/figures.h"
#include "apps/results/results_json.h"
#include "ident/campaign/fit_campaign.h"
#include "ident/update/model_update.h"
#include "ident/update/update_checks.h"
#include "ident/update/update_rows.h"
#include "model/scene/read_scene.h"

namespace rigfit::apps {
namespace {

/// "1.23 %"; "-" when there is no such number.
std::string percent(double ratio) {
  return std::isfinite(ratio) ? fmt::format("{:.2f} %", 100 * ratio) : "-";
}

// Where each parameter's uncertainty comes from, as shares of its variance; what is below half a
// percent is not shown.
void print_budget(std::ostream& out, const ident::UpdateResult& result) {
  for (const auto& p : result.parameters) {
    std::string shares;
    for (const auto& term : p.budget) {
      const double share = std::pow(term.std / p.std, 2);
      if (!(share > 0.005)) continue;
      shares += fmt::format("{}{} {:.0f} %", shares.empty() ? "" : ", ", term.source, 100 * share);
    }
    if (!shares.empty() && p.budget.size() > 1) {
      out << fmt::format("  variance of {}: {}\n", p.name, shares);
    }
  }
}

// Misfit, parameters with their budgets, pairs, rms errors, alternatives with what decides.
void print_update(std::ostream& out, const ident::UpdateResult& result, const States& states) {
  if (result.fit.ruled_out())
    out << "the data rule this model out: " << ident::fit_text(result.fit) << '\n';
  describe::print(out, describe::table_of(result.parameters));
  print_budget(out, result);
  describe::print(out, describe::table_of(ident::pair_rows(result.pairs, result.unpaired, states)));
  if (!result.pairs.empty()) {
    out << fmt::format("rms of the paired errors: {} before, {} fitted\n",
                       percent(result.rms_relative_error_before),
                       percent(result.rms_relative_error));
  }
  out << "fit: " << ident::fit_text(result.fit) << '\n';
  if (result.alternatives.size() > 1) {
    out << fmt::format("this answer has a weight of {:.3f}; others that the data support:\n",
                       result.alternatives.front().weight);
    for (const auto& text : ident::alternative_texts(result)) out << "  " << text << '\n';
  }
  if (result.frf_lines > 0) {
    out << fmt::format(
        "rms of |ln(model / measured)| over {} FRF lines: {:.3f} before, {:.3f} fitted\n",
        result.frf_lines, result.rms_log_frf_error_before, result.rms_log_frf_error);
  }
}

// Paired errors of the model before, fitted and held out, and of other models in the same rows.
Json comparison_json(const UpdateCommand& options, const UpdateStates& states,
                     const ident::UpdateResult& result, const std::vector<ident::HeldOut>& held,
                     VerbContext& context) {
  const auto error_of = [](const std::vector<ident::UpdatedPair>& pairs, std::size_t state,
                           std::size_t measured) {
    for (const auto& pair : pairs) {
      if (pair.state == static_cast<int>(state) && pair.measured == static_cast<int>(measured) &&
          !pair.cross_plane) {
        return pair.relative_error;
      }
    }
    return std::numeric_limits<double>::quiet_NaN();
  };
  std::vector<std::string> names{"before", "fitted"};
  if (!held.empty()) names.emplace_back("held out");
  names.insert(names.end(), options.data.compare.begin(), options.data.compare.end());
  describe::Table table{"", {"relative errors", "measured, Hz"}, {false, true}, {}};
  table.heads.insert(table.heads.end(), names.begin(), names.end());
  table.numeric.resize(table.heads.size(), true);
  std::vector<double> squares(names.size());
  std::vector<int> counts(names.size());
  Json rows = Json::array(), rms;
  for (std::size_t s = 0; s < states.states.size(); ++s) {
    const auto& state = states.states[s];
    for (std::size_t m = 0; m < state.measured.size(); ++m) {
      const double measured = state.measured[m].frequency_hz.value;
      std::vector<double> errors{error_of(result.pairs_before, s, m), error_of(result.pairs, s, m)};
      if (!held.empty()) errors.push_back(error_of(held[s].pairs, s, m));
      for (const double other : states.compared[s][m]) errors.push_back(other / measured - 1);
      Json row{{"state", state.name}, {"measured_hz", measured}};
      auto& cells =
          table.rows.emplace_back(std::vector{state.name, fmt::format("{:.4f}", measured)});
      for (std::size_t i = 0; i < names.size(); ++i) {
        const bool there = std::isfinite(errors[i]);
        cells.push_back(there ? fmt::format("{:+.2f} %", 100 * errors[i]) : "-");
        row[names[i]] = errors[i];
        if (there) squares[i] += errors[i] * errors[i], ++counts[i];
      }
      rows.push_back(std::move(row));
    }
  }
  auto& last = table.rows.emplace_back(std::vector<std::string>{"all", "rms"});
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double all = std::sqrt(squares[i] / counts[i]);  // NaN: none
    last.push_back(percent(all));
    rms[names[i]] = {{"rms_relative_error", all}, {"modes", counts[i]}};
  }
  context.out << '\n';
  describe::print(context.out, table);
  return {{"rms", std::move(rms)}, {"rows", std::move(rows)}};
}

void print_held_out(const UpdateStates& states, const std::vector<ident::HeldOut>& held,
                    VerbContext& context) {
  describe::Table table{
      "", {"held out", "before", "others fitted", "predicted"}, {false, true, true, true}, {}};
  for (const auto& one : held) {
    table.rows.push_back({states.states[static_cast<std::size_t>(one.state)].name,
                          percent(one.rms_before), percent(one.rms_fitted),
                          percent(one.rms_predicted)});
  }
  describe::print(context.out, table);
}

/// The fitted scene of each state, with the segments that its file asks for.
std::vector<model::Scene> updated_scenes(const UpdateStates& states,
                                         const ident::UpdateResult& result) {
  std::vector<model::Scene> scenes = result.scenes;
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    for (std::size_t m = 0; m < scenes[s].members.size(); ++m) {
      scenes[s].members[m].segments = states.segments[s][m];
    }
  }
  return scenes;
}

Json write_scenes(const UpdateCommand& options, const UpdateStates& states,
                  const ident::UpdateResult& result, VerbContext& context) {
  Json files = Json::array();
  if (options.out.empty()) {
    context.out << "--out FILE writes the updated scene\n";
    return files;
  }
  const auto scenes = updated_scenes(states, result);
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    std::filesystem::path path(options.out);
    if (scenes.size() > 1) {
      const std::string tension =
          states.tension[s] ? fmt::format("-{:g}N", *states.tension[s]) : "";
      const std::string number = options.data.scenes.size() > 1 ? fmt::format("-{}", s + 1) : "";
      path.replace_filename(fmt::format("{}{}{}{}", path.stem().string(), number, tension,
                                        path.extension().string()));
    }
    context.write(path, model::scene_text(scenes[s]));
    context.out << "updated scene: " << path.string() << '\n';
    files.push_back(path.string());
  }
  return files;
}

// The fit's options, with what is taken as known.
ident::UpdateOptions fit_options(const UpdateCommand& options, UpdateStates& states,
                                 VerbContext& context) {
  ident::UpdateOptions update;
  update.assumed_relative_std = options.assumed_std;
  update.model_relative_std = options.model_std;
  update.frf_model_relative_std = options.frf_model_std;
  update.shape_std = options.shape_std;
  update.starts = options.starts;
  update.threads = context.threads;
  if (!options.axial.empty()) {
    context.input(options.axial);
    for (auto& input : axial_inputs(options.axial, options.axial_damping, states)) {
      update.inputs.push_back(std::move(input));
    }
  }
  if (options.stiffness_common_std > 0 && states.stiffness.empty()) {
    throw UsageError("--stiffness-std is of the --stiffness table, and there is none");
  }
  for (auto& input : uncertain_inputs(options.inputs, options.stiffness_common_std, states)) {
    update.inputs.push_back(std::move(input));
  }
  for (auto& input : aim_inputs(options.aims, states)) update.inputs.push_back(std::move(input));
  for (auto& input : ident::sample_rate_inputs(states.clocks)) {
    update.inputs.push_back(std::move(input));
  }
  return update;
}

void tell_findings(const std::vector<ident::Finding>& findings, const ident::UpdateResult& result,
                   VerbContext& context) {
  context.tell(findings);
  if (result.status == ident::UpdateStatus::not_converged) {
    context.warn("not_converged", result.message);
    context.exit_code = ExitCode::not_converged;
  }
}

// Several models of the same modes: the heaviest as a fit by itself, and all beside each other.
Json compare_models(UpdateStates& states, const UpdateCommand& options, VerbContext& context,
                    ident::UpdateResult& result) {
  if (options.hold_out) {
    throw UsageError(
        "candidates are compared without --hold-out: give it to a fit of the model chosen");
  }
  if (!options.data.frfs.empty()) {
    throw UsageError("candidates are compared by modes: give --measured or --decay alone");
  }
  auto models = candidate_models(options, states, context);
  std::vector<ident::ModelCandidate> candidates;
  ident::UpdateOptions update;
  for (auto& one : models) {
    auto own = fit_options(options, one.states, context);
    if (candidates.empty()) update = std::move(own);
    auto priors = options.priors;
    priors.insert(priors.end(), one.priors.begin(), one.priors.end());
    const auto& scene = one.states.states.front().scene;
    std::vector<std::string> names = options.free;
    if (names.empty()) {
      for (const auto& parameter : free_parameters({}, {}, scene)) names.push_back(parameter.name);
    }
    names.insert(names.end(), one.free.begin(), one.free.end());
    candidates.push_back({one.name, one.states.states, free_parameters(names, priors, scene)});
  }
  const auto comparison = ident::compare_candidates(candidates, update);
  if (comparison.heaviest < 0) {
    throw NotConverged("none of the candidates could be fitted: " +
                       comparison.candidates.front().result.message);
  }
  const auto best = static_cast<std::size_t>(comparison.heaviest);
  result = comparison.candidates[best].result;
  states = std::move(models[best].states);
  context.out << "the heaviest candidate: " << comparison.candidates[best].name << '\n';
  print_update(context.out, result, states.states);
  if (context.plots) context.plots->add(fit_blocks("fit", states.states, result, {}));
  tell_findings(ident::fit_findings(result), result, context);
  Json json = update_json(result, states.states);
  json.update(candidates_json(comparison, context));
  return json;
}

Json fitted_json(UpdateStates& states, const UpdateCommand& options, VerbContext& context,
                 ident::UpdateResult& result) {
  if (!options.candidates.empty() || !options.ends.empty()) {
    return compare_models(states, options, context, result);
  }
  if (options.hold_out && states.states.size() < 2) {
    throw UsageError("--hold-out needs several states: a tension_N column or several scenes");
  }
  const auto free = free_parameters(options.free, options.priors, states.states.front().scene);
  const auto update = fit_options(options, states, context);
  auto outcome = ident::fit_campaign({states.states, free, update, options.hold_out});
  result = std::move(outcome.result);
  if (result.status == ident::UpdateStatus::no_model) throw NotConverged(result.message);

  print_update(context.out, result, states.states);
  if (context.plots) {
    context.plots->add(fit_blocks("fit", states.states, result, outcome.held));
  }
  tell_findings(outcome.findings, result, context);
  Json json = update_json(result, states.states);
  if (options.hold_out) {
    print_held_out(states, outcome.held, context);
    json["hold_out"] = held_out_json(outcome.held, states.states);
    json["rms_relative_error_held_out"] = outcome.rms_held_out;
  }
  if (!options.data.compare.empty()) {
    json["comparison"] = comparison_json(options, states, result, outcome.held, context);
  }
  return json;
}

Json run(UpdateCommand& options, VerbContext& context) {
  if (options.data.modes.empty() && options.data.frfs.empty() && options.data.decays.empty()) {
    throw UsageError("nothing to fit to: give --measured, --frf or --decay");
  }
  if (!options.band.empty()) options.data.band_hz = {options.band[0], options.band[1]};
  UpdateStates states = read_update_states(options.data, context);
  ident::UpdateResult result;
  Json json = fitted_json(states, options, context, result);
  if (context.at_hand) {
    context.at_hand->covariance = result.covariance;
    context.at_hand->fitted_scenes = updated_scenes(states, result);
  } else {
    json["scenes"] = write_scenes(options, states, result, context);
  }
  return json;
}

}  // namespace

describe::Options options_of(UpdateCommand& c) {
  using describe::option;
  return {
      option("SCENE", c.data.scenes, "Scene files (several: one for each file of data)")
          .required()
          .file(),
      option("--measured", c.data.modes,
             "Tables of measured modes: frequency_hz, and where known std, damping_ratio, "
             "damping_std, plane, tension_N (a state each), shape:<sensor>; or universal files of "
             "mode shapes (UFF 55, with 15 or 2411 for where the nodes are)")
          .file(),
      option("--frf", c.data.frfs,
             "FRFs (UFF 58), fitted line by line; names of inputs and responses are those of the "
             "scene's loads and sensors. Their modes give its starting values. An exponential "
             "window in them is part of the model then, not of its damping")
          .file(),
      option("--decay", c.data.decays,
             "Recordings of free decays: their frequencies and damping ratios")
          .file(),
      option("--channel", c.data.decay_channel, "Channel of the decays"),
      option("--tension", c.data.tensions,
             "N, of each universal file of --measured (or of none of them), then of each --frf "
             "and --decay: the cables' tension in that state")
          .positive(),
      option("--band", c.band, "Lines and modes of FRFs, decays and UFF 55 that count", "Hz")
          .count(2)
          .from_zero(),
      option("--compare", c.data.compare,
             "Further columns of the tables: frequencies of other models, shown beside"),
      option("--free", c.free,
             "Scene parameters to fit: NAME, NAME=TARGET,-TARGET (several that share a value), "
             "NAME@each (one value a state). Default: every member's EI"),
      option("--prior", c.priors, "NAME=VALUE,STD of a free parameter, from other tests"),
      option("--candidates", c.candidates,
             "TOML file of models to compare, [[candidate]] with name and, as needed, supports = { "
             "NODE = \"pinned|clamped|free|springs|own springs\" }, set = { \"PARAMETER\" = VALUE "
             "}, free = [...], prior = [...], scene = \"FILE\": weights by evidence, averaged "
             "parameters; exit code 4 when none has 90 % of the weight")
          .file(),
      option("--ends", c.ends,
             "The usual candidates: all nodes that are held \"pinned\", \"clamped\", with "
             "\"springs\" (one rotational stiffness, fitted), with \"own springs\" (one a node)")
          .one_of({"pinned", "clamped", "springs", "own springs"}),
      option("--column", c.data.column, "Name of the frequency column"),
      option("--plane", c.data.planes, "Plane of each file: in, out or any")
          .one_of({"in", "out", "any"}),
      option("--stiffness", c.data.stiffness,
             "Table of tension_N, EI_Nm2 and, where known, std, or the JSON result of rigfit "
             "bending: the cables' EI in each state")
          .file(),
      option("--stiffness-std", c.stiffness_common_std,
             "Relative uncertainty of that EI that all its tests share")
          .within(0.0, 1.0),
      option("--axial", c.axial,
             "JSON result of rigfit axial: EA of all cables, with its uncertainty")
          .file(),
      option("--axial-damping", c.axial_damping,
             "With --axial: its damping ratio too becomes that of all cables")
          .needs("--axial"),
      option("--input", c.inputs,
             "Uncertainty of what is not fitted: TARGET=STD or TARGET=0.5%, several targets with "
             "commas (-TARGET: opposite), `tension` for the cables' reading, @each at the end: "
             "independent in each state. Carried into the parameters and the predictions"),
      option("--aim", c.aims,
             "Where a load of the scene struck, LOAD=METRES,DEGREES (standard uncertainties of its "
             "place along the member and of its direction, of the mean of the hits): carried on "
             "like every --input. With --frf"),
      option("--assumed-std", c.assumed_std,
             "Relative standard uncertainty of frequencies that come without one")
          .within(1e-9, 1.0),
      option("--model-std", c.model_std,
             "Relative error in frequency that the model itself is allowed")
          .within(0.0, 1.0),
      option("--frf-model-std", c.frf_model_std,
             "Relative error in FRFs that the model itself is allowed")
          .within(0.0, 10.0),
      option("--shape-std", c.shape_std,
             "Uncertainty of a component of a unit shape: shapes are fitted too (0: they only help "
             "to pair)")
          .within(0.0, 1.0),
      option("--segments", c.data.segments,
             "Of every member while fitting (default: the scene's); fewer are faster")
          .within(2, 10000),
      option("--starts", c.starts, "1: only the answer near the scene's own values is looked for")
          .within(1, 1000),
      option("--hold-out", c.hold_out,
             "Also leave out each state in turn and predict it from the others"),
      option("--out", c.out, "Updated scene").writes()};
}

Verb update_verb() {
  return verb_of<UpdateCommand>(
      "update", "A scene's uncertain parameters fitted to measured modes",
      "Example:\n"
      "  rigfit update testdata/jalali2021/scenes/beam.toml \\\n"
      "    --measured testdata/jalali2021/table2_beam_frequencies.csv --column bond_graph_Hz \\\n"
      "    --plane in --free beam.EI_z tip.mass --out beam.updated.toml --json fit.json",
      run, true);
}

}  // namespace rigfit::apps
