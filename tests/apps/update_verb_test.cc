#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/run_program.h"

namespace rigfit::apps {
namespace {

using Json = nlohmann::json;

// A vertical cantilever; gravity and tip mass as given.
std::string beam(double EI, double tip_mass, double gravity = 9.80665) {
  return "gravity = " + std::to_string(gravity) + R"(
[[node]]
name = "foot"
position = [0.0, 0.0, 0.0]
support = "clamped"
[[node]]
name = "tip"
position = [0.0, 0.75, 0.0]
mass = )" +
         std::to_string(tip_mass) + R"(
[[member]]
name = "beam"
kind = "beam"
nodes = ["foot", "tip"]
segments = 12
mass_per_length = 0.3
EA = 7.0e6
EI = [)" +
         std::to_string(EI) + R"(, 200.0]
GJ = 3.0
)";
}

// The first five in-plane frequencies of a scene, as a table of measured modes.
std::string frequencies(const std::string& scene, bool std) {
  const auto run = run_program({"modes", scene, "--count", "12", "--json", "-"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  std::string text = std ? "frequency_hz,std,plane\n" : "frequency_hz,plane\n";
  int count = 0;
  const Json found = Json::parse(run.out);
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
  const auto out = (folder.path() / "new.toml").string();
  const auto run = run_program({"update", start, "--measured", modes, "--free", "beam.EI_z",
                                "tip.mass", "--out", out, "--json", "-"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json json = Json::parse(run.out);
  // Frequencies are written with six decimals: 1e-6 / 2 Hz, twice that for EI.
  EXPECT_NEAR(json["parameters"][0]["value"].get<double>(), 2.1, 1e-4 * 2.1);
  EXPECT_NEAR(json["parameters"][1]["value"].get<double>(), 0.02, 1e-3 * 0.02);
  EXPECT_TRUE(json["parameters"][0]["identifiable"].get<bool>());
  EXPECT_GT(json["parameters"][0]["std"].get<double>(), 0);
  EXPECT_LT(json["rms_relative_error"].get<double>(), 1e-5);
  EXPECT_GT(json["rms_relative_error_before"].get<double>(), 0.05);

  // What was written is a scene that fits at once.
  const Json again = Json::parse(
      run_program({"update", out, "--measured", modes, "--free", "beam.EI_z", "--starts", "1",
                   "--out", (folder.path() / "newer.toml").string(), "--json", "-"})
          .out);
  EXPECT_LT(again["rms_relative_error_before"].get<double>(), 1e-5);
}

TEST(UpdateVerb, AnUnidentifiableSetIsRefusedByName) {
  const TemporaryFolder folder;
  const auto scene = folder.write("scene.toml", beam(2.1, 0, 0));
  const auto modes = folder.write("modes.csv", frequencies(scene, true));
  const auto run = run_program({"update", scene, "--measured", modes, "--free", "beam.EI_z",
                                "beam.mass_per_length", "--starts", "1", "--out",
                                (folder.path() / "o.toml").string(), "--json", "-"});
  EXPECT_EQ(run.exit_code, 4) << run.err;
  EXPECT_NE(run.err.find("cannot separate"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("beam.mass_per_length"), std::string::npos) << run.err;
  const Json json = Json::parse(run.out);
  EXPECT_TRUE(json["parameters"][0]["std"].is_null());
  EXPECT_FALSE(json["parameters"][0]["identifiable"].get<bool>());
}

TEST(UpdateVerb, BadInputsEndWithTheirExitCode) {
  const TemporaryFolder folder;
  const auto scene = folder.write("scene.toml", beam(2.1, 0.02));
  const auto modes = folder.write("modes.csv", "frequency_hz\n2.3\n15\n");
  EXPECT_EQ(run_program({"update", scene}).exit_code, 2);
  EXPECT_EQ(run_program({"update", scene, "--measured", modes, "--prior", "x"}).exit_code, 2);
  EXPECT_EQ(run_program({"update", scene, "--measured", modes, "--hold-out"}).exit_code, 2);
  const auto unknown = run_program({"update", scene, "--measured", modes, "--free", "beam.E"});
  EXPECT_EQ(unknown.exit_code, 3);
  EXPECT_NE(unknown.err.find("beam.E"), std::string::npos) << unknown.err;
  const auto word = folder.write("word.csv", "frequency_hz,plane\n2.3,in\nhigh,in\n");
  const auto run = run_program({"update", scene, "--measured", word});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("word.csv"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("high"), std::string::npos) << run.err;
  const auto column = run_program({"update", scene, "--measured", modes, "--column", "test_Hz"});
  EXPECT_EQ(column.exit_code, 3);
  EXPECT_NE(column.err.find("frequency_hz"), std::string::npos) << column.err;
  const auto broken = folder.write("broken.toml", "[[node]]\nname = 3\n");
  EXPECT_EQ(run_program({"update", broken, "--measured", modes}).exit_code, 3);
}

}  // namespace
}  // namespace rigfit::apps
