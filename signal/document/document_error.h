// What is wrong with an input, said so that the person who made it can fix it.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace rigfit::document {

/// An input that cannot be used. `what()` is the whole message for a person: `Place` says where
/// (`before()` the problem, and `behind()` it the value).
template <typename Place>
class InputError : public std::runtime_error {
 public:
  using Where = Place;
  /// `remedy` says what to do about it.
  InputError(Where where, std::string problem, std::string remedy)
      : std::runtime_error(where.before() + problem + where.behind() +
                           (remedy.empty() ? "" : "; " + remedy)),
        where_(std::move(where)),
        problem_(std::move(problem)),
        remedy_(std::move(remedy)) {}

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

/// "file:line:column: ", of what is known.
[[nodiscard]] inline std::string place_text(const std::string& file, long line, long column) {
  std::string text = file;
  if (line > 0) text += ":" + std::to_string(line);
  if (column > 0) text += ":" + std::to_string(column);
  return text.empty() ? text : text + ": ";
}

/// Where in a TOML document.
struct DocumentPlace {
  std::string file;
  long line = 0;    ///< 1-based; 0: not tied to a line
  long column = 0;  ///< 1-based; 0: none
  std::string key;  ///< such as "member[0].EI", empty: none

  [[nodiscard]] std::string before() const {
    return place_text(file, line, column) + (key.empty() ? "" : key + ": ");
  }
  [[nodiscard]] std::string behind() const { return ""; }
};
using DocumentError = InputError<DocumentPlace>;

}  // namespace rigfit::document
