// FRFs from the columns of tables over frequency: which column is the real or imaginary part, the
// magnitude, the phase or the coherence of which function, by its title.
#pragma once

#include <vector>

#include "signal/readers/csv/frequency_table.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// Whether the table has FRFs: real and imaginary parts, or magnitudes and phases.
[[nodiscard]] bool holds_frfs(const FrequencyTable& table);

/// FRFs of one input: each pair of columns of each table is a response. Magnitudes may be in dB.
/// Throws RecordingError for tables without phase, of different lines, or with values that are no
/// numbers.
[[nodiscard]] FrfSet frfs_of(const std::vector<FrequencyTable>& tables);

}  // namespace rigfit::signal
