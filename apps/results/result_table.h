// A small table of results as people publish or keep them: a header line of names, numbers below,
// blank where there is none (text_table.h).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "model/scene/scene_error.h"

namespace rigfit::apps {

struct ResultTable {
  std::string file;
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;  ///< SI; NaN: blank
  std::vector<long> lines;                ///< line of each row in the file, 1-based
  long header_line = 1;

  /// By its title, with or without its unit. Throws model::SceneError naming the columns there are,
  /// when it is missing, and for a cell of it that is no number, with line and column.
  [[nodiscard]] std::size_t column(const std::string& name) const;

  /// By column: the first cell that is no number; empty: all are.
  std::vector<std::optional<model::SceneError>> faults;
};

/// Throws model::SceneError with file, line and column for what is not such a table.
[[nodiscard]] ResultTable read_result_table(const std::filesystem::path& path);

}  // namespace rigfit::apps
