// Cables and beams at the ends of what can hang or stand: nearly slack, taut to 10 kN, steep,
// inextensible, limp or stiff as a rod, near buckling, cut into three segments or three thousand.
#include "model/linear/modal_analysis.h"
#include "tests/reference/bar_chain.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::limits_test {

constexpr double kMass = 0.16667, kEA = 221780, kSpan = 2.4;
constexpr double kWeight = kMass * kStandardGravity;

/// What the estimate of the error by the number of segments may be short of it: a tenth
/// (segment_extrapolation.h), and what rounding makes of a frequency.
constexpr double kHonest = 1.1, kRounding = 1e-9;

Scene cable(double EI, double degrees = 0) {
  Scene scene = testing::paper_cable(200, EI, 0);  // segments by accuracy
  const double angle = degrees * kPi / 180;
  scene.nodes[1].position << kSpan * std::cos(angle), kSpan * std::sin(angle), 0;
  return scene;
}

/// Frequencies of both planes against a reference good to `own` (relative); within the analysis'
/// own estimate, which itself meets the scene's accuracy.
void compare(const Scene& scene, const std::vector<double>& in, const std::vector<double>& out,
             double own, int count) {
  const ModalAnalysis found = analyse_modes(scene, {.count = count});
  ASSERT_EQ(found.equilibrium.status, EquilibriumStatus::converged) << found.equilibrium.reason;
  ASSERT_TRUE(found.complete);
  ASSERT_EQ(std::ssize(found.modes), count);
  if (scene.members[0].segments == 0) {
    EXPECT_LE(found.relative_error_estimate, scene.accuracy);
  }
  std::size_t next[2] = {0, 0};
  for (const NaturalMode& mode : found.modes) {
    const bool out_of_plane = mode.plane == ModePlane::out;
    const auto& truth = out_of_plane ? out : in;
    const std::size_t i = next[out_of_plane]++;
    if (i >= truth.size()) continue;
    EXPECT_NEAR(mode.frequency_hz / truth[i], 1,
                kHonest * found.relative_error_estimate + own + kRounding);
  }
}

struct Hung {
  Scene scene;
  ElasticCatenary catenary;
  CatenaryState state;
};

/// A limp cable by its length, so that no tension has to be defined: longer than its chord by
/// `slack` (relative). Modes of both planes against bars on the catenary.
Hung hang(double slack, double degrees) {
  Hung hung{.scene = cable(0, degrees)};
  hung.scene.members[0].tension.reset();
  hung.scene.members[0].unstretched_length = kSpan * (1 + slack);
  const Eigen::Vector3d end = hung.scene.nodes[1].position;
  hung.catenary = {end.x(), end.y(), kWeight, kEA};
  hung.state = catenary_of_length(hung.catenary, kSpan * (1 + slack));
  const BarFrequencies bars = bar_frequencies(hung.catenary, hung.state, kMass, 3);
  compare(hung.scene, bars.in_hz, bars.out_hz, bars.error, 6);
  return hung;
}

TEST(CableLimits, ModesTensionAndSagOfNearlySlackOnes) {
  for (const double slack : {-1e-3, -1e-5, 0.0, 1e-5, 1e-3, 0.03, 0.3}) {
    SCOPED_TRACE(slack);
    const auto [scene, catenary, state] = hang(slack, 0);
    // Statics: second order in the segments' length, the rest of Richardson's value of fourth.
    ModesOptions options{.count = 1, .error_estimate = false};
    double tension[2], sag[2];
    for (int k = 0; k < 2; ++k) {
      options.segments = k == 0 ? 60 : 120;
      const Equilibrium rest = analyse_modes(scene, options).equilibrium;
      ASSERT_EQ(rest.status, EquilibriumStatus::converged) << rest.reason;
      tension[k] = rest.members[0].tension_N;
      sag[k] = rest.members[0].sag_m;
    }
    const auto limit = [](const double* x) { return (4 * x[1] - x[0]) / 3; };
    const auto change = [](const double* x) { return std::abs(x[1] - x[0]); };
    // Rounding of positions turns into EA times a few parts in 1e16.
    EXPECT_NEAR(limit(tension) / state.tension_N, 1,
                0.1 * change(tension) / state.tension_N + 1e-13 * kEA / state.tension_N + 1e-9);
    EXPECT_NEAR(limit(sag) / state.sag_m, 1, 0.1 * change(sag) / state.sag_m + 1e-9);
  }
}

TEST(CableLimits, ModesOfInclinedOnes) {
  for (const double degrees : {30.0, 60.0, 80.0}) {
    for (const double slack : {-1e-2, 1e-4, 1e-2}) {
      SCOPED_TRACE(degrees);
      static_cast<void>(hang(slack, degrees));
    }
  }
}

