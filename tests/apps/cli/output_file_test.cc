#include "apps/cli/output_file.h"

#include <sys/stat.h>

#include <thread>

#include "apps/cli/exit_code.h"
#include "tests/temporary_folder.h"
#include "tests/test.h"

namespace rigfit::apps::output_file_test {

namespace fs = std::filesystem;

TEST(OutputFile, ReplacesWholeAndLeavesNothingElse) {
  const testing::TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  make_output_folder(folder / "a" / "b");
  const fs::path path = folder / "a" / "b" / "x.json";
  write_whole_file(path, "old");
  write_whole_file(path, "new");
  EXPECT_EQ(temporary.read("a/b/x.json"), "new");
  EXPECT_EQ(std::distance(fs::directory_iterator(path.parent_path()), {}), 1);
  EXPECT_THROW(make_output_folder(path), OutputError);
  EXPECT_THROW(write_whole_file(folder / "none" / "x", "y"), OutputError);
  EXPECT_THROW(write_whole_file(folder, "y"), OutputError);
}

// A link stays one, and its target gets the content; a pipe is written into.
TEST(OutputFile, LinksAndPipesStayWhatTheyAre) {
  const testing::TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  fs::create_directories(folder / "to");
  fs::create_symlink("to/there.json", folder / "link");
  fs::create_symlink("link", folder / "again");
  write_whole_file(folder / "again", "content");
  EXPECT_TRUE(fs::is_symlink(folder / "link") && fs::is_symlink(folder / "again"));
  EXPECT_EQ(temporary.read("to/there.json"), "content");
  fs::create_symlink("circle", folder / "circle");
  EXPECT_THROW(write_whole_file(folder / "circle", "content"), OutputError);

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
}

}  // namespace rigfit::apps::output_file_test
