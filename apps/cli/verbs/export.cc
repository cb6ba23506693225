// rigfit export: a scene as the input of other programs.

#include "apps/cli/verbs/all.h"
#include "ident/predict/scene_prediction.h"
#include "model/export/write_calculix.h"
#include "model/export/write_moordyn.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/parameters.h"

namespace rigfit::apps {
namespace {

struct ExportOptions {
  std::string scene, calculix, moordyn, from;
  bool accept_fit = false;
  model::CalculixOptions deck;
};

struct ExportResult {
  std::vector<std::string> files;
  std::vector<model::CalculixMember> members;

  static constexpr auto fields() {
    using T = ExportResult;
    return std::tuple{
        describe::field("files", &T::files, "", "", ""),
        describe::field("members", &T::members, "", "members", "of the CalculiX deck")};
  }
};

Json run(ExportOptions& options, VerbContext& context) {
  if (options.calculix.empty() && options.moordyn.empty()) {
    throw UsageError("give --calculix DIR or --moordyn DIR");
  }
  const std::string stem = std::filesystem::path(options.scene).stem().string();
  model::Scene scene = scene_of(options.scene, context);
  std::vector<std::string> comments;  // each parameter with its 95 % interval
  if (!options.from.empty()) {
    context.input(options.from);
    for (const auto& known :
         read_fit(options.from, options.accept_fit, context, &comments).parameters) {
      model::set_parameter(scene, known.name, known.value);
    }
  }
  model::ModesOptions modes;
  modes.count = 1;
  modes.shapes = false;
  const auto analysis = model::analyse_modes(scene, modes);
  if (analysis.equilibrium.status != model::EquilibriumStatus::converged) {
    throw NotConverged(options.scene +
                       ": no equilibrium to export: " + analysis.equilibrium.reason);
  }
  ExportResult result;
  // `mark` begins a line of comments.
  const auto write_deck = [&](const std::string& folder, const char* end, const char* mark,
                              const auto& deck) {
    for (const auto& note : deck.notes) context.warn("not_exported_exactly", note, options.scene);
    const auto path = std::filesystem::path(folder) / (stem + end);
    make_output_folder(path.parent_path());
    std::string all;
    for (const auto& line : comments) all += fmt::format("{} {}\n", mark, line);
    context.write(path, all + deck.text);
    context.out << fmt::format("wrote {}\n", path.string());
    result.files.push_back(path.string());
  };
  if (!options.moordyn.empty()) {
    write_deck(options.moordyn, ".txt", "!", model::moordyn_input(scene, analysis.equilibrium));
  }
  if (!options.calculix.empty()) {
    const auto deck = model::calculix_deck(scene, analysis.equilibrium, options.deck);
    write_deck(options.calculix, ".inp", "**", deck);
    context.out << fmt::format("run it there with: ccx {}\n", stem);
    result.members = deck.members;
  }
  describe::print(context.out, describe::sheet_of(result));
  return describe::json_of(result);
}

describe::Options options_of(ExportOptions& c) {
  return {option("scene", c.scene, "Scene file (TOML)").required(),
          option("--calculix", c.calculix,
                 "Write a CalculiX deck (prestress, sag, frequencies) to this folder"),
          option("--moordyn", c.moordyn,
                 "Write the cables as a MoorDyn (version 2) input file to this folder"),
          option("--from", c.from,
                 "JSON result of an update: its values, with their intervals in comments"),
          option("--accept-fit", c.accept_fit,
                 "Export a fit that was refused or did not converge (exit code 4 or 5)"),
          option("--count", c.deck.frequencies, "Natural frequencies to ask for").within(1, 1000)};
}
}  // namespace

Verb export_verb() {
  return verb_of<ExportOptions>(
      "export", "Write a scene as input of another program (CalculiX, MoorDyn)",
      "The CalculiX deck's tensions at rest are the scene's; both are printed, with the ratio of "
      "the axial stiffnesses about rest (1 + 1.5 T/EA).\nExample:\n  rigfit export "
      "testdata/jalali2021/scenes/cable.toml --calculix build/ccx",
      run, false, false, describe::schema_of<ExportResult>);
}

}  // namespace rigfit::apps
