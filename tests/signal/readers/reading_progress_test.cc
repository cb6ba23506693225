// Readers tell how far they are, and what is thrown there ends the reading.
#include <cstddef>

#include "signal/readers/read_recording.h"
#include "tests/test.h"

namespace rigfit::signal {
namespace {

void expect_rising(const std::vector<std::size_t>& told, std::size_t size) {
  ASSERT_FALSE(told.empty());
  EXPECT_LE(told.back(), size);
  EXPECT_GT(told.back(), size / 2);
  for (std::size_t k = 1; k < told.size(); ++k) EXPECT_GT(told[k], told[k - 1]);
}

TEST(ReadingProgress, AUniversalFileIsToldDatasetByDataset) {
  const std::string file = RIGFIT_TESTDATA "/virtual_laboratory/beam/rig/hammer-hit1.uff";
  std::vector<std::size_t> told;
  const Recording read =
      read_recording(file, {.done_with = [&](std::size_t bytes) { told.push_back(bytes); }});
  EXPECT_GE(told.size(), read.channels.size());
  expect_rising(told, std::filesystem::file_size(file));
  const auto stop = [](std::size_t) { throw std::runtime_error("stopped"); };
  EXPECT_THROW(static_cast<void>(read_recording(file, {.done_with = stop})), std::runtime_error);
}

}  // namespace
}  // namespace rigfit::signal
