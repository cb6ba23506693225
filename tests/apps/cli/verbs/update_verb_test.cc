#include "model/scene/read_scene.h"
#include "tests/apps/apps_test.h"
#include "tests/ident/update/hanger.h"
#include "tests/scenes.h"

namespace rigfit::apps::update_verb_test {

// A vertical cantilever; gravity and tip mass as given.
std::string beam(double EI, double tip_mass, double gravity = 9.80665) {
  auto scene = model::testing::vertical_beam(0.75, EI, 0.3, 12);
  scene.gravity.y() = -gravity;
  scene.nodes[1].mass = tip_mass;
  scene.members[0].EI[1] = 200;
  return model::scene_text(scene);
}

// The first five in-plane frequencies of a scene, as a table of measured modes.
std::string frequencies(const std::string& scene, bool std) {
  std::string text = std ? "frequency_hz,std,plane\n" : "frequency_hz,plane\n";
  int count = 0;
  const Document found = document_of("modes {} --count 12", {scene});
  for (const auto& mode : found["modes"]) {
    if (mode["plane"] != "in" || ++count > 5) continue;
    const double f = mode["frequency_hz"];
    text += std::to_string(f) + (std ? "," + std::to_string(1e-3 * f) : "") + ",in\n";
  }
  return text;
}

TEST(UpdateVerb, FitsASceneAndWritesIt) {
  const TemporaryFolder folder;
  const auto truth = folder.write("truth.toml", beam(2.1, 0.02));
  const auto modes = folder.write("modes.csv", frequencies(truth, true));
  const auto start = folder.write("start.toml", beam(5.0, 0.05));
  const auto out = folder.at("new.toml");
  const Document json = document_of("update {} --measured {} --free beam.EI_z tip.mass --out {}",
                                    {start, modes, out});
  // Frequencies are written with six decimals: 1e-6 / 2 Hz, twice that for EI.
  EXPECT_NEAR(json["parameters"][0]["value"], 2.1, 1e-4 * 2.1);
  EXPECT_NEAR(json["parameters"][1]["value"], 0.02, 1e-3 * 0.02);
  EXPECT_TRUE(json["parameters"][0]["identifiable"].get<bool>());
  EXPECT_GT(json["parameters"][0]["std"].get<double>(), 0);
  EXPECT_LT(json["rms_relative_error"].get<double>(), 1e-5);
  EXPECT_GT(json["rms_relative_error_before"].get<double>(), 0.05);

  // What was written is a scene that fits at once.
  const Document again = document_of("update {} --measured {} --free beam.EI_z --starts 1 --out {}",
                                     {out, modes, folder.at("newer.toml")});
  EXPECT_LT(again["rms_relative_error_before"].get<double>(), 1e-5);
}

// Table 5's FE column at 100 to 300 N by three unknowns: the beam's EI and a span of its own for
// each cable. Equal spans leave 1.3 %; that they differ is what splits the cables' modes. The spans
// stand symmetric in the scene, so that the first start, by symmetry, cannot tell them apart.
TEST(UpdateVerb, TableFivesModelIsFoundByThreeUnknowns) {
  const TemporaryFolder folder;
  const std::string data = RIGFIT_TESTDATA "/jalali2021/";
  std::ifstream table(data + "table5_cable_beam.csv");
  std::string rows, line;
  for (int row = 0; std::getline(table, line); ++row) {
    if (!line.starts_with("25,")) rows += line + "\n";
  }
  const auto measured = folder.write("table5.csv", rows);
  const Document json = document_of(
      "update {}scenes/rig.toml --measured {} --column fe_Hz --stiffness "
      "{}table1_bending_stiffness.csv --plane in --segments 12 --starts 2 --free beam.EI_z 'right "
      "frame.x' 'left frame.x' --out {}",
      {data, measured, data, folder.at("o.toml")});
  EXPECT_LT(json["rms_relative_error"].get<double>(), 0.01);
  EXPECT_EQ(json["pairs"].size(), 18U);
  EXPECT_NEAR(json["parameters"][0]["value"], 2.1, 0.1);
  const double spans =
      json["parameters"][1]["value"].get<double>() - json["parameters"][2]["value"].get<double>();
  EXPECT_NEAR(spans / 2, 1.19, 0.01);
  for (const auto& parameter : json["parameters"]) {
    EXPECT_TRUE(parameter["identifiable"].get<bool>());
  }
}

// Modes 3 to 5 of the cable with many segments; 20 of them make EI 0.05 too large, at a std of
// 0.0075 that says nothing of it, and the fit is as good as can be.
TEST(UpdateVerb, SegmentsThatAreTooFewForTheValueAreSaid) {
  const TemporaryFolder folder;
  const auto run = run_line(
      "update $/jalali2021/scenes/cable.toml --measured {} --segments 20 --starts 1 --free "
      "cable.EI cable.tension",
      {folder.write("modes.csv",
                    "frequency_hz,std,plane\n22.15653,0.00665,in\n30.03540,0.00901,in\n"
                    "38.32908,0.0115,in\n")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("Take more segments"));
}

// The published rig from starts a hundredfold apart has one answer, the same odds against the next
// one, and says why. Table 5, all planes, EI of the cables from Table 1. A local search pairs a
// soft beam's many modes with the measured ones and may end at 0.07 (which from 20 is beyond the
// hundredfold that is looked through) or 0.27 N m2; the beam alone (Table 2) has 2.0.
TEST(UpdateVerb, TableFiveHasOneAnswerFromEveryStart) {
  const TemporaryFolder folder;
  const auto scene = testing::content_of(RIGFIT_TESTDATA "/jalali2021/scenes/rig.toml");
  double value = 0, odds = 0;
  for (const char* start : {"2.0", "0.2", "20.0"}) {
    const auto text = replaced(scene, "EI = [2.1,", std::string("EI = [") + start + ",");
    const auto run = run_line(
        "update {} --measured $/jalali2021/table5_cable_beam.csv --column test_Hz --stiffness "
        "$/jalali2021/table1_bending_stiffness.csv --free beam.EI_z --segments 12 --out {} --json "
        "{}",
        {folder.write("rig.toml", text), folder.at("o.toml"), folder.at("fit.json")});
    ASSERT_TRUE(run.exit_code == 0 || run.exit_code == 4) << run.err;
    const Document json = parsed(folder.read("fit.json"));
    const double EI = json["parameters"][0]["value"];
    const auto& answers = json["alternatives"];
    ASSERT_GE(answers.size(), 2u) << start;
    const double here = answers[0]["weight"].get<double>() / answers[1]["weight"].get<double>();
    EXPECT_GT(EI, 1.6) << start;
    EXPECT_LT(EI, 2.6) << start;
    if (odds == 0) value = EI, odds = here;
    EXPECT_NEAR(EI, value, 1e-4 * value) << start;
    EXPECT_NEAR(here, odds, 1e-3 * odds) << start;
  }
}

// EI over tension from the bending test, EA from the axial one, readings and mass: each a part of
// the budget and of the draws.
TEST(UpdateVerb, WhatIsTakenAsKnownIsPartOfTheUncertainty) {
  const TemporaryFolder folder;
  const auto stiffness =
      folder.write("bending.json",
                   R"({"tests": [{"tension_N": 25, "EI_Nm2": {"value": 0.2549, "std": 0.01}},
                    {"tension_N": 100, "EI_Nm2": {"value": 0.4948, "std": 0.02}},
                    {"tension_N": 200, "EI_Nm2": {"value": 0.5972, "std": 0.02}},
                    {"tension_N": 300, "EI_Nm2": {"value": 0.8283, "std": 0.03}},
                    {"tension_N": 400, "EI_Nm2": {"value": null, "std": null}}]})");
  const auto axial = folder.write("axial.json", R"({"EA_N": {"value": 221780, "std": 500}})");
  const auto modes = folder.write("modes.csv",
                                  "frequency_hz,std,plane,tension_N\n5.17,0.02,out,100\n"
                                  "10.4,0.02,out,100\n8.9,0.02,out,300\n17.95,0.02,out,300\n");
  const Document json = document_of(
      "update $/jalali2021/scenes/cable.toml --measured {} --stiffness {} --segments 12 --starts 1 "
      "--free cable.mass_per_length --axial {} --input tension=0.5%@each right.x=0.002 "
      "cable.EI=1% --out {}",
      {modes, stiffness, axial, folder.at("o.toml")});
  const auto& mass = json["parameters"][0];
  std::vector<std::string> sources;
  double squares = 0;
  for (const auto& term : mass["budget"]) {
    sources.push_back(term["source"]);
    squares += std::pow(term["std"].get<double>(), 2);
  }
  for (const char* source : {"data", "EA (axial test)", "tension [100 N]", "tension [300 N]",
                             "right.x", "EI at 100 N", "EI at 300 N", "cable.EI"}) {
    EXPECT_NE(std::find(sources.begin(), sources.end(), source), sources.end()) << source;
  }
  EXPECT_NEAR(std::sqrt(squares), mass["std"], 1e-9);
  // f^2 goes with T / m: half a percent of each reading, shared out between two, is what leads.
  EXPECT_GT(mass["std"].get<double>(), 0.003 * mass["value"].get<double>());
  for (const auto& pair : json["pairs"]) EXPECT_GT(pair["model_std_hz"].get<double>(), 0);
}

