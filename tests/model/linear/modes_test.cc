#include "model/linear/modes.h"

#include "model/algebra/eigenpairs.h"
#include "model/linear/modal_analysis.h"
#include "tests/reference/closed_forms.h"
#include "tests/reference/dense_eigen.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::modes_test {

using testing::cable_beam_rig;
using testing::paper_cable;
using testing::vertical_beam;

/// Frequencies of one plane at n segments.
std::vector<double> frequencies(Scene scene, int n, ModePlane plane, int count,
                                RotaryInertia inertia = RotaryInertia::accurate) {
  ModesOptions options{.count = 2 * count + 2, .segments = n};
  options.rotary_inertia = inertia;
  options.error_estimate = false;
  const ModalAnalysis analysis = analyse_modes(scene, options);
  EXPECT_EQ(analysis.equilibrium.status, EquilibriumStatus::converged)
      << analysis.equilibrium.reason;
  EXPECT_TRUE(analysis.complete);
  std::vector<double> out;
  for (const auto& mode : analysis.modes) {
    if (mode.plane == plane && int(out.size()) < count) out.push_back(mode.frequency_hz);
  }
  EXPECT_EQ(int(out.size()), count);
  return out;
}

/// The prestressed cable without weight is a tensioned Euler-Bernoulli beam whose mass and
/// stiffness are per unstretched length: m / (1 + e), EI (1 + e), e = T / EA.
UniformBeam stretched(double tension, double EI) {
  const double e = tension / 221780;
  return {2.4, 0.16667 / (1 + e), EI * (1 + e), tension};
}

TEST(Modes, OfOnePlaneAreThoseOfAll) {
  const Scene scene = testing::paper_cable(100, 0.4948, 12);
  ModesOptions options{.count = 14, .error_estimate = false};
  const auto all = analyse_modes(scene, options).modes;
  for (const ModePlane plane : {ModePlane::in, ModePlane::out}) {
    options.by_plane = plane == ModePlane::in ? std::array{5, 0} : std::array{0, 5};
    const auto some = analyse_modes(scene, options);
    const auto rates = analyse_mode_sensitivities(scene, {"cable.EI"}, options);
    ASSERT_EQ(some.modes.size(), 5U);
    EXPECT_TRUE(some.complete);
    std::size_t next = 0;
    for (const auto& mode : all) {
      if (mode.plane != plane || next == 5) continue;
      // Eigenvalues are found to 1e-10.
      EXPECT_NEAR(some.modes[next].frequency_hz, mode.frequency_hz, 1e-9 * mode.frequency_hz);
      EXPECT_GT(rates.frequency(static_cast<Index>(next), 0), 0);
      ++next;
    }
    EXPECT_EQ(next, 5U);
  }
  // With "auto" segments as well: 4 of one plane and 2 of the other, in their order.
  options.by_plane = {{4, 2}};
  options.accuracy = 1e-6;
  const auto both = analyse_modes(scene, options).modes;
  ASSERT_EQ(both.size(), 6U);
  EXPECT_EQ(std::ranges::count(both, ModePlane::out, &NaturalMode::plane), 2);
}

TEST(Modes, ThirtySegmentsOfTheAccurateInertiaAreFourthOrderForACable) {
  Scene scene = paper_cable(200, 0.5972);
  scene.gravity.setZero();
  const double truth = pinned_beam_frequencies(stretched(200, 0.5972), 1)[0];
  EXPECT_NEAR(frequencies(scene, 30, ModePlane::out, 1)[0] / truth, 1, 5e-6);
  // The paper's is second order: a quarter of the error for twice the segments, but for fourth
  // order.
  const double coarse =
      frequencies(scene, 30, ModePlane::out, 1, RotaryInertia::rigid_rod)[0] / truth - 1;
  const double fine =
      frequencies(scene, 60, ModePlane::out, 1, RotaryInertia::rigid_rod)[0] / truth - 1;
  EXPECT_NEAR(coarse / fine, 4, 0.05);
  EXPECT_NEAR(coarse, 4.5e-4, 0.2e-4);  // (pi / 30)^2 / 24
}

