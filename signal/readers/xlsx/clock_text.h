// Dates and times of spreadsheets, which are numbers of days, as text.
#pragma once

#include <optional>
#include <string>

#include "signal/readers/xlsx/workbook.h"

namespace rigfit::signal {

/// "2026-11-24 09:30:00.00000"; of a time of day or of hours passed "09:30:00.000000000"; of a
/// whole day in a format without a time "2026-11-24". Digits as far as the number holds them (0.6
/// us on days of this century), at most 9. Empty: negative, beyond the year 9999, or a day before
/// 1900-03-01 of those counted from 1900, which programs show differently: Excel counts a 29
/// February 1900 that never was.
[[nodiscard]] std::optional<std::string> clock_text(double days, CellFormat format, bool from_1904);

}  // namespace rigfit::signal
