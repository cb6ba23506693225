// A workbook (.xlsx, ECMA-376 part 1): the parts of its zip archive, and what it says besides its
// sheets' cells: the sheets, the texts that cells share, which cell formats show dates, and the day
// that dates count from.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "signal/recording/recording.h"
#include "signal/recording/recording_error.h"

namespace rigfit::signal {

/// The parts of the archive, unpacked block by block by minizip: one that would unpack to more than
/// a limit is refused before the memory is taken.
class ZipParts {
 public:
  /// Throws RecordingError when the file is no whole zip archive.
  explicit ZipParts(const std::filesystem::path& path);

  [[nodiscard]] bool holds(const std::string& part) const;

  /// A small part of XML as it is. This and the next throw RecordingError for a part that is
  /// absent, damaged, encrypted or too large.
  [[nodiscard]] std::string whole(const std::string& part);

  /// Calls `take` with each element of this name inside `parent` (both without namespaces), a block
  /// of them in memory at a time. Returns what stands behind the last of them.
  std::string in_pieces(const std::string& part, const std::string& parent,
                        const std::string& element,
                        const std::function<void(const pugi::xml_node&)>& take);

  /// The refusal of a part that is not as the format says.
  [[nodiscard]] RecordingError damaged(const std::string& part) const;

 private:
  void unpack(const std::string& part, const std::function<void(std::string_view)>& take);
  [[nodiscard]] RecordingError too_large(const std::string& part) const;

  std::string file_;
  std::unique_ptr<void, int (*)(void*)> zip_;
  std::size_t unpacked_ = 0;  ///< bytes, of all parts so far
};

// Elements of XML by their names without namespace prefixes: "x:row" is "row".
[[nodiscard]] bool has_local_name(std::string_view name, std::string_view local);
[[nodiscard]] pugi::xml_node local_child(const pugi::xml_node& node, std::string_view name);
/// A string with its runs of fonts put together; readings above characters (rPh) are left out.
[[nodiscard]] std::string string_of(const pugi::xml_node& item);

/// What a cell's number means by its format.
enum class CellFormat {
  number,
  date,       ///< a day
  date_time,  ///< a day and the time
  time,       ///< time of day, or hours passed
};

struct WorkbookSheet {
  std::string name;
  std::string part;  ///< in the archive; empty: no sheet of cells (a chart)
  bool hidden = false;
};

struct Workbook {
  std::vector<WorkbookSheet> sheets;
  std::vector<CellFormat> formats;  ///< by the number that cells give as their style
  bool from_1904 = false;           ///< dates count from 1904-01-01, not from 1900

  [[nodiscard]] std::size_t strings() const { return string_ends.size(); }
  [[nodiscard]] std::string_view string(std::size_t index) const;
  std::string string_text;  ///< the shared texts, one behind the other
  std::vector<std::size_t> string_ends;
};

/// Throws RecordingError for what is no workbook of this format.
[[nodiscard]] Workbook read_workbook(ZipParts& parts, const std::string& file);

/// The sheet called `wanted`, or its number ("#2"); empty: the first one that is not hidden, with a
/// note of the others. Throws RecordingError when there is none.
[[nodiscard]] const WorkbookSheet& chosen_sheet(const Workbook& workbook, const std::string& wanted,
                                                const std::string& file, std::vector<Note>& notes);

/// By the format's code, such as "dd.mm.yyyy hh:mm:ss.000" or "[h]:mm:ss".
[[nodiscard]] CellFormat cell_format(std::string_view code);

/// "2026-11-24 09:30:00.00000"; of a time of day or of hours passed "09:30:00.000000000"; of a
/// whole day in a format without a time "2026-11-24". Digits as far as the number holds them (0.6
/// us on days of this century), at most 9. Empty: negative, beyond the year 9999, or a day before
/// 1900-03-01 of those counted from 1900, which programs show differently: Excel counts a 29
/// February 1900 that never was.
[[nodiscard]] std::optional<std::string> clock_text(double days, CellFormat format, bool from_1904);

}  // namespace rigfit::signal
