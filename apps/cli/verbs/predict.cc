// rigfit predict: parameters of a fit, with their covariance, in another scene.

#include "apps/campaign_file/measured_modes.h"
#include "apps/cli/verbs/all.h"
#include "apps/describe/json_of.h"
#include "ident/predict/scene_prediction.h"

namespace rigfit::apps {
namespace {

struct PredictCommand {
  std::string scene;
  std::string from, measured, column, plane = "any";
  std::vector<std::string> maps, inputs;
  ident::PredictionOptions modes;
  bool accept_fit = false;
};

constexpr const char* kPredictExample =
    "Example: the beam of a rig, fitted with its cables on, by itself\n"
    "  rigfit update rig.toml --measured rig.csv --free beam.EI_z --json fit.json\n"
    "  rigfit predict beam.toml --from fit.json --count 5 --measured beam.csv";

/// "NAME=TARGET[,-TARGET...]": what a parameter of the fit is called in the scene; "NAME=": none.
void apply_maps(const std::vector<std::string>& maps, ident::FittedParameters& fitted) {
  for (const auto& text : maps) {
    const auto [name, list] = named_text("--map", text, "NAME=TARGET[,-TARGET...] or NAME=", true);
    const auto known = std::ranges::find(fitted.parameters, name, &ident::KnownParameter::name);
    if (known == fitted.parameters.end())
      throw UsageError("--map: the fit has no parameter " + name);
    known->targets = {""};
    if (list.empty()) continue;
    auto targets = signed_names("--map", list);
    known->targets = std::move(targets.names);
    known->factors = std::move(targets.signs);
  }
}

/// Adds the inputs of `--input` and says what became of each.
std::vector<ident::SceneInput> add_inputs(const model::Scene& scene, const PredictCommand& command,
                                          VerbContext& context, ident::FittedParameters& fitted) {
  std::vector<ident::SceneInput> inputs;
  for (const auto& text : command.inputs) {
    const auto given =
        named_numbers("--input", text, "NAME=STD, NAME=0.5% or NAME=VALUE,STD", 1, 2, true);
    inputs.push_back({given.name, {}, given.numbers.back(), given.relative});
    if (given.numbers.size() > 1) inputs.back().value = given.numbers[0];
  }
  auto added = ident::add_scene_inputs(scene, std::move(inputs), fitted);
  for (const auto& one : added) {
    if (!one.fitted) continue;
    context.warn("input_is_fitted",
                 one.name + " is fitted: --map NAME= of the fit's parameter keeps this input",
                 command.scene);
  }
  std::erase_if(added, [](const ident::SceneInput& one) { return one.fitted; });
  return added;
}

Json compared_json(const PredictCommand& command, const ident::ModePrediction& prediction,
                   VerbContext& context) {
  std::vector<ident::MeasuredMode> measured;
  for (auto& row : measured_modes(command.measured, command.column, plane_named(command.plane),
                                  prediction.scene, context)) {
    measured.push_back(std::move(row.mode));
  }
  const auto compared = ident::held_against(prediction, measured);
  context.out << '\n';
  describe::print(context.out, describe::table_of(compared));
  return describe::json_of(compared);
}

Json run(PredictCommand& command, VerbContext& context) {
  const model::Scene scene = scene_of(command.scene, context);
  context.input(command.from);
  auto fitted = read_fit(command.from, command.accept_fit, context);
  apply_maps(command.maps, fitted);
  if (fitted.parameters.empty()) throw Refused("the fit identifies no parameter", "no_parameter");
  context.tell(ident::replaced_states(scene, fitted));
  const auto inputs = add_inputs(scene, command, context, fitted);
  ident::ModePrediction prediction;
  try {
    prediction = ident::predict_modes(scene, fitted, command.modes);
    for (const auto& one : inputs) std::erase(prediction.used, one.name);
    if (prediction.used.empty()) {
      throw std::invalid_argument("no parameter of the fit is one of this scene's");
    }
  } catch (const std::invalid_argument& error) {
    throw Refused(std::string(error.what()) + "; --map NAME=TARGET says what one is called here",
                  "parameter_not_in_scene");
  }
  Json json{{"title", scene.title},
            {"parameters_used", prediction.used},
            {"parameters_not_used", prediction.not_used}};
  if (!inputs.empty()) json["uncertain_inputs"] = describe::json_of(inputs);
  json["modes"] = describe::json_of(prediction.modes);
  if (prediction.modes.empty()) {
    context.fail(prediction.equilibrium.reason, command.scene);
    return json;
  }
  for (const auto& name : prediction.not_used) {
    if (std::ranges::count(command.maps, name + "=") > 0) continue;
    context.warn("parameter_not_in_scene",
                 name + " of the fit is none of this scene's parameters: left out", command.scene);
  }
  context.out << fmt::format("parameters of the fit in this scene: {}\n\n",
                             fmt::join(prediction.used, " "));
  describe::print(context.out, describe::table_of(prediction.modes));
  if (!command.measured.empty()) json["measured"] = compared_json(command, prediction, context);
  return json;
}

describe::Options options_of(PredictCommand& c) {
  return {
      option("scene", c.scene, "Scene file (TOML)").required(),
      option("--from", c.from, "JSON result of `rigfit update`").required(),
      option("--map", c.maps,
             "What a parameter of the fit is called here, NAME=TARGET[,-TARGET...], or NAME= to "
             "keep the scene's own value"),
      option(
          "--input", c.inputs,
          "A number of this scene that is known to a standard uncertainty: NAME=STD, NAME=0.5% or "
          "NAME=VALUE,STD; one of the same name in the fit is the same quantity and counts once"),
      option("--accept-fit", c.accept_fit,
             "Predict from a fit that was refused or did not converge (exit code 4 or 5)"),
      option("--count", c.modes.count, "The first N modes").within(1, 1000),
      option("--segments", c.modes.segments, "Segments of every member, instead of the scene's")
          .within(2, 100000),
      option("--measured", c.measured,
             "Table of measured frequencies, or universal file of modes (UFF 55), to compare with"),
      option("--column", c.column, "Column of the frequencies in the table"),
      option("--plane", c.plane, "Plane of the measured modes").one_of({"in", "out", "any"})};
}

}  // namespace

Verb predict_verb() {
  return verb_of<PredictCommand>(
      "predict", "Modes of another scene with the parameters of a fit, with intervals",
      kPredictExample, run, false, false, []() -> Json {
        return describe::schema_of_keys(
            {{"modes", describe::schema_of<decltype(ident::ModePrediction::modes)>()}});
      });
}

}  // namespace rigfit::apps
