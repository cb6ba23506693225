#include "signal/readers/xlsx/zip_parts.h"

#include <minizip/unzip.h>

#include <vector>

namespace rigfit::signal {
namespace {

// A full sheet of 2^20 rows and 20 columns takes 50 bytes of XML a cell: 1 GiB.
constexpr std::size_t kMostOfArchive = std::size_t{1} << 30;
// What is parsed at once: a row of all 2^14 columns takes 1 MiB without texts. As a tree in memory
// it is up to 16 times as large.
constexpr std::size_t kLargestPiece = std::size_t{1} << 24;
constexpr std::size_t kUnpackedBlock = std::size_t{1} << 18;

/// The namespace of the document's first element with its colon; "?" where the text ends before.
std::string namespace_prefix(std::string_view xml) {
  for (std::size_t at = xml.find('<'); at + 1 < xml.size(); at = xml.find('<', at + 1)) {
    if (xml[at + 1] == '?' || xml[at + 1] == '!') continue;
    const std::size_t end = xml.find_first_of(" \t\r\n/>:", at + 1);
    if (end == std::string_view::npos) break;
    return xml[end] == ':' ? std::string(xml.substr(at + 1, end - at)) : "";
  }
  return "?";
}

/// Where the first element of this tag ("<row") begins.
std::size_t first_element(std::string_view xml, const std::string& tag) {
  std::size_t at = xml.find(tag);
  while (at != std::string_view::npos && at + tag.size() < xml.size() &&
         std::string_view(" \t\r\n/>").find(xml[at + tag.size()]) == std::string_view::npos) {
    at = xml.find(tag, at + 1);
  }
  return at;
}

}  // namespace

ZipParts::ZipParts(const std::filesystem::path& path)
    : file_(path.string()), zip_(::unzOpen64(path.c_str()), ::unzClose) {
  if (zip_ == nullptr) {
    throw RecordingError({file_, 0, 0, "", ""},
                         "is a workbook (.xlsx) that was cut off: its list of parts is missing",
                         "copy the file again, or open it in a spreadsheet program and save it");
  }
}

RecordingError ZipParts::damaged(const std::string& part) const {
  return {{file_, 0, 0, "", part},
          "is a workbook (.xlsx) with a damaged or missing part",
          "copy the file again, or open it in a spreadsheet program and save it as .xlsx"};
}

RecordingError ZipParts::too_large(const std::string& part) const {
  return {{file_, 0, 0, "", part},
          "is a workbook (.xlsx) that unpacks to more than is read (1 GiB, 16 MiB a row)",
          "save the sheet as CSV, or split it"};
}

bool ZipParts::holds(const std::string& part) const {
  return ::unzLocateFile(zip_.get(), part.c_str(), 1) == UNZ_OK;
}

void ZipParts::unpack(const std::string& part, const std::function<void(std::string_view)>& take) {
  unz_file_info64 info{};
  if (!holds(part) ||
      ::unzGetCurrentFileInfo64(zip_.get(), &info, nullptr, 0, nullptr, 0, nullptr, 0) != UNZ_OK) {
    throw damaged(part);
  }
  if ((info.flag & 1U) != 0) {
    throw RecordingError({file_, 0, 0, "", part}, "is a workbook in an encrypted zip archive",
                         "take the password off and save it as .xlsx");
  }
  if (::unzOpenCurrentFile(zip_.get()) != UNZ_OK) throw damaged(part);
  std::vector<char> block(kUnpackedBlock);
  std::size_t size = 0;
  for (;;) {
    const int read =
        ::unzReadCurrentFile(zip_.get(), block.data(), static_cast<unsigned>(block.size()));
    if (read < 0) throw damaged(part);
    if (read == 0) break;
    size += static_cast<std::size_t>(read);
    unpacked_ += static_cast<std::size_t>(read);
    if (unpacked_ > kMostOfArchive) throw too_large(part);
    take({block.data(), static_cast<std::size_t>(read)});
  }
  // The check sum is looked at here, but only of a part that was read to its stated end.
  if (::unzCloseCurrentFile(zip_.get()) != UNZ_OK || size != info.uncompressed_size) {
    throw damaged(part);
  }
}

std::string ZipParts::whole(const std::string& part) {
  std::string text;
  unpack(part, [&](std::string_view block) {
    text += block;
    if (text.size() > kLargestPiece) throw too_large(part);
  });
  return text;
}

std::string ZipParts::in_pieces(const std::string& part, const std::string& element,
                                const std::function<void(std::string_view)>& take) {
  std::string text, prefix = "?";
  bool begun = false;
  unpack(part, [&](std::string_view block) {
    text += block;
    if (prefix == "?") prefix = namespace_prefix(text);
    const std::string close = "</" + prefix + element + ">";
    if (const std::size_t last = text.rfind(close); last != std::string::npos) {
      const std::size_t end = last + close.size();
      const std::size_t begin = begun ? 0 : first_element(text, "<" + prefix + element);
      if (begin > last) throw damaged(part);
      take(std::string_view(text).substr(begin, end - begin));
      text.erase(0, end);
      begun = true;
    }
    if (text.size() > kLargestPiece) throw too_large(part);
  });
  return text;
}

}  // namespace rigfit::signal
