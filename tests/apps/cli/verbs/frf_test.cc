#include "signal/readers/read_recording.h"
#include "signal/writers/writers.h"
#include "tests/apps/apps_test.h"
#include "tests/reference/ten_mode_truth.h"

namespace rigfit::apps::frf_test {

using Hits = std::vector<testing::HammerHit>;

struct FrfVerb : ::testing::Test {
  FrfVerb() { options.block_samples = 8192; }
  std::string file(const std::string& name, const signal::Recording& recording) const {
    return folder.write(name, signal::csv_text(recording, {}, 9));
  }
  TemporaryFolder folder;
  testing::TenModeTruth truth = testing::ten_mode_truth(3);
  testing::ImpactRecordOptions options;
};

TEST_F(FrfVerb, AveragesTheGoodHitsAndSaysWhatIsWrongWithTheOther) {
  Hits hits = testing::hammer_hits(options);
  hits.push_back({hits[1].time_s + 0.02, 0.05 * hits[1].peak, hits[1].duration_s});
  const std::string hammer = file("hits.csv", testing::impact_recording(truth, hits, options));
  const auto json = document_of(
      "frf {} --force force --response a1 a3 --driving-point a1 --band 10 1300 "
      "--exponential-window 3 --out {} --csv {}",
      {hammer, folder.at("frf.uff"), folder.at("frf.csv")});
  ASSERT_EQ(json["hits"].size(), 5u);
  EXPECT_EQ(json["averages"], 4);
  for (std::size_t i = 0; i < 5; ++i) {
    const auto& hit = json["hits"][i];
    EXPECT_EQ(hit["accepted"], i != 1) << hit["reason"];
    EXPECT_EQ(hit["file"], hammer);
    EXPECT_NEAR(hit["time_s"], hits[i].time_s, 2e-3);
  }
  EXPECT_THAT(json["hits"][1]["reason"].get<std::string>(), HasSubstr("double hit"));
  EXPECT_EQ(json["sample_rate_hz"], 8192);
  EXPECT_EQ(json["frf_form"], "accelerance");
  EXPECT_EQ(json["units"], "(m/s^2)/N");
  EXPECT_EQ(json["exponential_decay_rate_1_s"], 3);
  EXPECT_NEAR(json["frequency_resolution_hz"].get<double>() * json["block_samples"].get<double>(),
              8192, 1e-6);
  EXPECT_EQ(json["inputs"].size(), 1u);

  // Both files hold the FRFs: noise of 0.5 % of each channel's rms is far below 2 % of them.
  const signal::FrfSet frfs = signal::read_frfs({folder.at("frf.uff")});
  ASSERT_EQ(frfs.H.cols(), 2);
  const Index lines = (frfs.frequency_hz.array() < 1300).count();
  const Eigen::MatrixXcd exact = truth.accelerance(frfs.frequency_hz.head(lines), 3);
  EXPECT_LT((frfs.H.col(1).head(lines) - exact.col(2)).norm(), 0.02 * exact.col(2).norm());
  EXPECT_EQ(frfs.H_std.cols(), 2);
  EXPECT_EQ(frfs.coherence.cols(), 2);
  EXPECT_EQ(frfs.exponential_decay_rate_1_s, 3);
  EXPECT_EQ(frfs.averages, 4);
  std::ifstream csv(folder.at("frf.csv"));
  std::string header, line;
  std::getline(csv, header);
  EXPECT_THAT(header, HasSubstr("a3 std ((m/s^2)/N),a3 coherence"));
  Index rows = 0;
  while (std::getline(csv, line)) ++rows;
  EXPECT_EQ(rows, frfs.frequency_hz.size());
}

TEST_F(FrfVerb, RefusesAmplitudesOfPulsesThatAreNotResolved) {
  signal::Recording recording = testing::impact_recording(truth, options);
  for (auto& channel : recording.channels) {
    const Eigen::VectorXd all = channel.samples;
    channel.samples = all(Eigen::seqN(0, all.size() / 4, 4));
  }
  recording.sample_rate_hz /= 4;
  const std::string slow = file("slow.csv", recording);
  const auto refused =
      run_line("frf {} --force force --out {} --json -", {slow, folder.at("o.uff")});
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("--frequencies-only"));
  const auto json = parsed(refused.out);
  ASSERT_EQ(json["hits"].size(), 5u);
  EXPECT_EQ(json["averages"], 0);
  EXPECT_EQ(json["amplitudes"], false);
  EXPECT_EQ(json["hits"][0]["faults"][0], "unresolved_pulse");
  EXPECT_FALSE(std::filesystem::exists(folder.at("o.uff")));

