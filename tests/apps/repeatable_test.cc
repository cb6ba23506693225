// The same inputs, version and seed give the same document, from run to run and with one thread or
// two: to the last digit, since every sum is taken in an order of its own making. Reports:
// PublishedTables.
#include "tests/apps/apps_test.h"

namespace rigfit::apps::repeatable_test {

std::vector<std::string> commands() {
  std::string hits, axial, lengths;
  for (const char* hit : {"1", "2", "3", "4", "5"}) {
    hits += fmt::format(" $/virtual_laboratory/beam/rig/hammer-hit{}.uff", hit);
  }
  for (const char* length : {"0.7", "1", "1.3"}) {
    for (const char* tap : {"1", "2"}) {
      axial += fmt::format(" $/virtual_laboratory/bench/axial/L{}m-{}.csv", length, tap);
      lengths += fmt::format(" {}", length);
    }
  }
  return {"frf" + hits + " --force force --band 1 160",
          "modal" + hits + " --force force --band 1 160",
          "axial" + axial + " --length" + lengths +
              " --length-std 0.001 --mass 2.2 --mass-std 0.002 --mass-per-length 0.16667 --band 20 "
              "100",
          "update $/jalali2021/scenes/beam.toml --measured "
          "$/jalali2021/table2_beam_frequencies.csv --column test_Hz --plane in --free beam.EI_z "
          "tip.mass --out OUT/beam.toml"};
}

/// The document less what names its folder and what measures time.
std::string numbers_of(nlohmann::ordered_json document) {
  const auto prune = [](auto&& self, nlohmann::ordered_json& value) -> void {
    for (const char* key : {"wall_s", "out", "files", "scenes_written"}) {
      if (value.is_object()) value.erase(key);
    }
    if (!value.is_structured()) return;
    for (auto& child : value) self(self, child);
  };
  prune(prune, document);
  return document.dump(1);
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at; (at = text.find(from)) != std::string::npos;) {
    text.replace(at, from.size(), to);
  }
}

std::string run(std::string line, const std::string& threads) {
  const TemporaryFolder folder;
  replace_all(line, "OUT", folder.path().string());
  const auto done = run_line(line + " --seed 1 --json - --threads " + threads);
  EXPECT_EQ(done.exit_code, 0) << line << "\n" << done.err;
  if (done.exit_code != 0) return "";
  std::string text = numbers_of(nlohmann::ordered_json::parse(done.out));
  replace_all(text, folder.path().string(), "OUT");
  return text;
}

TEST(Repeatable, FromRunToRunAndWithOneThreadOrTwo) {
  for (const auto& command : commands()) {
    const std::string once = run(command, "1");
    ASSERT_GT(once.size(), 200u);
    EXPECT_EQ(run(command, "2"), once) << command;
  }
}

}  // namespace rigfit::apps::repeatable_test
