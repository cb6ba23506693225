// Verb and report of the same bending tests: the same numbers, to the last digit.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/apps/run_program.h"

namespace rigfit::apps::bending_part_test {
namespace {

using Json = nlohmann::json;

const std::string kLaboratory = RIGFIT_TESTDATA "/virtual_laboratory/";

/// The bending part of the report of a campaign with this test; what stands beside the verb's keys
/// is taken out.
Json reported(const TemporaryFolder& folder, const std::string& test) {
  folder.write("campaign.toml",
               "title = \"bending\"\n[strand]\nyoungs_modulus = 195e9\nwires = 133\n"
               "wire_diameter = 0.397e-3\ndiameter = 6.35e-3\n[[test]]\nname = \"bending\"\nkind = "
               "\"bending\"\n" +
                   test);
  const auto run = run_line("report {} --out {} --quiet --json -",
                            {folder.path() / "campaign.toml", folder.path() / "out"});
  EXPECT_TRUE(run.exit_code == 0 || run.exit_code == 4) << run.err;
  return parsed(run.out)["bending"][0];
}

Json said(std::vector<std::string> command) {
  command.insert(command.begin(), "bending");
  for (const char* word : {"--strand", "195e9", "133", "0.397e-3", "6.35e-3", "--json", "-"}) {
    command.emplace_back(word);
  }
  return parsed(run_program(command).out);
}

/// Every key of the verb's document that is no envelope, in the report's part; files by name.
void expect_same(const Json& verb, const Json& part) {
  for (const char* key : {"laws", "law_choice", "curve", "bounds"}) {
    ASSERT_EQ(verb.contains(key), part.contains(key)) << key;
    if (verb.contains(key)) {
      EXPECT_EQ(verb[key].dump(), part[key].dump()) << key;
    }
  }
  ASSERT_EQ(verb["tests"].size(), part["tests"].size());
  for (std::size_t i = 0; i < verb["tests"].size(); ++i) {
    for (const auto& [key, value] : verb["tests"][i].items()) {
      if (key == "file") continue;
      ASSERT_TRUE(part["tests"][i].contains(key)) << key;
      EXPECT_EQ(value.dump(), part["tests"][i][key].dump()) << key;
    }
  }
}

TEST(BendingPart, RecordsGiveTheVerbsNumbers) {
  const TemporaryFolder folder;
  std::vector<std::string> command;
  for (const char* T : {"25", "100", "200", "300"}) {
    command.push_back(kLaboratory + "bench/bending/T" + T + "N.csv");
  }
  for (const char* word : {"--span", "0.5", "--span-std", "0.0005", "--tension-zero-std", "0.1",
                           "--load-calibration-std", "0.002"}) {
    command.emplace_back(word);
  }
  const Json part =
      reported(folder,
               "span = 0.5\nspan_std = 0.0005\ntension_zero_std = 0.1\n"
               "load_calibration_std = 0.002\n[[test.recording]]\nsynthetic = true\nfiles = [\"" +
                   kLaboratory + "bench/bending/*.csv\"]\n");
  const Json verb = said(command);
  ASSERT_EQ(verb["tests"].size(), 4U);
  EXPECT_GT(verb["tests"][0]["shared_relative_std"], 0.002);
  expect_same(verb, part);
}

// Coupons on two supports: a toe of 0.25 mm, an elastic part, and a slope that breaks. The modulus
// is that of the cross-section; the second coupon is 5 % stiffer.
TEST(BendingPart, BeamsWithoutTensionGiveTheVerbsNumbers) {
  const TemporaryFolder folder;
  std::vector<std::string> command;
  for (const double slope : {8.4, 8.82}) {
    std::string text = "displacement [mm];force [N]\n";
    for (int i = 0; i < 300; ++i) {
      const double d = 0.01 * i, x = std::max(0.0, d - 0.25);
      text += fmt::format("{:.4f};{:.4f}\n", d,
                          slope * (std::min(x, 2.0) + 0.3 * std::max(0.0, x - 2.0)));
    }
    command.push_back(folder.write(fmt::format("coupon{}.csv", command.size() + 1), text));
  }
  for (const char* word : {"--span", "0.1", "--span-std", "0.0002", "--tension", "0", "--ends",
                           "pinned", "--rectangle", "0.01", "0.004", "--section-std", "0.01",
                           "--load-calibration-std", "0.002"}) {
    command.emplace_back(word);
  }
  const Json part = reported(
      folder,
      "span = 0.1\nspan_std = 0.0002\ntension = 0\nends = \"pinned\"\nrectangle = [0.01, 0.004]\n"
      "section_std = 0.01\nload_calibration_std = 0.002\n[[test.recording]]\nsynthetic = true\n"
      "files = [\"coupon*.csv\"]\n");
  const Json verb = said(command);
  ASSERT_EQ(verb["tests"].size(), 2U);
  EXPECT_EQ(verb["tests"][0]["ends"], "pinned");
  // Four decimals of newtons are 1e-5 of the load.
  EXPECT_NEAR(verb["tests"][0]["stiffness_N_m"]["value"].get<double>(), 8400, 8.4);
  EXPECT_NEAR(verb["specimens"]["relative_scatter"].get<double>(), 0.05 / std::sqrt(2.0), 2e-3);
  EXPECT_EQ(verb["specimens"].dump(), part["specimens"].dump());
  expect_same(verb, part);
  EXPECT_EQ(part["tests"][0]["origin"], "synthetic");
}

TEST(BendingPart, KeysOfABeamAreChecked) {
  const TemporaryFolder folder;
  folder.write("beam.csv", "force [N],displacement [mm]\n0,0\n1,1\n2,2\n3,3\n");
  const auto refused = [&](const std::string& keys) {
    const auto campaign = folder.write(
        "c.toml", "title = \"b\"\n[[test]]\nname = \"b\"\nkind = \"bending\"\nspan = 0.1\n" + keys +
                      "[[test.recording]]\nfiles = [\"beam.csv\"]\n");
    const auto run = run_line("report {} --out {}", {campaign, folder.path() / "out"});
    EXPECT_EQ(run.exit_code, 3) << run.err;
    return run.err;
  };
  EXPECT_NE(refused("ends = \"pinned\"\n").find("add tension"), std::string::npos);
  EXPECT_NE(refused("tension = 20\n").find("is not 0"), std::string::npos);
  EXPECT_NE(refused("tension = 0\ndiameter = 0.01\nrectangle = [1, 1]\n").find("keep one"),
            std::string::npos);
}

TEST(BendingPart, PublishedValuesGiveTheVerbsNumbers) {
  const TemporaryFolder folder;
  for (const char* text :
       {"tension_N,EI_Nm2\n25,0.2549\n100,0.4948\n200,0.5972\n300,0.8283\n",
        "tension_N,EI_Nm2,std\n25,0.2549,0.004\n100,0.4948,0.01\n200,0.5972,0.02\n"
        "250,0.74,0.02\n300,0.8283,0.02\n"}) {
    const auto file = folder.write("EI.csv", text);
    const Json part = reported(folder,
                               "span = 0.5\ntable = { file = \"EI.csv\", tension = "
                               "\"tension_N\", EI = \"EI_Nm2\" }\n");
    expect_same(said({file}), part);
  }
}

}  // namespace
}  // namespace rigfit::apps::bending_part_test
