// Checks a document against a JSON schema, as much of it as our schemas use: type, enum, const,
// required, properties, additionalProperties, items, anyOf, $ref into $defs, minimum, maximum.
// A keyword that is not known is an error: a schema that is not checked says nothing.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace rigfit::apps {

/// What does not fit, with its place in the document; empty: it fits.
[[nodiscard]] std::vector<std::string> schema_errors(const nlohmann::json& document,
                                                     const nlohmann::json& schema);

}  // namespace rigfit::apps