TEST(Modes, AgreeWithDenseAlgebra) {
  for (const bool torsion : {false, true}) {
    Scene scene = cable_beam_rig(100, 0.4948, 6);
    scene.nodes[2].position.z() = torsion ? 0.3 : 0;  // out of the plane: motion in space
    for (auto& member : scene.members) member.polar_inertia = torsion ? 1e-6 : 0;
    const ChainModes modes = find_modes(scene, {.count = 12});
    ASSERT_EQ(modes.equilibrium.status, EquilibriumStatus::converged) << modes.equilibrium.reason;
    EXPECT_EQ(modes.chain->planar, !torsion);
    std::vector<double> dense;
    for (const MotionModes& motion : modes.motions) {
      // M v = nu K v has the finite modes as nu > 0, the unknowns without inertia as nu = 0.
      for (const double nu :
           testing::symmetric_eigenvalues(motion.mass.sparse(), motion.stiffness.sparse())) {
        if (nu > 1e-14) dense.push_back(1 / nu);
      }
      for (Index i = 0; i < motion.omega2.size(); ++i) {
        const Eigen::VectorXd x = motion.shapes.col(i);
        const Eigen::VectorXd mx = motion.mass * x;
        const Eigen::VectorXd r = motion.stiffness * x - motion.omega2[i] * mx;
        EXPECT_NEAR(x.dot(mx), 1, 1e-12);
        EXPECT_LT(r.norm(), 1e-6 * motion.omega2[i] * mx.norm());
      }
    }
    std::sort(dense.begin(), dense.end());
    for (std::size_t i = 0; i < modes.order.size(); ++i) {
      // Rounding 1e-16 times the conditioning of K, about EA / l over T / l = 1e4, times n^2.
      EXPECT_NEAR(modes.frequency_hz(i), std::sqrt(dense[i]) / (2 * kPi),
                  1e-8 * modes.frequency_hz(i));
    }
    EXPECT_TRUE(modes.complete());
  }
}

TEST(Modes, BandHoldsWhatTheCountHolds) {
  const Scene scene = cable_beam_rig(200, 0.5972);
  ModesOptions options{.count = 20};
  const ChainModes all = find_modes(scene, options);
  options.band_hz = {14.0, 33.0};
  const ChainModes band = find_modes(scene, options);
  EXPECT_TRUE(band.complete());
  std::size_t next = 0;
  for (std::size_t i = 0; i < all.order.size(); ++i) {
    const double f = all.frequency_hz(i);
    if (f < 14 || f > 33) continue;
    ASSERT_LT(next, band.order.size());
    EXPECT_NEAR(band.frequency_hz(next++) / f, 1, 1e-7);
  }
  EXPECT_EQ(next, band.order.size());
}

TEST(ModalAnalysis, SymmetricPairOfCablesIsSeparatedInPlaneFamilyAndEnergy) {
  Scene scene = cable_beam_rig(200, 0.5972);
  scene.sensors.push_back({"tip x", {"tip", "", 0}, {1, 0, 0}, Sensor::Quantity::displacement});
  const ModalAnalysis analysis = analyse_modes(scene, {.count = 12});
  int in = 0, out = 0;
  for (const auto& mode : analysis.modes) {
    (mode.plane == ModePlane::in ? in : out) += 1;
    double sum = 0;
    for (const auto& [member, part] : mode.kinetic_energy.all) sum += part;
    EXPECT_LE(sum, 1 + 1e-9);  // less the tip mass'
    EXPECT_GT(sum, 0.8);
    // The two cables are alike: they share every mode equally.
    EXPECT_NEAR(mode.kinetic_energy.all[1].second, mode.kinetic_energy.all[2].second, 1e-5);
    if (mode.plane == ModePlane::out) {
      EXPECT_EQ(mode.sensor_shape[0], 0);
    }
    EXPECT_EQ(mode.shape.size(), 3u);
  }
  EXPECT_GT(in, 3);
  EXPECT_GT(out, 3);
}

