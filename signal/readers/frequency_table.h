// FRFs as files hold them, one function from an input to a response each, and the set they make.
//
// Tables over frequency are FRFs (frequency, real and imaginary or magnitude and phase, coherence)
// and spectra, as analysers export them as text, and never recordings over time. Such a table is
// known by its first column (title "Frequency", unit Hz) where no column is the time, or by "FFT",
// "PSD", "FRF", "dB" ... among titles above a first column that rises. Titles tell which column is
// the real or imaginary part, the magnitude, the phase or the coherence of which function.
#pragma once

#include "signal/readers/csv_table.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

struct FrfUnit {
  double factor = 1;  ///< to SI
  FrfForm form = FrfForm::unknown;
  std::string unit;  ///< SI, such as "(m/s^2)/N"
};

/// "(m/s^2)/N" or "g/N", parted at a slash before a force. Empty: there is none.
[[nodiscard]] std::optional<FrfUnit> parse_frf_unit(const std::string& text);

/// One FRF, in SI.
struct FrfPart {
  MeasuredPoint response, input;
  FrfUnit unit;
  VectorXd frequency_hz;
  VectorXcd H;
  VectorXd coherence, H_std;  ///< as many lines; empty: not known
  std::string file;           ///< for messages
  long line = 0;
};

/// Whether two functions have the same frequencies, but for printing (1e-6 of the last).
[[nodiscard]] bool same_lines(const VectorXd& a, const VectorXd& b);

/// Frequencies, points, values, coherence and standard deviation of one FRF at least, in the unit
/// of the first (empty: not known, which is noted). A first or last line without numbers is left
/// out with a note (0 Hz in mobility, a file cut short). Throws RecordingError where frequencies do
/// not rise or differ, forms differ, an FRF between two of the points is absent or there twice, and
/// for values that are no numbers.
[[nodiscard]] FrfSet set_of_parts(const std::vector<FrfPart>& parts);

/// The column that holds the frequencies; empty: the table is none over frequency.
[[nodiscard]] std::optional<std::size_t> frequency_column(const CsvTable& table);

/// The title by which a table without frequencies shows that it is a spectrum; where neither times
/// nor a rate are stated, also by "dB", "RMS" or "magnitude", or by words of the header. Empty:
/// none.
[[nodiscard]] std::string spectrum_without_frequencies(const CsvTable& table);

/// FRFs of one input, of tables over frequency: each pair of columns of each table is a response.
/// Magnitudes may be in dB. Throws RecordingError for tables without phase, of different lines, or
/// with values that are no numbers.
[[nodiscard]] FrfSet frfs_of(const std::vector<CsvTable>& tables);

}  // namespace rigfit::signal
