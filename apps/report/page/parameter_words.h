// Parameters of a scene as a reader calls them: "beam.EI_z" is "Beam bending stiffness EI_z".
#pragma once

#include <string>
#include <string_view>

namespace rigfit::apps {

/// Name and symbol of a scene's parameter (model/scene/parameters.h). A name of a campaign's own,
/// such as "cable span", stays as it is but for its first letter; so does one that is not known.
[[nodiscard]] std::string parameter_words(std::string_view name);

/// A sentence with the plain names of the parameters in it.
[[nodiscard]] std::string with_parameter_words(std::string sentence);

/// The name of a state without the word for the only one: "beam, as built" is "beam".
[[nodiscard]] std::string state_words(std::string name);

/// True for ratios that are shown in percent: damping ratios.
[[nodiscard]] bool shown_in_percent(std::string_view name);

}  // namespace rigfit::apps
