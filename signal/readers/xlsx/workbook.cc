#include "signal/readers/xlsx/workbook.h"

#include <fmt/format.h>
#include <minizip/unzip.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>

#include "signal/recording/recording_time.h"

namespace rigfit::signal {
namespace {

// A full sheet of 2^20 rows and 20 columns takes 50 bytes of XML a cell: 1 GiB.
constexpr std::size_t kMostOfArchive = std::size_t{1} << 30;
// What is parsed at once: a row of all 2^14 columns takes 1 MiB without texts. As a tree in memory
// it is up to 16 times as large.
constexpr std::size_t kLargestPiece = std::size_t{1} << 24;
constexpr std::size_t kUnpackedBlock = std::size_t{1} << 18;

constexpr double kSecondsOfDay = 86400;
constexpr int kLongestHours = 1000;   // the reader of times takes three digits of hours
constexpr long k1900To1970 = 25569;   // days from 1899-12-30 to 1970-01-01
constexpr long k1904To1970 = 24107;   // days from 1904-01-01
constexpr long kFirstCommonDay = 61;  // 1900-03-01
constexpr double kDayAfter9999 = 2958466;

pugi::xml_document document_of(ZipParts& parts, const std::string& part) {
  const std::string text = parts.whole(part);
  pugi::xml_document document;
  if (!document.load_buffer(text.data(), text.size())) throw parts.damaged(part);
  return document;
}

/// Formats that have a number and no code (ECMA-376, 18.8.30).
CellFormat built_in_format(unsigned id) {
  struct Range {
    unsigned first, last;
    CellFormat format;
  };
  for (const auto& [first, last, format] : {Range{14, 17, CellFormat::date},
                                            {18, 21, CellFormat::time},
                                            {22, 22, CellFormat::date_time},
                                            {45, 47, CellFormat::time}}) {
    if (first <= id && id <= last) return format;
  }
  return CellFormat::number;
}

std::vector<CellFormat> formats_of(const pugi::xml_node& styles) {
  std::map<unsigned, CellFormat> codes;
  for (const auto& one : local_child(styles, "numFmts").children()) {
    codes[one.attribute("numFmtId").as_uint()] =
        cell_format(one.attribute("formatCode").as_string());
  }
  std::vector<CellFormat> formats;
  for (const auto& one : local_child(styles, "cellXfs").children()) {
    if (!has_local_name(one.name(), "xf")) continue;
    const unsigned id = one.attribute("numFmtId").as_uint();
    const auto coded = codes.find(id);
    formats.push_back(coded != codes.end() ? coded->second : built_in_format(id));
  }
  return formats;
}

struct Relation {
  std::string type;  ///< "worksheet", "styles" ...
  std::string part;
};

std::map<std::string, Relation> relations_of(ZipParts& parts) {
  std::map<std::string, Relation> relations;
  const auto document = document_of(parts, "xl/_rels/workbook.xml.rels");
  for (const auto& one : document.document_element().children()) {
    const std::string type = one.attribute("Type").as_string();
    const std::string target = one.attribute("Target").as_string();
    relations[one.attribute("Id").as_string()] = {
        type.substr(type.rfind('/') + 1),
        target.starts_with('/') ? target.substr(1) : "xl/" + target};
  }
  return relations;
}

void read_strings(ZipParts& parts, const std::string& part, Workbook& workbook) {
  parts.in_pieces(part, "sst", "si", [&](const pugi::xml_node& item) {
    workbook.string_text += string_of(item);
    workbook.string_ends.push_back(workbook.string_text.size());
  });
}

std::string sheet_names(const Workbook& workbook, const WorkbookSheet* besides) {
  std::vector<std::string> names;
  for (const auto& sheet : workbook.sheets) {
    if (&sheet != besides) names.push_back(sheet.name);
  }
  return listed(names);
}

}  // namespace

ZipParts::ZipParts(const std::filesystem::path& path)
    : file_(path.string()), zip_(::unzOpen64(path.c_str()), ::unzClose) {
  if (zip_ == nullptr) {
    throw file_error(file_, "is a workbook (.xlsx) that was cut off: its list of parts is missing",
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

std::string ZipParts::in_pieces(const std::string& part, const std::string& parent,
                                const std::string& element,
                                const std::function<void(const pugi::xml_node&)>& take) {
  std::string text;
  pugi::xml_document document;
  bool begun = false;
  unpack(part, [&](std::string_view block) {
    text += block;
    if (!begun) {
      // Behind the parent's tag.
      const std::size_t tag = text.find(parent);
      const std::size_t end = tag == std::string::npos ? tag : text.find('>', tag);
      begun = end != std::string::npos;
      if (begun) text.erase(0, end + 1);
    }
    // Up to the last element's end: "</row>", "</x:row>".
    const std::size_t last = begun ? text.rfind(element + ">") : std::string::npos;
    if (last != std::string::npos && last > 0 && (text[last - 1] == '/' || text[last - 1] == ':')) {
      const std::size_t end = last + element.size() + 1;
      if (!document.load_buffer(text.data(), end, pugi::parse_default | pugi::parse_fragment,
                                pugi::encoding_utf8)) {
        throw damaged(part);
      }
      for (const auto& one : document.children()) take(one);
      text.erase(0, end);
    }
    if (text.size() > kLargestPiece) throw too_large(part);
  });
  return text;
}

bool has_local_name(std::string_view name, std::string_view local) {
  return name == local || (name.ends_with(local) && name[name.size() - local.size() - 1] == ':');
}

pugi::xml_node local_child(const pugi::xml_node& node, std::string_view name) {
  return node.find_child([&](const auto& one) { return has_local_name(one.name(), name); });
}

/// A string with its runs of fonts put together; readings above characters (rPh) are left out.
std::string string_of(const pugi::xml_node& item) {
  std::string text;
  for (const auto& one : item.children()) {
    if (has_local_name(one.name(), "t")) text += one.text().get();
    if (has_local_name(one.name(), "r")) text += local_child(one, "t").text().get();
  }
  return text;
}

CellFormat cell_format(std::string_view code) {
  bool day = false, time = false, month = false;
  for (std::size_t k = 0; k < code.size() && code[k] != ';'; ++k) {
    char c = static_cast<char>(std::tolower(static_cast<unsigned char>(code[k])));
    if (c == '"') {
      k = code.find('"', k + 1);
    } else if (c == '\\' || c == '_' || c == '*') {
      ++k;  // the next character is shown, or its width kept free
    } else if (c == '[') {
      // "[h]": hours passed; others are colours, conditions and languages.
      const auto inside = code.substr(k + 1, code.find(']', k) - k - 1);
      time |= !inside.empty() && inside.find_first_not_of("hHmMsS") == std::string_view::npos;
      k = code.find(']', k);
    } else {
      day |= c == 'y' || c == 'd';
      time |= c == 'h' || c == 's';
      month |= c == 'm';
    }
    if (k >= code.size()) break;
  }
  if (day) return time ? CellFormat::date_time : CellFormat::date;
  if (time) return CellFormat::time;
  return month ? CellFormat::date : CellFormat::number;
}

std::string_view Workbook::string(std::size_t index) const {
  const std::size_t begin = index == 0 ? 0 : string_ends[index - 1];
  return std::string_view(string_text).substr(begin, string_ends[index] - begin);
}

Workbook read_workbook(ZipParts& parts, const std::string& file) {
  if (!parts.holds("xl/workbook.xml")) {
    const bool binary = parts.holds("xl/workbook.bin");
    throw file_error(file,
                     binary ? "is a binary Excel workbook (.xlsb)"
                            : "is a zip archive without a workbook (xl/workbook.xml) in it",
                     "open it in a spreadsheet program and save it as .xlsx, or as CSV");
  }
  Workbook workbook;
  const auto relations = relations_of(parts);
  const auto document = document_of(parts, "xl/workbook.xml");
  const pugi::xml_node root = document.document_element();
  workbook.from_1904 = local_child(root, "workbookPr").attribute("date1904").as_bool();
  for (const auto& one : local_child(root, "sheets").children()) {
    if (!has_local_name(one.name(), "sheet")) continue;
    WorkbookSheet sheet;
    sheet.name = one.attribute("name").as_string();
    sheet.hidden = !std::string_view(one.attribute("state").as_string("visible")).starts_with('v');
    const auto id = one.find_attribute(
        [](const auto& a) { return std::string_view(a.name()).ends_with(":id"); });
    const auto relation = relations.find(id.as_string());
    if (relation == relations.end()) throw parts.damaged("xl/workbook.xml");
    if (relation->second.type == "worksheet") sheet.part = relation->second.part;
    workbook.sheets.push_back(sheet);
  }
  for (const auto& [id, relation] : relations) {
    if (relation.type == "styles") {
      const auto styles = document_of(parts, relation.part);
      workbook.formats = formats_of(styles.document_element());
    }
    if (relation.type == "sharedStrings") read_strings(parts, relation.part, workbook);
  }
  return workbook;
}

const WorkbookSheet& chosen_sheet(const Workbook& workbook, const std::string& wanted,
                                  const std::string& file, std::vector<Note>& notes) {
  for (std::size_t k = 0; k < workbook.sheets.size(); ++k) {
    const WorkbookSheet& sheet = workbook.sheets[k];
    if (wanted.empty() ? sheet.hidden || sheet.part.empty()
                       : sheet.name != wanted && wanted != "#" + std::to_string(k + 1)) {
      continue;
    }
    if (sheet.part.empty()) {
      throw RecordingError({file, 0, 0, "", wanted}, "the sheet is a chart without cells",
                           "name another: it has " + sheet_names(workbook, &sheet));
    }
    if (wanted.empty() && workbook.sheets.size() > 1) {
      add_note(notes, "assumed", "",
               "Give --sheet NAME (key sheet) if \"{}\" is not the sheet to read: the workbook "
               "also has {}",
               sheet.name, sheet_names(workbook, &sheet));
    }
    return sheet;
  }
  throw RecordingError({file, 0, 0, "", wanted},
                       wanted.empty() ? "the workbook has no visible sheet of cells"
                                      : "the workbook has no sheet of that name",
                       "give --sheet NAME (key sheet): it has " + sheet_names(workbook, nullptr));
}

std::optional<std::string> clock_text(double days, CellFormat format, bool from_1904) {
  if (!(days >= 0) || days >= kDayAfter9999) return std::nullopt;
  // A quarter of the last digit's step is the number's own rounding.
  const double step =
      kSecondsOfDay * (std::nextafter(days, std::numeric_limits<double>::infinity()) - days);
  const int digits = std::clamp(static_cast<int>(std::floor(-std::log10(4 * step))), 0, 9);
  const double scale = std::pow(10.0, digits);
  const auto ticks = std::llround(days * kSecondsOfDay * scale);
  const auto per_second = static_cast<long long>(scale);
  const long long seconds = ticks / per_second;
  const auto clock = [&](long long hours) {
    const std::string text =
        fmt::format("{:02}:{:02}:{:02}", hours, seconds / 60 % 60, seconds % 60);
    return digits == 0 ? text : fmt::format("{}.{:0{}}", text, ticks % per_second, digits);
  };
  if (format == CellFormat::time && seconds / 3600 < kLongestHours) return clock(seconds / 3600);
  const auto day = static_cast<long>(seconds / 86400);
  if (!from_1904 && day < kFirstCommonDay) return std::nullopt;
  const std::chrono::year_month_day date{
      std::chrono::sys_days{std::chrono::days{day - (from_1904 ? k1904To1970 : k1900To1970)}}};
  const std::string text =
      fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()),
                  static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
  if (format == CellFormat::date && ticks % (86400 * per_second) == 0) return text;
  return text + " " + clock(seconds / 3600 % 24);
}

}  // namespace rigfit::signal
