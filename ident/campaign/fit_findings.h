// What a fit found, in words, for the verb and the report.
#pragma once

#include <string>
#include <vector>

#include "ident/statistics/finding.h"
#include "ident/update/problem/update_result.h"

namespace rigfit::ident {

/// Findings to be read before the numbers of a fit are used, most severe first.
[[nodiscard]] std::vector<Finding> fit_findings(const UpdateResult& result);

/// "chi-square 12.3 on 8 degrees of freedom, probability 0.14 ...".
[[nodiscard]] std::string fit_text(const UpdateFit& fit);

/// Describes each alternative but the first.
[[nodiscard]] std::vector<std::string> alternative_texts(const UpdateResult& result);

}  // namespace rigfit::ident
