// Motion that goes far and on for long: a million steps of something stiff with hardly any damping,
// and a beam bent through ninety degrees, where Euler angles end.
#include "model/chain/assembly.h"
#include "model/linear/modes.h"
#include "model/motion/explicit_motion.h"
#include "model/statics/equilibrium.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::long_motion_test {

/// A free beam that spins, bends and flies. EA over EI / l^2 is 1e4 times a segment's share in the
/// paper's beam: every step is one of its axial waves'. Sensors see displacement and velocity of
/// every node along every axis.
struct FlyingBeam {
  Chain chain;
  MotionProblem problem;

  FlyingBeam() {
    Scene scene =
        testing::span(testing::member(Member::Kind::beam, "beam", "", "", 4, 0.3, 1e5, 0.6),
                      testing::node("a", {0, 0, 0}), testing::node("b", {1, 0, 0}));
    scene.gravity.setZero();
    chain = Chain::from_scene(scene);
    chain.settled = true;
    problem.chain = &chain;
    problem.motion = Motion::space;
    problem.rest = problem.start = drawn_state(chain);
    const Assembly assembly(chain, Motion::space);
    problem.start_velocity.setZero(assembly.size());
    const Eigen::Vector3d spin(0.5, 3, 10);
    for (int k = 0; k < chain.nodes; ++k) {
      const Eigen::Vector3d x = problem.start.position.col(k);
      const Eigen::Vector3d v =
          spin.cross(x) + Eigen::Vector3d(0.2, 0.3 * std::cos(6 * x[0]), -0.3);
      for (int axis = 0; axis < 3; ++axis) {
        problem.start_velocity(assembly.numbering().displacement(axis, k)) = v[axis];
      }
      for (const auto quantity : {Sensor::Quantity::displacement, Sensor::Quantity::velocity}) {
        for (int axis = 0; axis < 3; ++axis) {
          ChainPoint point;
          point.node[0] = k;
          point.weight[0] = 1;
          point.count = 1;
          chain.sensors.push_back(point);
          chain.sensor_direction.push_back(Eigen::Vector3d::Unit(axis));
          problem.quantities.push_back(quantity);
        }
      }
    }
  }

  /// Linear and angular momentum of a row of samples.
  [[nodiscard]] Eigen::Matrix<double, 6, 1> momenta(const Eigen::MatrixXd& samples,
                                                    Index row) const {
    const Assembly assembly(chain, Motion::space);
    EnvelopeMatrix mass = assembly.matrix();
    assembly.mass(mass);
    Eigen::VectorXd v(assembly.size()), p(assembly.size());
    for (int k = 0; k < chain.nodes; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        v(assembly.numbering().displacement(axis, k)) = samples(row, 6 * k + 3 + axis);
      }
    }
    mass.multiply(v, p);
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    for (int k = 0; k < chain.nodes; ++k) {
      Eigen::Vector3d own, x = problem.rest.position.col(k);
      for (int axis = 0; axis < 3; ++axis) {
        own[axis] = p(assembly.numbering().displacement(axis, k));
        x[axis] += samples(row, 6 * k + axis);
      }
      sum.head<3>() += own;
      sum.tail<3>() += x.cross(own);
    }
    return sum;
  }
};

// Energy and angular momentum as the scheme's order says, (omega h)^4 / 144, for any number of
// steps; linear momentum to the rounding of each step.
TEST(LongMotion, EnergyAndMomentaStayOverAMillionSteps) {
  constexpr long kSteps = 1'000'000;
  constexpr double kPhase = 0.35;  // omega h of the highest frequency: a tenth of what is stable
  const FlyingBeam beam;
  ExplicitOptions run;
  run.sampling.rate_hz = run.sampling.duration_s = 1;
  run.step_s = explicit_motion(beam.problem, run).step_s * kPhase / 3.2;
  run.sampling.duration_s = *run.step_s * static_cast<double>(kSteps);
  run.sampling.rate_hz = 1000 / run.sampling.duration_s;
  const MotionOutput out = explicit_motion(beam.problem, run);
  ASSERT_TRUE(out.completed) << out.reason;
  EXPECT_GE(out.steps, kSteps);
  const double order = std::pow(kPhase, 4) / 144;
  EXPECT_LE(out.energy.drift(), order);
  const auto start = beam.momenta(out.samples, 0);
  for (Index row = 1; row < out.samples.rows(); ++row) {
    const Eigen::Matrix<double, 6, 1> change = beam.momenta(out.samples, row) - start;
    EXPECT_LE(change.head<3>().norm() / start.head<3>().norm(),
              1.1e-16 * static_cast<double>(kSteps) * 10);
    EXPECT_LE(change.tail<3>().norm() / start.tail<3>().norm(), order);
  }
}

