// rigfit predict: parameters of a fit, with their covariance, in another scene.

#include <complex>
#include <numbers>

#include "apps/campaign_file/measured_modes.h"
#include "apps/cli/verbs/all.h"
#include "ident/predict/scene_prediction.h"
#include "model/scene/sensor_quantity.h"
#include "signal/numerics/numbers.h"
#include "signal/writers/write_csv.h"

namespace rigfit::apps {
namespace {

struct PredictCommand {
  std::string scene;
  std::string from, measured, column, plane = "any", frf, response;
  std::vector<std::string> maps, inputs;
  describe::Band band_hz;
  ident::PredictionOptions modes;
  ident::ResponsePredictionOptions motion;
  int lines = 400;
  bool accept_fit = false;

  PredictCommand() { motion.response.sampling = {.duration_s = 2, .rate_hz = 500}; }
};

constexpr const char* kPredictExample =
    "Example: the beam of a rig, fitted with its cables on, by itself\n"
    "  rigfit update rig.toml --measured rig.csv --free beam.EI_z --json fit.json\n"
    "  rigfit predict beam.toml --from fit.json --count 5 --measured beam.csv";

/// "NAME=TARGET[,-TARGET...]": what a parameter of the fit is called in the scene.
void apply_maps(const std::vector<std::string>& maps, ident::FittedParameters& fitted) {
  for (const auto& text : maps) {
    const auto [name, list] = named_text("--map", text, "NAME=TARGET[,-TARGET...]");
    const auto known = std::ranges::find(fitted.parameters, name, &ident::KnownParameter::name);
    if (known == fitted.parameters.end())
      throw UsageError("--map: the fit has no parameter " + name);
    auto targets = signed_names("--map", list);
    known->targets = std::move(targets.names);
    known->factors = std::move(targets.signs);
  }
}

/// Adds the inputs of `--input` and says what became of each.
std::vector<ident::AddedInput> add_inputs(const model::Scene& scene, const PredictCommand& command,
                                          VerbContext& context, ident::FittedParameters& fitted) {
  std::vector<ident::SceneInput> inputs;
  for (const auto& text : command.inputs) {
    const auto given =
        named_numbers("--input", text, "NAME=STD, NAME=0.5% or NAME=VALUE,STD", 1, 2, true);
    auto& input = inputs.emplace_back();
    input.name = given.name;
    if (given.numbers.size() > 1) input.value = given.numbers[0];
    input.relative = given.relative;
    input.std = given.numbers.back();
  }
  auto added = ident::add_scene_inputs(scene, inputs, fitted);
  for (const auto& one : added) {
    if (!one.fitted) continue;
    context.warn("input_is_fitted",
                 one.name + " is a parameter of the fit, whose value and uncertainty are used",
                 command.scene);
  }
  std::erase_if(added, [](const ident::AddedInput& one) { return one.fitted; });
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

/// FRFs from every load to every sensor: magnitude, phase, 95 % interval of the magnitude.
void write_frfs(const PredictCommand& command, const model::Scene& scene,
                const ident::FittedParameters& fitted, const ident::ModePrediction& prediction,
                VerbContext& context) {
  const auto [low, high] =
      command.band_hz.value_or(std::pair(0.2 * prediction.modes.front().frequency_hz.value,
                                         1.2 * prediction.modes.back().frequency_hz.value));
  const auto frfs =
      ident::predict_frfs(scene, fitted, Eigen::VectorXd::LinSpaced(command.lines, low, high));
  signal::Recording table;
  table.time_s = frfs.frequency_hz;
  for (std::size_t s = 0; s < scene.sensors.size(); ++s) {
    for (std::size_t l = 0; l < scene.loads.size(); ++l) {
      const auto name = fmt::format("{} / {}", scene.sensors[s].name, scene.loads[l].name);
      const auto row = static_cast<Eigen::Index>(s), column = static_cast<Eigen::Index>(l);
      Eigen::MatrixXd values(frfs.frequency_hz.size(), 4);
      for (std::size_t k = 0; k < frfs.H.size(); ++k) {
        const auto h = frfs.H[k](row, column);
        values.row(static_cast<Eigen::Index>(k)) << std::abs(h), frfs.low[k](row, column),
            frfs.high[k](row, column), std::arg(h) * 180 / std::numbers::pi;
      }
      add_column(table, "|H| " + name, "", values.col(0));
      add_column(table, "low " + name, "", values.col(1));
      add_column(table, "high " + name, "", values.col(2));
      add_column(table, "phase " + name + " (deg)", "", values.col(3));
    }
  }
  context.write(command.frf, signal::csv_text(table, {}, 8, "frequency (Hz)"));
}

/// Time, then the value and its 95 % interval of every sensor.
Json write_response(PredictCommand& command, const model::Scene& scene,
                    const ident::FittedParameters& fitted, VerbContext& context) {
  for (const auto& load : scene.loads) {
    if (load.kind != model::Load::Kind::record) continue;
    throw UsageError("--response: hits and releases can be predicted; a record is " + load.name);
  }
  command.motion.response.segments = command.modes.segments;
  command.motion.seed = context.seed;
  const auto prediction = ident::predict_response(scene, fitted, command.motion);
  const auto& response = prediction.response;
  if (!response.completed) {
    throw Refused("--response: " + (response.reason.empty() ? "no response" : response.reason),
                  "no_response");
  }
  if (prediction.low.size() == 0) {
    throw Refused("--response: too few draws of the parameters have a response", "no_response");
  }
  signal::Recording table;
  table.sample_rate_hz = response.rate_hz;
  for (std::size_t s = 0; s < scene.sensors.size(); ++s) {
    const auto& sensor = scene.sensors[s];
    const auto column = static_cast<Eigen::Index>(s);
    for (const auto& [what, of] : {std::pair{"", &response.samples},
                                   {"low ", &prediction.low},
                                   {"high ", &prediction.high}}) {
      add_column(table, what + sensor.name, model::described(sensor.quantity).unit,
                 of->col(column));
    }
  }
  context.write(command.response, signal::csv_text(table, {}, 8));
  context.out << fmt::format("\nresponse: {} samples at {:g} Hz by {}, interval from {} draws\n",
                             response.samples.rows(), response.rate_hz,
                             model::name_of(response.solver), prediction.samples);
  return {{"samples", response.samples.rows()},
          {"sample_rate_hz", response.rate_hz},
          {"solver", model::name_of(response.solver)},
          {"draws", prediction.samples}};
}

Json run(PredictCommand& command, VerbContext& context) {
  const model::Scene scene = scene_of(command.scene, context);
  context.input(command.from);
  auto fitted = read_fit(command.from, command.accept_fit, context);
  apply_maps(command.maps, fitted);
  if (fitted.parameters.empty()) throw Refused("the fit identifies no parameter", "no_parameter");
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
    context.warn("parameter_not_in_scene",
                 name + " of the fit is none of this scene's parameters: left out", command.scene);
  }
  context.out << fmt::format("parameters of the fit in this scene: {}\n\n",
                             fmt::join(prediction.used, " "));
  describe::print(context.out, describe::table_of(prediction.modes));
  if (!command.measured.empty()) json["measured"] = compared_json(command, prediction, context);
  const bool moves = !command.frf.empty() || !command.response.empty();
  if (moves && (scene.loads.empty() || scene.sensors.empty())) {
    throw UsageError("--frf and --response: the scene has no load or no sensor");
  }
  if (!command.frf.empty()) write_frfs(command, scene, fitted, prediction, context);
  if (!command.response.empty()) {
    json["response"] = write_response(command, scene, fitted, context);
  }
  return json;
}

describe::Options options_of(PredictCommand& c) {
  return {
      option("scene", c.scene, "Scene file (TOML)").required(),
      option("--from", c.from, "JSON result of `rigfit update`").required(),
      option("--map", c.maps,
             "What a parameter of the fit is called here: NAME=TARGET[,-TARGET...]"),
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
      option("--plane", c.plane, "Plane of the measured modes").one_of({"in", "out", "any"}),
      option("--frf", c.frf, "FRFs with their 95 % intervals as a table").writes(),
      option("--band", c.band_hz, "Band of the FRFs"),
      option("--lines", c.lines, "Frequency lines of the FRFs").within(2, 100000),
      option("--response", c.response,
             "Response to the scene's loads with its 95 % interval as a table")
          .writes(),
      option("--duration", c.motion.response.sampling.duration_s, "Length of the response", "s")
          .within(1e-6, 3600),
      option("--rate", c.motion.response.sampling.rate_hz, "Sample rate of the response", "Hz")
          .within(1e-3, 1e6)};
}

}  // namespace

Verb predict_verb() {
  return verb_of<PredictCommand>(
      "predict",
      "Modes, FRFs and responses of another scene with the parameters of a fit, with intervals",
      kPredictExample, run);
}

}  // namespace rigfit::apps
