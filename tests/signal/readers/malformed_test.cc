// Every reader, fed with seeds, with regressions of faults found by fuzzing and with thousands of
// mutations of both, gives a sound recording or a RecordingError: never a crash, a hang or a wrong
// count. The libFuzzer targets in tests/fuzz search deeper.
#include <filesystem>

#include "signal/readers/files/read_formats.h"
#include "signal/readers/uff/read_uff_modes.h"
#include "tests/fuzz/mutations.h"
#include "tests/fuzz/require_sound.h"
#include "tests/test.h"

namespace rigfit::signal::malformed_test {
namespace {
namespace fs = std::filesystem;

void read_with_all(const std::string& bytes) {
  read_or_refuse([&] { require_sound(read_csv(bytes, "x")); });
  read_or_refuse([&] { require_sound(read_lvm(bytes, "x")); });
  read_or_refuse([&] { require_sound(read_uff(bytes, "x")); });
  read_or_refuse([&] { require_sound(read_uff_functions(bytes, "x")); });
  read_or_refuse([&] { (void)read_uff_frfs(bytes, "x"); });
  read_or_refuse([&] { require_sound(read_uff_modes(bytes, "x")); });
}

const std::vector<std::string> kWords = {"-1\n",       "    -1\n",
                                         "nan",        "1e999",
                                         "-1e-999",    "\"",
                                         "\r",         "\n",
                                         ",",          ";",
                                         "\t",         "58b",
                                         "9999999999", "***End_of_Header***",
                                         "\xFF",       "0",
                                         "-",          std::string(1, '\0')};

class Malformed : public ::testing::TestWithParam<const char*> {};

TEST_P(Malformed, SeedsAndMutationsGiveARecordingOrAReason) {
  const auto seeds = seeds_of(GetParam());
  ASSERT_GE(seeds.size(), 4u);
  std::mt19937_64 random(20260401);
  for (const auto& seed : seeds) {
    EXPECT_NO_THROW(read_with_all(seed.bytes)) << seed.name;
    for (int k = 0; k < 300; ++k) {
      const std::string bytes = mutated(seed.bytes, kWords, random);
      EXPECT_NO_THROW(read_with_all(bytes)) << seed.name << ", mutation " << k << ":\n" << bytes;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Readers, Malformed, ::testing::Values("csv", "lvm", "uff", "uff_modes"));

TEST(FuzzSeeds, LongFilesOfOddLineEndsAreReadInLinearTime) {
  // 2 MB with carriage returns only and a fault at the end: a search for the other line end from
  // every line would take minutes, the test's limit is in seconds.
  std::string text = "t,a\r";
  for (int k = 0; k < 200000; ++k) text += std::to_string(k) + ".5,1.25\r";
  EXPECT_EQ(read_csv(text, "x").samples(), 200000);
  for (int k = 0; k < 20000; ++k) text += "0.5,wrong\r";
  EXPECT_THROW((void)read_csv(text, "x"), RecordingError);
  std::string marks;
  for (int k = 0; k < 100000; ++k) marks += "    -1\r    15\r    -1\r";
  EXPECT_THROW((void)read_uff(marks + "    -1\r    x\r", "x"), RecordingError);
}

TEST(FuzzSeeds, AreReadable) {
  const auto read_all = [](const std::string& reader, auto&& read) {
    for (const auto& seed : seeds_of(reader)) {
      if (!fs::exists(fs::path(RIGFIT_FUZZ) / "seeds" / reader / seed.name)) continue;
      EXPECT_NO_THROW(require_sound(read(seed.bytes, seed.name))) << seed.name;
    }
  };
  using Text = const std::string&;
  read_all("csv", [](Text bytes, Text name) { return read_csv(bytes, name); });
  read_all("lvm", [](Text bytes, Text name) { return read_lvm(bytes, name); });
  read_all("uff_modes", [](Text bytes, Text name) { return read_uff_modes(bytes, name); });
  read_all("uff", [](Text bytes, Text name) { return read_uff_functions(bytes, name); });
}

}  // namespace
}  // namespace rigfit::signal::malformed_test
