// A small table of text as people keep results: names above, a row of cells a line below.
//
// Separator, decimal sign, byte-order mark, quotes and units are those of recordings, but nothing
// is left out: every line below the names is a row, and a cell that is no number is an error where
// a number is asked for. Names are in the first of the longest lines; units may stand in the line
// below. Lines that start with # are remarks. Numbers come in SI: of a unit in brackets, "tension
// (kN)", and of a force or frequency behind an underscore, "tension_kN".
#pragma once

#include "apps/describe/option.h"
#include "signal/recording/units.h"

namespace rigfit::apps {

struct TextTable {
  struct Column {
    std::string name;                ///< without a unit in brackets
    std::string unit;                ///< as written; empty: none
    std::optional<signal::Unit> si;  ///< empty: numbers cannot be had in SI
  };
  struct Row {
    long line = 0;  ///< in the file, 1-based
    std::vector<std::string> cells;
  };
  std::string file;
  long header_line = 1;
  std::vector<Column> columns;
  std::vector<Row> rows;
  char decimal = '.';

  /// The cell in SI; NaN for a blank or a word for none ("-", "NaN"). Throws model::SceneError with
  /// line and column for what is no finite number.
  [[nodiscard]] double number(const Row& row, std::size_t column) const;

  /// Index of the column of that title, with or without its unit, in any case of letters; -1: none.
  [[nodiscard]] std::ptrdiff_t find(const std::string& title) const;
  /// The same; throws model::SceneError with the nearest title or all there are when it is missing.
  [[nodiscard]] std::size_t column(const std::string& title) const;
};

/// Fills options from the cells of a row, by their names as titles; a blank keeps the default.
/// Throws model::SceneError with line and title.
void fill_row(const TextTable& table, const TextTable::Row& row, const describe::Options& options);

/// Every row has a cell for each column; what is absent at its end is blank. Throws
/// model::SceneError for what is no such table, signal::RecordingError for no file of text.
[[nodiscard]] TextTable read_text_table(const std::filesystem::path& path);

}  // namespace rigfit::apps
