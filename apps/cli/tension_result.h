// The result of `rigfit tension` as JSON and for people.
#pragma once

#include <ostream>

#include "apps/cli/verb.h"
#include "ident/campaign/tension_test.h"

namespace rigfit::apps {

/// Of a solved tension.
[[nodiscard]] Json tension_json(const ident::TensionResult& result);
void print_tension(std::ostream& out, const ident::TensionResult& result);

}  // namespace rigfit::apps
