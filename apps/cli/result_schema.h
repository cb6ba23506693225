// The JSON schema of described results, built from their descriptions: `rigfit help schema`.
#pragma once

#include <nlohmann/json.hpp>

namespace rigfit::apps {

/// Under `$defs`: what each verb of that name gives. A report's document has lists of the same
/// objects by kind of test.
[[nodiscard]] nlohmann::ordered_json result_schema();

}  // namespace rigfit::apps
