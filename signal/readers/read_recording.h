// Reads any supported recording, or FRFs that an analyser exported; the format is detected from the
// content, whatever its name.
#pragma once

#include <string_view>

#include "signal/readers/recording_description.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

struct CsvTable;  // csv_table.h

/// A file's bytes, mapped rather than copied, so that a 1 GB recording takes no extra memory.
class MappedFile {
 public:
  /// Throws RecordingError when the file cannot be opened, is a folder, or is empty.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  [[nodiscard]] std::string_view bytes() const { return {data_, size_}; }

 private:
  char* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Throws RecordingError for the files of other programs: what they are, how to export text.
void refuse_foreign(std::string_view bytes, const std::filesystem::path& path);

/// The name of the format (format_names) by the first bytes: "    -1" begins UFF, "LabVIEW
/// Measurement" LVM, "RIFF" WAV, "\x93NUMPY" a NumPy array, "MATLAB" with its version mark a .mat
/// file. Everything else is read as a table of text.
[[nodiscard]] std::string format_of(std::string_view bytes);

/// `options.format`, if given, overrides the detection. Throws RecordingError with file, line,
/// channel, value and remedy. Formats that are recognised but not read (TDMS, MDF, HDF5, Excel ...)
/// are refused by name, with advice on how to convert them.
[[nodiscard]] Recording read_recording(const std::filesystem::path& path,
                                       const ReadOptions& options = {});

/// FRFs from a universal or MATLAB file, or from tables of text over the same lines (one
/// file per response, or one for all). Throws RecordingError.
[[nodiscard]] FrfSet read_frfs(const std::vector<std::filesystem::path>& files,
                               const ReadOptions& options = {});

/// Functions over frequency, FRFs or spectra, as frequency_table.h has them. `bytes` are those
/// of the file at `path`. Empty when it is no table, or none over frequency. Throws RecordingError.
[[nodiscard]] std::optional<CsvTable> frequency_table_in(std::string_view bytes,
                                                         const std::filesystem::path& path,
                                                         const ReadOptions& options = {});

// The readers of single formats. `bytes` is the whole file, `path` is used in messages and by
// libraries that read files. All throw RecordingError.

/// Text tables as loggers write them. Separator (comma, semicolon, tab, blanks), decimal sign,
/// byte-order mark, quotes, line ends and the extent of the header are found from the text. Names
/// and units stand in the header in any of the usual ways ("Time (s),Force [N]", a row of units,
/// rows with labels in front, "rate_gyro_V"). Everything left out is noted.
[[nodiscard]] Recording read_csv(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {});

/// LabVIEW measurement files (.lvm, text) of one segment: the file's header is followed by that of
/// the segment (channels, units, X0, Delta_X) and a table without X values, with one column of
/// them, or with one per channel. A second segment is refused.
[[nodiscard]] Recording read_lvm(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {});

/// Universal files (dataset 58): time histories, each a channel by its entity's name, else the
/// first identification line, else the label, else node and direction ("5+Z"). The sample rate is
/// one over the printed step, rounded to a whole number of hertz where that lies within half of the
/// step's last digit. Refused are files that hold functions but no time history.
[[nodiscard]] Recording read_uff(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {});
/// Frequency response functions with coherence and, if rigfit wrote the file, their standard
/// deviation. Refused when there is none, when FRFs between some points are absent, or when their
/// frequencies differ.
[[nodiscard]] FrfSet read_uff_frfs(std::string_view bytes, const std::filesystem::path& path);

/// Sound files (.wav, also RF64 and RIFX) by libsndfile: whole and floating-point numbers. Samples
/// are fractions of full scale, which is the range of whole numbers: a description beside the file
/// gives `scale` and `unit`. A truncated file is read as far as it goes, with a note.
[[nodiscard]] Recording read_wav(std::string_view bytes, const std::filesystem::path& path,
                                 const ReadOptions& options = {});

/// NumPy arrays (.npy, versions 1 to 3) of numbers, of one or two dimensions; the longer one is
/// time. Refused are complex numbers, records, Python objects, more than two dimensions and a file
/// shorter than its header says.
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
/// lines ("freq", "f"), or beside the sampling rate and block length of their FFT.
[[nodiscard]] FrfSet read_mat_frfs(std::string_view bytes, const std::filesystem::path& path,
                                   const ReadOptions& options = {});

// Reads mode shapes of other programs: datasets 55 of a universal file, with the points of 15 or
// 2411 and the units of 164. FRFs and time histories in the same file are ignored.
//
// Dataset 55 ("data at nodes") gives normal modes (analysis type 2: frequency in hertz, viscous and
// hysteretic damping, the latter twice a damping ratio) and complex modes (types 3 and 7:
// eigenvalue p in rad/s, natural frequency |p| / 2 pi, damping ratio -Re p / |p|). Values are real
// or complex, three or six a node. In a conjugate pair the mode of positive frequency is taken.
// Layout: SDRC Universal File Datasets 15, 55, 164, 2411.

/// A node of datasets 15 or 2411.
struct UffNode {
  std::array<double, 3> position_m{0, 0, 0};
  /// Coordinate system of the displacements at the node; 0 and 1 are the global ones.
  int displacement_system = 0;
};

/// One mode of datasets 55.
struct UffMode {
  long line = 0;             ///< line of the dataset's number in the file
  double frequency_hz = 0;   ///< undamped natural frequency, positive
  double damping_ratio = 0;  ///< NaN: the file gives none (zero)
  /// Displacements along x, y, z by node; empty: values without directions.
  std::map<int, std::array<Complex, 3>> shape;
};

/// Modes and nodes of a file.
struct UffModes {
  std::map<int, UffNode> nodes;      ///< by number
  std::vector<UffMode> modes;        ///< by rising frequency
  std::vector<std::string> remarks;  ///< items left out, for a person
};

/// Throws RecordingError with the line that cannot be read, and when there is no mode.
[[nodiscard]] UffModes read_uff_modes(std::string_view bytes, const std::filesystem::path& path);
/// Reads a file. Throws RecordingError.
[[nodiscard]] UffModes read_uff_modes(const std::filesystem::path& path);

}  // namespace rigfit::signal
