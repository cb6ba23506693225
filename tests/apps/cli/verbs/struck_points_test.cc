// A rig struck at several points: the verb `modal` and the report give the same modes and hits to
// the last digit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/apps/cable_scene.h"
#include "tests/apps/run_program.h"

namespace rigfit::apps::struck_points_test {
namespace {

std::string scene() {
  std::string text = kCableScene + std::string("damping_ratio = 0.005\n");
  for (const auto& [name, place] : {std::pair{"quarter", "0.25"}, std::pair{"middle", "0.4"}}) {
    text += std::string("[[load]]\nname = \"") + name + "\"\nposition = " + place +
            "\nkind = \"impact\"\nmember = \"cable\"\ndirection = [0.0, -1.0, 0.0]\npeak = 5.0\n"
            "duration = 0.006\n";
  }
  for (const auto& [name, place] : {std::pair{"a", "0.5"}, std::pair{"b", "0.33"}}) {
    text += std::string("[[sensor]]\nname = \"") + name + "\"\nposition = " + place +
            "\nmember = \"cable\"\nquantity = \"acceleration\"\ndirection = [0.0, 1.0, 0.0]\n";
  }
  return text;
}

TEST(StruckPoints, AreJoinedByTheReportAsByTheVerb) {
  const TemporaryFolder folder;
  const auto path = [&](const char* name) { return folder.at(name); };
  const std::string rig = folder.write("rig.toml", scene());
  ASSERT_EQ(
      run_line("synthesize {} --out {} --seed 3 --rate 1024 --record 4 --hits 2 --double-hits 0",
               {rig, path("lab")})
          .exit_code,
      0);
  folder.write("campaign.toml", R"(title = "rig"
[[scene]]
name = "cable"
file = "rig.toml"
[[test]]
name = "hits"
kind = "modal"
scene = "cable"
planes = "in"
force = "force"
band = [4, 60]
[[test.recording]]
files = "lab/rig/quarter-hit*.csv"
load = "quarter"
[[test.recording]]
files = "lab/rig/middle-hit*.csv"
load = "middle"
)");
  const auto reported = run_line("report {} --out {}", {path("campaign.toml"), path("out")});
  ASSERT_EQ(reported.exit_code, 0) << reported.err;
  const auto report = parsed(folder.read("out/report.json"));
  const auto& state = report["recorded_modal"][0]["states"][0];

  std::vector<std::string> call{"modal"};
  for (const char* hit : {"quarter-hit1", "quarter-hit2", "middle-hit1", "middle-hit2"}) {
    call.push_back(path("lab/rig/") + std::string(hit) + ".csv");
  }
  for (const char* more : {"--force", "force", "--band", "4", "60", "--json", "-", "--struck",
                           "quarter", "quarter", "middle", "middle"}) {
    call.emplace_back(more);
  }
  const auto run = run_program(call);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto verb = parsed(run.out);
  EXPECT_EQ(verb["input_points"].size(), 2u);
  EXPECT_THAT(state["responses"], ::testing::ElementsAre("a", "b"));
  EXPECT_GE(verb["modes"].size(), 5u);
  ASSERT_EQ(state["modes"].size(), verb["modes"].size());
  EXPECT_EQ(state["modes"], verb["modes"]);
  std::vector<double> peaks, verb_peaks;
  for (const auto& place : state["struck"]) {
    for (const auto& hit : place["hits"]) peaks.push_back(hit["peak"]);
  }
  for (const auto& hit : verb["hits"]) verb_peaks.push_back(hit["peak"]);
  EXPECT_EQ(peaks, verb_peaks);
}

}  // namespace
}  // namespace rigfit::apps::struck_points_test
