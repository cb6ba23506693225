// rigfit update: a scene's uncertain parameters fitted to measured modes.

#include "apps/campaign_file/update_data.h"
#include "apps/cli/verbs/all.h"
#include "ident/update/model_candidates.h"
#include "ident/update/model_update.h"
#include "model/scene/read_scene.h"

namespace rigfit::apps {
namespace {

struct UpdateCommand {
  UpdateData data;
  std::vector<std::string> free, priors, inputs;
  std::string candidates;  ///< file; empty: none
  std::string out, axial;
  ident::UpdateOptions fit;
};

Json candidates_json(const ident::CandidateComparison& comparison, VerbContext& context) {
  auto& out = context.out;
  out << '\n';
  describe::print(out, describe::table_of(comparison.candidates));
  if (!comparison.averaged.empty()) {
    out << "averaged over the candidates by their weights:\n";
    describe::print(out, describe::table_of(comparison.averaged));
  }
  const auto& best = comparison.candidates[static_cast<std::size_t>(comparison.heaviest)];
  if (best.weight < 0.9) {
    context.refuse("several_models",
                   fmt::format("no candidate has 90 % of the weight, the heaviest ({}) has {:.2f}: "
                               "see candidates; the averaged values allow for all of them. More "
                               "modes, shapes or a prior decide",
                               best.name, best.weight));
  }
  return {{"candidates", describe::json_of(comparison.candidates)},
          {"averaged", describe::json_of(comparison.averaged)}};
}

/// The files written: of several states FILE-1-100N.toml, by number and tension where they differ.
Json write_scenes(const UpdateCommand& options, const UpdateStates& states,
                  const std::vector<model::Scene>& scenes, VerbContext& context) {
  Json files = Json::array();
  if (options.out.empty()) {
    context.out << "--out FILE writes the updated scene\n";
    return files;
  }
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    std::filesystem::path path(options.out);
    std::string name = path.stem().string();
    if (options.data.scenes.size() > 1) name += fmt::format("-{}", s + 1);
    if (scenes.size() > 1 && states.tension[s]) name += fmt::format("-{:g}N", *states.tension[s]);
    path.replace_filename(name + path.extension().string());
    context.write(path, model::scene_text(scenes[s]));
    context.out << "updated scene: " << path.string() << '\n';
    files.push_back(path.string());
  }
  return files;
}

// The fit's options, with what is taken as known.
ident::UpdateOptions fit_options(const UpdateCommand& options, UpdateStates& states,
                                 VerbContext& context) {
  ident::UpdateOptions update = options.fit;
  update.threads = context.threads;
  if (!options.axial.empty()) {
    context.input(options.axial);
    update.inputs = axial_inputs(options.axial, states);
  }
  std::ranges::move(uncertain_inputs(options.inputs, states), std::back_inserter(update.inputs));
  return update;
}

/// Text, figures, findings and JSON of a fit.
Json told(const UpdateStates& states, const ident::UpdateResult& result, VerbContext& context) {
  describe::print(context.out, describe::sheet_of(result));
  for (const auto& p : result.parameters) {
    const auto shares = describe::shares_text(p.variance_shares());
    if (p.budget.size() > 1) context.out << fmt::format("variance of {}: {}\n", p.name, shares);
  }
  for (const auto& text : ident::alternative_texts(result)) {
    context.out << "also supported by the data, " << text << '\n';
  }
  if (context.plots) context.plots->add(fit_blocks("fit", states.states, result));
  context.tell(ident::fit_findings(result));
  if (result.status == ident::UpdateStatus::not_converged) context.fail(result.message);
  return describe::json_of(result);
}

/// The models of `--candidates`, each with what is fitted in it beside --free and --prior, weighed
/// by their evidence (ident/update/model_candidates.h): the heaviest as a fit by itself, and all
/// beside each other. `states`: as the command gives them; then those of the heaviest.
Json compare_models(UpdateStates& states, const UpdateCommand& options, VerbContext& context,
                    ident::UpdateResult& result) {
  std::vector<UpdateStates> models;
  std::vector<ident::ModelCandidate> candidates;
  ident::UpdateOptions update;
  context.input(options.candidates);
  auto root = document::TomlTable::read_file(options.candidates);
  for (auto& table : root.tables_or_empty("candidate")) {
    std::string name, file;
    std::vector<std::string> free, priors, names = options.free, all_priors = options.priors;
    read_keys(table,
              {option("name", name, "Of the candidate").required(),
               option("scene", file, "In place of SCENE, relative to this file"),
               option("free", free, "Beside --free"), option("prior", priors, "Beside --prior")},
              "update");
    table.finish();
    auto& own = models.emplace_back(states);
    if (!file.empty()) {
      UpdateData data = options.data;
      data.scenes = {(std::filesystem::path(options.candidates).parent_path() / file).string()};
      own = read_update_states(data, context);
    }
    const auto own_options = fit_options(options, own, context);
    if (candidates.empty()) update = own_options;
    const auto& scene = own.states.front().scene;
    if (names.empty()) {
      for (const auto& parameter : free_parameters({}, {}, scene)) names.push_back(parameter.name);
    }
    names.insert(names.end(), free.begin(), free.end());
    all_priors.insert(all_priors.end(), priors.begin(), priors.end());
    candidates.push_back({name, own.states, free_parameters(names, all_priors, scene)});
  }
  root.finish();
  if (models.size() < 2) throw UsageError("candidates: two or more are needed to compare");
  const auto comparison = ident::compare_candidates(candidates, update);
  if (comparison.heaviest < 0) {
    throw NotConverged("none of the candidates could be fitted: " +
                       comparison.candidates.front().result.message);
  }
  const auto best = static_cast<std::size_t>(comparison.heaviest);
  result = comparison.candidates[best].result;
  states = std::move(models[best]);
  context.out << "the heaviest candidate: " << comparison.candidates[best].name << '\n';
  Json json = told(states, result, context);
  json.update(candidates_json(comparison, context));
  return json;
}

Json fitted_json(UpdateStates& states, const UpdateCommand& options, VerbContext& context,
                 ident::UpdateResult& result) {
  if (!options.candidates.empty()) return compare_models(states, options, context, result);
  if (options.fit.hold_out && states.states.size() < 2) {
    throw UsageError("--hold-out needs several states: a tension_N column or several scenes");
  }
  const auto free = free_parameters(options.free, options.priors, states.states.front().scene);
  result = ident::update_model(states.states, free, fit_options(options, states, context));
  if (result.status == ident::UpdateStatus::no_model) throw NotConverged(result.message);
  return told(states, result, context);
}

Json run(UpdateCommand& options, VerbContext& context) {
  if (options.data.modes.empty() && options.data.frfs.empty() && options.data.decays.empty()) {
    throw UsageError("nothing to fit to: give --measured, --frf or --decay");
  }
  UpdateStates states = read_update_states(options.data, context);
  ident::UpdateResult result;
  Json json = fitted_json(states, options, context, result);
  auto& scenes = result.scenes;
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    for (std::size_t m = 0; m < scenes[s].members.size(); ++m) {
      scenes[s].members[m].segments = states.segments[s][m];  // as its file asks for
    }
  }
  if (context.at_hand) {
    context.at_hand->covariance = result.covariance;
    context.at_hand->fitted_scenes = scenes;
  } else {
    json["scenes"] = write_scenes(options, states, scenes, context);
  }
  return json;
}

