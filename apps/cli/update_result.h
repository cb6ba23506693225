// What a model update found, as JSON and as text for a terminal.
#pragma once

#include <ostream>
#include <string>

#include "apps/campaign_file/update_data.h"
#include "apps/cli/verb.h"
#include "ident/update/model_update.h"

namespace rigfit::apps {

/// A measured mode and the model's it was paired with; frequencies in Hz, errors relative.
[[nodiscard]] Json pair_json(const ident::UpdatedPair& pair, const UpdateStates& states);
/// All pairs, then what stayed alone on either side, with why.
[[nodiscard]] Json pairs_json(const ident::UpdateResult& result, const UpdateStates& states);
/// Mean, std and 95 % bounds of every parameter and predicted frequency.
[[nodiscard]] Json monte_carlo_json(const ident::UpdateResult& result, const UpdateStates& states,
                                    const ident::UpdateMonteCarlo& study);
/// "1.23 %"; "-" when there is no such number.
[[nodiscard]] std::string percent(double ratio);
/// Parameters with their budgets, pairs, rms errors.
void print_update(std::ostream& out, const ident::UpdateResult& result, const UpdateStates& states);

}  // namespace rigfit::apps
