// rigfit modes: static equilibrium of a scene, then its natural modes.
#include <fmt/format.h>

#include <memory>

#include "apps/cli/at_hand.h"
#include "apps/cli/plots/plot_option.h"
#include "apps/cli/verbs/all.h"
#include "apps/report/figures/figures.h"
#include "model/linear/modal_analysis.h"

namespace rigfit::apps {
namespace {

struct ModesCommand {
  std::string scene;
  int count = 6;
  std::vector<double> band;
  int segments = 0;
  std::string rotary_inertia = "accurate";
  std::string torsion = "auto";
  bool shapes = false;
};

Json vectors(const Eigen::Matrix3Xd& columns) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    list.push_back({columns(0, i), columns(1, i), columns(2, i)});
  }
  return list;
}

Json equilibrium_json(const model::Equilibrium& equilibrium) {
  Json members = Json::array();
  for (const auto& member : equilibrium.members) {
    members.push_back({{"member", member.member},
                       {"sag_m", member.sag_m},
                       {"tension_N", member.tension_N},
                       {"tension_max_N", member.tension_max_N},
                       {"unstretched_length_m", member.unstretched_length_m},
                       {"segments", member.segments}});
  }
  Json out{{"status", model::name_of(equilibrium.status)},
           {"residual", equilibrium.residual},
           {"iterations", equilibrium.iterations},
           {"members", std::move(members)}};
  if (!equilibrium.reason.empty()) out["reason"] = equilibrium.reason;
  return out;
}

Json mode_json(const model::NaturalMode& mode, const model::Scene& scene, bool shapes) {
  Json energy = Json::object();
  for (std::size_t m = 0; m < mode.kinetic_energy.size(); ++m) {
    energy[scene.members[m].name] = mode.kinetic_energy[m];
  }
  Json out{{"frequency_hz", mode.frequency_hz},   {"damping_ratio", mode.damping_ratio},
           {"plane", model::name_of(mode.plane)}, {"family", model::name_of(mode.family)},
           {"kinetic_energy", std::move(energy)}, {"extrapolated_hz", mode.extrapolated_hz}};
  Json sensors = Json::object();
  for (Eigen::Index i = 0; i < mode.sensor_shape.size(); ++i) {
    sensors[scene.sensors[static_cast<std::size_t>(i)].name] = mode.sensor_shape[i];
  }
  out["sensors"] = std::move(sensors);
  if (shapes) {
    Json list = Json::array();
    for (const auto& shape : mode.shape) {
      Json one{{"member", shape.member}, {"displacement", vectors(shape.displacement)}};
      if (shape.twist.size() > 0) {
        one["twist"] =
            std::vector<double>(shape.twist.data(), shape.twist.data() + shape.twist.size());
      }
      list.push_back(std::move(one));
    }
    out["shape"] = std::move(list);
  }
  return out;
}

void print(std::ostream& out, const model::ModalAnalysis& analysis, const model::Scene& scene) {
  out << fmt::format("{:<16} {:>12} {:>12} {:>9}\n", "member", "tension, N", "sag, mm", "segments");
  for (const auto& member : analysis.equilibrium.members) {
    out << fmt::format("{:<16} {:>12.4f} {:>12.4f} {:>9}\n", member.member, member.tension_N,
                       1e3 * member.sag_m, member.segments);
  }
  out << fmt::format("\n{:>4} {:>12} {:>9}  {:<8} {:<7} kinetic energy\n", "mode", "frequency, Hz",
                     "damping", "plane", "family");
  for (std::size_t i = 0; i < analysis.modes.size(); ++i) {
    const auto& mode = analysis.modes[i];
    std::string energy;
    for (std::size_t m = 0; m < mode.kinetic_energy.size(); ++m) {
      if (mode.kinetic_energy[m] < 0.005) continue;
      energy += fmt::format("{}{} {:.0f} %", energy.empty() ? "" : ", ", scene.members[m].name,
                            100 * mode.kinetic_energy[m]);
    }
    out << fmt::format("{:>4} {:>12.5f} {:>9.5f}  {:<8} {:<7} {}\n", i + 1, mode.frequency_hz,
                       mode.damping_ratio, model::name_of(mode.plane), model::name_of(mode.family),
                       energy);
  }
  if (analysis.extrapolated) {
    out << "\nfrequencies extrapolated to vanishing segments; shapes of the segments above\n";
  }
  out << fmt::format("\n{} unknowns, relative error of a frequency at most about {:.2g}; {}\n",
                     analysis.unknowns, analysis.relative_error_estimate,
                     analysis.complete ? "a Sturm count shows that none was missed"
                                       : "not proved that none was missed");
}

