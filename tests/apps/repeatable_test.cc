// The same inputs, version and seed give the same document, from run to run and with one thread or
// two: to the last digit, since every sum is taken in an order of its own making.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/apps/run_program.h"

namespace rigfit::apps::repeatable_test {
namespace {

using Document = nlohmann::ordered_json;

struct Command {
  const char* name;
  std::vector<std::string> words;
};

std::string lab(const std::string& name) { return RIGFIT_TESTDATA "/virtual_laboratory/" + name; }

std::vector<std::string> hits() {
  std::vector<std::string> files;
  for (int hit = 1; hit <= 5; ++hit) {
    files.push_back(lab("beam/rig/hammer-hit" + std::to_string(hit) + ".uff"));
  }
  return files;
}

std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::vector<Command> commands() {
  using Words = std::vector<std::string>;
  std::vector<Command> list;
  list.push_back({"frf", Words{"frf"} + hits() + Words{"--force", "force", "--band", "1", "160"}});
  list.push_back(
      {"modal", Words{"modal"} + hits() + Words{"--force", "force", "--band", "1", "160"}});
  Words axial{"axial"}, lengths{"--length"};
  for (const char* length : {"0.7", "1", "1.3"}) {
    for (int tap = 1; tap <= 2; ++tap) {
      axial.push_back(
          lab("bench/axial/L" + std::string(length) + "m-" + std::to_string(tap) + ".csv"));
      lengths.emplace_back(length);
    }
  }
  list.push_back(
      {"axial", axial + lengths +
                    Words{"--length-std", "0.001", "--mass", "2.2", "--mass-std", "0.002",
                          "--mass-per-length", "0.16667", "--band", "20", "100"}});
  list.push_back({"update",
                  {"update", RIGFIT_TESTDATA "/jalali2021/scenes/beam.toml", "--measured",
                   RIGFIT_TESTDATA "/jalali2021/table2_beam_frequencies.csv", "--column", "test_Hz",
                   "--plane", "in", "--free", "beam.EI_z", "tip.mass", "--out", "OUT/beam.toml"}});
  list.push_back({"report", {"report", "OUT/campaign.toml", "--out", "OUT/report"}});
  return list;
}

// Tests and a fit with several starts, for threads to share.
constexpr const char* kCampaign = R"(title = "beam"
[[scene]]
name = "beam"
file = "@/scenes/beam.toml"
[[test]]
name = "bending"
kind = "bending"
span = 1.0
table = { file = "@/table1_bending_stiffness.csv", tension = "tension_N", EI = "EI_Nm2" }
[[test]]
name = "beam"
kind = "modal"
scene = "beam"
planes = ["in"]
table = { file = "@/table2_beam_frequencies.csv", measured = "test_Hz" }
[[fit]]
name = "fit"
tests = ["beam"]
starts = 4
[[fit.parameter]]
name = "beam.EI_z"
[[fit.parameter]]
name = "tip.mass"
)";

/// The document less what names its folder and what measures time.
std::string numbers_of(Document document) {
  const auto prune = [](auto&& self, Document& value) -> void {
    for (const char* key : {"wall_s", "out", "files", "scenes_written"}) {
      if (value.is_object()) value.erase(key);
    }
    if (!value.is_structured()) return;
    for (auto& child : value) self(self, child);
  };
  prune(prune, document);
  return document.dump(1);
}

std::string run(const Command& command, const char* threads, const char* seed) {
  const TemporaryFolder folder;
  std::string campaign = kCampaign;
  for (std::size_t at; (at = campaign.find('@')) != std::string::npos;) {
    campaign.replace(at, 1, RIGFIT_TESTDATA "/jalali2021");
  }
  folder.write("campaign.toml", campaign);
  std::vector<std::string> words = command.words;
  for (auto& word : words) {
    if (word.starts_with("OUT/")) word = (folder.path() / word.substr(4)).string();
  }
  const auto done = run_program(
      words + std::vector<std::string>{"--threads", threads, "--seed", seed, "--json", "-"});
  EXPECT_EQ(done.exit_code, 0) << command.name << "\n" << done.err;
  if (done.exit_code != 0) return "";
  std::string text = numbers_of(Document::parse(done.out));
  for (std::size_t at; (at = text.find(folder.path().string())) != std::string::npos;) {
    text.replace(at, folder.path().string().size(), "OUT");
  }
  return text;
}

TEST(Repeatable, FromRunToRunAndWithOneThreadOrTwo) {
  for (const auto& command : commands()) {
    SCOPED_TRACE(command.name);
    const std::string once = run(command, "1", "1");
    ASSERT_GT(once.size(), 200u);
    EXPECT_EQ(run(command, "2", "1"), once);
  }
}

}  // namespace
}  // namespace rigfit::apps::repeatable_test
