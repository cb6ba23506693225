// Tables over frequency: FRFs (frequency, real and imaginary or magnitude and phase, coherence) and
// spectra, as analysers export them as text. Never taken as recordings over time.
//
// Such a table is known by its first column (title "Frequency", unit Hz) where no column is the
// time, or by "FFT", "spectrum", "PSD", "FRF", "dB" ... among titles above a first column that
// rises.
// Which column is the real or imaginary part, the magnitude, the phase or the coherence of which
// function is told by its title.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "signal/readers/csv/csv_table.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// The column that holds the frequencies; empty: the table is none over frequency.
[[nodiscard]] std::optional<std::size_t> frequency_column(const CsvTable& table);

/// The title by which a table without frequencies shows that it is a spectrum; where neither times
/// nor a rate are stated, also by "dB", "RMS" or "magnitude", or by words of the header. Empty:
/// none.
[[nodiscard]] std::string spectrum_without_frequencies(const CsvTable& table);

/// The table with the frequencies, which rise, as its first channel and functions of numbers behind
/// them. Empty when it is none over frequency. Throws RecordingError.
[[nodiscard]] std::optional<CsvTable> frequency_table_of(CsvTable table);

/// FRFs of one input, of tables over frequency: each pair of columns of each table is a response.
/// Magnitudes may be in dB. Throws RecordingError for tables without phase, of different lines, or
/// with values that are no numbers.
[[nodiscard]] FrfSet frfs_of(const std::vector<CsvTable>& tables);

}  // namespace rigfit::signal
