// The lines of a universal file, dataset by dataset: marks of -1, fixed columns, numbers.
#pragma once

#include <climits>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "signal/recording/recording_error.h"

namespace rigfit::signal {

/// A line with the offset that it begins at.
struct UffLine {
  std::string_view text;
  std::size_t at = 0;
};

class UffText {
 public:
  UffText(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  /// Goes behind the line with the number of the next dataset, which it returns; nothing at the end
  /// of the file. Throws RecordingError for a mark without a number behind it.
  [[nodiscard]] std::optional<int> next_dataset();
  /// The line with the dataset's number.
  [[nodiscard]] const UffLine& head() const { return head_; }
  [[nodiscard]] bool any() const { return any_; }

  /// The dataset's next line; nothing at its end mark, and at the end of the file.
  [[nodiscard]] std::optional<UffLine> line();
  /// The same; throws RecordingError where the dataset ends.
  UffLine needed_line();
  /// Goes behind the dataset's end mark; false where there is none.
  bool skip_to_end();

  /// Offset of what comes next, and going there.
  [[nodiscard]] std::size_t next() const { return next_; }
  void go_to(std::size_t next) { next_ = next; }
  /// Offset of the next line that holds "-1" and nothing else, at or behind the line start `from`.
  [[nodiscard]] std::optional<std::size_t> mark(std::size_t from) const;

  /// 1-based; lines behind binary values are counted as their bytes have it.
  [[nodiscard]] long line_of(std::size_t at) const;
  /// `column`: from 1, 0: none.
  [[nodiscard]] RecordingError error(std::size_t at, long column, std::string_view value,
                                     std::string problem, std::string remedy) const;

  /// Columns `from` .. `from + width` of a line without blanks, as text and as numbers; 0 where
  /// they are blank. Throws RecordingError for what is no number, or no whole one from `low` to
  /// `high`.
  [[nodiscard]] static std::string_view columns(std::string_view line, std::size_t from,
                                                std::size_t width);
  [[nodiscard]] double number(const UffLine& line, std::size_t from, std::size_t width) const;
  int integer(const UffLine& line, std::size_t from, std::size_t width,
              const char* problem = "not a whole number", int low = INT_MIN,
              int high = INT_MAX) const;

  /// The number behind blanks at `at`, which moves behind it; nothing at `end`. A word for no value
  /// is NaN. Throws RecordingError for other text.
  [[nodiscard]] std::optional<double> next_number(std::size_t& at, std::size_t end) const;

 private:
  std::string_view bytes_;
  const std::string& file_;
  std::size_t next_ = 0;
  UffLine head_;
  bool any_ = false;
  mutable std::size_t counted_to_ = 0;  // start of line `counted_`
  mutable long counted_ = 1;
};

}  // namespace rigfit::signal