constexpr double kLength = 0.75, kEI = 2.1;

/// The elastica: clamped along x, pulled at its tip in the direction `alpha` so that the tip turns
/// by `turn`, EI theta'' = -P sin(alpha - theta). Integrated from the tip, theta = turn - u^2,
/// which takes the root out of ds = dtheta / sqrt(2 P / EI (cos(alpha - turn) - cos(alpha -
/// theta))).
struct Elastica {
  double force_N = 0, x = 0, y = 0;
};

Elastica elastica(double alpha, double turn) {
  const int n = 20000;  // Simpson's rule: good to 1e-15 here
  double length = 0, x = 0, y = 0;
  for (int i = 0; i <= n; ++i) {
    const double u = std::sqrt(turn) * i / n, theta = turn - u * u;
    // cos(a) - cos(b) = 2 sin((a + b) / 2) sin((b - a) / 2), b - a = u^2.
    const double rest = 2 * std::sin(alpha - 0.5 * (turn + theta)) * std::sin(0.5 * u * u);
    const double ds = i == 0 ? 2 / std::sqrt(std::sin(alpha - turn)) : 2 * u / std::sqrt(rest);
    const double weight = (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2) * std::sqrt(turn) / n / 3;
    length += weight * ds;
    x += weight * ds * std::cos(theta);
    y += weight * ds * std::sin(theta);
  }
  // ds = sqrt(EI / 2 P) times that.
  const double scale = kLength / length;
  return {kEI / (2 * scale * scale), x * scale, y * scale};
}

// A tip turned by 60 to 170 degrees. Whatever order above the first it converges with, the last
// halving of the segments changes more than is left; axial stretch P / EA.
TEST(LoadedState, BeamBentThroughNinetyDegreesIsTheElastica) {
  for (const double degrees : {60.0, 89.9, 90.0, 120.0, 170.0}) {
    const double turn = degrees * kPi / 180, alpha = turn + 0.15;
    const Elastica truth = elastica(alpha, turn);
    Eigen::Vector2d tip[2];
    for (int k = 0; k < 2; ++k) {
      Scene scene = testing::vertical_beam(kLength, kEI, 0.295, k == 0 ? 40 : 80);
      scene.gravity.setZero();
      scene.nodes[1].position << kLength, 0, 0;
      scene.loads = {
          testing::impact({"tip", "", 0}, {std::cos(alpha), std::sin(alpha), 0}, 0, 0, "pull")};
      Chain chain = Chain::from_scene(scene);
      const ChainEquilibrium rest = find_equilibrium(chain, scene);
      const Assembly assembly(chain, Motion::in_plane);
      const std::optional<ChainState> loaded =
          loaded_state(assembly, rest.state, truth.force_N * load_rows(assembly));
      ASSERT_TRUE(loaded.has_value()) << degrees;
      const Eigen::Vector3d end =
          chain.axes.transpose() * loaded->position.col(chain.members[0].nodes.back());
      tip[k] = end.head<2>();
    }
    EXPECT_LE((tip[1] - Eigen::Vector2d(truth.x, truth.y)).norm() / kLength,
              (tip[1] - tip[0]).norm() / kLength + truth.force_N / 1e7)
        << degrees;
  }
}

}  // namespace rigfit::model::long_motion_test
