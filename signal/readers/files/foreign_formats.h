// Files of other programs that are not read here: named, with the way out.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace rigfit::signal {

/// A format that is recognised and not read.
struct ForeignFormat {
  std::string name;    ///< such as "National Instruments TDMS"
  std::string remedy;  ///< what to do about it
};

/// By the first bytes; empty: none of those known.
[[nodiscard]] std::optional<ForeignFormat> foreign_format(std::string_view bytes);

/// Whether the bytes begin a zip archive with the parts of an Excel workbook (.xlsx), which is
/// read.
[[nodiscard]] bool is_excel_workbook(std::string_view bytes);

}  // namespace rigfit::signal
