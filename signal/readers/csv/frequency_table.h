// Tables over frequency: FRFs (frequency, real and imaginary or magnitude and phase, coherence) and
// spectra, as analysers export them as text. Never taken as recordings over time.
//
// Such a table is known by its first column (title "Frequency", unit Hz) where no column is the
// time, or by "FFT", "spectrum", "PSD", "FRF", "dB" ... among titles above a first column that
// rises.
// Which column is the real or imaginary part, the magnitude, the phase or the coherence of which
// function is told by its title.
#pragma once

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "signal/readers/csv/csv_table.h"
#include "signal/recording/recording.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// Functions over frequency.
struct FrequencyTable {
  std::filesystem::path path;
  Eigen::VectorXd frequency_hz;    ///< rising
  std::vector<Channel> functions;  ///< each as long as the frequencies
  std::string heading;             ///< the header's text, lower case
  std::vector<Note> notes;
};

/// The column that holds the frequencies; empty: the table is none over frequency.
[[nodiscard]] std::optional<std::size_t> frequency_column(const CsvTable& table);

/// The title by which a table without frequencies shows that it is a spectrum; where neither times
/// nor a rate are stated, also by "dB", "RMS" or "magnitude", or by words of the header. Empty:
/// none.
[[nodiscard]] std::string spectrum_without_frequencies(const CsvTable& table);

/// The functions of a table that is over frequency. Empty when it is none. Throws RecordingError.
[[nodiscard]] std::optional<FrequencyTable> frequency_table_of(CsvTable csv,
                                                               const std::filesystem::path& path);

/// FRFs of one input: each pair of columns of each table is a response. Magnitudes may be in dB.
/// Throws RecordingError for tables without phase, of different lines, or with values that are no
/// numbers.
[[nodiscard]] FrfSet frfs_of(const std::vector<FrequencyTable>& tables);

}  // namespace rigfit::signal
