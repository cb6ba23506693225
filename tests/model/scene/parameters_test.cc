#include "model/scene/parameters.h"

#include "model/linear/modal_analysis.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::parameters_test {

TEST(Parameters, EveryNameReadsBackWhatWasSet) {
  Scene scene = testing::cable_beam_rig(200, 0.6);
  scene.nodes[2].support.kind = Support::Kind::elastic;
  scene.members[1].masses = {{0.4, 0.05}};
  const auto names = parameter_names(scene);
  EXPECT_THAT(names, ::testing::IsSupersetOf({"left cable.tension", "left cable.EI", "beam.EI_z",
                                              "beam.EI_y", "tip.mass", "tip.x",
                                              "left.translational_y", "left cable.masses1.mass"}));
  EXPECT_THAT(names, Not(Contains("beam.EI")));  // it has two
  double value = 0.123;
  for (const auto& name : names) {
    set_parameter(scene, name, value);
    EXPECT_EQ(parameter(scene, name), value) << name;
    value += 1;
  }
}

TEST(Parameters, UnknownNameListsTheKnownOnes) {
  Scene scene = testing::paper_cable(200, 0.6);
  EXPECT_THAT([&] { set_parameter(scene, "cable.tensoin", 1); },
              ::testing::ThrowsMessage<SceneError>(HasSubstr("cable.tension")));
}

}  // namespace rigfit::model::parameters_test
