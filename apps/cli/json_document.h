// The envelope around every verb's JSON result: version, command, inputs with hashes, warnings.
#pragma once

#include "apps/cli/verb.h"

namespace rigfit::apps {

/// `{rigfit, command, inputs[], warnings[], notes[], error, ...result}`. `error`, `{exit_code,
/// code, message, where}`, is there when the run ends with another exit code than 0: the first
/// warning that refused or that says what did not converge. Non-finite numbers in `result` become
/// null.
[[nodiscard]] Json json_document(const VerbContext& context, const std::string& verb, Json result);

/// null when not finite.
[[nodiscard]] Json json_number(double value);

/// `{value, std}`, each null when not finite.
[[nodiscard]] Json json_estimate(double value, double std);

}  // namespace rigfit::apps
