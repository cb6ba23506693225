#include "signal/recording/recording_error.h"

#include <gtest/gtest.h>

namespace rigfit::signal::recording_error_test {
namespace {

TEST(RecordingError, SaysFileLineChannelValueAndRemedy) {
  const RecordingError error({"hits.csv", 12, 3, "force", "1,2,3"}, "not a number",
                             "write numbers with one decimal sign");
  EXPECT_STREQ(error.what(),
               "hits.csv:12:3: channel \"force\": not a number (\"1,2,3\"); write numbers with one "
               "decimal sign");
}

}  // namespace
}  // namespace rigfit::signal::recording_error_test