TEST(ModalAnalysis, TorsionalAndAxialModesOfABeam) {
  Scene scene = vertical_beam(0.75, 200, 0.3, 60);
  scene.gravity.setZero();
  scene.members[0].EA = 3e4;  // f = sqrt(EA / m) / (4 L) = 105.4 Hz
  scene.members[0].GJ = 2;
  scene.members[0].polar_inertia = 1e-4;  // f = sqrt(GJ / J) / (4 L) = 47.1 Hz
  const ModalAnalysis analysis = analyse_modes(scene, {.band_hz = std::pair(1.0, 200.0)});
  const double axial = std::sqrt(3e4 / 0.3) / 3, torsion = std::sqrt(2 / 1e-4) / 3;
  int seen = 0;
  for (const auto& mode : analysis.modes) {
    // Clamped-free rods of n = 60 segments: second order, (pi / 2 / 60)^2 / 24 = 3e-5.
    if (mode.plane == ModePlane::axial && std::abs(mode.frequency_hz / axial - 1) < 1e-4) ++seen;
    if (mode.plane == ModePlane::torsion && std::abs(mode.frequency_hz / torsion - 1) < 1e-4)
      ++seen;
  }
  EXPECT_EQ(seen, 2);
}

/// Torsion left out where it acts: what that costs stands in the result.
TEST(ModalAnalysis, TorsionLeftOutIsPriced) {
  Scene scene = testing::cable_beam_rig(200, 0.5972, 12);
  scene.members[0].EI = {2.1, 2.1};   // two that differ need the section's attitude
  scene.nodes[3].position.z() = 0.3;  // the cables pull the beam's tip round
  ModesOptions options{.count = 6};
  const ModalAnalysis whole = analyse_modes(scene, options);
  options.torsion = false;
  const ModalAnalysis without = analyse_modes(scene, options);
  ASSERT_EQ(without.modes.size(), whole.modes.size());
  double worst = 0;
  for (std::size_t i = 0; i < whole.modes.size(); ++i) {
    worst =
        std::max(worst, std::abs(whole.modes[i].frequency_hz / without.modes[i].frequency_hz - 1));
  }
  EXPECT_GT(worst, 0);
  const auto torsion = std::find_if(without.left_out.begin(), without.left_out.end(),
                                    [](const auto& left) { return left.what == "torsion"; });
  ASSERT_NE(torsion, without.left_out.end());
  EXPECT_NEAR(torsion->relative_error, worst, 1e-6 * worst);
}

/// A pinned beam of L / h = 15, rectangular: what its section takes off the third frequency by
/// Timoshenko's equation, EI k^4 - m w^2 - m r^2 (1 + E / kappa G) k^2 w^2 + m^2 r^2 w^4 / kappa GA
/// = 0, is what the model says to leave out, to the second order of (k r)^2 = 3 %.
TEST(ModalAnalysis, SaysWhatInertiaAndShearOfASectionTakeOff) {
  const double length = 1.5, height = 0.1, EA = 2e8, m = 7.85;
  const double r2 = height * height / 12, EI = EA * r2, over_shear = 2.6 * 6 / 5;
  Scene scene = testing::vertical_beam(length, EI, m, 40);
  scene.gravity.setZero();
  for (auto& node : scene.nodes) node.support.kind = Support::Kind::pinned;
  scene.members[0].EA = EA;
  scene.members[0].EI = {EI, EI};
  ModesOptions options{.by_plane = {{3, 0}}};
  const ModalAnalysis found = analyse_modes(scene, options);
  ASSERT_EQ(found.modes.size(), 3U);
  const double k = 3 * kPi / length, x = k * k * r2;
  // w^2 in units of EI k^4 / m: 1 - y (1 + x (1 + s)) + y^2 x^2 s = 0.
  const double b = 1 + x * (1 + over_shear), a = x * x * over_shear;
  const double timoshenko = std::sqrt((b - std::sqrt(b * b - 4 * a)) / (2 * a));
  double said = 0;
  for (const LeftOut& one : found.left_out) {
    if (one.what.starts_with("section inertia")) said = one.relative_error;
  }
  EXPECT_NEAR(said, 1 - timoshenko, 0.15 * (1 - timoshenko));
  scene.members[0].kind = Member::Kind::cable;
  scene.members[0].tension = 1000;
  for (const LeftOut& one : analyse_modes(scene, options).left_out) {
    EXPECT_FALSE(one.what.starts_with("section inertia"));
  }
}

}  // namespace rigfit::model::modes_test
