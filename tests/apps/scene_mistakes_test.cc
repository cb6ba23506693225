// Wrong scenes through the program: a mistake ends with exit code 3, and standard error names the
// file, the line, the key, the problem and the remedy; nothing else is written. All mistakes:
// tests/model/scene/read_scene_test.cc.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/apps/run_program.h"

namespace rigfit::apps::scene_mistakes_test {
namespace {
using ::testing::HasSubstr;

const char* const kScene = R"(title = "rig"
gravity = 9.81
accuracy = 1e-3

[[node]]
name = "left"
position = [0.0, 0.0, 0.0]
support = "pinned"

[[node]]
name = "tip"
position = [1.2, 0.0, 0.0]
mass = 0.02

[[node]]
name = "foot"
position = [1.2, -0.75, 0.0]
support = { translational = [inf, inf, inf], rotational = [1e3, inf, 2e3] }

[[node]]
name = "right"
position = [2.4, 0.0, 0.0]
support = "pinned"

[[member]]
name = "cable"
kind = "cable"
nodes = ["left", "tip"]
segments = 8
mass_per_length = 0.16667
EA = 221780.0
EI = 0.5972
GJ = 0.1
tension = 200.0
damping_ratio = 0.005

[[member]]
name = "other"
kind = "cable"
nodes = ["tip", "right"]
segments = 9
mass_per_length = 0.16667
EA = 221780.0
EI = 0.5972
tension = 200.0

[[member]]
name = "beam"
kind = "beam"
nodes = ["foot", "tip"]
segments = 10
mass_per_length = 0.3
EA = 1e6
EI = [2.1, 8.5]
GJ = 1.5
damping = { axial = 1.0, bending = 0.01 }
mass = [{ position = 0.6, mass = 0.005 }]

[[load]]
name = "hammer"
kind = "impact"
member = "beam"
position = 0.8
direction = [1.0, 0.0, 0.0]
peak = 100.0
duration = 0.002

[[sensor]]
name = "mid"
member = "cable"
position = 0.5
quantity = "velocity"
)";

struct Mistake {
  std::string what;  ///< for a person who reads the test
  std::string from;  ///< text of kScene to be replaced; empty: `to` is added at the end
  std::string to;
  std::string at;  ///< text of the wrong scene on the line that must be named; empty: no line
  std::string key;
  std::string problem, remedy;
};

const std::vector<Mistake>& mistakes() {
  static const std::vector<Mistake> all{
      {"not TOML", "title = \"rig\"", "title = \"rig", "title", "", "not TOML", "mend this line"},
      {"decimal comma", "EA = 221780.0", "EA = 221780,0", "EA = 221780,0", "", "not TOML",
       "decimal point"},
      {"unknown key of a member", "GJ = 0.1", "G_J = 0.1", "G_J", "member[0].G_J", "not known",
       "did you mean \"GJ\""},
      {"a required word is missing", "kind = \"impact\"\n", "", "[[load]]", "load[0].kind",
       "is missing", "add `kind"},
      {"a number with its unit", "EA = 221780.0", "EA = \"221.78 kN\"", "EA = \"221.78 kN\"",
       "member[0].EA", "got the string \"221.78 kN\"", "in N, without quotes or unit"},
      {"half a segment", "segments = 8", "segments = 8.5", "segments = 8.5", "member[0].segments",
       "whole number", "from 2 to"},
      {"both kinds of damping", "damping_ratio = 0.005",
       "damping_ratio = 0.005\ndamping = { axial = 1 }", "damping = { axial = 1 }",
       "member[0].damping", "beside damping_ratio", "keep one"},
      {"a missing node", "nodes = [\"left\", \"tip\"]", "nodes = [\"lfet\", \"tip\"]", "lfet",
       "member[0].nodes", "there is no node \"lfet\"", "did you mean \"left\""},
      {"two rigs in one scene", "",
       "[[node]]\nname = \"a\"\nposition = [3, 0, 0]\n[[node]]\nname = \"b\"\n"
       "position = [4, 0, 0]\n[[member]]\nname = \"loose\"\nkind = \"beam\"\n"
       "nodes = [\"a\", \"b\"]\nmass_per_length = 1\nEA = 1\nEI = 1\n",
       "nodes = [\"a\"", "member[3].nodes", "not connected", "share a node"},
      {"a recorded force that is not there", "kind = \"impact\"",
       "kind = \"record\"\nfile = \"none.csv\"", "none.csv", "load[0].file", "there is no file",
       "starts at the scene's folder"},
  };
  return all;
}

TEST(SceneMistakes, EndWithThreeNamingFileLineKeyAndRemedy) {
  const TemporaryFolder folder;
  for (const Mistake& mistake : mistakes()) {
    SCOPED_TRACE(mistake.what);
    std::string text = kScene;
    if (mistake.from.empty()) {
      text += mistake.to;
    } else {
      const auto at = text.find(mistake.from);
      ASSERT_NE(at, std::string::npos);
      text.replace(at, mistake.from.size(), mistake.to);
    }
    const std::string scene = folder.write("rig.toml", text);
    const auto run = run_line("modes {} --json -", {scene});
    EXPECT_EQ(run.exit_code, 3) << run.err;
    EXPECT_EQ(run.out, "");
    std::string where = scene;
    if (!mistake.at.empty()) {
      const auto at = text.find(mistake.at);
      ASSERT_NE(at, std::string::npos);
      const auto end = text.begin() + static_cast<std::ptrdiff_t>(at);
      where += ":" + std::to_string(1 + std::count(text.begin(), end, '\n')) + ":";
    }
    EXPECT_THAT(run.err, HasSubstr(where));
    EXPECT_THAT(run.err, HasSubstr(mistake.key));
    EXPECT_THAT(run.err, HasSubstr(mistake.problem));
    EXPECT_THAT(run.err, HasSubstr(mistake.remedy));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
}

TEST(SceneMistakes, AFileThatIsNoSceneAndARigThatNothingHolds) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_line("modes {} --quiet", {folder.write("rig.toml", kScene)}).exit_code, 0);
  std::string loose = kScene;
  for (const char* support : {"support = \"pinned\"\n", "support = \"pinned\"\n",
                              "support = { translational = [inf, inf, inf], rotational = [1e3, "
                              "inf, 2e3] }\n"}) {
    loose.erase(loose.find(support), std::string(support).size());
  }
  for (const auto& [path, problem] :
       {std::pair{folder.at("none.toml"), "there is no such file"},
        {folder.write("loose.toml", loose), "nothing holds the rig"}}) {
    const auto run = run_line("modes {}", {path});
    EXPECT_EQ(run.exit_code, 3) << run.err;
    EXPECT_THAT(run.err, HasSubstr(path));
    EXPECT_THAT(run.err, HasSubstr(problem));
    EXPECT_EQ(run.out, "");
  }
}

