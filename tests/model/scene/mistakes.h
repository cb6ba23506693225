// Mistakes in a TOML document, one at a time, and what its reader must say of each.
#pragma once

#include "model/scene/scene.h"
#include "tests/test.h"

namespace rigfit::model::testing {

struct Mistake {
  std::string from;  ///< text of the document to be replaced (empty: append)
  std::string to, key;
  long line;  ///< 0: no line
  const char* message;
};

/// `read` refuses the document with each mistake, by its file, line and key and with a remedy.
inline void expect_refused(const std::string& document, const std::vector<Mistake>& mistakes,
                           const std::string& file,
                           const std::function<void(const std::string&)>& read) {
  for (const auto& mistake : mistakes) {
    SCOPED_TRACE(mistake.from + " -> " + mistake.to);
    std::string text = document;
    const auto at = mistake.from.empty() ? text.size() : text.find(mistake.from);
    ASSERT_NE(at, std::string::npos);
    text.replace(at, mistake.from.size(), mistake.to);
    try {
      read(text);
      ADD_FAILURE() << "was accepted";
    } catch (const SceneError& error) {
      EXPECT_EQ(error.where().file, file);
      EXPECT_EQ(error.where().key, mistake.key);
      EXPECT_EQ(error.where().line, mistake.line) << error.what();
      EXPECT_THAT(error.what(), HasSubstr(mistake.message));
      EXPECT_FALSE(error.remedy().empty());
    }
  }
}

}  // namespace rigfit::model::testing
