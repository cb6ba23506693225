// Probabilities as text: two digits. Below 1e-6 the number depends on the assumed distribution more
// than on the data, so that it is not shown.
#pragma once

#include <string>

namespace rigfit::ident {

/// "0.012", "below 1e-6"; "-" for NaN, where nothing is left over to judge by.
[[nodiscard]] std::string probability_text(double p);

/// "p = 0.012", "p below 1e-6".
[[nodiscard]] std::string p_text(double p);

}  // namespace rigfit::ident
