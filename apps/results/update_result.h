// What a model update found, as JSON, warnings and text: the same for the verb and for the report.
#pragma once

#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "apps/cli/json_document.h"
#include "ident/update/model_update.h"
#include "ident/update/update_checks.h"

namespace rigfit::apps {

using States = std::vector<ident::UpdateState>;

/// Parameters (name, start, value, std, low, high, budget ...), fit, alternatives, pairs, errors,
/// identifiability: all that a fit found.
[[nodiscard]] Json update_json(const ident::UpdateResult& result, const States& states);
/// States held out: errors before, of those fitted, and as predicted.
[[nodiscard]] Json held_out_json(const std::vector<ident::HeldOut>& held, const States& states);

/// "1.23 %"; "-" when there is no such number.
[[nodiscard]] std::string percent(double ratio);
/// Misfit, parameters with their budgets, pairs, rms errors, alternatives with what decides.
void print_update(std::ostream& out, const ident::UpdateResult& result, const States& states);
}  // namespace rigfit::apps