  const auto kept =
      document_of("frf {} --force force --out {} --frequencies-only", {slow, folder.at("o.uff")});
  EXPECT_EQ(kept["frf_form"], "unknown");
  EXPECT_EQ(kept["amplitudes"], false);
  EXPECT_TRUE(std::filesystem::exists(folder.at("o.uff")));
}

TEST_F(FrfVerb, OneHitAFileAndItsPolarityAtTheDrivingPoint) {
  std::string files;
  options.hits = 1;
  options.force_sign = -1;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    options.seed = seed;
    files += " " +
             file("hit" + std::to_string(seed) + ".csv", testing::impact_recording(truth, options));
  }
  const auto json = document_of("frf" + files + " --force force --driving-point a1");
  EXPECT_EQ(json["averages"], 3);
  EXPECT_LT(json["hits"][2]["peak"].get<double>(), -50);
  EXPECT_EQ(json["driving_point"]["verdict"], "inverted");
}

TEST_F(FrfVerb, ARovingHammerGivesEveryPointItsColumnAndChecksReciprocity) {
  options.noise = 0.002;
  options.hits = 2;
  std::vector<std::string> files;
  for (const Index struck : {0, 2}) {
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      truth.driving_point = struck;
      options.seed = seed + static_cast<std::uint64_t>(10 * struck);
      files.push_back(file("p" + std::to_string(struck) + std::to_string(seed) + ".csv",
                           testing::impact_recording(truth, options)));
    }
  }
  const std::string line = fmt::format(
      "frf {} --force force --response a1 a3 --band 10 1300 --exponential-window 3 --struck a1 ",
      fmt::join(files, " "));
  const auto json = document_of(line + "a1 a3 a3 --out {} --csv {}",
                                {folder.at("roving.uff"), folder.at("roving.csv")});
  EXPECT_EQ(json["hits"].size(), 8u);
  EXPECT_EQ(json["hits"][7]["struck"], "a3");
  EXPECT_EQ(json["hits"][7]["file"], files[3]);
  EXPECT_EQ(json["averages"], 4);
  EXPECT_EQ(json["struck"], Document({"a1", "a3"}));
  ASSERT_EQ(json["driving_points"].size(), 2u);
  EXPECT_EQ(json["driving_points"][1]["point"], "a3");
  EXPECT_EQ(json["driving_points"][1]["verdict"], "consistent");
  ASSERT_EQ(json["reciprocity"].size(), 1u);
  EXPECT_EQ(json["reciprocity"][0]["points"], Document({"a1", "a3"}));
  EXPECT_LT(json["reciprocity"][0]["difference"].get<double>(), 0.05);
  EXPECT_GT(json["reciprocity"][0]["from_noise"].get<double>(), 0);
  const signal::FrfSet frfs = signal::read_frfs({folder.at("roving.uff")});
  ASSERT_EQ(frfs.inputs.size(), 2u);
  EXPECT_EQ(frfs.inputs[1].name, "a3");
  EXPECT_EQ(frfs.inputs[1].node, frfs.responses[1].node);
  std::ifstream csv(folder.at("roving.csv"));
  std::string header;
  std::getline(csv, header);
  EXPECT_THAT(header, HasSubstr("a3 by a1 real"));

  // `modal` takes the two columns as two references.
  const auto modes = document_of("modal {} --band 100 1300", {folder.at("roving.uff")})["modes"];
  ASSERT_EQ(modes.size(), 8u);  // above 100 Hz
  for (std::size_t r = 0; r < 8; ++r) {
    const double f = truth.frequency_hz[static_cast<Index>(r) + 2];
    EXPECT_NEAR(modes[r]["frequency_hz"]["value"], f, 1e-3 * f);
    EXPECT_EQ(modes[r]["participation"].size(), 2u);
  }

  EXPECT_EQ(run_line(line + "a3").exit_code, 2);
  EXPECT_EQ(run_line(line + "a1 a3 a3 --driving-point a1").exit_code, 2);
}

}  // namespace rigfit::apps::frf_test
