#include "apps/cli/terminal.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>

namespace rigfit::apps {

std::string on_terminal(TerminalColour colour, std::string_view text) {
  const char* const none = std::getenv("NO_COLOR");
  const char* const term = std::getenv("TERM");
  const bool plain = ::isatty(STDERR_FILENO) == 0 || (none != nullptr && *none != '\0') ||
                     term == nullptr || std::string_view(term) == "dumb";
  return plain ? std::string(text)
               : fmt::format("\033[1;{}m{}\033[0m", static_cast<int>(colour), text);
}

}  // namespace rigfit::apps
