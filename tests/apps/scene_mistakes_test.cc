// Wrong scenes through the program: a mistake ends with exit code 3, and standard error names the
// file, the line, the key, the problem and the remedy; nothing else is written. All mistakes:
// tests/model/scene/read_scene_test.cc.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "model/scene/read_scene.h"
#include "tests/apps/cable_scene.h"
#include "tests/apps/run_program.h"
#include "tests/scenes.h"

namespace rigfit::apps::scene_mistakes_test {
namespace {
using ::testing::HasSubstr;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(SceneMistakes, EndWithThreeNamingFileLineKeyAndRemedy) {
  struct Mistake {
    const char *from, *to;
    int line;
    const char *key, *problem, *remedy;
  };
  const TemporaryFolder folder;
  for (const Mistake& mistake :
       {Mistake{"GJ = 0.1", "G_J = 0.1", 17, "member[0].G_J", "not known", "did you mean \"GJ\""},
        {"[\"left\", ", "[\"lfet\", ", 12, "member[0].nodes", "there is no node \"lfet\"",
         "did you mean \"left\""}}) {
    SCOPED_TRACE(mistake.to);
    const std::string scene =
        folder.write("rig.toml", replaced(kCableScene, mistake.from, mistake.to));
    const auto run = run_line("modes {} --json -", {scene});
    EXPECT_EQ(run.exit_code, 3) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_THAT(run.err,
                HasSubstr(mistake.line == 0 ? scene : fmt::format("{}:{}:", scene, mistake.line)));
    for (const char* said : {mistake.key, mistake.problem, mistake.remedy}) {
      EXPECT_THAT(run.err, HasSubstr(said));
    }
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
}

/// Scenes that read well and cannot rest: exit code 5, what gives way, and what to change.
TEST(SceneMistakes, ScenesThatCannotRestEndWithFive) {
  const auto limp = [](const std::string& tension) {
    return replaced(kCableScene, "tension = 200.0", tension);
  };
  // A post on a hinge falls over; a mast too slender for its own weight buckles.
  const auto post = [](bool hinged, double mass_per_length, bool weightless = false) {
    auto scene = model::testing::vertical_beam(0.75, 2.1, mass_per_length, 20);
    if (hinged) scene.nodes[0].support.kind = model::Support::Kind::pinned;
    if (weightless) scene.gravity.setZero();
    scene.members[0].EA = 1e6, scene.members[0].GJ = 0;
    return model::scene_text(scene);
  };
  auto twisting = model::testing::cable_beam_rig(200, 0.5972, 8);
  twisting.members[0].GJ = 0;
  struct Impossible {
    std::string scene, status, culprit, remedy;
  };
  const TemporaryFolder folder;
  for (const Impossible& one :
       {Impossible{"gravity = 0.0\n" + limp("unstretched_length = 3.0"), "slack", "cable \"cable\"",
                   "a shorter unstretched_length"},
        {replaced(limp("tension = 1e-6"), "EI = 0.5972\nGJ = 0.1", "EI = 0"), "slack",
         "cable \"cable\"", "a larger tension"},
        {model::scene_text(twisting), "mechanism", "\"beam\" can twist", "give it a GJ"},
        {post(true, 0.3), "buckled", "buckled", "brace it"},
        {post(false, 6), "buckled", "buckled", "brace it"},
        {post(true, 0.3, true), "mechanism", "\"beam\" can move",
         "give one of its nodes a support"}}) {
    const std::string scene = folder.write("rig.toml", one.scene);
    const auto run = run_line("modes {} --json -", {scene});
    EXPECT_EQ(run.exit_code, 5) << one.scene << run.err;
    EXPECT_THAT(run.err, HasSubstr(scene));
    EXPECT_THAT(run.err, HasSubstr(one.culprit));
    EXPECT_THAT(run.err, HasSubstr(one.remedy));
    const auto json = parsed(run.out);
    EXPECT_EQ(json["equilibrium"]["status"], one.status) << one.scene;
    EXPECT_TRUE(json["modes"].empty());
  }
}

}  // namespace
}  // namespace rigfit::apps::scene_mistakes_test
