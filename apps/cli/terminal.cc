#include "apps/cli/terminal.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <sstream>

namespace rigfit::apps {

std::string on_terminal(TerminalColour colour, std::string_view text) {
  const char* const none = std::getenv("NO_COLOR");
  const char* const term = std::getenv("TERM");
  const bool plain = ::isatty(STDERR_FILENO) == 0 || (none != nullptr && *none != '\0') ||
                     term == nullptr || std::string_view(term) == "dumb";
  return plain ? std::string(text)
               : fmt::format("\033[1;{}m{}\033[0m", static_cast<int>(colour), text);
}

std::size_t text_width() {
  winsize size{};
  const bool known = ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col >= 40;
  return known ? size.ws_col : 80;
}

std::string wrapped(const std::string& text, std::size_t indent, std::size_t width) {
  std::string result;
  std::size_t column = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line); column = 0) {
    if (!result.empty()) result += '\n';
    const bool kept = indent == 0 && line.starts_with(' ');
    std::size_t at = 0;
    while (!kept && line.size() - at > width - column) {
      // What stands before the indentation is never parted from its text.
      const std::size_t least = at + (at == 0 && indent > 0 ? indent : 1);
      std::size_t cut = line.rfind(' ', at + width - column);
      if (cut == std::string::npos || cut < least) cut = line.find(' ', least);
      if (cut == std::string::npos) break;
      result += line.substr(at, cut - at) + '\n' + std::string(indent, ' ');
      column = indent;
      at = cut + 1;
    }
    result += line.substr(at);
  }
  return result;
}

}  // namespace rigfit::apps
