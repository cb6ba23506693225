#include "apps/cli/verbs/all.h"

#include "model/scene/actual_state.h"

namespace rigfit::apps {

Verbs all_verbs() {
  return {inspect_verb(), resample_verb(), bending_verb(), axial_verb(),      decay_verb(),
          frf_verb(),     modal_verb(),    modes_verb(),   respond_verb(),    update_verb(),
          tension_verb(), predict_verb(),  plan_verb(),    synthesize_verb(), export_verb(),
          bench_verb(),   new_verb(),      report_verb()};
}

void write_result(const std::string& file, const std::function<std::string()>& content,
                  const char* what, const char* key, Json& result, VerbContext& context) {
  if (file.empty()) return;
  context.write(file, content());
  context.out << what << ": " << file << '\n';
  result[key] = file;
}

void warn_of_mass(const model::Scene& scene, const std::string& file, VerbContext& context) {
  const double strain = model::undecided_mass(scene);
  if (strain == 0) return;
  context.warn(
      "mass_of",
      fmt::format("say mass_of = \"installed\" or \"unstretched\" of the cables: which one "
                  "changes the mass by {:.2g} %, frequencies by half of that",
                  100 * strain),
      file);
}

describe::ByName energy_by_member(const model::NaturalMode& mode, const model::Scene& scene) {
  describe::ByName parts;
  for (std::size_t m = 0; m < mode.kinetic_energy.size(); ++m) {
    parts.all.emplace_back(scene.members[m].name, mode.kinetic_energy[m]);
  }
  return parts;
}

void add_column(signal::Recording& table, std::string name, const std::string& unit,
                Eigen::VectorXd samples) {
  signal::Channel column;
  column.name = std::move(name);
  column.unit = column.source_unit = unit;
  column.samples = std::move(samples);
  table.channels.push_back(std::move(column));
}

}  // namespace rigfit::apps
