// What is wrong with a TOML document: file, line, key and remedy.
#pragma once

#include <stdexcept>
#include <string>

namespace rigfit::document {

/// A TOML document that cannot be used. `what()` is the whole message for a person.
class DocumentError : public std::runtime_error {
 public:
  /// Where in the document.
  struct Where {
    std::string file;
    long line = 0;    ///< 1-based; 0: not tied to a line
    long column = 0;  ///< 1-based; 0: none
    std::string key;  ///< such as "member[0].EI", empty: none
  };
  /// `remedy` says what to write instead.
  DocumentError(Where where, std::string problem, std::string remedy);

  /// The place.
  const Where& where() const { return where_; }
  /// What is wrong, without place and remedy.
  const std::string& problem() const { return problem_; }
  /// What to write instead; may be empty.
  const std::string& remedy() const { return remedy_; }

 private:
  Where where_;
  std::string problem_;
  std::string remedy_;
};

}  // namespace rigfit::document
