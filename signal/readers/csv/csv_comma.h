// What the comma means in a table of whole numbers that commas part: "1,5" may be two columns or
// one number.
#pragma once

#include <string_view>
#include <vector>

namespace rigfit::signal {

enum class CommaMeaning {
  separator,  ///< between columns
  decimal,    ///< inside the numbers of one column
  both,       ///< between columns and inside numbers: columns were split wrongly
  undecided,  ///< either reading is possible
};

/// `lines`: rows of the table; `titles`: the header's line above them, empty: none. Decided by
/// titles, by leading zeros behind a comma ("1,05"), by signs ("1,-5"), by numbers of decimals, and
/// by a first column that counts or rises in equal steps. A table with a decimal point, or with an
/// odd number of columns, uses its commas as separators.
[[nodiscard]] CommaMeaning comma_meaning(const std::vector<std::string_view>& lines,
                                         std::string_view titles);

}  // namespace rigfit::signal
