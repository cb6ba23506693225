// A tension from frequencies as figures.
#pragma once

#include <string>
#include <vector>

#include "apps/report/drawing/plot.h"
#include "ident/tension/cable_tension.h"

namespace rigfit::apps {

/// Measured and modelled frequencies over mode number, a series a candidate; the errors of the
/// candidates; the tension of each candidate with its 95 % interval beside that of all and the
/// formulas.
[[nodiscard]] std::vector<Plot> tension_plots(const std::string& id,
                                              const ident::TensionResult& result);

}  // namespace rigfit::apps
