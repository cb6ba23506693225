#include "ident/virtual_rig/virtual_rig.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/parameters.h"
#include "model/scene/read_scene.h"
#include "signal/ambient/ambient_modes.h"
#include "signal/readers/read_recording.h"
#include "signal/writers/writers.h"
#include "tests/apps/apps_test.h"
#include "tests/reference/ambient_motion.h"
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

namespace rigfit::apps::ambient_test {

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
  const Document json =
      document_of("modal {} {} --ambient --band 0.3 8",
                  {setup("a.csv", 1, {0, 4, 1}), setup("b.csv", 2, {0, 4, 2, 3})});
  ASSERT_EQ(json["modes"].size(), 5u);
  ASSERT_EQ(json["responses"].size(), 5u);
  for (std::size_t r = 0; r < 5; ++r) {
    const auto& f = json["modes"][r]["frequency_hz"];
    const double expected = truth.frequency_hz[r];
    // Five standard deviations of ten values.
    EXPECT_NEAR(f["value"], expected, 5 * f["std"].get<double>());
    EXPECT_LT(f["low"], f["high"]);
    EXPECT_EQ(json["modes"][r]["shape"].size(), 5u);
    EXPECT_FALSE(json["modes"][r]["doubtful"].get<bool>());
  }
}

TEST_F(AmbientVerb, FigureMarksTheModes) {
  (void)document_of("modal {} --ambient --band 0.3 8 --plot {}",
                    {setup("a.csv", 1, {0, 4, 1}), folder.at("modes.svg")});
  EXPECT_THAT(folder.read("modes.svg"),
              AllOf(HasSubstr("singular value 1"), HasSubstr("Mode shapes"),
                    HasSubstr("Stabilisation diagram")));
}

TEST_F(AmbientVerb, ReportShowsSpectraPolesAndShapes) {
  (void)setup("a.csv", 1, {0, 4, 1}), (void)setup("b.csv", 2, {0, 4, 2, 3});
  const auto campaign = folder.write("wind.toml", R"(title = "Chain in wind"
[[test]]
name = "chain"
kind = "modal"
ambient = true
[[test.recording]]
files = ["a.csv", "b.csv"]
)");
  ASSERT_EQ(run_program({"report", campaign, "--out", folder.at("report")}).exit_code, 0);
  EXPECT_THAT(folder.read("report/report.html"),
              AllOf(HasSubstr("Singular values of the spectral matrix"), HasSubstr("set-up 2"),
                    HasSubstr("Stabilisation diagram"), HasSubstr("Mode shapes"),
                    Not(HasSubstr("hammer"))));
}

// The rig of the virtual laboratory in the state that was struck, moved by unknown forces: its own
// modes with 120 segments a member, sensors and accelerometers where the hammer test had them.
signal::Recording rig_in_ambient_motion(const std::string& laboratory) {
  const auto records = Document::parse(std::ifstream(laboratory + "rig/truth.json"))["rig"][0];
  auto scene = model::read_scene(laboratory + "truth/rig.toml");
  for (const auto& [name, value] : records["parameters"].items()) {
    if (name.ends_with(".tension") || name.find(".EI") != std::string::npos) {
      model::set_parameter(scene, name, value);
    }
  }
  scene = ident::finer_scene(scene, records["segments_times"]);
  model::ModesOptions options;
  options.count = 16;
  const auto modes = model::analyse_modes(scene, options).modes;
  const auto count = static_cast<Index>(modes.size());
  reference::AmbientStructure rig{Eigen::VectorXd(count), Eigen::VectorXd(count),
                                  Eigen::MatrixXd(static_cast<Index>(scene.sensors.size()), count),
                                  Eigen::MatrixXd::Identity(count, count)};
  for (Index r = 0; r < count; ++r) {
    const auto& mode = modes[r];
    rig.frequency_hz[r] = mode.frequency_hz;
    rig.damping_ratio[r] = mode.damping_ratio;
    rig.shapes.col(r) = mode.sensor_shape;
  }
  reference::AmbientMotion motion;
  motion.rate_hz = 256, motion.duration_s = 1800;
  return reference::recorded(rig, motion);
}

// Two tests that share nothing but the rig: modes of both are the same within both intervals.
TEST(AmbientMotion, ModesAreThoseOfTheHammerTest) {
  const std::string laboratory = std::string(RIGFIT_TESTDATA) + "/virtual_laboratory/";
  const auto json = document_of(
      fmt::format("modal {0}1.uff {0}2.uff {0}3.uff {0}4.uff {0}5.uff --force force --band 2 60",
                  laboratory + "rig/rig/T200N-hammer-hit"));
  signal::AmbientOptions options;
  options.low_hz = 2, options.high_hz = 60;
  const auto ambient = signal::ambient_modes(rig_in_ambient_motion(laboratory), options);
  int same = 0;
  for (const auto& hammer : json["modes"]) {
    if (hammer["doubtful"].get<bool>()) continue;
    const double f = hammer["frequency_hz"]["value"], f_std = hammer["frequency_hz"]["std"],
                 zeta = hammer["damping_ratio"]["value"], zeta_std = hammer["damping_ratio"]["std"];
    for (const auto& found : ambient.modes) {
      if (found.mode.doubtful || std::abs(found.mode.frequency_hz.value - f) > zeta * f) continue;
      ++same;
      EXPECT_LT(found.frequency_95.low, f + 1.96 * f_std) << f;
      EXPECT_GT(found.frequency_95.high, f - 1.96 * f_std) << f;
      EXPECT_LT(found.damping_95.low, zeta + 1.96 * zeta_std) << f;
      EXPECT_GT(found.damping_95.high, zeta - 1.96 * zeta_std) << f;
    }
  }
  EXPECT_GE(same, 5);
}

}  // namespace rigfit::apps::ambient_test
