#include "model/frfs/frf_synthesis.h"

#include "model/linear/modal_analysis.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::frf_synthesis_test {

Scene instrumented(Scene scene) {
  scene.sensors = {testing::sensor("cable", 0.25, Sensor::Quantity::displacement),
                   testing::sensor("cable", 1.0 / 3, Sensor::Quantity::acceleration)};
  for (const double place : {0.25, 1.0 / 3}) {
    scene.loads.push_back(testing::impact({"", "cable", place}, {0, 1, 0}, 0, 0,
                                          place == 0.25 ? "at quarter" : "at third"));
  }
  return scene;
}

// On the line s = i omega, and on s = i omega + a of an exponential window; the second sensor reads
// a velocity, s x.
TEST(FrfSynthesis, IsTheSumOfAllModes) {
  Scene scene = instrumented(testing::paper_cable(200, 0.5972, 12));
  scene.sensors[1].quantity = Sensor::Quantity::velocity;
  scene.members[0].damping_ratio = 0.02;
  ModesOptions options;
  options.count = 33;  // all that there are
  const ModalAnalysis analysis = analyse_modes(scene, options);
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(40, 0.5, 40);
  for (const double rate : {0.0, 3.0}) {
    const SynthesizedFrfs frfs = synthesize_frfs(scene, lines, {}, rate);
    for (Index k = 0; k < lines.size(); ++k) {
      const Complex s(rate, 2 * kPi * lines[k]);
      Complex sum = 0;
      for (const auto& mode : analysis.modes) {
        const double wr = 2 * kPi * mode.frequency_hz;
        // Modes beyond twice the highest line are not damped there.
        const double zeta = mode.frequency_hz <= 80 ? mode.damping_ratio : 0;
        sum += mode.sensor_shape[0] * mode.load_shape[1] / (s * s + 2 * zeta * wr * s + wr * wr);
      }
      const auto h = frfs.H[k](0, 1);
      EXPECT_LT(std::abs(h - sum), 1e-6 * std::abs(sum)) << lines[k];
      const auto back = frfs.H[k](1, 0);  // reciprocal
      EXPECT_LT(std::abs(back - s * h), 1e-8 * std::abs(back));
    }
  }
}

TEST(FrfSynthesis, StaticLineIsTheTautStringsCompliance) {
  // Limp, weightless string under T: x (L - x) / (L T) at the load.
  Scene scene = instrumented(testing::paper_cable(200, 0, 12));
  scene.gravity.setZero();
  const SynthesizedFrfs frfs = synthesize_frfs(scene, Eigen::VectorXd::Zero(1));
  EXPECT_NEAR(frfs.H[0](0, 0).real(), 0.6 * 1.8 / (2.4 * 200), 1e-9);
  EXPECT_EQ(frfs.H[0](1, 0), Complex(0, 0));
}

void expect_finite_resonance(const Scene& scene) {
  const ModalAnalysis analysis = analyse_modes(scene, {.count = 2});
  const auto& mode =
      analysis.modes[1].plane == ModePlane::in ? analysis.modes[1] : analysis.modes[0];
  Eigen::VectorXd line(1);
  line << mode.frequency_hz;
  const SynthesizedFrfs frfs = synthesize_frfs(scene, line);
  const double omega = 2 * kPi * mode.frequency_hz;
  const double peak =
      mode.sensor_shape[0] * mode.load_shape[0] / (2 * mode.damping_ratio * omega * omega);
  // One mode's peak; the others add their static part, a share of about 2 zeta.
  EXPECT_NEAR(-frfs.H[0](0, 0).imag() / peak, 1, 0.02);
}

TEST(FrfSynthesis, JointDampersHoldTheResonanceFinite) {
  Scene scene = instrumented(testing::paper_cable(200, 0.5972, 12));
  scene.members[0].damping = {200, 0.05, 0};
  expect_finite_resonance(scene);
}

TEST(FrfSynthesis, JointDampersAndDampingRatiosSideBySide) {
  // Half the cable has the ones, half the others: both kinds of damping in one matrix.
  Scene scene = instrumented(testing::paper_cable(200, 0.5972, 12));
  scene.nodes.push_back(scene.nodes[0]);
  scene.nodes[2].name = "middle";
  scene.nodes[2].position << 1.2, 0, 0;
  scene.nodes[2].support.kind = Support::Kind::free;
  scene.members.push_back(scene.members[0]);
  scene.members[0].nodes = {"left", "middle"};
  scene.members[1].name = "other";
  scene.members[1].nodes = {"middle", "right"};
  scene.members[0].damping = {200, 0.05, 0};
  scene.members[1].damping_ratio = 0.01;
  expect_finite_resonance(scene);
}

}  // namespace rigfit::model::frf_synthesis_test
