// From the text of a table to its layout (separator, decimal sign, where its numbers begin, what
// each column is called and holds), to columns, and from columns, of text or of arrays, to a
// recording with its times and rate.
//
// Names, units, ranges and a sample rate stand above the numbers, in rows with or without a label
// in front ("Sampling Rate(Hz)" 50, "Sample interval [ms]" 2, "Einheit;V"). The comma in a table of
// whole numbers ("1,5") may part columns or be the decimal sign: a title for each column or signs
// ("1,-5") decide, or the table is refused with the question.
#pragma once

#include <bit>
#include <set>

#include "signal/readers/csv_fields.h"
#include "signal/readers/recording_description.h"

namespace rigfit::signal {

struct CsvColumn {
  std::string name;  ///< UTF-8; empty: the file gives none
  std::string unit;  ///< as written, UTF-8; empty: none
  double range = 0;  ///< full scale as written in the header, in `unit`; 0: none
  /// What most fields hold; text: words in most lines; empty: nothing, or now and then something.
  FieldKind kind = FieldKind::number;
  double filled = 0;  ///< share of the lines looked at that hold a number or a word for none
  /// Most digits behind the decimal sign in the last lines looked at that hold a number; 400: none.
  int decimals = 400;

  bool wanted = true;     ///< to be read as a channel
  std::size_t place = 0;  ///< in the file

  /// The first text of a column of words that also holds numbers, or texts that begin as numbers: a
  /// part of the file; empty: none.
  std::string_view unread{};

  [[nodiscard]] bool has_data() const {
    return kind == FieldKind::number || kind == FieldKind::clock;
  }
};

struct CsvLayout {
  CsvDialect dialect;
  std::vector<CsvColumn> columns;
  std::size_t body = 0;       ///< offset of the first line of numbers
  long body_line = 1;         ///< its 1-based number
  long numbers_above = 0;     ///< lines of numbers directly above it, of other columns
  double stated_rate_hz = 0;  ///< by the header; 0: none
  long rate_line = 0;         ///< where
  std::string rate_text;      ///< as written
  bool has_names = false;
  bool more_titles = false;      ///< than columns
  std::string unmatched_titles;  ///< a line of titles that does not fit the columns; empty: none
  std::string heading;           ///< the header's lines of text, UTF-8, lower case, its first 4 kB
};

/// Throws RecordingError when there is no table of numbers in the text, and when its commas can be
/// read in two ways and `options` do not say. `file` is for messages.
[[nodiscard]] CsvLayout find_csv_layout(std::string_view bytes, const std::string& file,
                                        const ReadOptions& options = {});

/// Reads names, units, ranges and the rate from the lines above the table, parts of `bytes`. Throws
/// RecordingError where two rates differ or a title's line breaks.
void read_csv_header(const std::vector<std::string_view>& lines, std::string_view bytes,
                     const std::string& file, const ReadOptions& options, CsvLayout& layout);

/// Whether a text above a table is a unit, known to `parse_unit` or not.
[[nodiscard]] bool is_unit_text(std::string_view text);

/// Sets `decimals` of the columns of a layout that a reader made itself.
void find_csv_decimals(std::string_view bytes, CsvLayout& layout);

/// The rate, Hz, that a label ("Sampling rate", "dt [ms]"), a number and its unit state; 0: none.
[[nodiscard]] double rate_of_label(const std::string& label, double number,
                                   const std::string& unit);

/// Whether a column of this name holds times.
[[nodiscard]] bool is_time_name(const std::string& name);

/// A table of columns, of text or of arrays, as channels: which are taken, under which names and in
/// which units, and what is left out.
struct CsvTable {
  std::string file;  ///< for messages
  CsvLayout layout;
  std::vector<Channel> channels;
  std::vector<CsvColumn> columns;  ///< each channel's
  std::vector<Note> notes;

  /// Adds a column's numbers as a channel, with a name of its own and in SI, and notes what is
  /// wrong with it.
  void add(CsvColumn description, VectorXd numbers);
  /// By its clock times, unit or name.
  [[nodiscard]] bool is_time(std::size_t channel) const {
    return columns[channel].kind == FieldKind::clock ||
           channels[channel].quantity == Quantity::time || is_time_name(columns[channel].name);
  }

 private:
  std::set<std::string> used_;  ///< names
};

/// Parses the lines of a table of numbers straight into columns: one per column of its layout,
/// those that are not wanted empty, NaN where there is no number. Notes what is left out or
/// missing. Throws RecordingError with line and column for a field that is neither a number nor a
/// word for none, for too many fields, for a table without numbers, and for one so ragged that most
/// of it would be empty. `progress`, when given, is told now and then how many bytes are done with.
[[nodiscard]] std::vector<VectorXd> parse_csv_body(
    std::string_view bytes, CsvTable& table, const std::function<void(std::size_t)>& progress = {});

/// Throws RecordingError.
[[nodiscard]] CsvTable read_csv_columns(std::string_view bytes, const std::string& file,
                                        const ReadOptions& options = {});

/// Whether values, `fewest` or more, rise as the times of even samples do. Tables of loads and
/// masses, which have no titles either, are shorter.
[[nodiscard]] bool looks_like_time(const VectorXd& values, int decimals, Index fewest = 24);

/// The times are the column of such a name ("time", "Zeit", "t" ...), that of clock times, or the
/// first one without a name where it rises in equal steps over more rows than a table of loads has.
/// A first column that counts the samples is no channel either. Throws RecordingError, also for a
/// table over frequency (frequency_table.h): a spectrum is no recording over time.
[[nodiscard]] Recording recording_of_table(CsvTable table, const std::filesystem::path& path,
                                           const std::string& format, const ReadOptions& options);

// Arrays of numbers (NumPy, MATLAB) as a table of columns, and that as a recording.

/// How numbers stand in a file.
struct NumberType {
  char kind = 'f';       ///< 'f' floating point, 'i' whole, 'u' whole without sign
  std::size_t size = 8;  ///< bytes
  bool swapped = false;  ///< in the other byte order than here
};
/// Whether numbers of this byte order have the other one than here.
[[nodiscard]] constexpr bool is_swapped(bool big_endian) {
  return big_endian != (std::endian::native == std::endian::big);
}

/// The numbers at `bytes`, column after column or, `by_rows`, row after row, as doubles. Empty:
/// there is no such type.
[[nodiscard]] MatrixXd matrix_of(const NumberType& type, const char* bytes, Index rows, Index cols,
                                 bool by_rows = false);

/// Adds an array's columns or, where it is wide, its rows to the table, with a note: its longer
/// side is time. `name`, as titles of CSV have it ("Force [N]"), stands in front of their numbers.
/// `single`: held in single precision, so that times are known to 6e-8 of their size.
void add_array(const MatrixXd& values, const std::string& name, bool single, CsvTable& table);

/// Times are the column of such a name, or the first of several where it rises in equal steps
/// (noted). `stated_rate_hz`: by the file, 0: not. Throws RecordingError.
[[nodiscard]] Recording recording_of_arrays(CsvTable table, const std::filesystem::path& path,
                                            const std::string& format, const ReadOptions& options,
                                            double stated_rate_hz);

}  // namespace rigfit::signal