/// Scenes that read well and cannot rest: exit code 5, what gives way, and what to change.
TEST(SceneMistakes, ScenesThatCannotRestEndWithFive) {
  struct Impossible {
    std::string what, from, to, status, culprit, remedy;
  };
  const std::vector<Impossible> all{
      {"too long a cable", "tension = 200.0", "unstretched_length = 100", "slack",
       "cable \"cable\"", "a shorter unstretched_length"},
      {"a tension that cannot bear the cable", "EI = 0.5972\nGJ = 0.1\ntension = 200.0",
       "EI = 0\ntension = 1e-6", "slack", "cable \"cable\"", "a larger tension"},
      {"a section free to twist", "GJ = 1.5", "GJ = 0", "mechanism", "\"beam\" can twist",
       "give it a GJ"},
  };
  const TemporaryFolder folder;
  for (const Impossible& one : all) {
    SCOPED_TRACE(one.what);
    std::string text = kScene;
    text.replace(text.find(one.from), one.from.size(), one.to);
    const std::string scene = folder.write("rig.toml", text);
    const auto run = run_line("modes {} --json -", {scene});
    EXPECT_EQ(run.exit_code, 5) << run.err;
    EXPECT_THAT(run.err, HasSubstr(scene));
    EXPECT_THAT(run.err, HasSubstr(one.culprit));
    EXPECT_THAT(run.err, HasSubstr(one.remedy));
    const auto json = parsed(run.out);
    EXPECT_EQ(json["equilibrium"]["status"], one.status);
    EXPECT_TRUE(json["modes"].empty());
  }
  // A post on a hinge falls over; a mast too slender for its own weight buckles.
  const std::string post = R"([[node]]
name = "foot"
position = [0.0, 0.0, 0.0]
support = "SUPPORT"
[[node]]
name = "top"
position = [0.0, 0.75, 0.0]
[[member]]
name = "post"
kind = "beam"
nodes = ["foot", "top"]
segments = 20
mass_per_length = MASS
EA = 1e6
EI = 2.1
)";
  const auto rest = [&](const std::string& support, const std::string& mass) {
    std::string text = post;
    text.replace(text.find("SUPPORT"), 7, support);
    text.replace(text.find("MASS"), 4, mass);
    return run_line("modes {} --json -", {folder.write("post.toml", text)});
  };
  EXPECT_EQ(rest("clamped", "0.3").exit_code, 0);
  for (const auto& [support, mass] : {std::pair{"pinned", "0.3"}, std::pair{"clamped", "6.0"}}) {
    const auto run = rest(support, mass);
    EXPECT_EQ(run.exit_code, 5) << run.err;
    EXPECT_THAT(run.err, HasSubstr("post.toml"));
    EXPECT_THAT(run.err, HasSubstr("buckled"));
    EXPECT_THAT(run.err, HasSubstr("brace it"));
    EXPECT_EQ(parsed(run.out)["equilibrium"]["status"], "buckled");
  }
  const std::string weightless = "gravity = 0.0\n" + post;
  std::string text = weightless;
  text.replace(text.find("SUPPORT"), 7, "pinned");
  text.replace(text.find("MASS"), 4, "0.3");
  const auto run = run_line("modes {} --json -", {folder.write("post.toml", text)});
  EXPECT_EQ(run.exit_code, 5) << run.err;
  EXPECT_THAT(run.err, HasSubstr("\"post\" can move"));
  EXPECT_THAT(run.err, HasSubstr("mechanism; give one of its nodes a support"));
}

}  // namespace
}  // namespace rigfit::apps::scene_mistakes_test
