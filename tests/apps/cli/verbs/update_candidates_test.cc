// Models of the same modes compared through the program: a hanger with end springs.
#include "model/scene/read_scene.h"
#include "tests/apps/apps_test.h"
#include "tests/ident/update/hanger.h"

namespace rigfit::apps::update_candidates_test {

using Kind = model::Support::Kind;

// 10 m, 30 kg/m, EI 2e5 N m2; with elastic ends held by springs.
std::string hanger(double tension, Kind ends = Kind::pinned, double spring_Nm_rad = 0) {
  auto scene = ident::testing::hanger(ends, 2e5, spring_Nm_rad);
  scene.members[0].tension = tension;
  return model::scene_text(scene);
}

// Six frequencies to 0.05 %, 500 kN and end springs of 30 EI / L.
std::string six_frequencies(const TemporaryFolder& folder, double relative_std) {
  const auto truth = folder.write("truth.toml", hanger(5e5, Kind::elastic, 6e5));
  Normal normal(4);
  std::string text = "frequency_hz,std,plane\n";
  int count = 0;
  const Document modelled = document_of("modes {} --count 14", {truth});
  for (const auto& mode : modelled["modes"]) {
    if (mode["plane"] != "in" || ++count > 6) continue;
    const double f = mode["frequency_hz"];
    text += std::to_string(f * (1 + relative_std * normal())) + "," +
            std::to_string(relative_std * f) + ",in\n";
  }
  return text;
}

// Pinned, clamped and, where asked for, springs started at 10 EI / L. Returns the file's path.
std::string candidates(const TemporaryFolder& folder, bool springs) {
  folder.write("clamped.toml", hanger(4e5, Kind::clamped));
  folder.write("springs.toml", hanger(4e5, Kind::elastic, 2e5));
  std::string text =
      "[[candidate]]\nname = \"pinned\"\n"
      "[[candidate]]\nname = \"clamped\"\nscene = \"clamped.toml\"\n";
  if (springs) {
    text +=
        "[[candidate]]\nname = \"springs\"\nscene = \"springs.toml\"\n"
        "free = [\"springs=a.rotational_y,a.rotational_z,b.rotational_y,b.rotational_z\"]\n";
  }
  return folder.write("candidates.toml", text);
}

TEST(UpdateCandidates, EndSpringsOfAHangerAreChosenAndGiveItsTension) {
  const TemporaryFolder folder;
  const auto modes = folder.write("modes.csv", six_frequencies(folder, 5e-4));
  const auto scene = folder.write("hanger.toml", hanger(4e5));
  const Document json =
      document_of("update {} --measured {} --free h.tension --candidates {} --out {}",
                  {scene, modes, candidates(folder, true), folder.at("updated.toml")});
  ASSERT_EQ(json["candidates"].size(), 3U);
  const auto& springs = named(json["candidates"], "name", "springs");
  EXPECT_GT(springs["weight"].get<double>(), 0.99);
  EXPECT_GT(springs["p_value"].get<double>(), 0.001);
  EXPECT_EQ(springs["degrees_of_freedom"], 4);
  EXPECT_TRUE(springs["log_evidence"].is_number());
  EXPECT_LT(named(json["candidates"], "name", "pinned")["p_value"].get<double>(), 1e-6);
  EXPECT_EQ(springs["parameters"][1]["name"], "springs");
  const auto& tension = named(json["averaged"], "name", "h.tension");
  EXPECT_LE(tension["low"].get<double>(), 5e5);
  EXPECT_GE(tension["high"].get<double>(), 5e5);
  EXPECT_NEAR(tension["value"], 5e5, 0.05 * 5e5);
  // The result is the heaviest's, its scene the one written.
  EXPECT_EQ(json["parameters"], springs["parameters"]);
  EXPECT_THAT(folder.read("updated.toml"), HasSubstr("rotational"));
}

// Two frequencies to 5 % cannot tell ends apart: what is averaged is wider than what each says.
TEST(UpdateCandidates, WhatTheDataCannotTellIsRefusedWithItsAverage) {
  const TemporaryFolder folder;
  const auto modes =
      folder.write("modes.csv", "frequency_hz,std,plane\n7.17,0.36,in\n15.0,0.75,in\n");
  const auto scene = folder.write("hanger.toml", hanger(4e5));
  const auto run =
      run_line("update {} --measured {} --free h.tension --candidates {} --out {} --json -",
               {scene, modes, candidates(folder, false), folder.at("updated.toml")});
  EXPECT_EQ(run.exit_code, 4) << run.err;
  EXPECT_THAT(run.err, HasSubstr("no candidate has 90 % of the weight"));
  const Document json = parsed(run.out);
  const auto& tension = named(json["averaged"], "name", "h.tension");
  double narrowest = INFINITY;
  for (const auto& one : json["candidates"]) {
    const auto& own = named(one["parameters"], "name", "h.tension");
    narrowest = std::min(narrowest, own["high"].get<double>() - own["low"].get<double>());
  }
  EXPECT_GT(tension["high"].get<double>() - tension["low"].get<double>(), narrowest);
}

TEST(UpdateCandidates, MistakesAreNamed) {
  const TemporaryFolder folder;
  const auto modes = folder.write("modes.csv", "frequency_hz,std,plane\n7.17,0.36,in\n");
  const auto scene = folder.write("hanger.toml", hanger(4e5));
  const auto fails = [&](const std::string& text, int code, const std::string& said) {
    const auto file = folder.write("c.toml", text);
    const auto run = run_line("update {} --measured {} --free h.tension --candidates {} --out {}",
                              {scene, modes, file, folder.at("updated.toml")});
    EXPECT_EQ(run.exit_code, code) << run.err;
    EXPECT_THAT(run.err, HasSubstr(said));
  };
  const std::string one = "[[candidate]]\nname = \"one\"\n";
  fails(one, 2, "two or more");
  fails(one + one, 2, "a name of its own");
  fails(one + "[[candidate]]\nname = \"two\"\nscene = \"none.toml\"\n", 3, "none.toml");
  fails(one + "[[candidate]]\nname = \"two\"\nsprings = 1\n", 3, "springs");
}

}  // namespace rigfit::apps::update_candidates_test
