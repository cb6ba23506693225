#include "apps/cli/output_file.h"

#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "apps/cli/exit_code.h"
#include "tests/test.h"

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
  EXPECT_THROW(write_whole_file(folder / "none" / "x", "y"), OutputError);
  EXPECT_THROW(write_whole_file(folder, "y"), OutputError);
  fs::remove_all(folder);
}

// A link stays one, and its target gets the content; a pipe is written into.
TEST(OutputFile, LinksAndPipesStayWhatTheyAre) {
  const fs::path folder = fs::path(::testing::TempDir()) / "rigfit_output_links";
  fs::remove_all(folder);
  fs::create_directories(folder / "to");
  fs::create_symlink("to/there.json", folder / "link");
  fs::create_symlink("link", folder / "again");
  write_whole_file(folder / "again", "content");
  EXPECT_TRUE(fs::is_symlink(folder / "link") && fs::is_symlink(folder / "again"));
  std::ifstream file(folder / "to" / "there.json");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "content");

  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::string received;
  std::thread reader([&] {
    std::ifstream in(pipe);
    received.assign(std::istreambuf_iterator<char>(in), {});
  });
  write_whole_file(pipe, std::string(200000, 'x'));  // more than a pipe holds
  reader.join();
  EXPECT_EQ(received, std::string(200000, 'x'));
  EXPECT_TRUE(fs::is_fifo(pipe));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace rigfit::apps::output_file_test
