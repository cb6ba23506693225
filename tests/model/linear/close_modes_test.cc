// Modes that are hard to tell apart: planes that agree to 1e-5, rigs whose symmetry repeats
// frequencies, and a cable's modes followed through their crossings.
#include "model/linear/modal_analysis.h"
#include "tests/reference/bar_chain.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::close_modes_test {

/// All displacements of all members, one under the other.
Eigen::VectorXd stacked(const NaturalMode& mode) {
  Eigen::VectorXd out;
  for (const auto& shape : mode.shape) {
    const Index at = out.size();
    out.conservativeResize(at + shape.displacement.size());
    out.tail(shape.displacement.size()) = shape.displacement.reshaped();
  }
  return out;
}

// A limp cable at 300 N: its second modes in and out of plane are 1e-5 apart. The split against
// bars along the catenary; in a plane of its own, turned in space, and among members that leave no
// plane of symmetry at all.
TEST(CloseModes, PlanesThatAgreeAreToldApart) {
  const double mass = 0.16667, tension = 300;
  const ElasticCatenary truth{2.4, 0, mass * kStandardGravity, 221780};
  const BarFrequencies bars = bar_frequencies(truth, catenary_of_tension(truth, tension), mass, 2);
  const double split = bars.out_hz[1] / bars.in_hz[1] - 1;
  ASSERT_TRUE(split < 2e-5 && split > 0);
  for (const int variant : {0, 1, 2}) {
    Scene scene = testing::paper_cable(tension, 0, 60);
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    if (variant == 1) {
      turn = Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
      for (auto& node : scene.nodes) node.position = turn * node.position;
      scene.gravity = turn * scene.gravity;
    }
    if (variant == 2) {  // a stiff strut beside it, out of every plane
      scene.nodes.push_back(testing::node("foot", {1, -1, 1}, Support::Kind::clamped));
      scene.nodes.push_back(testing::node("top", {1.3, -0.5, 1.2}));
      Member strut = testing::vertical_beam(1, 5000, 1, 4).members[0];
      strut.nodes = {"foot", "top"};
      scene.members.push_back(strut);
    }
    const ModalAnalysis found = analyse_modes(scene, {.count = 6});
    ASSERT_TRUE(found.complete && found.modes.size() == 6) << variant;
    double in = 0, out = 0;
    int seen[2] = {0, 0};
    for (const NaturalMode& mode : found.modes) {
      ASSERT_TRUE(mode.plane == ModePlane::in || mode.plane == ModePlane::out) << variant;
      const bool second = ++seen[mode.plane == ModePlane::out] == 2;
      if (second) (mode.plane == ModePlane::out ? out : in) = mode.extrapolated_hz;
      // Nothing of the other plane: to rounding, over the gap of 1e-5.
      const Eigen::VectorXd across = mode.shape[0].displacement.transpose() * turn.col(2);
      const double share = across.squaredNorm() / mode.shape[0].displacement.squaredNorm();
      EXPECT_LE(mode.plane == ModePlane::out ? 1 - share : share, 1e-8) << variant;
    }
    // The extrapolated frequencies are good to a hundredth of what they correct, and so is the
    // split between them; the bars' own error adds.
    EXPECT_NEAR(out / in - 1, split, 0.01 * found.relative_error_estimate + bars.error) << variant;
  }
}

// A mast between four guys, each like the next one a quarter turn on: turned by that, every mode
// must lie in the space of those of its own frequency.
TEST(CloseModes, AMastWithFourGuysIsAsItWasAfterAQuarterTurn) {
  Scene scene = testing::vertical_beam(0.75, 2.1, 0.295, 12);
  scene.nodes[1].mass = 0.02;
  for (int k = 0; k < 4; ++k) {
    const double c[] = {1, 0, -1, 0}, s[] = {0, 1, 0, -1};
    const std::string number = std::to_string(k);
    scene.nodes.push_back(
        testing::node("anchor " + number, {1.2 * c[k], 0.75, 1.2 * s[k]}, Support::Kind::pinned));
    Member guy = testing::paper_cable(100, 0.4948, 12).members[0];
    guy.name = "guy " + number;
    guy.nodes = {"anchor " + number, "tip"};
    scene.members.push_back(guy);
  }
  const ModalAnalysis found = analyse_modes(scene, {.count = 24, .error_estimate = false});
  ASSERT_EQ(found.equilibrium.status, EquilibriumStatus::converged) << found.equilibrium.reason;
  ASSERT_TRUE(found.complete && found.modes.size() == 24);
  // A quarter turn about y takes x to z and z to -x, guy k to guy k + 1.
  Eigen::Matrix3d quarter;
  quarter << 0, 0, -1, 0, 1, 0, 1, 0, 0;
  int pairs = 0;
  for (std::size_t i = 0; i < 24;) {
    std::size_t end = i + 1;
    while (end < 24 && found.modes[end].frequency_hz < (1 + 1e-6) * found.modes[i].frequency_hz) {
      ++end;
    }
    // The last group may go on beyond the modes asked for.
    if (end == 24) break;
    if (end - i == 2) ++pairs;
    // Equal to rounding: 1e-16 times EA / l over the lowest stiffness (1e4) times n^2.
    EXPECT_LE(found.modes[end - 1].frequency_hz / found.modes[i].frequency_hz - 1, 1e-9);
    Eigen::MatrixXd space(stacked(found.modes[i]).size(), Index(end - i));
    for (std::size_t k = i; k < end; ++k) {
      space.col(Index(k - i)) = stacked(found.modes[k]);
    }
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(space);
    for (std::size_t k = i; k < end; ++k) {
      NaturalMode turned = found.modes[k];
      turned.shape[0].displacement = quarter * found.modes[k].shape[0].displacement;
      for (std::size_t guy = 0; guy < 4; ++guy) {
        turned.shape[1 + (guy + 1) % 4].displacement =
            quarter * found.modes[k].shape[1 + guy].displacement;
      }
      const Eigen::VectorXd v = stacked(turned);
      // Rounding over the relative gap to the next frequency, 1e-6 at least.
      EXPECT_LE((v - space * qr.solve(v)).norm() / v.norm(), 1e-6) << k;
    }
    i = end;
  }
  EXPECT_GE(pairs, 6);
}

