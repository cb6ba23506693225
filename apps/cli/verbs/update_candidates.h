// `update --candidates FILE` and `--ends WORD...`: several models of the same measured modes, each
// fitted, weighed by its evidence, their parameters averaged (ident/update/model_candidates.h).
//
// FILE is TOML, one table [[candidate]] each (apps/README.md, "Choose between models"). Nodes that
// `supports` puts on "springs" keep their place and their twist about the member's axis, and share
// one rotational stiffness about both axes across it, the parameter "springs"; on "own springs"
// each has one of its own, NODE.springs. `free` and `prior` stand beside --free and --prior;
// `scene`, relative to the file, takes the place of SCENE.
#pragma once

#include <string>
#include <vector>

#include "apps/campaign_file/update_data.h"
#include "apps/cli/verb.h"
#include "ident/update/model_candidates.h"

namespace rigfit::apps {

struct UpdateCommand {
  UpdateData data;
  std::vector<double> band;
  std::vector<std::string> free, priors, inputs, aims;
  std::string candidates;         ///< file; empty: none
  std::vector<std::string> ends;  ///< "pinned", "clamped", "springs", "own springs": the same
  std::string out, axial;
  bool axial_damping = false;
  bool hold_out = false;
  int starts = 4;
  double assumed_std = 0.01, model_std = 0, frf_model_std = 0, shape_std = 0;
  double stiffness_common_std = 0;
};

[[nodiscard]] describe::Options options_of(UpdateCommand& command);

/// A candidate with what is fitted in it: names as for --free and --prior.
struct NamedModel {
  std::string name;
  UpdateStates states;
  std::vector<std::string> free, priors;
};

/// The candidates of `command.candidates` or `command.ends`. `states`: as the command gives them.
/// Throws UsageError, document::DocumentError, model::SceneError and what read_update_states does.
[[nodiscard]] std::vector<NamedModel> candidate_models(const UpdateCommand& command,
                                                       const UpdateStates& states,
                                                       VerbContext& context);

/// `candidates[]` and `averaged[]`; prints them and refuses where no candidate has 90 % of the
/// weight.
[[nodiscard]] Json candidates_json(const ident::CandidateComparison& comparison,
                                   VerbContext& context);

}  // namespace rigfit::apps
