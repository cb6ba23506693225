// The verbs, each in the file of its name, and what nearly every one of them uses.
#pragma once

#include "apps/campaign/campaign.h"
#include "apps/campaign_file/recordings.h"
#include "apps/cli/plots/plot_option.h"
#include "apps/cli/verb.h"
#include "apps/describe/json_of.h"
#include "apps/describe/sheet.h"
#include "apps/report/figures/figures.h"
#include "apps/results/results_json.h"
#include "model/linear/natural_mode.h"
#include "model/scene/scene.h"
#include "signal/recording/recording.h"

namespace rigfit::ident {
struct FittedParameters;
}

namespace rigfit::apps {

Verb axial_verb();
Verb bench_verb();
Verb bending_verb();
Verb decay_verb();
Verb export_verb();
Verb frf_verb();
Verb inspect_verb();
Verb modal_verb();
Verb modes_verb();
Verb new_verb();
Verb plan_verb();
Verb predict_verb();
Verb report_verb();
Verb resample_verb();
Verb respond_verb();
Verb synthesize_verb();
Verb tension_verb();
Verb update_verb();

/// Writes a file of results where one is asked for, and names it in the text and the document.
void write_result(const std::string& file, const std::function<std::string()>& content,
                  const char* what, const char* key, Json& result, VerbContext& context);

/// Warns where the cables' mass per length may be that of two states that differ.
void warn_of_mass(const model::Scene& scene, const std::string& file, VerbContext& context);

/// Values and covariance of the parameters that a fit's JSON result identifies; warns of the others
/// and of a fit with several answers, carries its findings on, and refuses where it ended with 4 or
/// 5 and is not `accepted`. `lines`, where given, gets a line of each with its 95 % interval.
/// Throws model::SceneError where the file is no such result.
[[nodiscard]] ident::FittedParameters read_fit(const std::string& path, bool accepted,
                                               VerbContext& context,
                                               std::vector<std::string>* lines = nullptr);

/// The options of a hammer test, of the verbs that begin with one.
struct ImpactCommand {
  std::vector<std::string> files;
  ident::HammerTestOptions hammer;
  std::vector<std::string> struck;  ///< point struck in each file; empty: one point in all
};

/// Those of the test, without the files.
[[nodiscard]] describe::Options options_of(ImpactCommand& command);

struct ImpactRun {
  /// The points struck and the recordings of each; one without a name unless the hammer roves.
  std::vector<signal::StruckPoint> places;
  ident::HammerTest test;
};

/// Reads the files and analyses the test. Every finding becomes a warning. Throws UsageError for
/// options that make no sense, Refused when there is no hit at all; when all hits were rejected the
/// FRFs are empty and `context.refuse` has said why and what can be had.
[[nodiscard]] ImpactRun run_impact_test(VerbContext& context, const ImpactCommand& command);

/// Adds a column to a table that is written as CSV.
void add_column(signal::Recording& table, std::string name, const std::string& unit,
                Eigen::VectorXd samples);

}  // namespace rigfit::apps