/// Parity of the transverse motion under left-right mirroring: +1 or -1.
double parity_of(const NaturalMode& mode) {
  const auto motion = mode.shape[0].displacement.row(mode.plane == ModePlane::out ? 2 : 1);
  return motion.dot(motion.reverse()) / motion.squaredNorm();
}

/// 400 steps of tension from 24 to 60 N, past both crossovers of a sagging cable. Twelve modes are
/// followed by their shapes alone; more than half of its MAC can go to one successor only. Returns
/// the tensions, N, at which the first two symmetric in-plane modes of a level cable pass the
/// antisymmetric ones.
std::array<double, 2> sweep(double EI, double degrees) {
  constexpr int kSteps = 400, kFound = 18;
  constexpr std::size_t kFollowed = 12;
  ModesOptions options{.count = kFound, .error_estimate = false};
  options.damped = false;
  std::vector<NaturalMode> followed;
  std::array<double, kFollowed> parity{};
  std::array<double, 2> crossing{}, before{};
  double tension_before = 0;
  for (int step = 0; step <= kSteps; ++step) {
    const double tension = 24 + 36.0 * step / kSteps;
    Scene scene = testing::paper_cable(tension, EI, 40);
    const double angle = degrees * kPi / 180;
    scene.nodes[1].position << 2.4 * std::cos(angle), 2.4 * std::sin(angle), 0;
    const auto found = analyse_modes(scene, options);
    EXPECT_TRUE(found.complete && found.modes.size() == kFound) << tension;
    if (::testing::Test::HasFailure()) return crossing;
    if (step == 0) {
      followed.assign(found.modes.begin(), found.modes.begin() + kFollowed);
      for (std::size_t k = 0; k < kFollowed; ++k) parity[k] = parity_of(followed[k]);
    }
    std::vector<bool> taken(kFound, false);
    for (std::size_t k = 0; k < kFollowed; ++k) {
      const Eigen::VectorXd old = stacked(followed[k]).normalized();
      std::vector<double> mac;
      for (const auto& mode : found.modes) {
        mac.push_back(std::pow(old.dot(stacked(mode).normalized()), 2));
      }
      const auto best = std::max_element(mac.begin(), mac.end());
      const auto to = static_cast<std::size_t>(best - mac.begin());
      const NaturalMode& next = found.modes[to];
      EXPECT_GE(*best, 0.5) << tension;
      EXPECT_FALSE(taken[to]) << tension << ": a mode is lost";
      EXPECT_EQ(next.plane, followed[k].plane) << tension << ": two modes are swapped";
      if (degrees == 0) {
        EXPECT_NEAR(parity_of(next), parity[k], 0.01) << tension;
      }
      taken[to] = true;
      followed[k] = next;
    }
    std::vector<double> symmetric, antisymmetric;
    for (const auto& mode : found.modes) {
      if (mode.plane != ModePlane::in) continue;
      (parity_of(mode) > 0 ? symmetric : antisymmetric).push_back(mode.frequency_hz);
    }
    for (std::size_t k = 0; k < 2 && degrees == 0; ++k) {
      const double difference = symmetric[k] - antisymmetric[k];
      if (before[k] > 0 && difference <= 0) {
        crossing[k] = tension - (tension - tension_before) * difference / (difference - before[k]);
      }
      before[k] = difference;
    }
    tension_before = tension;
  }
  return crossing;
}

// Irvine's theory puts the crossovers at parameters of 4 pi^2 and 16 pi^2 for small (m g L / H)^2:
// what it leaves out is of that size, relative.
TEST(CloseModes, AreFollowedThroughTheirCrossingsWhichAreIrvines) {
  const auto crossing = sweep(0, 0);
  for (const std::size_t k : {0, 1}) {
    ASSERT_GT(crossing[k], 0);
    const double expected = std::pow(2 * kPi * (static_cast<double>(k) + 1), 2);
    EXPECT_NEAR(irvine_parameter({2.4, 0.16667, 221780, crossing[k]}) / expected, 1,
                std::pow(0.16667 * kStandardGravity * 2.4 / crossing[k], 2));
  }
}

TEST(CloseModes, AreFollowedWithStiffnessLevelAndInclined) {
  static_cast<void>(sweep(0.2549, 0));
  static_cast<void>(sweep(0.2549, 20));
}

}  // namespace rigfit::model::close_modes_test
