// A table costs the memory of its numbers, not that of its text.
#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include "signal/readers/read_recording.h"
#include "tests/test.h"

namespace rigfit::signal::bounded_memory_test {

namespace fs = std::filesystem;

/// A line "Name: 123 kB" of /proc/self/status, in bytes.
std::optional<double> bytes_of(const std::string& name) {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(name + ":", 0) == 0) return 1024 * std::stod(line.substr(name.size() + 1));
  }
  return {};
}

/// The peak of resident memory begins anew; false where the system does not let it.
bool reset_peak() {
  ::malloc_trim(0);
  const int file = ::open("/proc/self/clear_refs", O_WRONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool done = ::write(file, "5", 1) == 1;
  ::close(file);
  return done;
}

TEST(ReadCsv, MemoryIsThatOfTheNumbers) {
#ifdef RIGFIT_SANITIZED
  GTEST_SKIP() << "the sanitizer's own memory would be measured";
#endif
  constexpr int kColumns = 3, kLines = 2000;
  constexpr double kSize = 64e6;
  std::string block;
  for (int k = 0; k < kLines; ++k) {
    for (int c = 0; c < kColumns; ++c) {
      block += (c > 0 ? "," : "") + std::to_string(std::sin(0.001 * (k + 1) * (c + 1))) +
               "0123456";  // 15 digits
    }
    block += '\n';
  }
  const fs::path path =
      fs::temp_directory_path() / ("rigfit_memory_" + std::to_string(::getpid()) + ".csv");
  long blocks = 0;
  {
    std::ofstream out(path, std::ios::binary);
    out << "sample_rate_hz,51200\na,b,c\n";
    for (double written = 0; written < kSize; written += double(block.size()), ++blocks) {
      out << block;
    }
    ASSERT_TRUE(out.good());
  }
  const double file_bytes = double(fs::file_size(path));
  const double numbers = 8.0 * kColumns * kLines * double(blocks);
  ASSERT_LT(numbers, 0.55 * file_bytes);
  const bool measurable = reset_peak();
  const auto before = bytes_of("VmRSS");
  const Recording recording = read_recording(path);
  const auto peak = bytes_of("VmHWM");
  fs::remove(path);
  ASSERT_EQ(recording.channels.size(), std::size_t(kColumns));
  EXPECT_EQ(recording.samples(), kLines * blocks);
  if (!measurable || !before || !peak) GTEST_SKIP() << "no peak of memory can be had here";
  // The text would be twice as much again.
  EXPECT_LT(*peak - *before, numbers + 25e6) << "numbers: " << numbers << ", file: " << file_bytes;
  EXPECT_GT(*peak - *before, 0.9 * numbers);
}

}  // namespace rigfit::signal::bounded_memory_test
