// TerminalColour where standard error is a terminal that has it (NO_COLOR and TERM=dumb switch it
// off).
#pragma once

#include <string>
#include <string_view>

namespace rigfit::apps {

enum class TerminalColour { red = 31, yellow = 33 };

/// `text` in bold and that colour on such a terminal, else as it is.
[[nodiscard]] std::string on_terminal(TerminalColour colour, std::string_view text);

}  // namespace rigfit::apps
