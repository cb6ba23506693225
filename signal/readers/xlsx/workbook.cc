#include "signal/readers/xlsx/workbook.h"

#include <cctype>
#include <map>
#include <pugixml.hpp>

#include "signal/readers/xlsx/xml_elements.h"

namespace rigfit::signal {
namespace {

constexpr unsigned kFragment = pugi::parse_default | pugi::parse_fragment;

pugi::xml_document document_of(ZipParts& parts, const std::string& part) {
  const std::string text = parts.whole(part);
  pugi::xml_document document;
  if (!document.load_buffer(text.data(), text.size())) throw parts.damaged(part);
  return document;
}

/// Formats that have a number and no code (ECMA-376, 18.8.30; from 27 on those of East Asia).
CellFormat built_in_format(unsigned id) {
  if (id == 9 || id == 10) return CellFormat::percent;
  if ((id >= 14 && id <= 17) || (id >= 27 && id <= 31) || id == 36 || (id >= 50 && id <= 58)) {
    return CellFormat::date;
  }
  if (id == 22) return CellFormat::date_time;
  if ((id >= 18 && id <= 21) || (id >= 32 && id <= 35) || (id >= 45 && id <= 47)) {
    return CellFormat::time;
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
  pugi::xml_document document;
  static_cast<void>(parts.in_pieces(part, "si", [&](std::string_view xml) {
    if (!document.load_buffer(xml.data(), xml.size(), kFragment, pugi::encoding_utf8)) {
      throw parts.damaged(part);
    }
    for (const auto& item : document.children()) {
      workbook.string_text += string_of(item);
      workbook.string_ends.push_back(workbook.string_text.size());
    }
  }));
}

std::string sheet_names(const Workbook& workbook, const WorkbookSheet* besides) {
  std::vector<std::string> names;
  for (const auto& sheet : workbook.sheets) {
    if (&sheet != besides) names.push_back(sheet.name);
  }
  return listed(names);
}

}  // namespace

CellFormat cell_format(std::string_view code) {
  bool day = false, time = false, month = false, percent = false;
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
      percent |= c == '%';
    }
    if (k >= code.size()) break;
  }
  if (day) return time ? CellFormat::date_time : CellFormat::date;
  if (time) return CellFormat::time;
  return month ? CellFormat::date : percent ? CellFormat::percent : CellFormat::number;
}

std::string_view Workbook::string(std::size_t index) const {
  const std::size_t begin = index == 0 ? 0 : string_ends[index - 1];
  return std::string_view(string_text).substr(begin, string_ends[index] - begin);
}

Workbook read_workbook(ZipParts& parts, const std::string& file) {
  if (!parts.holds("xl/workbook.xml")) {
    const bool binary = parts.holds("xl/workbook.bin");
    throw RecordingError({file, 0, 0, "", ""},
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
      notes.push_back({"assumed",
                       "Give --sheet NAME (key sheet) if \"" + sheet.name +
                           "\" is not the sheet to read: the workbook also has " +
                           sheet_names(workbook, &sheet),
                       ""});
    }
    return sheet;
  }
  throw RecordingError({file, 0, 0, "", wanted},
                       wanted.empty() ? "the workbook has no visible sheet of cells"
                                      : "the workbook has no sheet of that name",
                       "give --sheet NAME (key sheet): it has " + sheet_names(workbook, nullptr));
}

}  // namespace rigfit::signal
