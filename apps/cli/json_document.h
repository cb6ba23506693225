// The envelope around every verb's JSON result: version, command, inputs with hashes, warnings.
#pragma once

#include <filesystem>

#include "apps/cli/verb.h"

namespace rigfit::apps {

/// `{rigfit, command, inputs[], warnings[], notes[], error, ...result}`. `error`, `{exit_code,
/// code, message, where}`, is there when the run ends with another exit code than 0: the first
/// warning that refused or that says what did not converge. Non-finite numbers are null where it is
/// written.
[[nodiscard]] Json json_document(const VerbContext& context, const std::string& verb,
                                 const Json& result);

/// A document that the program wrote, with that key. `by`: the command that writes one.
/// Throws model::SceneError for another file.
[[nodiscard]] Json read_document(const std::filesystem::path& path, const char* key,
                                 const char* by);
/// A number of an object; NaN where there is none.
[[nodiscard]] double number_in(const Json& object, const char* key);

}  // namespace rigfit::apps
