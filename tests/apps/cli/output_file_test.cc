#include "apps/cli/output_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "apps/cli/exit_code.h"

namespace rigfit::apps::output_file_test {
namespace {
namespace fs = std::filesystem;

TEST(OutputFile, ReplacesWholeAndLeavesNothingElse) {
  const fs::path folder = fs::path(::testing::TempDir()) / "rigfit_output_file";
  fs::remove_all(folder);
  make_output_folder(folder / "a" / "b");
  const fs::path path = folder / "a" / "b" / "x.json";
  write_whole_file(path, "old");
  write_whole_file(path, "new");
  std::ifstream file(path);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "new");
  EXPECT_EQ(std::distance(fs::directory_iterator(path.parent_path()), {}), 1);
  EXPECT_THROW(make_output_folder(path), UsageError);
  EXPECT_THROW(write_whole_file(folder / "none" / "x", "y"), std::system_error);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace rigfit::apps::output_file_test
