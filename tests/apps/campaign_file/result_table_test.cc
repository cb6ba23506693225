#include "apps/campaign_file/result_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "model/scene/scene_error.h"
#include "tests/apps/run_program.h"

namespace rigfit::apps::result_table_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ResultTable, ReadsNumbersBlanksAndRemarks) {
  const TemporaryFolder folder;
  const auto table = read_result_table(folder.write(
      "t.csv", "\xef\xbb\xbf# a remark\r\ntension_N, \"test_Hz\"\r\n25,1.5\r\n\r\n100,\r\n"));
  EXPECT_THAT(table.columns, ElementsAre("tension_N", "test_Hz"));
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0][1], 1.5);
  EXPECT_TRUE(std::isnan(table.rows[1][1]));
  EXPECT_THAT(table.lines, ElementsAre(3, 5));
  EXPECT_EQ(table.column("test_Hz"), 1u);
  const auto semicolons = read_result_table(folder.write("s.csv", "a;b\n1;2\n"));
  EXPECT_EQ(semicolons.rows[0][1], 2);
}

TEST(ResultTable, RefusesWhatIsNoTable) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& text) -> std::string {
    try {
      static_cast<void>(read_result_table(folder.write("t.csv", text)).column("test_Hz"));
    } catch (const model::SceneError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(message("a,test_Hz\n1,x\n"), HasSubstr("t.csv:2:2: \"x\" in column \"test_Hz\""));
  EXPECT_THAT(message("a,test_Hz\n1,inf\n"), HasSubstr("is not a number"));
  EXPECT_THAT(message("a,test_Hz\n1,2,3\n"), HasSubstr("has 3 values, the header 2"));
  EXPECT_THAT(message("a,test_Hz\n"), HasSubstr("no rows"));
  EXPECT_THAT(message(""), HasSubstr("no rows"));
  EXPECT_THAT(message("a,tset_Hz\n1,2\n"), HasSubstr("did you mean \"tset_Hz\"?"));
  EXPECT_THROW(static_cast<void>(read_result_table(folder.path() / "none.csv")), model::SceneError);
  EXPECT_THROW(static_cast<void>(read_result_table(folder.path())), model::SceneError);
}

}  // namespace
}  // namespace rigfit::apps::result_table_test
