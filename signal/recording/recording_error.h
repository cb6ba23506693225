// What is wrong with a recording, said such that the person who made it can mend it.
#pragma once

#include <stdexcept>
#include <string>

namespace rigfit::signal {

/// A recording that cannot be read. `what()` is the whole message for a person.
class RecordingError : public std::runtime_error {
 public:
  struct Where {
    std::string file;
    long line = 0;        ///< 1-based; 0: not tied to a line
    long column = 0;      ///< 1-based column of the table or character position; 0: none
    std::string channel;  ///< empty: none
    std::string value;    ///< the offending text, empty: none
  };
  RecordingError(Where where, std::string problem, std::string remedy);

  const Where& where() const { return where_; }
  const std::string& problem() const { return problem_; }
  const std::string& remedy() const { return remedy_; }

 private:
  Where where_;
  std::string problem_;
  std::string remedy_;
};

}  // namespace rigfit::signal
