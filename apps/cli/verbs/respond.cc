// rigfit respond: the time response of a scene at its sensors.

#include "apps/cli/verbs/all.h"
#include "model/response/response.h"
#include "model/scene/sensor_quantity.h"
#include "signal/writers/writers.h"

namespace rigfit::apps {
namespace {

struct RespondCommand {
  std::string scene, out;
  model::ResponseOptions response;

  RespondCommand() { response.sampling = {.duration_s = 0, .rate_hz = 0}; }
};

/// The force of a recorded load, its file's only channel; without a unit it is in N.
model::ForceHistory read_force(const model::Load& load, const std::string& scene_file,
                               VerbContext& context) {
  const signal::Recording recording = load_recording(load.file, context);
  const auto& force = recording.channels.front();
  const bool is_force =
      force.quantity == signal::Quantity::force || force.quantity == signal::Quantity::unknown;
  const bool timed = recording.time_s.size() > 0 || recording.sample_rate_hz > 0;
  for (const auto& [there, problem] :
       {std::pair{recording.channels.size() > 1, "has more than one channel"},
        {!is_force, "has no force channel"},
        {!force.samples.allFinite(), "has missing samples"},
        {!timed, "has neither a time column nor a rate"}}) {
    if (!there) continue;
    throw model::SceneError({scene_file, 0, 0, "load.file"}, load.file + ": " + problem,
                            "give it columns of time (s) and force (N) without gaps");
  }
  model::ForceHistory history{{}, {force.samples.begin(), force.samples.end()}};
  for (Eigen::Index i = 0; i < force.samples.size(); ++i) {
    history.time_s.push_back(recording.time_at(i));
  }
  return history;
}

/// The sensors' channels over time.
signal::Recording recording_of(const model::Scene& scene, const model::ResponseResult& response) {
  signal::Recording recording;
  recording.sample_rate_hz = response.rate_hz;
  for (std::size_t s = 0; s < scene.sensors.size(); ++s) {
    add_column(recording, response.sensors[s], model::described(scene.sensors[s].quantity).unit,
               response.samples.col(static_cast<Eigen::Index>(s)));
  }
  return recording;
}

Json run(RespondCommand& options, VerbContext& context) {
  const model::Scene scene = scene_of(options.scene, context);
  auto& wanted = options.response;
  const double rows = wanted.sampling.duration_s * wanted.sampling.rate_hz;
  if (!(rows >= 1)) throw UsageError("--duration times --rate must give at least one sample");
  if (rows > 5e7) throw UsageError("more than 50 million samples: lower --rate or --duration");
  if (scene.sensors.empty()) {
    throw model::SceneError({scene.file, 0, 0, "sensor"}, "the scene has no sensor",
                            "add a [[sensor]] with the member and position to look at");
  }
  wanted.resolution_estimate = true;
  wanted.records.resize(scene.loads.size());
  for (std::size_t l = 0; l < scene.loads.size(); ++l) {
    if (scene.loads[l].kind != model::Load::Kind::record) continue;
    wanted.records[l] = read_force(scene.loads[l], scene.file, context);
  }
  if (scene.loads.empty()) {
    context.warn("no-load", "the scene has no load: it stays at rest", options.scene);
  }

  const model::ResponseResult response = model::simulate_response(scene, wanted);
  if (response.impossible) throw Refused(options.scene + ": " + response.reason);
  if (!response.completed) throw NotConverged(options.scene + ": " + response.reason);

  warn_of_mass(scene, options.scene, context);
  if (response.linear_error > 0) {
    context.warn(
        "motion_not_linear",
        fmt::format("use --solver auto: the motion shifts frequencies by {:.2g} %, so that "
                    "the linear response errs by about {:.2g} %",
                    100 * response.frequency_shift, 100 * response.linear_error),
        options.scene);
  }

  Json result = describe::json_of(response);
  result["samples"] = response.samples.rows();
  result["sensors"] = describe::json_list(recording_of(scene, response).channels, [](auto& one) {
    const auto& x = one.samples;
    return Json{{"name", one.name},
                {"unit", one.unit},
                {"min", x.minCoeff()},
                {"max", x.maxCoeff()},
                {"rms", x.norm() / std::sqrt(x.size())}};
  });
  Json segments = Json::array();
  for (std::size_t m = 0; m < response.segments.size(); ++m) {
    segments.push_back({{"member", response.members[m]}, {"segments", response.segments[m]}});
  }
  result["modelled"] = {
      {"motion", response.motion},       {"unknowns", response.unknowns},
      {"segments", std::move(segments)}, {"resolution_error", response.resolution_error},
      {"kept", response.kept},           {"left_out", describe::json_of(response.left_out)}};
  context.out << scene.title << '\n';
  describe::print(context.out, describe::sheet_of(response));
  if (context.plots) context.plots->add(response_plots("response", scene, response));
  if (context.at_hand) context.at_hand->samples = response.samples;
  const auto csv = [&] { return signal::csv_text(recording_of(scene, response), {}, 9); };
  write_result(options.out, csv, "response", "out", result, context);
  return result;
}

describe::Options options_of(RespondCommand& c) {
  auto& r = c.response;
  return {option("scene", c.scene, "Scene file (TOML)").required(),
          option("--duration", r.sampling.duration_s, "Seconds to simulate").required().positive(),
          option("--rate", r.sampling.rate_hz, "Samples a second").required().positive(),
          option("--out", c.out, "CSV: time, then one column a sensor").writes().required(),
          choice("--solver", r.solver, {"auto", "modal", "explicit", "stiff"},
                 "auto: modal when the estimated frequency shift is within the scene's accuracy"),
          choice("--plane", r.space, {"auto", "off"},
                 "Move in the plane of symmetry where nothing pushes the scene out of it"),
          choice("--axial", r.axial, {"auto", "off", "on"},
                 "Axial waves at their own speed; off: slowed (explicit solver)"),
          option("--segments", r.segments, "Segments of every member, instead of the scene's")
              .within(2, 10000)};
}

}  // namespace

Verb respond_verb() {
  return verb_of<RespondCommand>(
      "respond", "Time response of a scene at its sensors: linear or geometrically exact by need",
      "Example:\n"
      "  rigfit respond testdata/scenes/cable-release.toml --duration 10 --rate 2000 "
      "--out response.csv",
      run, true, false, describe::schema_of<model::ResponseResult>);
}

}  // namespace rigfit::apps
