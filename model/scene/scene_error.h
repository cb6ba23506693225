// What is wrong with a scene or campaign file, said such that the person who wrote it can mend it.
#pragma once

#include <stdexcept>
#include <string>

namespace rigfit::model {

/// A TOML document that cannot be used. `what()` is the whole message for a person.
class SceneError : public std::runtime_error {
 public:
  struct Where {
    std::string file;
    long line = 0;    ///< 1-based; 0: not tied to a line
    long column = 0;  ///< 1-based; 0: none
    std::string key;  ///< such as "member[0].EI", empty: none
  };
  SceneError(Where where, std::string problem, std::string remedy);

  const Where& where() const { return where_; }
  const std::string& problem() const { return problem_; }
  const std::string& remedy() const { return remedy_; }

 private:
  Where where_;
  std::string problem_;
  std::string remedy_;
};

}  // namespace rigfit::model
