// Seeds of a reader, faults of it once found by fuzzing, and mutations of both.
#pragma once

#include "tests/test.h"

namespace rigfit {

struct FuzzSeed {
  std::string name, bytes;
};

/// Files of tests/fuzz/seeds/READER and tests/fuzz/regressions/READER, by name.
inline std::vector<FuzzSeed> seeds_of(const std::string& reader) {
  namespace fs = std::filesystem;
  std::vector<FuzzSeed> seeds;
  for (const char* kind : {"seeds", "regressions"}) {
    const fs::path folder = fs::path(RIGFIT_FUZZ) / kind / reader;
    if (!fs::is_directory(folder)) continue;
    for (const auto& entry : fs::directory_iterator(folder)) {
      std::ifstream file(entry.path(), std::ios::binary);
      seeds.push_back({entry.path().filename().string(),
                       std::string(std::istreambuf_iterator<char>(file), {})});
    }
  }
  std::sort(seeds.begin(), seeds.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  return seeds;
}

/// One to four edits: bytes changed, cut, doubled, or replaced by `words` that readers look for.
inline std::string mutated(std::string bytes, const std::vector<std::string>& words,
                           std::mt19937_64& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  for (auto edits = 1 + below(4); edits > 0 && !bytes.empty(); --edits) {
    const std::size_t at = below(bytes.size());
    const std::size_t length = std::min(1 + below(40), bytes.size() - at);
    switch (below(5)) {
      case 0:
        bytes[at] = static_cast<char>(random());
        break;
      case 1:
        bytes.erase(at, length);
        break;
      case 2:
        bytes.insert(below(bytes.size()), bytes.substr(at, length));
        break;
      case 3:
        bytes.insert(at, words[below(words.size())]);
        break;
      default:
        bytes.resize(at);
        break;
    }
  }
  return bytes;
}

/// Seeds of a reader and `count` mutations of each: `read` throws where it gives neither what it
/// owes nor a reason.
template <typename Read>
void expect_sound_or_reason(const std::string& reader, const std::vector<std::string>& words,
                            int count, Read&& read) {
  const auto seeds = seeds_of(reader);
  ASSERT_GE(seeds.size(), 3U) << reader;
  std::mt19937_64 random(20260401);
  for (const auto& seed : seeds) {
    EXPECT_NO_THROW(read(seed.bytes)) << seed.name;
    for (int k = 0; k < count; ++k) {
      const std::string bytes = mutated(seed.bytes, words, random);
      EXPECT_NO_THROW(read(bytes)) << seed.name << ", mutation " << k << ":\n" << bytes;
    }
  }
}

/// Those of the folder of seeds are no refusals.
template <typename Read>
void expect_seeds_are_read(const std::string& reader, Read&& read) {
  for (const auto& seed : seeds_of(reader)) {
    if (!std::filesystem::exists(RIGFIT_FUZZ "/seeds/" + reader + "/" + seed.name)) continue;
    EXPECT_NO_THROW(read(seed)) << seed.name;
  }
}

/// What TOML readers look for.
inline const std::vector<std::string>& toml_words() {
  static const std::vector<std::string> words = [] {
    std::vector<std::string> all{"[[node]]\n", "[[member]]\n", "[[test]]\n", "[[repeat]]\n"};
    std::istringstream others(
        "nan inf -1 1e999 1e-320 0 99999999999 \"\" [] {} \"auto\" true ' \" # [ ]");
    for (std::string word; others >> word;) all.push_back(word);
    all.insert(all.end(), {"\xFF", "\n", "= 2026-04-01 "});
    return all;
  }();
  return words;
}

}  // namespace rigfit
