// The JSON result of `rigfit update` as what another verb starts from.
#pragma once

#include <string>
#include <vector>

#include "apps/cli/verb_context.h"
#include "ident/predict/scene_prediction.h"

namespace rigfit::apps {

/// Values and covariance of the parameters that the fit identifies; warns of the others and of a
/// fit with several answers, carries its findings on, and refuses where it ended with 4 or 5 and is
/// not `accepted`. `lines`, where given, gets a line of each with its 95 % interval. Throws
/// model::SceneError where the file is no such result.
[[nodiscard]] ident::FittedParameters read_fit(const std::string& path, bool accepted,
                                               VerbContext& context,
                                               std::vector<std::string>* lines = nullptr);

/// "NAME=TARGET[,-TARGET...]": what a parameter of the fit is called in the scene. Throws
/// UsageError.
void apply_maps(const std::vector<std::string>& maps, ident::FittedParameters& fitted);

}  // namespace rigfit::apps