/// A weightless cable is a prestressed beam, whose mass and stiffness are per unstretched length:
/// `count` modes of a plane against the closed form, which is good to `own`.
void compare_weightless(double tension, double EI, bool clamped, int count, int segments = 0,
                        double own = 0) {
  SCOPED_TRACE(::testing::Message() << tension << " N, EI " << EI << (clamped ? ", clamped" : ""));
  Scene scene = cable(EI);
  scene.gravity.setZero();
  scene.members[0].tension = tension;
  scene.members[0].segments = segments;
  for (auto& node : scene.nodes) {
    if (clamped) node.support.kind = Support::Kind::clamped;
  }
  const double e = tension / kEA;
  const UniformBeam beam{kSpan, kMass / (1 + e), EI * (1 + e), tension};
  const auto truth =
      clamped ? clamped_beam_frequencies(beam, count) : pinned_beam_frequencies(beam, count);
  compare(scene, truth, truth, own, 2 * count);
}

// EImin and EImax of the paper's strand, next to none and none.
TEST(CableLimits, ModesOfLimpStiffAndTautOnes) {
  for (const double tension : {25.0, 300.0, 1e4}) {
    for (const double EI : {0.0, 1e-9, 0.0306, 15.5632}) {
      for (const bool clamped : {false, true}) {
        // Boundary layers of sqrt(EI / T) = 6 micrometres are out of a segment's reach.
        if (clamped && EI < 0.01) continue;
        compare_weightless(tension, EI, clamped, 3);
      }
    }
  }
}

TEST(CableLimits, ModesOfThreeSegmentsAndOfThreeThousand) {
  for (const bool clamped : {false, true}) compare_weightless(200, 0.5972, clamped, 1, 3);
  // Rounding alone: 1e-16 times the highest over the lowest eigenvalue, 16 EI / l^4 over
  // T (pi / L)^2.
  const double l = kSpan / 3000;
  const double conditioning = 16 * 0.5972 / std::pow(l, 4) / (200 * std::pow(kPi / kSpan, 2));
  compare_weightless(200, 0.5972, false, 3, 3000, 1.1e-16 * conditioning);
}

// Irvine's limit: small weight over tension, a parameter of 5000 by EA alone. His theory leaves out
// (m g L / H)^2 = 1e-6 and the strain; rounding of positions is worth EA / T times 1e-16 a segment.
TEST(CableLimits, ModesOfAnInextensibleOne) {
  Scene scene = cable(0);
  scene.members[0].EA = 1e12;
  scene.gravity << 0, -1e-3 * 200 / (kMass * kSpan), 0;
  const SaggingCable taut{kSpan, kMass, 1e12, 200, 1e-3 * 200 / (kMass * kSpan)};
  std::vector<double> in = irvine_symmetric_frequencies(taut, 3);
  for (const double f : irvine_antisymmetric_frequencies(taut, 3)) in.push_back(f);
  std::sort(in.begin(), in.end());
  compare(scene, in, irvine_out_of_plane_frequencies(taut, 3), 2e-6, 6);
}

// A column under 90 to 99.999 % of the weight that buckles it, m g L^3 / EI = (9/4) j^2 with j the
// first zero of J_(-1/3) (Greenhill 1881); a little beyond it is refused.
TEST(BeamLimits, AColumnNearBucklingUnderItsWeight) {
  constexpr double kGreenhill = 7.837347438943, kColumnEA = 1e8;
  const double weight = 0.3 * kStandardGravity * 0.75;
  for (const double rest : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, -1e-5}) {
    SCOPED_TRACE(rest);
    const double EI = weight * 0.75 * 0.75 / (kGreenhill * (1 - rest));
    Scene scene = testing::vertical_beam(0.75, EI, 0.3, rest < 0 ? 60 : 0);
    scene.members[0].EA = kColumnEA;
    const ModalAnalysis found = analyse_modes(scene, {.count = 4});
    if (rest < 0) {
      EXPECT_EQ(found.equilibrium.status, EquilibriumStatus::buckled);
      EXPECT_TRUE(found.modes.empty());
      continue;
    }
    ASSERT_EQ(found.equilibrium.status, EquilibriumStatus::converged) << found.equilibrium.reason;
    ASSERT_TRUE(found.complete);
    const auto truth = standing_cantilever_frequencies({0.75, 0.3, EI, 0}, 0, kStandardGravity, 2);
    // Its own weight of 2.2 N shortens the column by 1.1e-8 on average, with which the critical
    // weight rises two to three times as much; the axial force is known to three roundings of EA.
    // Half of both over what is left to buckling moves the frequency.
    const double critical = 3 * weight / (2 * kColumnEA) + 3.3e-16 * kColumnEA / weight;
    for (std::size_t i = 0; i < found.modes.size(); ++i) {
      EXPECT_NEAR(found.modes[i].frequency_hz / truth[i / 2], 1,
                  kHonest * found.relative_error_estimate + critical / (2 * rest) + kRounding);
    }
  }
}

// Rounding: 1e-16 times the highest over the lowest eigenvalue, 16 n^4 / 1.875^4.
TEST(BeamLimits, ACantileverOfThreeSegmentsAndOfThreeThousand) {
  for (const auto& [segments, count] : {std::pair{3, 1}, {3000, 3}}) {
    Scene scene = testing::vertical_beam(0.75, 2.1, 0.295, segments);
    scene.gravity.setZero();
    const auto truth = cantilever_frequencies({0.75, 0.295, 2.1, 0}, 0, count);
    compare(scene, truth, truth, 0, 2 * count);
  }
}

}  // namespace rigfit::model::limits_test
