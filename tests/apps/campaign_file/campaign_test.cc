#include "apps/campaign/campaign.h"

#include "model/scene/scene.h"
#include "tests/apps/apps_test.h"
#include "tests/fuzz/mutations.h"
#include "tests/fuzz/require_campaign.h"
#include "tests/model/scene/mistakes.h"

namespace rigfit::apps::campaign_test {

// A campaign of tables, in whose text the line numbers below count, and the files that it names.
class CampaignFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    namespace fs = std::filesystem;
    fs::copy(RIGFIT_FUZZ "/campaign_folder", folder_.path());
    fs::copy(RIGFIT_FUZZ "/seeds/campaign/tables.toml", folder_.path());
    text_ = folder_.read("tables.toml");
  }
  TemporaryFolder folder_;
  std::string text_;
};

TEST_F(CampaignFiles, AreReadWhole) {
  const Campaign campaign = read_campaign(folder_.write("campaign.toml", text_));
  EXPECT_EQ(campaign.title, "rig");
  ASSERT_TRUE(campaign.strand.has_value());
  EXPECT_EQ(campaign.strand->elements, 133);
  ASSERT_EQ(campaign.scenes.size(), 1u);
  EXPECT_EQ(campaign.scenes[0].scene.members[0].name, "cable");
  ASSERT_EQ(campaign.scenes[0].origins.size(), 2u);
  EXPECT_EQ(campaign.scenes[0].origins[1].kind, ValueOrigin::Kind::assumed);
  EXPECT_EQ(campaign.scenes[0].origins[1].how, "a guess");
  ASSERT_EQ(campaign.tests.size(), 2u);
  EXPECT_EQ(campaign.tests[0].as<BendingTest>().test.span_m.value, 1.0);
  const auto& modal = campaign.tests[1].as<ModalTest>();
  EXPECT_EQ(modal.plane, model::ModePlane::in);
  EXPECT_THAT(modal.scene->EI_of, ElementsAre("cable.EI"));
  EXPECT_EQ(modal.models[0], "FE");
  EXPECT_EQ(campaign.inputs.size(), 4u);
}

TEST_F(CampaignFiles, AmbientMotionNeedsNoForce) {
  const std::string text = R"(title = "tower"
[[test]]
name = "wind"
kind = "modal"
ambient = true
reference = ["top"]
band = [0.2, 5.0]
[[test.recording]]
files = ["*.csv"]
)";
  const auto campaign = parse_campaign(text, folder_.path() / "campaign.toml");
  const auto& options = campaign.tests.at(0).as<ModalTest>().options;
  EXPECT_TRUE(options.ambient);
  EXPECT_THAT(options.references, ElementsAre("top"));
  try {
    static_cast<void>(parse_campaign(text +
                                         "\n[[test]]\nname = \"x\"\nkind = \"modal\"\nambient = "
                                         "true\nforce = \"f\"\n[[test.recording]]\nfiles = \"a\"",
                                     folder_.path() / "campaign.toml"));
    ADD_FAILURE() << "a force of ambient motion was accepted";
  } catch (const model::SceneError& error) {
    EXPECT_THAT(error.what(), HasSubstr("beside ambient"));
  }
}

