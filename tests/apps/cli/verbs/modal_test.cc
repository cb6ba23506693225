#include "signal/readers/read_recording.h"
#include "signal/writers/write_uff.h"
#include "tests/apps/apps_test.h"
#include "tests/reference/defective_frfs.h"
#include "tests/reference/ten_mode_truth.h"

namespace rigfit::apps::modal_test {

struct ModalVerb : ::testing::Test {
  /// Exact FRFs with 1e-3 noise, 0.5 to 1400 Hz, under a window.
  [[nodiscard]] std::string frf_file(double window) const {
    signal::FrfSet set = truth.frfs(Eigen::VectorXd::LinSpaced(2800, 0.5, 1400), window);
    Normal normal(4);
    const double scale = 1e-3 * set.H.norm() / std::sqrt(static_cast<double>(set.H.size()));
    for (Complex& h : set.H.reshaped()) h += scale * Complex(normal(), normal());
    set.sample_rate_hz = 4096;
    return folder.write("frf.uff", signal::uff_text(set));
  }
  TemporaryFolder folder;
  testing::TenModeTruth truth = testing::ten_mode_truth(4);
};

TEST_F(ModalVerb, FrfsGiveModesThatRebuildThem) {
  const std::string file = frf_file(1);
  const Document json = document_of("modal {} --out {} --synthesis {}",
                                    {file, folder.at("modes.uff"), folder.at("again.uff")});
  ASSERT_EQ(json["modes"].size(), 10u);
  const Eigen::MatrixXcd residues = truth.residues();
  for (std::size_t r = 0; r < 10; ++r) {
    const auto& mode = json["modes"][r];
    const auto i = static_cast<Index>(r);
    // Five standard deviations of 20 values.
    EXPECT_NEAR(mode["frequency_hz"]["value"], truth.frequency_hz[i],
                5 * mode["frequency_hz"]["std"].get<double>());
    EXPECT_NEAR(mode["damping_ratio"]["value"], truth.damping_ratio[i],
                5 * mode["damping_ratio"]["std"].get<double>());
    EXPECT_GT(mode["damping_ratio_with_window"], mode["damping_ratio"]["value"]);
    ASSERT_EQ(mode["shape"].size(), 4u);
    for (Index o = 0; o < 4; ++o) {
      const auto& entry = mode["shape"][o];
      const Complex d = Complex(entry["re"], entry["im"]) - residues(o, i);
      EXPECT_LT(std::abs(d.real()), 5 * entry["std_re"].get<double>());
      EXPECT_LT(std::abs(d.imag()), 5 * entry["std_im"].get<double>());
    }
    EXPECT_LT(mode["reconstruction_error"], 0.05);
    EXPECT_GT(mode["modal_phase_collinearity"], 0.99);
    EXPECT_EQ(mode["doubtful"], false) << mode["doubt"];
  }
  EXPECT_EQ(json["responses"][2]["name"], "a3");
  EXPECT_EQ(json["exponential_decay_rate_1_s"], 1);
  EXPECT_EQ(json["frf_form"], "accelerance");
  EXPECT_EQ(json["auto_mac"].size(), 10u);
  EXPECT_EQ(json["stabilisation"]["highest_order"], 60);
  EXPECT_GT(json["stabilisation"]["poles"].size(), 100u);
  EXPECT_EQ(json["inputs"].size(), 1u);

  // What was written is what was said: the FRFs from the modes are those measured, but for noise.
  const signal::FrfSet measured = signal::read_frfs({file});
  const signal::FrfSet again = signal::read_frfs({folder.at("again.uff")});
  ASSERT_EQ(again.H.rows(), measured.H.rows());
  EXPECT_LT((again.H - measured.H).norm(), 1.5e-3 * measured.H.norm());
  EXPECT_EQ(again.exponential_decay_rate_1_s, 1);
  EXPECT_EQ(count(folder.read("modes.uff"), "    -1\n    55 "), 10u);
}

TEST_F(ModalVerb, ADominatingWindowsDampingIsRefused) {
  const auto run = run_line("modal {} --json -", {frf_file(3)});
  EXPECT_EQ(run.exit_code, 4);
  EXPECT_THAT(run.err, HasSubstr("the window gives 66 %"));
  const auto json = parsed(run.out);
  ASSERT_EQ(json["modes"].size(), 10u);
  EXPECT_EQ(json["modes"][0]["damping_refused"], true);
  EXPECT_TRUE(json["modes"][0]["damping_ratio"]["value"].is_null());
  EXPECT_NEAR(json["modes"][0]["frequency_hz"]["value"], 25, 0.01);
  EXPECT_FALSE(json["modes"][1]["damping_ratio"]["value"].is_null());
}

// Another analyser's file does not say that it used a window; its rate is stated and comes off.
TEST_F(ModalVerb, FrfsFromAFileTakeAStatedWindowAndRefuseOptionsOfHits) {
  signal::FrfSet set = truth.frfs(Eigen::VectorXd::LinSpaced(2800, 0.5, 1400), 1);
  set.exponential_decay_rate_1_s = 0;
  const std::string file = folder.write("other.uff", signal::uff_text(set));
  const Document json = document_of("modal {} --exponential-window 1 --quiet", {file});
  EXPECT_EQ(json["exponential_decay_rate_1_s"], 1);
  // The 25 Hz mode: 1 % with 1 / (2 pi 25) = 0.64 % of the window on top. No noise.
  EXPECT_NEAR(json["modes"][0]["damping_ratio"]["value"], 0.01, 1e-5);
  EXPECT_NEAR(json["modes"][0]["damping_ratio_with_window"], 0.01637, 1e-4);
  const auto refused = run_line("modal {} --block 2 --struck a1 --force-window auto", {file});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--struck: is given without --force"));
  EXPECT_EQ(run_line("modal {} --exponential-window 2", {frf_file(1)}).exit_code, 2);
  EXPECT_EQ(run_line("modal {} --force force --averages 5", {file}).exit_code, 2);
}

// Records of 8 s that end with 40 % of the first mode's amplitude: the FRFs rebuilt have what that
// adds. Noise of 0.14 % of the mean FRF.
TEST_F(ModalVerb, RebuiltFrfsHaveWhatRecordsThatEndEarlyAdd) {
  testing::DefectiveFrfOptions options;
  options.frequency_hz = (Eigen::VectorXd(2) << 2.0924, 13.11).finished();
  options.record_s = 8, options.before_hit_s = 0.4;
  options.spacing_hz = 0.125, options.low_hz = 0.125, options.high_hz = 20;
  options.damping_ratio = -std::log(0.4) / (2 * kPi * 2.0924 * options.record_s);
  options.points = 3, options.points_are_inputs = false;
  options.noise = 1e-3;
  const signal::FrfSet set = testing::defective_frfs(options);
  const std::string file = folder.write("cut.uff", signal::uff_text(set));
  static_cast<void>(document_of("modal {} --synthesis {}", {file, folder.at("again.uff")}));
  const signal::FrfSet again = signal::read_frfs({folder.at("again.uff")});
  EXPECT_LT((again.H - set.H).norm(), 2e-3 * set.H.norm());
}

}  // namespace rigfit::apps::modal_test
