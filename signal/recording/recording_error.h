// Says what is wrong with a recording so that the person who made it can fix it.
#pragma once

#include <stdexcept>
#include <string>

namespace rigfit::signal {

/// A recording that cannot be read. `what()` is the whole message for a person.
class RecordingError : public std::runtime_error {
 public:
  /// Where in the file.
  struct Where {
    std::string file;
    long line = 0;          ///< 1-based; 0: not tied to a line
    long column = 0;        ///< 1-based column of the table or character position; 0: none
    std::string channel{};  ///< empty: none
    std::string value{};    ///< the offending text, empty: none
    std::string cell{};     ///< in a sheet ("Sheet1!B7"), said instead of line and column
  };
  /// `remedy` says what to do about it.
  RecordingError(Where where, std::string problem, std::string remedy);

  /// The place.
  const Where& where() const { return where_; }
  /// What is wrong, without place and remedy.
  const std::string& problem() const { return problem_; }
  /// What to do about it; may be empty.
  const std::string& remedy() const { return remedy_; }

 private:
  Where where_;
  std::string problem_;
  std::string remedy_;
};

}  // namespace rigfit::signal
