// The readers of single formats; signal/readers/read_recording.h tells formats apart.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "signal/readers/recording_description.h"
#include "signal/recording/recording.h"
#include "signal/spectra/frf_set.h"

// `bytes` is the whole file, `path` is used in messages and by libraries that read files. All throw
// RecordingError.
namespace rigfit::signal {

/// Text tables as loggers write them. Separator (comma, semicolon, tab, blanks), decimal sign,
/// byte-order mark, quotes, line ends and the extent of the header are found from the text. Names
/// and units stand in the header in any of the usual ways ("Time (s),Force [N]", a row of units,
/// rows with labels in front, "rate_gyro_V"). Everything left out is noted.
[[nodiscard]] Recording read_csv(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {});

/// LabVIEW measurement files (.lvm, text). Source: National Instruments, "Specification for the
/// LabVIEW Measurement File (.lvm)". One file header is followed by segments, each with its own
/// header (channels, units, X0, Delta_X) and table, which has no X values, one column of them, or
/// one per channel. Segments of the same channels are joined; where gaps lie between them the times
/// are kept.
[[nodiscard]] Recording read_lvm(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {});

/// Universal files (dataset 58): time histories, each a channel by its entity's name, else the
/// first identification line, else the label, else node and direction ("5+Z"). The sample rate is
/// one over the printed step, rounded to a whole number of hertz where that lies within half of the
/// step's last digit. Refused are files that hold functions but no time history.
[[nodiscard]] Recording read_uff(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {});
/// Like read_uff for a file with time histories. Otherwise functions of any type become channels,
/// to be looked at: `sample_rate_hz` stays 0 and complex values become magnitudes (both are noted).
[[nodiscard]] Recording read_uff_functions(std::string_view bytes,
                                           const std::filesystem::path& path);
/// Frequency response functions with coherence and, if rigfit wrote the file, their standard
/// deviation. Refused when there is none, when FRFs between some points are absent, or when their
/// frequencies differ.
[[nodiscard]] FrfSet read_uff_frfs(std::string_view bytes, const std::filesystem::path& path);

/// Sound files (.wav, also RF64 and big-endian RIFX) by libsndfile: 8 to 32 bit integers, 32 and 64
/// bit floating point, any number of channels, called "channel 1" and so on. Samples are fractions
/// of full scale (-1 to 1); what that means the file does not say: a description beside it gives
/// `scale` and `unit` (recording_description.h). The range is full scale where the file holds whole
/// numbers. A truncated file is read as far as it goes, with a note.
[[nodiscard]] Recording read_wav(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {});

/// NumPy arrays (.npy, versions 1 to 3) of numbers, of one or two dimensions; the longer one is
/// time. Refused are complex numbers, records, Python objects, more than two dimensions and a file
/// shorter than its header says. Source: numpy.lib.format, "A simple format for saving numpy
/// arrays".
[[nodiscard]] Recording read_npy(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {});

/// MATLAB files (.mat), versions 5 to 7 and 7.3, by libmatio: numeric arrays, also inside structs
/// and cells. Arrays whose longer side has the same length are the channels of the recording; a
/// variable with a name for time ("t", "time") holds the times, and a scalar named like a rate or
/// step ("fs", "dt") gives the rate. Where arrays of several lengths could be meant the file is
/// refused, with their names. `options.variables` names the arrays to take ("data", "run.acc").
[[nodiscard]] Recording read_mat(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {});

/// FRFs of a MATLAB file: complex arrays (lines x points) beside a frequency vector of as many
/// lines ("freq", "f").
[[nodiscard]] FrfSet read_mat_frfs(std::string_view bytes, const std::filesystem::path& path,
                                   const ReadOptions& options = {});

/// A sheet of an Excel workbook (.xlsx, ECMA-376) as a table: by the rules of tables of text
/// (csv/csv_table.h), on its numbers as they are saved; cells with dates are times, empty ones
/// missing. `options.sheet`: name or number ("#2"); empty: the first that is visible, and a note
/// names the others. Refused, with the cell: an error (\#DIV/0! ...; \#N/A is a missing value), and
/// a formula saved without its value.
[[nodiscard]] Recording read_xlsx(std::string_view bytes, const std::filesystem::path& path,
                                  const ReadOptions& options = {});
/// The columns of the sheet, whatever they are over.
struct CsvTable;
[[nodiscard]] CsvTable read_xlsx_columns(const std::filesystem::path& path,
                                         const ReadOptions& options = {});
/// Whether the bytes begin a zip archive with the parts of an Excel workbook.
[[nodiscard]] bool is_excel_workbook(std::string_view bytes);

/// A file of another program that is recognised and not read.
struct ForeignFormat {
  std::string name;    ///< such as "National Instruments TDMS"
  std::string remedy;  ///< what to do about it
};
/// By the first bytes; empty: none of those known.
[[nodiscard]] std::optional<ForeignFormat> foreign_format(std::string_view bytes);

}  // namespace rigfit::signal
