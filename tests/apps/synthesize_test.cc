#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/apps/run_program.h"

namespace rigfit::apps {
namespace {
using ::testing::HasSubstr;
using Json = nlohmann::json;

const std::string kScene = RIGFIT_TESTDATA "/jalali2021/scenes/cable.toml";

TEST(SynthesizeVerb, WritesRecordingsThatTheOtherVerbsReadBack) {
  const TemporaryFolder folder;
  const std::string out = folder.path() / "lab";
  const auto made = run_program({"synthesize",     kScene, "--out",          out,   "--seed",  "7",
                                 "--hits",         "3",    "--record",       "4",   "--finer", "1",
                                 "--bending-span", "1",    "--axial-length", "1.0", "--taps",  "1",
                                 "--json",         "-"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(Json::parse(made.out)["data"], "synthetic");
  const Json truth = Json::parse(folder.read("lab/truth.json"));
  EXPECT_EQ(truth["seed"], 7);
  ASSERT_EQ(truth["rig"][0]["records"].size(), 3u);
  EXPECT_THAT(folder.read("lab/rig/hammer-hit1.csv"), HasSubstr("synthetic"));

  // The tap's frequency comes back: 1 s of decay at 30 dB and more gives it to well under 0.1 %.
  const auto decay = run_program({"decay", out + "/axial/L1m-1.csv", "--channel", "tension",
                                  "--band", "20", "100", "--json", "-"});
  ASSERT_EQ(decay.exit_code, 0) << decay.err;
  const double damped = truth["axial"][0]["frequency_hz"];
  const double ratio = truth["axial"][0]["damping_ratio"];
  const double natural = damped / std::sqrt(1 - ratio * ratio);
  const Json mode = Json::parse(decay.out)["modes"][0];
  EXPECT_NEAR(mode["frequency_hz"]["value"], natural, 1e-3 * natural);
  EXPECT_NEAR(mode["damping_ratio"]["value"], ratio, 0.05 * ratio);
}

TEST(SynthesizeVerb, SaysWhatIsMissing) {
  const TemporaryFolder folder;
  const std::string bare = folder.write("bare.toml", R"(
[[node]]
name = "a"
position = [0.0, 0.0, 0.0]
support = "clamped"
[[node]]
name = "b"
position = [0.0, 1.0, 0.0]
[[member]]
name = "beam"
kind = "beam"
nodes = ["a", "b"]
segments = 10
mass_per_length = 0.3
EA = 1e6
EI = 2.0
GJ = 1.0
)");
  const auto nothing = run_program({"synthesize", bare, "--out", folder.path() / "x"});
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_THAT(nothing.err, HasSubstr("nothing to test"));
  const auto no_cable =
      run_program({"synthesize", bare, "--out", folder.path() / "x", "--bending-span", "1"});
  EXPECT_EQ(no_cable.exit_code, 3);
  EXPECT_THAT(no_cable.err, HasSubstr("no cable"));
}

}  // namespace
}  // namespace rigfit::apps