// Four tensions of Table 4, each predicted from the others; rows at the in-plane fundamental (100
// and 200 N) come out as leakage, not as pairs.
TEST(UpdateVerb, HoldOutByTensionPrintsBothErrors) {
  const TemporaryFolder folder;
  const std::string data = RIGFIT_TESTDATA "/jalali2021/";
  const auto run = run_line(
      "update {}scenes/cable.toml --measured {}table4_cable_out_of_plane.csv --column test_Hz "
      "--plane out --stiffness {}table1_bending_stiffness.csv --free "
      "cable.mass_per_length --segments 12 --starts 1 --hold-out --out {} --json {}",
      {data, data, data, folder.at("o.toml"), folder.at("o.json")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("held out"));
  const Document json = parsed(folder.read("o.json"));
  ASSERT_EQ(json["hold_out"].size(), 4u);
  for (const auto& held : json["hold_out"]) {
    EXPECT_GT(held["rms_relative_error_predicted"].get<double>(), 0);
    EXPECT_GT(held["rms_relative_error_fitted"].get<double>(), 0);
  }
  int leakage = 0;
  for (const auto& pair : json["pairs"]) leakage += pair.value("leakage", false) ? 1 : 0;
  EXPECT_EQ(leakage, 2);
}

// Hits of the virtual laboratory to FRFs to the beam's stiffness, from a guess 17 % off. The model
// has half of the tested rig's segments and clamps that converge slowly: 1 % of EI. Under a window
// of 2 1/s, which adds 0.02 to the damping ratio of the mode among the lines, the damping found is
// still the beam's own.
TEST(UpdateVerb, FrfsOfTheVirtualLaboratoryGiveItsTruth) {
  const TemporaryFolder folder;
  const std::string data = RIGFIT_TESTDATA "/virtual_laboratory/";
  const auto frf = folder.at("beam.uff");
  std::string averaging = "frf";
  for (const char* hit : {"1", "2", "3", "4", "5"}) {
    averaging += fmt::format(" $/virtual_laboratory/beam/rig/hammer-hit{}.uff", hit);
  }
  averaging +=
      " --force force --response 'beam 0.65 m' --force-window 0.012 --band 5 100 "
      "--exponential-window 2 --out " +
      frf;
  ASSERT_EQ(run_line(averaging).exit_code, 0);
  const Document json = document_of(
      "update {}scenes/beam.toml --frf {} --band 8 25 --plane in --free beam.EI_z tip.mass "
      "beam.damping_ratio --starts 1 --input hammer.position=0.002 hammer.direction_z=0.0175 "
      "--out {}",
      {data, frf, folder.at("o.toml")});
  EXPECT_NEAR(json["parameters"][0]["value"], 2.17, 0.01 * 2.17);
  EXPECT_GT(json["frf_lines"], 30);
  EXPECT_LT(json["rms_log_frf_error"].get<double>(),
            0.3 * json["rms_log_frf_error_before"].get<double>());
  const auto& damping = json["parameters"][2];
  std::string sources;
  for (const auto& term : damping["budget"]) sources += term["source"].get<std::string>() + "; ";
  EXPECT_EQ(sources, "data; hammer.position; hammer.direction_z; force of the hits of hammer; ");
  EXPECT_TRUE(damping["identifiable"].get<bool>());
  EXPECT_NEAR(damping["value"], 0.01, 4 * damping["std"].get<double>());
  EXPECT_LT(damping["std"].get<double>(), 0.005);
}

// A decay recorded on the model itself: its damping comes back through the file.
TEST(UpdateVerb, DecaysAreData) {
  const TemporaryFolder folder;
  const auto cable = [](double damping_ratio) {
    auto scene = model::testing::released_cable(12, 0.01);
    scene.members[0].damping_ratio = damping_ratio;
    scene.sensors.resize(1);
    return model::scene_text(scene);
  };
  const auto truth = folder.write("truth.toml", cable(0.02));
  const auto start = folder.write("start.toml", cable(0.006));
  const auto record = folder.at("r.csv");
  ASSERT_EQ(run_line("respond {} --duration 3 --rate 500 --out {}", {truth, record}).exit_code, 0);
  const Document json = document_of(
      "update {} --decay {} --channel sensor --band 5 30 --plane in --free cable.damping_ratio "
      "--out "
      "{}",
      {start, record, folder.at("o.toml")});
  // The record is the model's own: what is left is its anti-aliasing (none) and seven digits.
  EXPECT_NEAR(json["parameters"][0]["value"], 0.02, 2e-4);
}

// Where no --out asks for it no scene is written, and the text says how. A fit that was refused is
// predicted from with exit code 4, or with --accept-fit.
TEST(UpdateVerb, WritesNoSceneUnasked) {
  const TemporaryFolder folder;
  const auto scene = folder.write("scene.toml", beam(2.1, 0, 0));
  const auto modes = folder.write("modes.csv", frequencies(scene, true));
  const auto fit = folder.at("fit.json");
  const auto here = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const auto run =
      run_line("update {} --measured {} --free beam.EI_z beam.mass_per_length --starts 1 --json {}",
               {scene, modes, fit});
  std::filesystem::current_path(here);
  EXPECT_EQ(run.exit_code, 4) << run.err;
  EXPECT_THAT(run.err, HasSubstr("cannot separate"));
  EXPECT_THAT(run.err, HasSubstr("beam.mass_per_length"));
  EXPECT_THAT(run.out, HasSubstr("--out FILE writes the updated scene"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "scene.updated.toml"));
  const auto one =
      run_line("update {} --measured {} --free beam.EI_z beam.EI_y --starts 1 --json {}",
               {scene, modes, fit});
  ASSERT_EQ(one.exit_code, 4) << one.err;  // nothing measured moves with EI_y
  const auto refused = run_line("predict {} --from {} --count 2", {scene, fit});
  EXPECT_EQ(refused.exit_code, 4) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("--accept-fit"));
  EXPECT_EQ(run_line("predict {} --from {} --count 2 --accept-fit", {scene, fit}).exit_code, 0);
}

// Models of the same modes compared through the program: a hanger with end springs.

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

}  // namespace rigfit::apps::update_verb_test
