#include "signal/readers/files/read_formats.h"

#include <algorithm>

namespace rigfit::signal {
namespace {

using namespace std::string_view_literals;

struct Signature {
  std::string_view bytes;
  ForeignFormat format;
};

constexpr const char* kUnpack = "unpack it and give the recording itself";

const Signature kSignatures[] = {
    {"TDSm"sv,
     {"a National Instruments TDMS file",
      "export it as LVM, CSV or UFF 58: in LabVIEW or DIAdem, or in Python by nptdms "
      "(TdmsFile.read(F).as_dataframe().to_csv)"}},
    {"MDF     "sv,
     {"an ASAM MDF (MF4) file",
      "export it as MAT or CSV, in Python by asammdf: MDF(F).export('mat') or export('csv')"}},
    {"\x89HDF\r\n\x1a\n"sv,
     {"an HDF5 file", "export the arrays as .npy, .mat or CSV, in Python by h5py and numpy.save"}},
    {"\x1F\x8B"sv, {"a gzip file", kUnpack}},
    {"%PDF"sv, {"a PDF document", "give the recording, not its plot or report"}},
    {"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"sv,
     {"an old Excel workbook (.xls), or one with a password",
      "open it in a spreadsheet program and save it as .xlsx without a password, or as CSV"}},
};

/// What stands somewhere in the names of the parts of a zip archive.
const Signature kArchives[] = {
    {"opendocument.spreadsheet"sv,
     {"an OpenDocument spreadsheet (.ods)", "save the sheet as .xlsx or CSV"}},
    {".npy"sv, {"a NumPy archive (.npz)", "unpack it (unzip) and give the .npy file of one array"}},
    {""sv, {"a zip archive", kUnpack}},
};

constexpr auto kZipPart = "PK\x03\x04"sv;  // a part of a zip archive: 30 bytes, then its name

}  // namespace

bool is_excel_workbook(std::string_view bytes) {
  const auto head = bytes.substr(0, 1 << 16);
  if (!head.starts_with(kZipPart)) return false;
  bool office = false;  // a workbook, a text or slides
  for (std::size_t at = 0; at != std::string_view::npos && at + 30 < head.size();
       at = head.find(kZipPart, at + 1)) {
    const auto name = head.substr(at + 30);
    if (name.starts_with("xl/")) return true;
    if (name.starts_with("word/") || name.starts_with("ppt/")) return false;
    office |= name.starts_with("[Content_Types].xml");
  }
  return office;
}

std::optional<ForeignFormat> foreign_format(std::string_view bytes) {
  for (const auto& [begin, format] : kSignatures) {
    if (bytes.starts_with(begin)) return format;
  }
  if (bytes.starts_with(kZipPart) && !is_excel_workbook(bytes)) {
    for (const auto& [part, format] : kArchives) {
      if (bytes.substr(0, 1 << 16).find(part) != std::string_view::npos) return format;
    }
  }
  auto text = bytes.substr(0, 512);
  text.remove_prefix(std::min(text.find_first_not_of("\xEF\xBB\xBF \t\r\n"), text.size()));
  for (const char* begin :
       {"<?xml", "<!doctype", "<!DOCTYPE", "<html", "<HTML", "{\"", "{\n", "[{"}) {
    if (text.starts_with(begin)) {
      return ForeignFormat{"a web page, XML or JSON document",
                           "export the recording itself as CSV, LVM or UFF 58"};
    }
  }
  return std::nullopt;
}

}  // namespace rigfit::signal