Json run(const ModesCommand& options, VerbContext& context) {
  const model::Scene scene = scene_of(options.scene, context);
  model::ModesOptions wanted;
  wanted.count = options.count;
  if (!options.band.empty()) wanted.band_hz = {options.band[0], options.band[1]};
  if (options.segments > 0) wanted.segments = options.segments;
  if (options.rotary_inertia == "rigid_rod") {
    wanted.rotary_inertia = model::RotaryInertia::rigid_rod;
  }
  if (options.torsion != "auto") wanted.torsion = options.torsion == "on";
  wanted.shapes = options.shapes || context.plots;
  const model::ModalAnalysis analysis = model::analyse_modes(scene, wanted);

  Json result{{"title", scene.title}};
  result["modes"] = Json::array();
  result["equilibrium"] = equilibrium_json(analysis.equilibrium);
  if (analysis.equilibrium.status != model::EquilibriumStatus::converged) {
    context.fail(analysis.equilibrium.reason, options.scene);
    return result;
  }
  for (const auto& mode : analysis.modes) {
    result["modes"].push_back(mode_json(mode, scene, options.shapes));
  }
  result["relative_error_estimate"] = analysis.relative_error_estimate;
  result["frequencies"] = analysis.extrapolated ? "extrapolated" : "chain";
  result["complete"] = analysis.complete;
  Json left_out = Json::array();
  for (const auto& one : analysis.left_out) {
    left_out.push_back({{"what", one.what}, {"relative_error", one.relative_error}});
  }
  result["modelled"] = {
      {"kept", analysis.kept}, {"left_out", std::move(left_out)}, {"unknowns", analysis.unknowns}};
  if (!analysis.complete) {
    context.warn("modes_not_counted", "a Sturm count does not agree with the modes found",
                 options.scene);
  }
  if (!options.band.empty() && analysis.modes.empty()) {
    context.warn("empty_band", "no natural frequency lies in the band", options.scene);
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
  print(context.out, analysis, scene);
  if (context.plots) context.plots->add(modes_blocks("shapes", scene, analysis));
  return result;
}

describe::Options options_of(ModesCommand& c) {
  using describe::option;
  return {option("scene", c.scene, "Scene file (TOML)").required().type("SCENE"),
          option("--count", c.count, "The first N modes").type("N").within(1, 10000),
          option("--band", c.band, "All modes between two frequencies", "Hz")
              .type("LO HI")
              .count(2)
              .excludes("--count"),
          option("--segments", c.segments, "Segments of every member, instead of the scene's")
              .type("N")
              .within(2, 100000),
          option("--rotary-inertia", c.rotary_inertia,
                 "Of a segment, and its joints: accurate, or a rigid rod's as in the paper")
              .one_of({"accurate", "rigid_rod"}),
          option("--torsion", c.torsion, "Model torsion: where needed, always or never")
              .one_of({"auto", "on", "off"}),
          option("--shapes", c.shapes, "Mode shapes at every node in the JSON result")};
}

}  // namespace

Verb modes_verb() {
  Verb verb = verb_of<ModesCommand>(
      "modes", "Static equilibrium of a scene, then its natural modes",
      "Example:\n  rigfit modes testdata/jalali2021/scenes/cable.toml --count 6 --json modes.json",
      [](const ModesCommand& c, VerbContext& context) { return run(c, context); });
  verb.draws = true;
  return verb;
}

}  // namespace rigfit::apps
