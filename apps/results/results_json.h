// What tests and fits found, as JSON: walks over the descriptions of the results. The verbs and the
// report's document hold the same. And such documents read again.
#pragma once

#include "apps/cli/verb_context.h"
#include "ident/campaign/modal/modal_campaign.h"
#include "ident/campaign/single_tests/axial_campaign.h"

namespace rigfit::apps {

/// The test's fields and `samples`; of a test without a result the samples only.
[[nodiscard]] Json axial_json(const ident::AxialCampaignResult& result);

/// `hits[]` of a hammer test, accepted and rejected; each with the point `struck` when the hammer
/// roves.
[[nodiscard]] Json hits_json(const std::vector<signal::StruckPoint>& places,
                             const ident::HammerTest& test);

/// A document that the program wrote, with that key. `by`: the command that writes one.
/// Throws model::SceneError for another file.
[[nodiscard]] Json read_document(const std::filesystem::path& path, const char* key,
                                 const char* by);
/// A number of an object; NaN where there is none.
[[nodiscard]] double number_in(const Json& object, const char* key);

}  // namespace rigfit::apps
