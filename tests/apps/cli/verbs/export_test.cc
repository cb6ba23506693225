#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/run_program.h"

namespace rigfit::apps::export_test {
namespace {
using ::testing::HasSubstr;

TEST(ExportVerb, WritesADeckAndRefusesWhatItCannotSay) {
  const TemporaryFolder folder;
  const std::string scene = RIGFIT_TESTDATA "/jalali2021/scenes/cable.toml";
  const auto run = run_program({"export", scene, "--calculix", folder.path() / "ccx"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(folder.read("ccx/cable.inp"), HasSubstr("*FREQUENCY"));
  EXPECT_EQ(run_program({"export", scene}).exit_code, 2);
  EXPECT_EQ(run_program({"export", "none.toml", "--calculix", folder.path() / "x"}).exit_code, 3);
}

}  // namespace
}  // namespace rigfit::apps::export_test
