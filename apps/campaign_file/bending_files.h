// Files of bending tests: load-deflection records and tables, tables of EI over tension, and what
// `rigfit bending --json` wrote. The verb, the report and what takes EI(T) read them here.
#pragma once

#include "apps/campaign_file/recordings.h"
#include "apps/cli/verb_context.h"
#include "ident/campaign/modal/modal_model.h"
#include "ident/campaign/single_tests/bending_campaign.h"
#include "signal/recording/recording.h"

namespace rigfit::apps {

/// The first channel whose name begins, in any case of letters, as the first of these that one
/// does; null: none.
[[nodiscard]] const signal::Channel* channel_like(const signal::Recording& recording,
                                                  const std::vector<std::string>& beginnings);

/// By names ("tension", "load", "deflection" ...), else by their quantities: one displacement and a
/// force (or mass) that rises and falls with it; of two forces the one that does so least, or that
/// hardly changes, is the tension. Empty: the recording is something else.
[[nodiscard]] std::optional<LoadDeflection> load_deflection(const signal::Recording& recording);

/// Names of columns; empty: the first whose name begins in one of the usual ways, such as
/// "tension", "preload"; "load", "force", "Q"; "deflection", "displacement", "lvdt", "d".
struct BendingColumns : LoadDeflection {
  /// A beam without tension: no tension column is looked for. Loads may be masses (dead weights).
  bool without_tension = false;
  /// How a person names one, with {} for tension, load or deflection.
  std::string remedy = "name it with --{}";
};

/// A recording or table as every reader of it; times and their faults do not matter here and are
/// not noted. Inputs and notes go to the context.
[[nodiscard]] signal::Recording load_bending_file(const std::filesystem::path& path,
                                                  VerbContext& context);
/// Takes notes out that only matter where time does.
void drop_time_notes(signal::Recording& recording);

/// EI values where there is a column of EI (with std, or low and high), else a record. A column
/// without a unit is taken as SI, with a warning. Throws signal::RecordingError with file, column,
/// row and remedy for columns that are missing, of another quantity, or EI that is not positive.
[[nodiscard]] ident::BendingSource bending_source(const signal::Recording& recording,
                                                  const BendingColumns& columns,
                                                  std::vector<Finding>& warnings);

/// EI(T) from a table of it, or from what `rigfit bending --json FILE` wrote (.json): its tests
/// that gave an EI, by the same laws. Throws model::SceneError, signal::RecordingError.
[[nodiscard]] ident::StiffnessCurve read_stiffness_curve(const std::filesystem::path& path,
                                                         VerbContext& context);

/// All cables take tension, EI and EA.
[[nodiscard]] ident::SceneUse use_of_cables(const model::Scene& scene);

/// The scene with its cables at a tension, and with the EI that the curve, if it is not empty, has
/// there; warns outside the tested tensions.
[[nodiscard]] model::Scene cables_at(const model::Scene& scene, double tension_N,
                                     const ident::StiffnessCurve& curve, const std::string& file,
                                     VerbContext& context);

}  // namespace rigfit::apps
