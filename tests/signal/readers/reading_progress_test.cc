// Readers tell how far they are, and what is thrown there ends the reading.
#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "signal/readers/files/read_formats.h"
#include "signal/readers/read_recording.h"

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
      read_recording(file, {}, [&](std::size_t bytes) { told.push_back(bytes); });
  EXPECT_GE(told.size(), read.channels.size());
  expect_rising(told, std::filesystem::file_size(file));
  const auto stop = [](std::size_t) { throw std::runtime_error("stopped"); };
  EXPECT_THROW(static_cast<void>(read_recording(file, {}, stop)), std::runtime_error);
}

// A table is told every 16 MB.
TEST(ReadingProgress, ALongTableIsToldOnTheWay) {
  std::string text = "force [N]\n";
  const std::string rows(std::size_t{1} << 16, '1');
  while (text.size() < (std::size_t{18} << 20)) {
    text += rows;
    for (std::size_t k = text.size() - rows.size() + 15; k < text.size(); k += 16) text[k] = '\n';
  }
  std::vector<std::size_t> told;
  static_cast<void>(read_csv(text, "long.csv", {}, [&](std::size_t at) { told.push_back(at); }));
  expect_rising(told, text.size());
}

}  // namespace
}  // namespace rigfit::signal
