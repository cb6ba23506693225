#include "signal/readers/read_recording.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "signal/readers/csv_fields.h"
#include "signal/readers/frequency_table.h"
#include "signal/recording/recording_time.h"

namespace rigfit::signal {
namespace {

/// What begins files of other programs, what they are and what to do about them.
struct Foreign {
  std::string_view begin;
  const char *name, *remedy;
};

constexpr const char *kPage = "a web page, XML or JSON document",
                     *kOfPage = "give the numbers as CSV, recordings also as LVM or UFF 58";
constexpr Foreign kForeign[] = {
    {"TDSm", "a National Instruments TDMS file",
     "export it as LVM, CSV or UFF 58: in LabVIEW or DIAdem, or in Python by nptdms "
     "(TdmsFile.read(F).as_dataframe().to_csv)"},
    {"MDF     ", "an ASAM MDF (MF4) file",
     "export it as MAT or CSV, in Python by asammdf: MDF(F).export('mat') or export('csv')"},
    {"\x89HDF\r\n\x1a\n", "an HDF5 file",
     "export the arrays as .npy, .mat or CSV, in Python by h5py and numpy.save"},
    {"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1", "an old Excel workbook (.xls), or one with a password",
     "open it in a spreadsheet program and save the sheet as CSV (UTF-8)"},
    {"PK\x03\x04", "a workbook or another zip archive (.xlsx, .ods, .zip, .npz)",
     "save the sheet as CSV (UTF-8), or unpack it and give the recording itself"},
    {"<?xml", kPage, kOfPage},
    {"<!doctype", kPage, kOfPage},
    {"<html", kPage, kOfPage},
    {"{\"", kPage, kOfPage},
    {"{\n", kPage, kOfPage},
    {"[{", kPage, kOfPage}};

struct Reader {
  std::string_view format;
  Recording (*read)(std::string_view, const std::filesystem::path&, const ReadOptions&);
};
constexpr Reader kReaders[] = {{"csv", read_csv}, {"lvm", read_lvm}, {"uff", read_uff},
                               {"wav", read_wav}, {"npy", read_npy}, {"mat", read_mat}};

}  // namespace

void refuse_foreign(std::string_view bytes, const std::filesystem::path& path) {
  std::string head = lower_case(bytes.substr(0, 512));
  head.erase(0, head.find_first_not_of("\xEF\xBB\xBF \t\r\n"));
  for (const Foreign& foreign : kForeign) {
    if (bytes.starts_with(foreign.begin) || head.starts_with(foreign.begin)) {
      throw file_error(path, std::string("is ") + foreign.name, foreign.remedy);
    }
  }
}

MappedFile::MappedFile(const std::filesystem::path& path) {
  const auto fail = [&](const std::string& problem, const std::string& remedy) {
    throw file_error(path, problem, remedy);
  };
  // A pipe without a writer must not hang the run.
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) {
    fail(std::string("cannot be opened: ") + std::strerror(errno), "check the path and its rights");
  }
  struct stat status {};
  const bool is_file = ::fstat(file, &status) == 0 && S_ISREG(status.st_mode);
  size_ = is_file ? static_cast<std::size_t>(status.st_size) : 0;
  void* const mapped =
      size_ == 0 ? MAP_FAILED : ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0);
  const int reason = errno;
  ::close(file);
  if (!is_file) fail("is not a file", "give the file of one recording");
  if (size_ == 0) fail("is empty", "record again or copy the file again");
  if (mapped == MAP_FAILED) {
    fail(std::string("cannot be read: ") + std::strerror(reason), "copy it to a local disk");
  }
  data_ = static_cast<char*>(mapped);
  ::madvise(data_, size_, MADV_SEQUENTIAL);
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) ::munmap(data_, size_);
}

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const Reader& reader : kReaders) names.emplace_back(reader.format);
  return names;
}

std::string format_of(std::string_view bytes) {
  const auto magic = bytes.substr(0, 4);
  if ((magic == "RIFF" || magic == "RIFX" || magic == "RF64") && bytes.size() >= 12 &&
      bytes.substr(8, 4) == "WAVE") {
    return "wav";
  }
  if (bytes.substr(0, 6) == "\x93NUMPY") return "npy";
  if (bytes.substr(0, 6) == "MATLAB" && bytes.size() >= 128 &&
      (bytes.substr(126, 2) == "IM" || bytes.substr(126, 2) == "MI")) {
    return "mat";
  }
  auto head = bytes.substr(0, 1024);
  if (head.substr(0, 3) == "\xEF\xBB\xBF") head.remove_prefix(3);
  while (!head.empty()) {
    const auto line = trim_blanks(take_line(head));
    if (line == "-1") return "uff";
    if (line.substr(0, 19) == "LabVIEW Measurement") return "lvm";
    if (!line.empty()) break;
  }
  return "csv";
}

Recording read_recording(const std::filesystem::path& path, const ReadOptions& options) {
  const MappedFile file(path);
  const std::string format = options.format.empty() ? format_of(file.bytes()) : options.format;
  const auto* const reader = std::ranges::find(kReaders, format, &Reader::format);
  if (reader == std::end(kReaders)) {
    throw file_error(path, "no format of that name is read",
                     "csv (any table of text), lvm, uff, wav, npy or mat", format);
  }
  if (options.format.empty()) refuse_foreign(file.bytes(), path);
  Recording recording = reader->read(file.bytes(), path, options);
  shorten(recording.notes);
  return recording;
}

FrfSet read_frfs(const std::vector<std::filesystem::path>& files, const ReadOptions& options) {
  std::vector<CsvTable> tables;
  for (const auto& path : files) {
    const MappedFile file(path);
    refuse_foreign(file.bytes(), path);
    const std::string format = format_of(file.bytes());
    if (format == "uff" && files.size() == 1) return read_uff_frfs(file.bytes(), path);
    if (format == "mat" && files.size() == 1) return read_mat_frfs(file.bytes(), path, options);
    std::optional<CsvTable> table = frequency_table_in(file.bytes(), path, options);
    if (!table) {
      throw file_error(path,
                       format == "uff" ? "is one of several universal files"
                                       : "is no table of FRFs over frequency",
                       "give one UFF file, text tables with frequency, real and imaginary part; or "
                       "recordings of hits, with --force CHANNEL");
    }
    tables.push_back(std::move(*table));
  }
  return frfs_of(tables);
}

std::optional<CsvTable> frequency_table_in(std::string_view bytes,
                                           const std::filesystem::path& path,
                                           const ReadOptions& options) {
  if (format_of(bytes) != "csv") return std::nullopt;
  CsvTable table = read_csv_columns(bytes, path.string(), options);
  const auto at = frequency_column(table);
  if (!at) return std::nullopt;
  std::vector<Channel> kept;
  for (std::size_t k = *at; k < table.channels.size(); ++k) {
    if (k > *at && table.columns[k].kind != FieldKind::number) continue;
    kept.push_back(std::move(table.channels[k]));
  }
  table.channels = std::move(kept);
  return table;
}

}  // namespace rigfit::signal
