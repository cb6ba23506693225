// What to know about a result of the axial test: what the lengths can and cannot tell, inputs taken
// as exact, EA against a catalogue's.
#pragma once

#include "ident/axial/axial_result.h"

namespace rigfit::ident {

/// Fills notes, catalogue value and plausibility of an otherwise complete result. Codes:
/// one_length, lengths_too_close, lengths_disagree, series_compliance, massless_cable,
/// exact_inputs, below_catalogue, above_catalogue.
void judge_axial(AxialTestResult& result, const AxialSetup& setup, const AxialOptions& options);

}  // namespace rigfit::ident