TEST_F(CampaignFiles, MistakesAreRefusedWithFileLineKeyAndRemedy) {
  const std::vector<model::testing::Mistake> mistakes = {
      {"title = \"rig\"", "titel = \"rig\"", "title", 0, "is missing"},
      {"source = \"a paper\"", "sauce = \"a paper\"", "sauce", 2, "did you mean \"source\""},
      {"title = \"rig\"", "title = 3", "title", 1, "must be a string"},
      {"title = \"rig\"", "title = \"rig", "", 1, "not TOML"},
      {"youngs_modulus = 195e9", "youngs_modulus = -195e9", "strand.youngs_modulus", 4, "positive"},
      {"youngs_modulus = 195e9", "youngs_modulus = \"195 GPa\"", "strand.youngs_modulus", 4,
       "without quotes or unit"},
      {"wires = 133", "wires = 0", "strand.wires", 5, "from 1 to"},
      {"wire_diameter = 0.3937e-3", "wire_diameter = 0.3937", "strand.wire_diameter", 6,
       "larger than"},
      {"diameter = 6.35e-3", "diameter = nan", "strand.diameter", 7, "finite"},
      {"name = \"cable\"", "name = \"ca ble\"", "scene[0].name", 9, "letters, digits"},
      {"file = \"cable.toml\"", "file = \"none.toml\"", "scene[0].file", 10, "there is no file"},
      {"file = \"cable.toml\"", "", "scene[0].file", 8, "is missing"},
      {"\"cable.EA\" = \"axial test\"", "\"cable.EAA\" = \"axial test\"",
       "scene[0].published.cable.EAA", 12, "did you mean \"cable.EA\""},
      {"\"right.x\" = \"a guess\"", "\"cable.EA\" = \"a guess\"", "scene[0].assumed.cable.EA", 14,
       "given twice"},
      {"[scene.assumed]", "[scene.guessed]", "scene[0].guessed", 13, "not known here"},
      {"kind = \"bending\"", "kind = \"bendnig\"", "test[0].kind", 17, "did you mean \"bending\""},
      {"span = 1.0", "span = 0", "test[0].span", 18, "positive"},
      {"span = 1.0", "", "test[0].span", 15, "is missing"},
      {"span = 1.0", "spam = 1.0", "test[0].span", 15, "rename \"spam\""},
      {"span = 1.0", "span = 1.0\nscene = \"cable\"", "test[0].scene", 19, "not known here"},
      {"file = \"EI.csv\"", "file = \"IE.csv\"", "test[0].table.file", 20, "there is no file"},
      {"EI = \"EI_Nm2\"", "EI = \"EI_Nm\"", "test[0].table.EI", 22, "did you mean \"EI_Nm2\""},
      {"name = \"modes\"", "name = \"bending\"", "test[1].name", 24, "used twice"},
      {"scene = \"cable\"", "scene = \"cabel\"", "test[1].scene", 26, "did you mean \"cable\""},
      {"planes = [\"in\"]", "planes = [\"up\"]", "test[1].planes", 27, "none of in, out"},
      {"planes = [\"in\"]", "planes = []", "test[1].planes", 27, "is empty"},
      {"tension_of = [\"cable.tension\"]", "tension_of = [\"cable.tensoin\"]", "test[1].tension_of",
       28, "did you mean \"cable.tension\""},
      {"tension_of = [\"cable.tension\"]\n", "", "test[1].tension_of", 23, "is missing although"},
      {"tension = \"tension_N\"\nmeasured", "measured", "test[1].tension_of", 28,
       "no tension column"},
      {"measured = \"test_Hz\"", "measured = \"test\"", "test[1].table.measured", 33,
       "no column \"test\""},
      {"FE = \"fe_Hz\"", "FE = 3", "test[1].table.models.FE", 34, "must be a string"},
      {"[[test]]\nname = \"modes\"", "[test]\nname = \"modes\"", "", 23, "not TOML"},
  };
  const std::string file = folder_.at("campaign.toml");
  model::testing::expect_refused(text_, mistakes, file, [&](const std::string& text) {
    static_cast<void>(read_campaign(folder_.write("campaign.toml", text)));
  });
}

TEST_F(CampaignFiles, MistakesInWhatItNamesAreRefusedInTheirFile) {
  const std::string file = folder_.write("campaign.toml", text_);
  const auto message = [&](const std::string& name, const std::string& text) -> std::string {
    const std::string before = folder_.read(name);
    folder_.write(name, text);
    std::string what = "accepted";
    try {
      static_cast<void>(read_campaign(file));
    } catch (const model::SceneError& error) {
      what = error.what();
    }
    folder_.write(name, before);
    return what;
  };
  EXPECT_THAT(message("cable.toml", std::string(kCableScene) + "x = 1\n"),
              HasSubstr("cable.toml:19:1: member[0].x"));
  EXPECT_THAT(message("modes.csv", "tension_N,test_Hz,fe_Hz\n25,five,5.3\n"),
              HasSubstr("modes.csv:2:2: \"five\""));
  EXPECT_THAT(message("modes.csv", "tension_N,test_Hz,fe_Hz\n25,-5.2,5.3\n"),
              HasSubstr("modes.csv:2: test_Hz: -5.2 is no positive number"));
  EXPECT_THAT(message("modes.csv", "tension_N,test_Hz,fe_Hz\n,5.2,5.3\n"),
              HasSubstr("modes.csv:2: tension_N: is missing"));
  EXPECT_THAT(message("EI.csv", "tension_N,EI_Nm2\n25,0\n"), HasSubstr("0 is no positive number"));
  EXPECT_THAT(message("EI.csv", "\n"), HasSubstr("no rows"));
  EXPECT_EQ(message("EI.csv", folder_.read("EI.csv")), "accepted");
  // The first column that begins with "std" is EI's.
  EXPECT_EQ(message("EI.csv", "tension_N,EI_Nm2,std_EI,std_method\n25,0.2,,type A\n"), "accepted");
}

// Fed with seeds, regressions of faults found by fuzzing and mutations of both, the reader gives a
// campaign whose parts are there, or a reason.
TEST(MalformedCampaign, GivesACampaignOrAReason) {
  const std::filesystem::path path = RIGFIT_FUZZ "/campaign_folder/campaign.toml";
  expect_sound_or_reason("campaign", toml_words(), 2000, [&](const std::string& bytes) {
    require_campaign_or_reason(bytes, path);
  });
  expect_seeds_are_read(
      "campaign", [&](const FuzzSeed& seed) { require_sound(parse_campaign(seed.bytes, path)); });
}

}  // namespace rigfit::apps::campaign_test
