// rigfit export: a scene as the input of other programs.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "apps/cli/output_file.h"
#include "apps/cli/verbs/all.h"
#include "model/export/write_calculix.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/read_scene.h"

namespace rigfit::apps {
namespace {

struct ExportOptions {
  std::string scene;
  std::string calculix;
  model::CalculixOptions deck;
};

Json run(const ExportOptions& options, VerbContext& context) {
  context.input(options.scene);
  const model::Scene scene = model::read_scene(options.scene);
  model::ModesOptions modes;
  modes.count = 1;
  modes.shapes = false;
  const auto analysis = model::analyse_modes(scene, modes);
  if (analysis.equilibrium.status != model::EquilibriumStatus::converged) {
    throw NotConverged(options.scene +
                       ": no equilibrium to export: " + analysis.equilibrium.reason);
  }
  const auto deck = model::calculix_deck(scene, analysis.equilibrium, options.deck);
  for (const auto& note : deck.notes) context.warn("not_exported_exactly", note, options.scene);
  make_output_folder(options.calculix);
  const std::filesystem::path path =
      std::filesystem::path(options.calculix) /
      (std::filesystem::path(options.scene).stem().string() + ".inp");
  context.write(path, deck.text);
  context.out << fmt::format("wrote {}\nrun it there with: ccx {}\n", path.string(),
                             path.stem().string());
  Json members = Json::array();
  for (const auto& member : deck.members) {
    context.out << fmt::format("{}: {:.6g} N at rest in the deck, {:.6g} N in the scene\n",
                               member.name, member.tension_N, member.scene_tension_N);
    members.push_back({{"member", member.name},
                       {"deck_tension_N", member.tension_N},
                       {"scene_tension_N", member.scene_tension_N},
                       {"axial_stiffness_ratio", member.axial_stiffness_ratio}});
  }
  Json result;
  result["members"] = std::move(members);
  result["files"] = Json::array({path.string()});
  return result;
}

describe::Options options_of(ExportOptions& c) {
  using describe::option;
  return {
      option("scene", c.scene, "Scene file (TOML)").required().type("SCENE"),
      option("--calculix", c.calculix,
             "Write a CalculiX deck (prestress, sag, frequencies) to this folder")
          .required()
          .type("DIR"),
      option("--elements", c.deck.elements_per_member, "Beam elements a member").within(2, 2000),
      option("--count", c.deck.frequencies, "Natural frequencies to ask for").within(1, 1000)};
}
}  // namespace

Verb export_verb() {
  return verb_of<ExportOptions>(
      "export", "Write a scene as input of another program (CalculiX)",
      "The deck's tensions at rest are the scene's; both are printed, with the ratio of the axial "
      "stiffnesses about rest (1 + 1.5 T/EA) in the JSON.\nExample:\n  rigfit export "
      "testdata/jalali2021/scenes/cable.toml --calculix build/ccx",
      [](const ExportOptions& c, VerbContext& context) { return run(c, context); });
}

}  // namespace rigfit::apps
