#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "signal/writers/write_csv.h"
#include "tests/apps/run_program.h"
#include "tests/reference/ambient_motion.h"

namespace rigfit::apps::ambient_test {
namespace {

struct AmbientVerb : ::testing::Test {
  /// The chain's channels of these numbers, 20 minutes.
  std::string setup(const std::string& name, std::uint64_t seed,
                    const std::vector<std::size_t>& channels) {
    reference::AmbientMotion motion;
    motion.seed = seed;
    auto recording = reference::recorded(truth, motion);
    std::vector<signal::Channel> kept;
    for (const std::size_t c : channels) kept.push_back(recording.channels[c]);
    recording.channels = kept;
    return folder.write(name, signal::csv_text(recording, {}));
  }
  TemporaryFolder folder;
  reference::AmbientStructure truth = reference::five_storeys();
};

TEST_F(AmbientVerb, ModesOfTwoSetups) {
  const auto run =
      run_program({"modal", setup("a.csv", 1, {0, 4, 1}), setup("b.csv", 2, {0, 4, 2, 3}),
                   "--ambient", "--band", "0.3", "8", "--json", "-"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = parsed(run.out);
  ASSERT_EQ(json["modes"].size(), 5u);
  ASSERT_EQ(json["responses"].size(), 5u);
  for (std::size_t r = 0; r < 5; ++r) {
    const auto& f = json["modes"][r]["frequency_hz"];
    const double expected = truth.frequency_hz[static_cast<Eigen::Index>(r)];
    // Five standard deviations of ten values.
    EXPECT_NEAR(f["value"].get<double>(), expected, 5 * f["std"].get<double>());
    EXPECT_LT(f["low"], f["high"]);
    EXPECT_EQ(json["modes"][r]["shape"].size(), 5u);
    EXPECT_FALSE(json["modes"][r]["doubtful"].get<bool>());
  }
}

TEST_F(AmbientVerb, MissingReferenceNamesThoseThatServe) {
  const auto run = run_program({"modal", setup("a.csv", 1, {0, 4, 1}), setup("b.csv", 2, {0, 4, 2}),
                                "--ambient", "--reference", "c2", "--band", "0.3", "8"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("\"c1\", \"c5\""), std::string::npos) << run.err;
}

TEST_F(AmbientVerb, FigureMarksTheModes) {
  const std::string figure = (folder.path() / "modes.svg").string();
  const auto run = run_program(
      {"modal", setup("a.csv", 1, {0, 4, 1}), "--ambient", "--band", "0.3", "8", "--plot", figure});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string drawn = folder.read("modes.svg");
  EXPECT_NE(drawn.find("singular value 1"), std::string::npos);
  EXPECT_NE(drawn.find("Stabilisation diagram"), std::string::npos);
}

TEST_F(AmbientVerb, OptionsOfHitsAreRefused) {
  const auto run = run_program({"modal", setup("a.csv", 1, {0, 4}), "--ambient", "--trigger", "5"});
  EXPECT_EQ(run.exit_code, 2);
}

}  // namespace
}  // namespace rigfit::apps::ambient_test
