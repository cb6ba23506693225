// Figures of the model against a hammer test: FRFs, and the response to a hit as it was recorded.
#pragma once

#include <string>
#include <vector>

#include "apps/report/modal/modal_states.h"
#include "apps/report/page/report_part.h"
#include "ident/campaign/modal/model_answers.h"

namespace rigfit::apps {

using ident::ModelVersion;

/// Magnitudes of the test with their band, and of every version; empty series when nothing could be
/// computed.
[[nodiscard]] Plot frf_overlay_plot(const std::string& id, const ident::ModalTestState& recorded,
                                    const Instrumented& rig,
                                    const std::vector<ModelVersion>& versions);

/// What a response computation did and left out, in words.
[[nodiscard]] ModelCost response_cost(const std::string& what, const model::ResponseResult& result);

}  // namespace rigfit::apps
