// The terminal: its width, lines broken to it, and colour where standard error is one that has it
// (NO_COLOR and TERM=dumb switch colour off).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace rigfit::apps {

enum class TerminalColour { red = 31, yellow = 33 };

/// `text` in bold and that colour on such a terminal, else as it is.
[[nodiscard]] std::string on_terminal(TerminalColour colour, std::string_view text);

/// Columns of the terminal that standard output is; 80 elsewhere.
[[nodiscard]] std::size_t text_width();

/// `text` broken at blanks to `width` columns, every line but the first begun with `indent` blanks;
/// lines that begin with a blank (commands) stay as they are.
[[nodiscard]] std::string wrapped(const std::string& text, std::size_t indent, std::size_t width);

}  // namespace rigfit::apps
