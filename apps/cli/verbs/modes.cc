// rigfit modes: static equilibrium of a scene, then its natural modes.

#include "apps/cli/verbs/all.h"
#include "model/linear/modal_analysis.h"

namespace rigfit::apps {
namespace {

struct ModesCommand {
  std::string scene;
  model::ModesOptions modes;
  bool shapes = false;
};

Json run(ModesCommand& options, VerbContext& context) {
  const model::Scene scene = scene_of(options.scene, context);
  options.modes.shapes = options.shapes || context.plots;
  const model::ModalAnalysis analysis = model::analyse_modes(scene, options.modes);

  Json result{{"title", scene.title},
              {"modes", Json::array()},
              {"equilibrium", describe::json_of(analysis.equilibrium)}};
  if (analysis.equilibrium.status != model::EquilibriumStatus::converged) {
    context.fail(analysis.equilibrium.reason, options.scene);
    return result;
  }
  for (const auto& mode : analysis.modes) {
    Json& json = result["modes"].emplace_back(describe::json_of(mode));
    json["sensors"] = Json::object();
    for (Eigen::Index s = 0; s < mode.sensor_shape.size(); ++s) {
      json["sensors"][scene.sensors[static_cast<std::size_t>(s)].name] = mode.sensor_shape[s];
    }
    if (options.shapes) json["shape"] = describe::json_of(mode.shape);
  }
  result["relative_error_estimate"] = analysis.relative_error_estimate;
  result["frequencies"] = analysis.extrapolated ? "extrapolated" : "chain";
  result["complete"] = analysis.complete;
  result["modelled"] = {{"kept", analysis.kept},
                        {"left_out", describe::json_of(analysis.left_out)},
                        {"unknowns", analysis.unknowns}};
  if (!analysis.complete) {
    context.warn("modes_not_counted", "a Sturm count does not agree with the modes found",
                 options.scene);
  }
  if (options.modes.band_hz && analysis.modes.empty()) {
    context.warn("no_modes", "no natural frequency lies in the band", options.scene);
  }
  for (const auto& one : analysis.left_out) {
    if (one.what.find("section inertia") == std::string::npos ||
        !(one.relative_error > scene.accuracy)) {
      continue;
    }
    context.warn("section_inertia",
                 fmt::format("lower the highest frequencies of stocky beams by hand: {}, which the "
                             "model leaves out, take up to about {:.2g} % off them (radius of "
                             "gyration from EI / EA)",
                             one.what, 100 * one.relative_error),
                 options.scene);
  }
  if (analysis.relative_error_estimate > scene.accuracy) {
    context.warn("segments_too_few",
                 fmt::format("the frequencies' relative error is about {:.2g}, more than the "
                             "scene's accuracy of {:.2g}: use more segments or \"auto\"",
                             analysis.relative_error_estimate, scene.accuracy),
                 options.scene);
  }
  warn_of_mass(scene, options.scene, context);
  auto& out = context.out;
  describe::print(out, describe::sheet_of(analysis.equilibrium));
  out << '\n';
  describe::print(out, describe::table_of(analysis.modes));
  if (analysis.extrapolated) {
    out << "\nfrequencies extrapolated to vanishing segments; shapes of the segments above\n";
  }
  out << fmt::format("\n{} unknowns, relative error of a frequency at most about {:.2g}; {}\n",
                     analysis.unknowns, analysis.relative_error_estimate,
                     analysis.complete ? "a Sturm count shows that none was missed"
                                       : "not proved that none was missed");
  if (context.plots) context.plots->add(shapes_pictures("shapes", "", scene, analysis));
  return result;
}

describe::Options options_of(ModesCommand& c) {
  return {
      option("scene", c.scene, "Scene file (TOML)").required(),
      option("--count", c.modes.count, "The first N modes").within(1, 10000),
      option("--band", c.modes.band_hz, "All modes between two frequencies").excludes("--count"),
      option("--segments", c.modes.segments, "Segments of every member, instead of the scene's")
          .within(2, 100000),
      choice("--torsion", c.modes.torsion, {"auto", "off", "on"},
             "Model torsion: where needed, never or always"),
      option("--shapes", c.shapes, "Mode shapes at every node in the JSON result")};
}

}  // namespace

Verb modes_verb() {
  return verb_of<ModesCommand>(
      "modes", "Static equilibrium of a scene, then its natural modes",
      "Example:\n  rigfit modes testdata/jalali2021/scenes/cable.toml --count 6 --json modes.json",
      run, true, false, []() -> Json {
        return describe::schema_of_keys(
            {{"modes", describe::schema_of<std::vector<model::NaturalMode>>()},
             {"equilibrium", describe::schema_of<decltype(model::ModalAnalysis::equilibrium)>()}});
      });
}

}  // namespace rigfit::apps
