// Wrong scenes through the program: every mistake ends with exit code 3, and standard error names
// the file, the line, the key, the problem and the remedy; nothing else is written.
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
      {"the same key twice", "GJ = 0.1", "GJ = 0.1\nGJ = 0.2", "GJ = 0.2", "", "not TOML",
       "mend this line"},
      {"decimal comma", "EA = 221780.0", "EA = 221780,0", "EA = 221780,0", "", "not TOML",
       "decimal point"},
      {"unknown key of the scene", "gravity = 9.81", "gravty = 9.81", "gravty", "gravty",
       "not known", "did you mean \"gravity\""},
      {"unknown key of a member", "GJ = 0.1", "G_J = 0.1", "G_J", "member[0].G_J", "not known",
       "did you mean \"GJ\""},
      {"unknown key of a support", "rotational = [1e3", "rotation = [1e3",
       "rotation =", "node[2].support.rotation", "not known", "did you mean \"rotational\""},
      {"unknown key of a damper", "axial = 1.0", "axail = 1.0", "axail", "member[2].damping.axail",
       "not known", "did you mean \"axial\""},
      {"unknown table", "", "[[spring]]\nnode = \"tip\"\n", "[[spring]]", "spring", "not known",
       "known keys"},
      {"a required number is missing", "mass_per_length = 0.16667\n", "", "[[member]]",
       "member[0].mass_per_length", "is missing", "a number in kg/m"},
      {"a required word is missing", "kind = \"impact\"\n", "", "[[load]]", "load[0].kind",
       "is missing", "add `kind"},
      {"a name is missing", "name = \"left\"\n", "", "[[node]]", "node[0].name", "is missing",
       "add `name"},
      {"an empty name", "name = \"left\"", "name = \"\"", "name = \"\"", "node[0].name", "is empty",
       "a name of its own"},
      {"a word for a number", "EI = 0.5972", "EI = \"soft\"", "EI = \"soft\"", "member[0].EI",
       "got the string \"soft\"", "N m2"},
      {"a number with its unit", "EA = 221780.0", "EA = \"221.78 kN\"", "EA = \"221.78 kN\"",
       "member[0].EA", "got the string \"221.78 kN\"", "in N, without quotes or unit"},
      {"a number for a word", "kind = \"cable\"", "kind = 3", "kind = 3", "member[0].kind",
       "must be a string", "double quotes"},
      {"true for a number", "mass = 0.02", "mass = true", "mass = true", "node[1].mass",
       "must be a number, got true", "in kg"},
      {"a table for a number", "tension = 200.0", "tension = { N = 200 }", "tension = { N",
       "member[0].tension", "got a table", "in N"},
      {"half a segment", "segments = 8", "segments = 8.5", "segments = 8.5", "member[0].segments",
       "whole number", "from 2 to"},
      {"one segment", "segments = 8", "segments = 1", "segments = 1\n", "member[0].segments",
       "got 1", "from 2 to"},
      {"a million segments", "segments = 8", "segments = 1000000", "segments = 1000000",
       "member[0].segments", "got 1000000", "from 2 to"},
      {"negative mass", "mass_per_length = 0.3", "mass_per_length = -0.3", "= -0.3",
       "member[2].mass_per_length", "greater than zero, got -0.3", "in kg/m"},
      {"negative stiffness", "EI = [2.1, 8.5]", "EI = [2.1, -8.5]", "-8.5", "member[2].EI",
       "value 2 must not be negative, got -8.5", "2 numbers in N m2"},
      {"zero axial stiffness", "EA = 1e6", "EA = 0", "EA = 0", "member[2].EA",
       "greater than zero, got 0", "in N"},
      {"negative tension", "tension = 200.0", "tension = -200.0", "tension = -200",
       "member[0].tension", "greater than zero", "in N"},
      {"negative node mass", "mass = 0.02", "mass = -0.02", "mass = -0.02", "node[1].mass",
       "must not be negative", "in kg"},
      {"not a number", "EA = 221780.0", "EA = nan", "EA = nan", "member[0].EA",
       "must be a finite number, got nan", "in N"},
      {"infinite", "GJ = 0.1", "GJ = inf", "GJ = inf", "member[0].GJ", "must be a finite number",
       "N m2"},
      {"a position that is not finite", "position = [1.2, 0.0, 0.0]", "position = [1.2, inf, 0.0]",
       "[1.2, inf", "node[1].position", "value 2 must be a finite number", "3 numbers in m"},
      {"a position in a plane", "position = [1.2, 0.0, 0.0]", "position = [1.2, 0.0]",
       "position = [1.2, 0.0]", "node[1].position", "has 2 values", "3 numbers in m"},
      {"an accuracy in percent", "accuracy = 1e-3", "accuracy = 1", "accuracy", "accuracy",
       "at most 0.1", "such as 1e-4"},
      {"damping in percent", "damping_ratio = 0.005", "damping_ratio = 5", "damping_ratio = 5",
       "member[0].damping_ratio", "below 1", "not percent"},
      {"both kinds of damping", "damping_ratio = 0.005",
       "damping_ratio = 0.005\ndamping = { axial = 1 }", "damping = { axial = 1 }",
       "member[0].damping", "beside damping_ratio", "keep one"},
      {"nodes of the same name", "name = \"tip\"", "name = \"left\"",
       "name = \"left\"\nposition = [1.2", "node[1].name", "\"left\" is used twice",
       "names of their own"},
      {"a member named as a node", "name = \"beam\"", "name = \"tip\"", "name = \"tip\"\nkind",
       "member[2].name", "\"tip\" is used twice", "names of their own"},
      {"sensors of the same name", "", "[[sensor]]\nname = \"mid\"\nnode = \"tip\"\n",
       "name = \"mid\"\nnode", "sensor[1].name", "\"mid\" is used twice", "a name of its own"},
      {"a missing node", "nodes = [\"left\", \"tip\"]", "nodes = [\"lfet\", \"tip\"]", "lfet",
       "member[0].nodes", "there is no node \"lfet\"", "did you mean \"left\""},
      {"three nodes", "nodes = [\"left\", \"tip\"]", "nodes = [\"left\", \"tip\", \"foot\"]",
       "\"tip\", \"foot\"", "member[0].nodes", "names 3 nodes", "two nodes"},
      {"a member without length", "nodes = [\"left\", \"tip\"]", "nodes = [\"tip\", \"tip\"]",
       "[\"tip\", \"tip\"]", "member[0].nodes", "has no length", "different positions"},
      {"nodes at the same place", "position = [1.2, 0.0, 0.0]", "position = [0.0, 0.0, 0.0]",
       "nodes = [\"left\"", "member[0].nodes", "has no length", "different positions"},
      {"a node that nothing uses", "", "[[node]]\nname = \"lost\"\nposition = [3, 0, 0]\n",
       "name = \"lost\"", "node[4].name", "no member ends at node \"lost\"", "delete it"},
      {"two rigs in one scene", "",
       "[[node]]\nname = \"a\"\nposition = [3, 0, 0]\n[[node]]\nname = \"b\"\n"
       "position = [4, 0, 0]\n[[member]]\nname = \"loose\"\nkind = \"beam\"\n"
       "nodes = [\"a\", \"b\"]\nmass_per_length = 1\nEA = 1\nEI = 1\n",
       "nodes = [\"a\"", "member[3].nodes", "not connected", "share a node"},
      {"an unknown kind of member", "kind = \"beam\"", "kind = \"rod\"", "kind = \"rod\"",
       "member[2].kind", "does not know \"rod\"", "\"cable\" or \"beam\""},
      {"an unknown support", "support = \"pinned\"", "support = \"pined\"", "pined",
       "node[0].support", "does not know \"pined\"", "did you mean \"pinned\""},
      {"an unknown kind of load", "kind = \"impact\"", "kind = \"step\"", "kind = \"step\"",
       "load[0].kind", "does not know \"step\"", "\"record\""},
      {"an unknown quantity", "quantity = \"velocity\"", "quantity = \"strain\"", "strain",
       "sensor[0].quantity", "does not know \"strain\"", "\"force\""},
      {"an unknown joint", "damping_ratio = 0.005", "joint = \"hinge\"", "hinge", "member[0].joint",
       "does not know \"hinge\"", "\"rigid\" or \"pinned\""},
      {"a cable of no tension", "tension = 200.0\ndamping_ratio = 0.005", "", "[[member]]",
       "member[0].tension", "is missing", "one of tension"},
      {"a tension given twice", "tension = 200.0", "tension = 200.0\nunstretched_length = 1.2",
       "unstretched_length", "member[0].unstretched_length", "a second time", "keep only one"},
      {"a cable stretched away", "tension = 200.0", "stretch = 1.3", "stretch", "member[0].stretch",
       "as long as", "displacement of the end"},
      {"a tensioned beam", "EA = 1e6", "EA = 1e6\ntension = 3", "tension = 3", "member[2].tension",
       "stress-free as drawn", "kind = \"cable\""},
      {"a cable of two bending stiffnesses", "EI = 0.5972", "EI = [0.5, 0.6]", "[0.5, 0.6]",
       "member[0].EI", "two bending stiffnesses", "kind = \"beam\""},
      {"a position in percent", "position = 0.8", "position = 80", "position = 80",
       "load[0].position", "from 0 to 1, got 80", "fraction"},
      {"no direction", "direction = [1.0, 0.0, 0.0]", "direction = [0, 0, 0]", "direction",
       "load[0].direction", "has no length", "such as"},
      {"a load nowhere", "member = \"beam\"\nposition = 0.8\n", "", "[[load]]", "load[0].member",
       "is missing", "say where"},
      {"a sensor at two places", "position = 0.5", "position = 0.5\nnode = \"tip\"",
       "node = \"tip\"", "sensor[0].node", "beside a member", "keep one"},
      {"a sensor on a missing member", "member = \"cable\"", "member = \"cabel\"", "cabel",
       "sensor[0].member", "there is no member \"cabel\"", "did you mean \"cable\""},
      {"a recorded force that is not there", "kind = \"impact\"",
       "kind = \"record\"\nfile = \"none.csv\"", "none.csv", "load[0].file", "there is no file",
       "starts at the scene's folder"},
      {"repeated by nothing", "",
       "[[repeat]]\nmembers = [\"beam\"]\ncount = 2\noffset = [0, 0, 0]\n", "offset",
       "repeat[0].offset", "no length", "distance to the next"},
      {"a mass outside its member", "position = 0.6", "position = 1.6", "1.6",
       "member[2].mass[0].position", "from 0 to 1", "fraction"},
  };
  return all;
}