describe::Options options_of(UpdateCommand& c) {
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
      band("--band", c.data.band_low_hz, c.data.band_high_hz,
           "Lines and modes of FRFs, decays and UFF 55 that count"),
      option("--free", c.free,
             "Scene parameters to fit: NAME, NAME=TARGET,-TARGET (several that share a value), "
             "NAME@each (one value a state). Default: every member's EI"),
      option("--prior", c.priors, "NAME=VALUE,STD of a free parameter, from other tests"),
      option(
          "--candidates", c.candidates,
          "TOML file of models to compare, [[candidate]] with name and, as needed, scene = "
          "\"FILE\", free = [...], prior = [...]: weights by evidence, averaged parameters; exit "
          "code 4 when none has 90 % of the weight")
          .file(),
      option("--column", c.data.column, "Name of the frequency column"),
      option("--plane", c.data.planes, "Plane of each file: in, out or any")
          .one_of({"in", "out", "any"}),
      option("--stiffness", c.data.stiffness,
             "Table of tension_N, EI_Nm2 and, where known, std, or the JSON result of rigfit "
             "bending: the cables' EI in each state")
          .file(),
      option("--axial", c.axial,
             "JSON result of rigfit axial: EA of all cables, with its uncertainty")
          .file(),
      option("--input", c.inputs,
             "Uncertainty of what is not fitted: TARGET=STD or TARGET=0.5%, several targets with "
             "commas (-TARGET: opposite), `tension` for the cables' reading, @each at the end: "
             "independent in each state. Carried into the parameters and the predictions"),
      option("--assumed-std", c.fit.assumed_relative_std,
             "Relative standard uncertainty of frequencies that come without one")
          .within(1e-9, 1.0),
      option("--model-std", c.fit.model_relative_std,
             "Relative error in frequency that the model itself is allowed")
          .within(0.0, 1.0),
      option("--segments", c.data.segments,
             "Of every member while fitting (default: the scene's); fewer are faster")
          .within(2, 10000),
      option("--starts", c.fit.starts,
             "1: only the answer near the scene's own values is looked for")
          .within(1, 1000),
      option("--hold-out", c.fit.hold_out,
             "Also leave out each state in turn and predict it from the others")
          .excludes("--candidates"),
      option("--out", c.out, "Updated scene").writes()};
}

}  // namespace

Verb update_verb() {
  return verb_of<UpdateCommand>(
      "update", "A scene's uncertain parameters fitted to measured modes",
      "Example:\n"
      "  rigfit update testdata/jalali2021/scenes/beam.toml \\\n"
      "    --measured testdata/jalali2021/table2_beam_frequencies.csv --column bond_graph_Hz \\\n"
      "    --plane in --free beam.EI_z tip.mass --out beam.updated.toml --json fit.json",
      run, true, false, describe::schema_of<ident::UpdateResult>);
}

}  // namespace rigfit::apps
