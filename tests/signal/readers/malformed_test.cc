// Every reader, fed with seeds, with regressions of faults found by fuzzing and with thousands of
// mutations of both, gives a sound recording or a RecordingError: never a crash, a hang or a wrong
// count. The libFuzzer targets in tests/fuzz search deeper.
#include "signal/readers/read_recording.h"
#include "signal/readers/uff58.h"
#include "tests/fuzz/mutations.h"
#include "tests/fuzz/require_sound.h"
#include "tests/temporary_folder.h"
#include "tests/test.h"

namespace rigfit::signal::malformed_test {

void read_with_all(const std::string& bytes) {
  read_or_refuse([&] { require_sound(read_csv(bytes, "x")); });
  read_or_refuse([&] { require_sound(read_lvm(bytes, "x")); });
  read_or_refuse([&] { require_sound(read_uff(bytes, "x")); });
  read_or_refuse([&] { (void)read_uff_frfs(bytes, "x"); });
  read_or_refuse([&] { require_sound(read_uff_modes(bytes, "x")); });
}

TEST(Malformed, SeedsAndMutationsGiveARecordingOrAReason) {
  std::vector<std::string> words{"-1\n", "    -1\n", "\r", "\n", "\t", std::string(1, '\0')};
  std::istringstream others("nan 1e999 -1e-999 \" , ; 58b 9999999999 ***End_of_Header*** \xFF 0 -");
  for (std::string word; others >> word;) words.push_back(word);
  for (const char* reader : {"csv", "lvm", "uff", "uff_modes"}) {
    expect_sound_or_reason(reader, words, 100, read_with_all);
  }
}

TEST(Malformed, FilesThatLibrariesRead) {
  const testing::TemporaryFolder folder;
  for (const char* reader : {"mat", "npy", "wav"}) {
    const auto read = [&](const std::string& bytes) {
      const auto path = folder.write(reader, bytes);
      read_or_refuse([&] { require_sound(read_recording(path, {.format = reader})); });
    };
    expect_sound_or_reason(reader, {std::string(4, '\xFF')}, 150, read);
  }
}

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
    expect_seeds_are_read(
        reader, [&](const FuzzSeed& seed) { require_sound(read(seed.bytes, seed.name)); });
  };
  using Text = const std::string&;
  read_all("csv", [](Text bytes, Text name) { return read_csv(bytes, name); });
  read_all("lvm", [](Text bytes, Text name) { return read_lvm(bytes, name); });
  const testing::TemporaryFolder folder;  // for the files that libmatio reads
  read_all("mat",
           [&](Text bytes, Text name) { return read_mat(bytes, folder.write(name, bytes)); });
  read_all("uff_modes", [](Text bytes, Text name) { return read_uff_modes(bytes, name); });
  expect_seeds_are_read("uff", [](const FuzzSeed& seed) {
    if (seed.name == "psd.uff") return static_cast<void>(read_uff58(seed.bytes, "x"));
    if (seed.name.starts_with("frf")) return static_cast<void>(read_uff_frfs(seed.bytes, "x"));
    require_sound(read_uff(seed.bytes, "x"));
  });
}

}  // namespace rigfit::signal::malformed_test
