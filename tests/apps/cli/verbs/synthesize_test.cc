#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/apps/run_program.h"

namespace rigfit::apps::synthesize_test {
namespace {
using ::testing::HasSubstr;
using Json = nlohmann::json;

TEST(SynthesizeVerb, WritesRecordingsThatTheOtherVerbsReadBack) {
  const TemporaryFolder folder;
  const std::string out = folder.path() / "lab";
  EXPECT_EQ(document_of("synthesize $/jalali2021/scenes/cable.toml --out {} --seed 7 --hits 3 "
                        "--record 4 --finer 1 --bending-span 1 --axial-length 1.0 --taps 1",
                        {out})["data"],
            "synthetic");
  const Json truth = parsed(folder.read("lab/truth.json"));
  EXPECT_EQ(truth["seed"], 7);
  ASSERT_EQ(truth["rig"][0]["records"].size(), 3u);
  EXPECT_THAT(folder.read("lab/rig/hammer-hit1.csv"), HasSubstr("synthetic"));

  // The tap's frequency comes back: 1 s of decay at 30 dB and more gives it to well under 0.1 %.
  const double damped = truth["axial"][0]["frequency_hz"];
  const double ratio = truth["axial"][0]["damping_ratio"];
  const double natural = damped / std::sqrt(1 - ratio * ratio);
  const Json mode =
      document_of("decay {}/axial/L1m-1.csv --channel tension --band 20 100", {out})["modes"][0];
  EXPECT_NEAR(mode["frequency_hz"]["value"], natural, 1e-3 * natural);
  EXPECT_NEAR(mode["damping_ratio"]["value"], ratio, 0.05 * ratio);
}

TEST(SynthesizeVerb, SeveralTensionsInUffAndTheirTruth) {
  const TemporaryFolder folder;
  const std::string out = folder.path() / "lab";
  const auto made = run_line(
      "synthesize $/jalali2021/scenes/cable.toml --out {} --tension 100 200 --tension-std 0.01 "
      "--hits 1 --double-hits 0 --record 1 --finer 1 --format uff --bending-span 0.5 --stiffness "
      "$/jalali2021/table1_bending_stiffness.csv",
      {out});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const Json truth = parsed(folder.read("lab/truth.json"));
  ASSERT_EQ(truth["rig"].size(), 2u);
  ASSERT_EQ(truth["bending"].size(), 2u);
  EXPECT_EQ(truth["rig"][1]["tension_meant_N"], 200);
  const double tension = truth["rig"][1]["parameters"]["cable.tension"];
  EXPECT_NE(tension, 200);
  EXPECT_NEAR(tension, 200, 5 * 2);
  EXPECT_NEAR(truth["bending"][0]["EI_Nm2"].get<double>(), 0.4948, 1e-12);
  EXPECT_THAT(folder.read("lab/rig/T200N-hammer-hit1.uff"), HasSubstr("synthetic"));
}

// The set kept in testdata/: intervals of the verbs hold its truth.
TEST(VirtualLaboratory, BendingAndAxialTestsGiveTheTruthBack) {
  const std::string data = RIGFIT_TESTDATA "/virtual_laboratory/";
  const TemporaryFolder folder;
  const auto bending_command = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"bending"};
    for (const char* T : {"25", "100", "200", "300"}) {
      words.push_back(data + "bench/bending/T" + T + "N.csv");
    }
    for (const char* word : {"--span", "0.5", "--json", "-"}) words.emplace_back(word);
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  auto command = bending_command({});
  const auto bending = run_program(command);
  ASSERT_EQ(bending.exit_code, 0) << bending.err;
  const Json tests = parsed(bending.out)["tests"];
  ASSERT_EQ(tests.size(), 4u);
  const double truth[] = {0.29, 0.5, 0.67397, 0.80746};
  for (std::size_t k = 0; k < 4; ++k) {
    const Json& EI = tests[k]["EI_Nm2"];
    // One of four 95 % intervals may miss; four standard uncertainties none.
    EXPECT_NEAR(EI["value"].get<double>(), truth[k], 4 * EI["std"].get<double>()) << k;
    EXPECT_LT(EI["std"].get<double>(), 0.01 * truth[k]) << k;
  }

  // The span's uncertainty is common to the four points: it widens their intervals and the band,
  // but gives the laws no other weights, so no other ranking.
  command = bending_command({"--span-std", "0.0005"});
  const Json wider = parsed(run_program(command).out);
  const Json plain = parsed(bending.out);
  EXPECT_GT(wider["tests"][0]["EI_Nm2"]["std"], plain["tests"][0]["EI_Nm2"]["std"]);
  EXPECT_EQ(wider["laws"][0]["law"], plain["laws"][0]["law"]);
  const double before = plain["laws"][0]["aicc"], after = wider["laws"][0]["aicc"];
  EXPECT_NEAR(after, before, 0.2 * std::abs(before));

  command = {"axial"};
  for (const char* L : {"0.7", "1", "1.3"}) {
    for (int tap = 1; tap <= 5; ++tap) {
      command.push_back(data + "bench/axial/L" + L + "m-" + std::to_string(tap) + ".csv");
    }
  }
  for (const char* word :
       {"--mass", "2.2", "--mass-std", "0.002", "--length", "0.7", "1.0", "1.3", "--length-std",
        "0.001", "--mass-per-length", "0.16667", "--json", "-"}) {
    command.emplace_back(word);
  }
  const auto axial = run_program(command);
  ASSERT_EQ(axial.exit_code, 0) << axial.err;
  const Json result = parsed(axial.out);
  EXPECT_NEAR(result["EA_N"]["value"].get<double>(), 205000,
              4 * result["EA_N"]["std"].get<double>());
  EXPECT_NEAR(result["damping_ratio"]["value"].get<double>(), 0.017, 2e-5);
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
  const auto nothing = run_line("synthesize {} --out {}", {bare, folder.path() / "x"});
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_THAT(nothing.err, HasSubstr("nothing to test"));
  const auto endless = run_line("synthesize $/jalali2021/scenes/cable.toml --out {} --rate 1e300",
                                {folder.path() / "endless"});
  EXPECT_EQ(endless.exit_code, 2);
  EXPECT_THAT(endless.err, HasSubstr("lower --rate"));
  const auto no_cable =
      run_line("synthesize {} --out {} --bending-span 1", {bare, folder.path() / "x"});
  EXPECT_EQ(no_cable.exit_code, 3);
  EXPECT_THAT(no_cable.err, HasSubstr("no cable"));
}

}  // namespace
}  // namespace rigfit::apps::synthesize_test
