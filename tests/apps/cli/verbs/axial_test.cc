#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "ident/virtual_rig/virtual_axial.h"
#include "signal/writers/write_csv.h"
#include "tests/apps/run_program.h"

namespace rigfit::apps::axial_test {
namespace {
using ::testing::HasSubstr;

// Three lengths, two taps each, from the continuous rod (synthetic).
std::vector<std::string> records(const TemporaryFolder& folder) {
  std::vector<std::string> files;
  auto random = ident::random_stream(5, 1);
  for (const double length : {0.7, 1.0, 1.3}) {
    for (int tap = 0; tap < 2; ++tap) {
      ident::VirtualAxialTest test;
      test.EA_N = 221780, test.mass_per_length_kg_m = 0.16667, test.length_m = length;
      test.hung_mass_kg = 2.2, test.damping_ratio = 0.017, test.after_s = 1;
      test.load_cell.noise_std = 1;
      files.push_back(
          folder.write("tap" + std::to_string(files.size()) + ".csv",
                       signal::csv_text(ident::virtual_axial_record(test, random), {}, 9)));
    }
  }
  return files;
}

TEST(AxialVerb, PoolsLengthsWithABudget) {
  TemporaryFolder folder;
  auto arguments = records(folder);
  arguments.insert(arguments.begin(), "axial");
  for (const char* a : {"--mass", "2.2", "--mass-std", "0.001", "--length", "0.7", "1.0", "1.3",
                        "--length-std", "0.001", "--mass-per-length", "0.16667", "--json", "-"}) {
    arguments.push_back(a);
  }
  const auto run = run_program(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = parsed(run.out);
  const double EA = json["EA_N"]["value"], std = json["EA_N"]["std"];
  EXPECT_NEAR(EA, 221780, 4 * std);
  EXPECT_LT(std, 0.01 * EA);
  EXPECT_NEAR(json["damping_ratio"]["value"].get<double>(), 0.017,
              4 * json["damping_ratio"]["std"].get<double>());
  EXPECT_GT(json["damping_Ns_m"]["value"].get<double>(), 0);
  ASSERT_EQ(json["samples"].size(), 6u);
  EXPECT_EQ(json["samples"][2]["length_m"], 1.0);
  EXPECT_EQ(json["lengths"].size(), 3u);
  double share = 0;
  for (const auto& row : json["budget"]) share += row["share"].get<double>();
  EXPECT_NEAR(share, 1, 1e-9);
  EXPECT_THAT(json["plausibility"].get<std::string>(), HasSubstr("13 %"));
  // The same seed gives the same numbers.
  EXPECT_EQ(run_program(arguments).out, run.out);
}

TEST(AxialVerb, GivesTheNumbersOfTheReport) {
  // Verb and report on the virtual laboratory's axial test: every number the same to the last
  // digit.
  const std::string campaign = std::string(RIGFIT_TESTDATA) + "/virtual_laboratory/";
  std::vector<std::string> arguments{"axial"};
  for (const char* length : {"0.7", "1", "1.3"}) {
    for (int tap = 1; tap <= 5; ++tap) {
      arguments.push_back(campaign + "bench/axial/L" + length + "m-" + std::to_string(tap) +
                          ".csv");
    }
  }
  for (const char* a : {"--channel", "tension", "--mass", "2.2", "--mass-std", "0.002", "--length",
                        "0.7", "1.0", "1.3", "--length-std", "0.001", "--mass-per-length",
                        "0.16667", "--band", "20", "100", "--json", "-"}) {
    arguments.push_back(a);
  }
  const auto verb = run_program(arguments);
  ASSERT_EQ(verb.exit_code, 0) << verb.err;
  const auto by_verb = parsed(verb.out);

  TemporaryFolder folder;
  folder.write(
      "campaign.toml",
      "title = \"axial\"\n[[test]]\nname = \"axial\"\nkind = "
      "\"axial\"\nmass = 2.2\nmass_std = 0.002\nmass_per_length = "
      "0.16667\nlength_std = 0.001\nchannel = \"tension\"\nband = "
      "[20.0, 100.0]\n" +
          [&] {
            std::string groups;
            for (const char* length : {"0.7", "1", "1.3"}) {
              groups += "[[test.recording]]\nfiles = [\"" + campaign + "bench/axial/L" + length +
                        "m-*.csv\"]\nlength = " + length + "\n";
            }
            return groups;
          }());
  const auto by_report =
      document_of("report {} --out {}", {folder.at("campaign.toml"), folder.at("out")})["axial"][0];
  for (const char* key :
       {"EA_N", "damping_ratio", "damping_Ns_m", "coverage_factor_95", "samples", "lengths",
        "budget", "series_compliance_m_N", "between_lengths_std_N", "p_same_EA"}) {
    ASSERT_TRUE(by_verb.contains(key)) << key;
    EXPECT_EQ(by_verb[key], by_report[key]) << key;
  }
}

TEST(AxialVerb, OneLengthIsABoundUnlessTheFrameIsStated) {
  TemporaryFolder folder;
  const auto files = records(folder);
  const auto run_with = [&](std::vector<std::string> more) {
    std::vector<std::string> all{"axial",   files[2],       files[3], "--mass",
                                 "2.2",     "--length",     "1.0",    "--mass-per-length",
                                 "0.16667", "--length-std", "0.001",  "--json",
                                 "-"};
    all.insert(all.end(), more.begin(), more.end());
    const auto run = run_program(all);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return parsed(run.out);
  };
  const auto bound = run_with({});
  EXPECT_EQ(bound["EA_N"]["bound"], "lower");
  EXPECT_LT(bound["EA_N"]["low"].get<double>(), 221780);
  EXPECT_GT(bound["EA_N"]["high"].get<double>(), 4e6);
  EXPECT_GT(bound["EA_N"]["std"].get<double>(), 1e6);
  EXPECT_NEAR(bound["assembly_stiffness_N_m"]["value"].get<double>(), 221780, 2000);
  const auto& warnings = bound["warnings"];
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(),
                          [](const auto& warning) { return warning["code"] == "one_length"; }));
  const auto rigid = run_with({"--frame-stiffness", "rigid"});
  EXPECT_EQ(rigid["EA_N"]["value"], bound["EA_if_rigid_N"]["value"]);
  EXPECT_EQ(rigid["EA_N"]["high"], bound["EA_if_rigid_N"]["high"]);
  EXPECT_FALSE(rigid["EA_N"].contains("bound"));
  const auto soft = run_with({"--frame-stiffness", "5e6", "--frame-stiffness-std", "5e5"});
  EXPECT_GT(soft["EA_N"]["value"].get<double>(), 1.04 * 221780);
  EXPECT_GT(soft["EA_N"]["std"].get<double>(), 0.003 * 221780);

  // The report says the same to the last digit.
  const auto campaign = [&](const std::string& frame) {
    folder.write("campaign.toml",
                 "title = \"axial\"\n[[test]]\nname = \"axial\"\nkind = \"axial\"\nmass = 2.2\n"
                 "mass_per_length = 0.16667\nlength_std = 0.001\n" +
                     frame +
                     "[[test.recording]]\nfiles = [\"tap2.csv\", \"tap3.csv\"]\n"
                     "length = 1.0\n");
    return document_of("report {} --out {}",
                       {folder.at("campaign.toml"), folder.at("out")})["axial"][0];
  };
  EXPECT_EQ(campaign("")["EA_N"], bound["EA_N"]);
  EXPECT_EQ(campaign("frame_stiffness = \"rigid\"\n")["EA_N"], rigid["EA_N"]);
  EXPECT_EQ(campaign("frame_stiffness = 5e6\nframe_stiffness_std = 5e5\n")["EA_N"], soft["EA_N"]);
}

}  // namespace
}  // namespace rigfit::apps::axial_test
