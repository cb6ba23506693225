// rigfit predict: parameters of a fit, with their covariance, in another scene; and the JSON result
// of a fit as what verbs start from.

#include "apps/campaign_file/measured_modes.h"
#include "apps/cli/verbs/all.h"
#include "ident/predict/scene_prediction.h"
#include "model/scene/scene.h"

namespace rigfit::apps {
namespace {

struct PredictCommand {
  std::string scene;
  std::string from, measured, column, plane = "any";
  std::vector<std::string> maps, inputs;
  ident::PredictionOptions modes;
  bool accept_fit = false;
};

constexpr const char* kWrittenBy = "rigfit update SCENE ... --json FIT.json";

/// What the fit ended with.
void tell_outcome(const Json& json, const std::string& path, bool accepted, VerbContext& context) {
  for (const auto& warning : json.value("warnings", Json::array())) {
    const std::string code = warning.value("code", "");
    if (code != "model_ruled_out" && code != "not_converged") continue;
    context.warn("fit_" + code, "in the fit: " + warning.value("message", ""), path);
  }
  const double exit_code = number_in(json.value("error", Json::object()), "exit_code");
  if (exit_code >= 4 && !accepted) {
    context.refuse("fit_refused",
                   fmt::format("mend the fit, or take it with --accept-fit: it ended with exit "
                               "code {:g}, and its parameters need not be those of the rig",
                               exit_code),
                   path);
  }
  const Json answers = json.value("alternatives", Json::array());
  if (!answers.empty() && number_in(answers.at(0), "weight") < 0.9) {
    context.warn("not_decided",
                 "the fit has several answers; the prediction is of the heaviest one", path);
  }
}

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
  const auto rows = measured_modes(command.measured, command.column, plane_named(command.plane),
                                   prediction.scene, context);
  const auto compared = ident::held_against(prediction, {rows.begin(), rows.end()});
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

ident::FittedParameters read_fit(const std::string& path, bool accepted, VerbContext& context,
                                 std::vector<std::string>* lines) {
  const Json json = read_document(path, "parameters", kWrittenBy);
  try {
    ident::FittedParameters fitted;
    std::vector<std::size_t> kept;  // rows whose parameters are identified
    std::vector<double> std;
    const auto& rows = json["parameters"];
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto name = rows[i].at("name").get<std::string>();
      const auto value = rows[i].at("value").get<double>();
      if (const double known = number_in(rows[i], "std"); std::isfinite(known)) {
        fitted.parameters.push_back({name, value});
        std.push_back(known);
        kept.push_back(i);
      } else {
        context.warn("parameter_without_std",
                     name + " is not identified by the fit: the scene's own value stays", path);
      }
      const double low = number_in(rows[i], "low"), high = number_in(rows[i], "high");
      if (lines != nullptr && std::isfinite(low) && std::isfinite(high)) {
        lines->push_back(
            fmt::format("{} = {:.6g}, 95 %: {:.6g} to {:.6g}", name, value, low, high));
      }
    }
    const Json given = json.value("correlation", Json());
    const auto n = static_cast<Eigen::Index>(kept.size());
    Eigen::MatrixXd correlation = Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto row = kept[static_cast<std::size_t>(i)];
      for (Eigen::Index j = 0; j < n && !given.is_null(); ++j) {
        if (i != j) correlation(i, j) = given.at(row).at(kept[static_cast<std::size_t>(j)]);
      }
      // What the fit's own inputs do to its parameters, from their budgets.
      for (const auto& term : rows[row].value("budget", Json::array())) {
        const double change = number_in(term, "change");
        if (std::isfinite(change)) ident::add_effect(term.value("source", ""), i, change, fitted);
      }
    }
    const auto stds = Eigen::Map<const Eigen::VectorXd>(std.data(), n).asDiagonal();
    fitted.covariance = stds * correlation * stds;
    tell_outcome(json, path, accepted, context);
    return fitted;
  } catch (const Json::exception& error) {
    throw model::SceneError({path, 0, 0, "parameters"},
                            std::string("is no whole result of a fit: ") + error.what(),
                            std::string("give what ") + kWrittenBy + " wrote");
  }
}

Verb predict_verb() {
  return verb_of<PredictCommand>(
      "predict", "Modes of another scene with the parameters of a fit, with intervals",
      kPredictExample, run, false, false, []() -> Json {
        return describe::schema_of_keys(
            {{"modes", describe::schema_of<decltype(ident::ModePrediction::modes)>()}});
      });
}

}  // namespace rigfit::apps
