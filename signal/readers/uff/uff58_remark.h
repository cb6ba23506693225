// What dataset 58 has no exact place for, kept in identification lines 4 and 5 as "rigfit key=value
// ..." so that our own files come back as they were. Other programs see a line of text.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace rigfit::signal {

/// {"rate", "51200"} ...; empty when the line is not ours.
[[nodiscard]] std::map<std::string, std::string> parse_uff58_remark(std::string_view line);

/// The number of that key; `fallback` when there is none or it is not a finite number.
[[nodiscard]] double remark_number(const std::map<std::string, std::string>& remark,
                                   const std::string& key, double fallback);

}  // namespace rigfit::signal
