#include "ident/virtual_rig/virtual_rig.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/parameters.h"
#include "model/scene/read_scene.h"
#include "signal/ambient/ambient_modes.h"
#include "signal/writers/write_csv.h"
#include "tests/apps/apps_test.h"
#include "tests/reference/ambient_motion.h"

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
