// Probabilities in words: two digits, and none so small that it only says how far a normal
// distribution's tail is trusted.
#pragma once

#include <string>

namespace rigfit::ident {

/// "0.012", "below 1e-6"; "-" for NaN, where nothing is left over to judge by.
[[nodiscard]] std::string probability_text(double p);

/// "p = 0.012", "p below 1e-6".
[[nodiscard]] std::string p_text(double p);

}  // namespace rigfit::ident