TEST(SceneMistakes, TheSceneItselfIsRight) {
  const TemporaryFolder folder;
  const auto run = run_program({"modes", folder.write("rig.toml", kScene), "--quiet"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

TEST(SceneMistakes, EndWithThreeNamingFileLineKeyAndRemedy) {
  const TemporaryFolder folder;
  EXPECT_GE(mistakes().size(), 50u);
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
    const auto run = run_program({"modes", scene, "--json", "-"});
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

TEST(SceneMistakes, FilesThatAreNoScenes) {
  const TemporaryFolder folder;
  const auto expect_three = [](const std::string& path, const char* problem) {
    SCOPED_TRACE(problem);
    const auto run = run_program({"modes", path});
    EXPECT_EQ(run.exit_code, 3) << run.err;
    EXPECT_THAT(run.err, HasSubstr(path));
    EXPECT_THAT(run.err, HasSubstr(problem));
    EXPECT_EQ(run.out, "");
  };
  expect_three((folder.path() / "none.toml").string(), "there is no such file");
  expect_three(folder.path().string(), "this is not a file");
  expect_three(folder.write("binary.toml", std::string("\xff\xfe\x00\x01", 4)), "not TOML");
  expect_three(folder.write("empty.toml", ""), "at least one [[member]]");
  expect_three(folder.write("recording.csv", "t,a\n0,1\n"), "not TOML");
  std::string loose = kScene;
  for (const char* support : {"support = \"pinned\"\n", "support = \"pinned\"\n",
                              "support = { translational = [inf, inf, inf], rotational = [1e3, "
                              "inf, 2e3] }\n"}) {
    loose.erase(loose.find(support), std::string(support).size());
  }
  expect_three(folder.write("loose.toml", loose), "nothing holds the rig");
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
    const auto run = run_program({"modes", scene, "--json", "-"});
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
    return run_program({"modes", folder.write("post.toml", text), "--json", "-"});
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
  const auto run = run_program({"modes", folder.write("post.toml", text), "--json", "-"});
  EXPECT_EQ(run.exit_code, 5) << run.err;
  EXPECT_THAT(run.err, HasSubstr("\"post\" can move"));
  EXPECT_THAT(run.err, HasSubstr("mechanism; give one of its nodes a support"));
}

}  // namespace
}  // namespace rigfit::apps::scene_mistakes_test
