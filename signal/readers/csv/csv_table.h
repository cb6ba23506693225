// From the lines of a table to its columns, and from columns, of text or of arrays, to a recording
// with its times and rate.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "signal/readers/csv/csv_layout.h"
#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::signal {

/// The lines of a table of numbers, parsed straight into columns.
struct CsvBody {
  /// One per column of the layout; those not asked for are empty. NaN where there is no number.
  std::vector<Eigen::VectorXd> columns;
  Eigen::Index rows = 0;
  long short_rows = 0;  ///< rows with fewer fields than columns
  long comment_lines = 0;
  long footer_line = 0;          ///< first line of text behind the table; 0: none
  bool incomplete_last = false;  ///< the last line broke off and was left out
  long empty_rows_at_end = 0;    ///< left out
};

/// Parses the columns that `wanted` marks. Throws RecordingError with line and column for a field
/// that is neither a number nor a word for none, for too many fields, and for a table so ragged
/// that most of it would be empty. `progress`, when given, is told now and then how many bytes are
/// done with.
[[nodiscard]] CsvBody parse_csv_body(std::string_view bytes, const CsvLayout& layout,
                                     const std::vector<bool>& wanted, const std::string& file,
                                     const std::function<void(std::size_t)>& progress = {});

/// A table of columns, of text or of arrays, as channels: which are taken, under which names and in
/// which units, and what is left out.
struct CsvTable {
  std::string file;  ///< for messages
  CsvLayout layout;
  std::vector<Channel> channels;
  std::vector<CsvColumn> columns;   ///< of each channel
  std::vector<std::size_t> places;  ///< of each channel's column in the file
  std::vector<Note> notes;

  /// Adds a column's numbers as a channel, with a name of its own and in SI, and notes what is
  /// wrong with it.
  void add(CsvColumn description, std::size_t place, Eigen::VectorXd numbers);
  /// By its clock times, unit or name.
  [[nodiscard]] bool is_time(std::size_t channel) const {
    return columns[channel].kind == ColumnKind::clock ||
           channels[channel].quantity == Quantity::time || is_time_name(columns[channel].name);
  }

 private:
  std::set<std::string> used_;  ///< names
};

/// `bytes`: text as text_without_mark gives it. Throws RecordingError.
[[nodiscard]] CsvTable read_csv_columns(std::string_view bytes, const std::string& file,
                                        const ReadOptions& options = {});

/// Whether values rise as the times of even samples do, and there are enough of them.
[[nodiscard]] bool looks_like_time(const Eigen::VectorXd& values, int decimals);

/// The times are the column of such a name ("time", "Zeit", "t" ...), that of clock times, or the
/// first one without a name where it rises in equal steps (also as a coarse clock shows them) over
/// more rows than a table of loads has. A first column that counts the samples is no channel
/// either. Throws RecordingError, also for a table over frequency (frequency_table.h): a spectrum
/// is no recording over time.
[[nodiscard]] Recording recording_of_table(CsvTable table, const std::filesystem::path& path,
                                           const std::string& format, const ReadOptions& options);

}  // namespace rigfit::signal
