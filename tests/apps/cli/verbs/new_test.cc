#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/apps/run_program.h"

namespace rigfit::apps::new_test {
namespace {

using ::testing::HasSubstr;

TEST(New, WritesACampaignThatRunsAndNeverOverwrites) {
  const TemporaryFolder folder;
  const std::string rig = (folder.path() / "rig").string();
  const auto made = run_program({"new", rig, "--json", "-"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(parsed(made.out)["files"].size(), 4u);
  const auto report = run_program({"report", rig + "/campaign.toml", "--out", rig + "/report"});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  EXPECT_THAT(folder.read("rig/report/report.html"), HasSubstr("Example: a cable in a test rig"));
  const auto again = run_program({"new", rig});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("exists already"));
  EXPECT_EQ(run_program({"new"}).exit_code, 2);
}

}  // namespace
}  // namespace rigfit::apps::new_test
