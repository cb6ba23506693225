#include "model/scene/read_scene.h"

#include "tests/fuzz/mutations.h"
#include "tests/fuzz/require_scene.h"
#include "tests/model/scene/mistakes.h"
#include "tests/scenes.h"
#include "tests/temporary_folder.h"
#include "tests/test.h"

namespace rigfit::model::read_scene_test {

/// Line numbers below count in this text.
const std::string kScene = rigfit::testing::content_of(RIGFIT_FUZZ "/seeds/scene/small_rig.toml");

TEST(ReadScene, ReadsEverything) {
  const Scene scene = parse_scene(kScene, "rig.toml");
  EXPECT_EQ(scene.title, "rig");
  EXPECT_EQ(scene.file, "rig.toml");
  EXPECT_EQ(scene.gravity, Eigen::Vector3d(0, -9.81, 0));
  EXPECT_EQ(scene.accuracy, 1e-5);
  ASSERT_EQ(scene.nodes.size(), 3u);
  EXPECT_EQ(scene.nodes[0].support.kind, Support::Kind::pinned);
  EXPECT_EQ(scene.nodes[1].support.kind, Support::Kind::free);
  EXPECT_EQ(scene.nodes[1].mass, 0.02);
  EXPECT_EQ(scene.nodes[2].support.kind, Support::Kind::elastic);
  EXPECT_TRUE(std::isinf(scene.nodes[2].support.translational[1]));
  EXPECT_EQ(scene.nodes[2].support.rotational[2], 2e3);

  ASSERT_EQ(scene.members.size(), 2u);
  const Member& cable = scene.members[0];
  EXPECT_EQ(cable.kind, Member::Kind::cable);
  EXPECT_EQ(cable.segments, 24);
  EXPECT_EQ(cable.tension, 200);
  EXPECT_EQ(cable.EI[0], 0.5972);
  EXPECT_EQ(cable.EI[1], 0.5972);
  EXPECT_EQ(cable.damping_ratio, 0.005);
  EXPECT_EQ(cable.joint[0], Member::Joint::pinned);
  EXPECT_EQ(cable.joint[1], Member::Joint::rigid);
  EXPECT_EQ(cable.assembled, Member::Assembled::hanging);
  const Member& beam = scene.members[1];
  EXPECT_EQ(beam.kind, Member::Kind::beam);
  EXPECT_EQ(beam.segments, 0);
  EXPECT_FALSE(beam.tension.has_value());
  EXPECT_EQ(beam.EI[1], 8.5);
  EXPECT_EQ(beam.taper, 0.5);
  EXPECT_EQ(beam.damping.bending, 0.01);
  EXPECT_FALSE(beam.damping_ratio.has_value());
  ASSERT_EQ(beam.masses.size(), 1u);
  EXPECT_EQ(beam.masses[0].position, 0.6);

  ASSERT_EQ(scene.loads.size(), 2u);
  EXPECT_NEAR((scene.loads[0].direction - Eigen::Vector3d(0.6, 0, 0.8)).norm(), 0, 1e-15);
  EXPECT_EQ(scene.loads[1].name, "load-2");
  EXPECT_EQ(scene.loads[1].kind, Load::Kind::release);
  EXPECT_EQ(scene.loads[1].direction, Eigen::Vector3d(0, -1, 0));
  ASSERT_EQ(scene.sensors.size(), 2u);
  EXPECT_EQ(scene.sensors[0].quantity, Sensor::Quantity::velocity);
  EXPECT_EQ(scene.sensors[1].name, "sensor-2");
  EXPECT_EQ(scene.sensors[1].place.node, "tip");
}

TEST(ReadScene, RefusesMistakesWithLineKeyAndRemedy) {
  const std::vector<testing::Mistake> mistakes = {
      {"title = \"rig\"", "title = \"rig", "", 1, "not TOML"},
      {"GJ = 0.1", "GJ = 0.1\nGJ = 0.2", "", 29, "mend this line"},
      {"EA = 221780.0", "EA = 221780,0", "", 26, "decimal point"},
      {"", "[[spring]]\nnode = \"tip\"\n", "spring", 68, "known keys"},
      {"kind = \"impact\"\n", "", "load[0].kind", 44, "add `kind"},
      {"name = \"left\"", "name = \"\"", "node[0].name", 6, "a name of its own"},
      {"kind = \"cable\"", "kind = 3", "member[0].kind", 22, "double quotes"},
      {"mass = 0.02", "mass = true", "node[1].mass", 13, "must be a number, got true"},
      {"tension = 200", "tension = { N = 200 }", "member[0].tension", 29, "got a table"},
      {"EI = [2.1, 8.5]", "EI = [2.1, -8.5]", "member[1].EI", 39,
       "value 2 must not be negative, got -8.5"},
      {"position = [1.2, 0, 0.0]", "position = [1.2, 0]", "node[1].position", 12, "3 numbers in m"},
      {"nodes = [\"left\", \"tip\"]", "nodes = [\"left\", \"tip\", \"foot\"]", "member[0].nodes",
       23, "names 3 nodes"},
      {"position = 0.5\nquantity", "position = 0.5\nnode = \"tip\"\nquantity", "sensor[0].node", 63,
       "beside a member"},
      {"EA = 221780.0", "EAA = 221780.0", "member[0].EA", 20, "is missing"},
      {"GJ = 0.1", "Gj = 0.1", "member[0].Gj", 28, "did you mean \"GJ\""},
      {"gravity = 9.81", "gravty = 9.81", "gravty", 2, "did you mean \"gravity\""},
      {"gravity = 9.81", "gravity = -9.81", "gravity", 2, "negative"},
      {"gravity = 9.81", "gravity = [0, -9.81]", "gravity", 2, "3 numbers"},
      {"accuracy = 1e-5", "accuracy = 0.5", "accuracy", 3, "at most 0.1"},
      {"accuracy = 1e-5", "accuracy = 0.0", "accuracy", 3, "greater than zero"},
      {"name = \"left\"\n", "", "node[0].name", 5, "missing"},
      {"name = \"tip\"", "name = \"left\"", "node[1].name", 11, "used twice"},
      {"name = \"beam\"", "name = \"tip\"", "member[1].name", 34, "used twice"},
      {"name = \"hammer\"", "name = \"cable\"", "load[0].name", 45, "used twice"},
      {"position = [1.2, 0, 0.0]", "position = [1.2, nan, 0.0]", "node[1].position", 12, "finite"},
      {"position = [1.2, 0, 0.0]", "position = \"here\"", "node[1].position", 12, "got the string"},
      {"mass = 0.02", "mass = -0.02", "node[1].mass", 13, "negative"},
      {"support = \"pinned\"", "support = \"pined\"", "node[0].support", 8,
       "did you mean \"pinned\""},
      {"support = \"pinned\"", "support = 3", "node[0].support", 8, "word or a table"},
      {"rotational = [1e3", "rotation = [1e3", "node[2].support.rotation", 18,
       "did you mean \"rotational\""},
      {"rotational = [1e3", "rotational = [-1e3", "node[2].support.rotational", 18, "negative"},
      {"nodes = [\"left\", \"tip\"]", "nodes = [\"lfet\", \"tip\"]", "member[0].nodes", 23,
       "there is no node \"lfet\"; did you mean \"left\"?"},
      {"nodes = [\"left\", \"tip\"]", "nodes = [\"left\"]", "member[0].nodes", 23, "names 1 nodes"},
      {"nodes = [\"left\", \"tip\"]", "nodes = [\"tip\", \"tip\"]", "member[0].nodes", 23,
       "has no length"},
      {"position = [1.2, 0, 0.0]", "position = [0, 0, 0.0]", "member[0].nodes", 23,
       "has no length"},
      {"kind = \"cable\"", "kind = \"rope\"", "member[0].kind", 22, "\"cable\" or \"beam\""},
      {"segments = 24", "segments = 0", "member[0].segments", 24, "from 2 to"},
      {"segments = 24", "segments = -3", "member[0].segments", 24, "from 2 to"},
      {"segments = 24", "segments = 1000000", "member[0].segments", 24, "from 2 to"},
      {"segments = 24", "segments = 24.5", "member[0].segments", 24, "whole number"},
      {"segments = 24", "segments = \"many\"", "member[0].segments", 24, "\"auto\""},
      {"mass_per_length = 0.16667", "", "member[0].mass_per_length", 20, "is missing"},
      {"mass_per_length = 0.16667", "mass_per_length = 0", "member[0].mass_per_length", 25,
       "greater than zero"},
      {"EA = 221780.0", "EA = inf", "member[0].EA", 26, "finite"},
      {"EA = 221780.0", "EA = \"221 kN\"", "member[0].EA", 26, "without quotes or unit"},
      {"EI = 0.5972", "EI = -0.5972", "member[0].EI", 27, "negative"},
      {"EI = 0.5972", "EI = [0.5, 0.6]", "member[0].EI", 27, "two bending stiffnesses"},
      {"EI = [2.1, 8.5]", "EI = [2.1, 8.5, 3]", "member[1].EI", 39, "2 numbers"},
      {"tension = 200", "", "member[0].tension", 20, "one of tension"},
      {"tension = 200", "tension = -200", "member[0].tension", 29, "greater than zero"},
      {"tension = 200", "tension = 200\nunstretched_length = 1.2", "member[0].unstretched_length",
       30, "keep only one"},
      {"tension = 200", "stretch = 1.3", "member[0].stretch", 29, "as long as"},
      {"taper = 0.5", "tension = 20", "member[1].tension", 40, "stress-free"},
      {"taper = 0.5", "taper = 0", "member[1].taper", 40, "greater than zero"},
      {"damping_ratio = 0.005", "damping_ratio = 1.7", "member[0].damping_ratio", 30, "below 1"},
      {"damping_ratio = 0.005", "damping_ratio = 0.01\ndamping = { axial = 1 }",
       "member[0].damping", 31, "keep one"},
      {"axial = 1.0", "axail = 1.0", "member[1].damping.axail", 41, "did you mean \"axial\""},
      {"joint = [\"pinned\", \"rigid\"]", "joint = \"hinged\"", "member[0].joint", 31,
       "\"rigid\" or \"pinned\""},
      {"position = 0.6,", "position = 60,", "member[1].mass[0].position", 42, "from 0 to 1"},
      {"mass = 0.005", "mass = 0", "member[1].mass[0].mass", 42, "greater than zero"},
      {"position = 0.8", "position = -0.1", "load[0].position", 48, "from 0 to 1"},
      {"position = 0.8", "node = \"tip\"", "load[0].node", 48, "keep one"},
      {"member = \"beam\"\nposition = 0.8\n", "", "load[0].member", 44, "say where"},
      {"member = \"beam\"", "member = \"baem\"", "load[0].member", 47, "did you mean \"beam\""},
      {"direction = [3.0, 0.0, 4.0]", "direction = [0, 0, 0]", "load[0].direction", 49,
       "no length"},
      {"peak = 100", "peak = 0", "load[0].peak", 50, "greater than zero"},
      {"duration = 0.002", "", "load[0].duration", 44, "is missing"},
      {"kind = \"impact\"", "kind = \"step\"", "load[0].kind", 46, "\"record\""},
      {"mass = 0.2\n", "mass = 0.2\ndirection = [0, 1, 0]\n", "load[1].direction", 58,
       "along gravity"},
      {"gravity = 9.81", "gravity = 0", "load[1].kind", 54, "no gravity"},
      {"peak = 100\nduration = 0.002", "file = \"none.csv\"", "load[0].peak", 44, "is missing"},
      {"kind = \"impact\"\nmember = \"beam\"\nposition = 0.8\ndirection = [3.0, 0.0, 4.0]\npeak = "
       "100\nduration = 0.002",
       "kind = \"record\"\nmember = \"beam\"\nposition = 0.8\nfile = \"none.csv\"", "load[0].file",
       49, "there is no file"},
      {"quantity = \"velocity\"", "quantity = \"speed\"", "sensor[0].quantity", 63, "acceleration"},
      {"node = \"tip\"\ndirection", "node = \"tpi\"\ndirection", "sensor[1].node", 66,
       "did you mean \"tip\""},
      {"node = \"tip\"\ndirection", "node = \"tip\"\nquantity = \"force\"\ndirection",
       "sensor[1].node", 66, "belongs to a member"},
      {"node = \"tip\"\ndirection", "name = \"mid\"\nnode = \"tip\"\ndirection", "sensor[1].name",
       66, "used twice"},
      {"", "[[node]]\nname = \"lost\"\nposition = [3, 0, 0]\n", "node[3].name", 69,
       "no member ends"},
      {"",
       "[[node]]\nname = \"a\"\nposition = [3, 0, 0]\n[[node]]\nname = \"b\"\nposition = [4, 0, "
       "0]\n[[member]]\nname = \"loose\"\nkind = \"beam\"\nnodes = [\"a\", \"b\"]\nmass_per_length "
       "= 1\nEA = 1\nEI = 1\n",
       "member[2].nodes", 77, "not connected"},
      {"", "[[repeat]]\nmembers = [\"mast\"]\ncount = 2\noffset = [1, 0, 0]\n", "repeat[0].members",
       69, "there is no member \"mast\""},
      {"", "[[repeat]]\nmembers = [\"beam\"]\ncount = 0\noffset = [1, 0, 0]\n", "repeat[0].count",
       70, "from 1 to"},
      {"", "[[repeat]]\nmembers = [\"beam\"]\ncount = 2\noffset = [0, 0, 0]\n", "repeat[0].offset",
       71, "no length"},
      {"", "[[repeat]]\nmembers = [\"cable\"]\ncount = 2\noffset = [1.2, 0, 0]\n",
       "repeat[0].offset", 71, "whose support differs"},
      {"", "[[member]]\n", "member[2].name", 68, "is missing"},
  };
  testing::expect_refused(kScene, mistakes, "rig.toml", [](const std::string& text) {
    static_cast<void>(parse_scene(text, "rig.toml"));
  });
}

TEST(ReadScene, NothingHoldsTheRig) {
  const std::string text =
      "[[node]]\nname=\"a\"\nposition=[0,0,0]\n[[node]]\nname=\"b\"\nposition=[1,0,0]\n[[member]]\n"
      "name=\"m\"\nkind=\"beam\"\nnodes=[\"a\",\"b\"]\nmass_per_length=1\nEA=1\nEI=1\n";
  EXPECT_THROW(static_cast<void>(parse_scene(text, "x.toml")), SceneError);
  EXPECT_EQ(parse_scene("gravity = 0\n" + text, "x.toml").members.size(), 1u);
  EXPECT_THROW(static_cast<void>(parse_scene("", "x.toml")), SceneError);
}

TEST(ReadScene, RepeatsALineOfPoles) {
  using testing::node, testing::member;
  Scene first;
  first.nodes = {node("foot", {0, 0, 0}, Support::Kind::clamped), node("top", {0, 10, 0}),
                 node("next", {50, 10, 0}), node("anchor", {150, 10, 0}, Support::Kind::pinned)};
  first.members = {member(Member::Kind::beam, "pole", "foot", "top", 8, 30, 1e8, 1e6),
                   member(Member::Kind::cable, "line", "top", "next", 8, 1, 1e7, 100)};
  first.members[1].tension = 5000;
  const std::string repeat =
      "[[repeat]]\nmembers = [\"pole\", \"line\"]\ncount = 2\noffset = [50, 0, 0]\n";
  const Scene scene = parse_scene(scene_text(first) + repeat, "line.toml");
  // Three poles, three spans: two tops coincide with the ends of the spans before them, and the
  // last span ends at the anchor.
  ASSERT_EQ(scene.members.size(), 6u);
  ASSERT_EQ(scene.nodes.size(), 7u);
  EXPECT_EQ(scene.members[2].name, "pole-2");
  EXPECT_EQ(scene.members[2].nodes[1], "next");
  EXPECT_EQ(scene.members[3].nodes[0], "next");
  EXPECT_EQ(scene.members[5].name, "line-3");
  EXPECT_EQ(scene.members[5].nodes[1], "anchor");
  EXPECT_EQ(scene.members[5].tension, 5000);
}

/// A scene in the program's own words: read and written to the last character. Numbers are in their
/// shortest exact form.
TEST(ReadScene, WrittenTextStays) {
  const auto text = rigfit::testing::content_of(RIGFIT_FUZZ "/seeds/scene/written.toml");
  ASSERT_GT(text.size(), 1000u);
  EXPECT_EQ(scene_text(parse_scene(text, "written.toml")), text);
}

TEST(ReadScene, FileErrors) {
  const rigfit::testing::TemporaryFolder folder;
  const auto refused = [&](const std::string& name, const char* problem) {
    EXPECT_THAT([&] { static_cast<void>(read_scene(folder.path() / name)); },
                ::testing::ThrowsMessage<SceneError>(HasSubstr(problem)));
  };
  refused("none.toml", "there is no such file");
  refused("", "this is not a file");
  folder.write("binary.toml", std::string("\xff\xfe\x00\x01", 4));
  refused("binary.toml", "not TOML");
  folder.write("empty.toml", "");
  refused("empty.toml", "at least one [[member]]");
  folder.write("force.csv", "0,0\n1,1\n");
  std::string text = kScene;
  const std::string impact = "peak = 100\nduration = 0.002";
  text.replace(text.find("kind = \"impact\""), 15, "kind = \"record\"");
  text.replace(text.find(impact), impact.size(), "file = \"force.csv\"");
  const Scene scene = read_scene(folder.write("rig.toml", text));
  EXPECT_EQ(scene.loads[0].kind, Load::Kind::record);
  EXPECT_EQ(scene.loads[0].file, folder.at("force.csv"));
  // It reads back to the same file.
  EXPECT_EQ(parse_scene(scene_text(scene), scene.file).loads[0].file, scene.loads[0].file);
}

// Fed with seeds, regressions of faults found by fuzzing and mutations of both, the reader gives a
// scene that reads back from its own text, or a reason.
TEST(MalformedScene, GivesASceneOrAReason) {
  expect_sound_or_reason("scene", toml_words(), 1000, require_scene_or_reason);
  expect_seeds_are_read(
      "scene", [](const FuzzSeed& seed) { require_sound(parse_scene(seed.bytes, seed.name)); });
}

}  // namespace rigfit::model::read_scene_test
