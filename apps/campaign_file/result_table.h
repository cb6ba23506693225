// A small table of results as people publish or keep them: a header line of names, numbers below,
// blank where there is none. CSV with commas or semicolons; lines that start with # are remarks.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rigfit::apps {

struct ResultTable {
  std::string file;
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;  ///< NaN: blank
  std::vector<long> lines;                ///< of each row in the file, 1-based

  /// Throws model::SceneError naming the columns there are, when it is missing.
  [[nodiscard]] std::size_t column(const std::string& name) const;
};

/// Throws model::SceneError with file, line and column for what is not such a table.
[[nodiscard]] ResultTable read_result_table(const std::filesystem::path& path);

}  // namespace rigfit::apps
