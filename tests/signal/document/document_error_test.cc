#include "document/document_error.h"

#include <gtest/gtest.h>

namespace rigfit::document::document_error_test {
namespace {

TEST(DocumentError, SaysFileLineKeyAndRemedy) {
  const DocumentError error({"cable.toml", 7, 6, "member[0].EI"}, "must not be negative, got -1",
                            "give the bending stiffness in N m2");
  EXPECT_STREQ(error.what(),
               "cable.toml:7:6: member[0].EI: must not be negative, got -1; give the bending "
               "stiffness in N m2");
}

}  // namespace
}  // namespace rigfit::document::document_error_test
