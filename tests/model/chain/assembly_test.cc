// Forces against differences of the energy, the tangent against second differences, at random
// states far from rest: three independent implementations of each energy (sum, gradient, Hessian).
#include "model/chain/assembly.h"

#include "tests/reference/dense_eigen.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::assembly_test {

using testing::cable_beam_rig;
using testing::paper_cable;

/// Everything at once: junction of three, torsion, elastic support, masses, straight ends, taper.
Scene rich_scene() {
  Scene scene = cable_beam_rig(50, 0.5, 4);
  scene.members[0].segments = 3;
  scene.members[0].taper = 0.7;
  scene.members[0].polar_inertia = 1e-3;
  scene.members[0].EA = 400;  // soft, so that no energy drowns the others in rounding
  for (int m : {1, 2}) {
    scene.members[m].EA = 300;
    scene.members[m].tension.reset();
    scene.members[m].stretch = 0.02;
    scene.members[m].assembled = Member::Assembled::straight;
  }
  scene.members[1].masses = {{0.4, 0.05}};
  scene.nodes[2].support.kind = Support::Kind::elastic;
  scene.nodes[2].support.translational << 50, 80, 60;
  scene.nodes[2].support.rotational << 2, 3, 4;
  return scene;
}

Eigen::VectorXd random_vector(int n, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Eigen::VectorXd v(n);
  for (int i = 0; i < n; ++i) v[i] = normal(random);
  return v;
}

/// Scale of the largest single energy: what rounding is relative to.
class AssemblyDerivatives : public ::testing::TestWithParam<Motion> {};

TEST_P(AssemblyDerivatives, AreThoseOfTheEnergy) {
  Chain chain = Chain::from_scene(rich_scene());
  ASSERT_TRUE(chain.planar);
  chain.settled = true;
  const Assembly assembly(chain, GetParam());
  std::mt19937_64 random(7);
  ChainState state = drawn_state(chain);
  // Turned by tenths of a radian a joint; in the plane only where the motion asks for it.
  const Assembly mover(chain, GetParam() == Motion::out_of_plane ? Motion::in_plane : GetParam());
  mover.advance(state, random_vector(mover.size(), random), 0.05, state);
  Eigen::VectorXd force(assembly.size());
  EnvelopeMatrix tangent = assembly.matrix();
  assembly.force_and_tangent(state, force, tangent);
  Eigen::VectorXd force_only(assembly.size());
  assembly.force(state, force_only);
  EXPECT_TRUE(MatricesNear(force, force_only, 1e-12 * force.norm()));

  const double scale = std::abs(assembly.potential(state));
  ChainState moved;
  for (int trial = 0; trial < 40; ++trial) {
    const Eigen::VectorXd d = random_vector(assembly.size(), random);
    const auto energy_at = [&](double h) {
      assembly.advance(state, d, h, moved);
      return assembly.potential(moved);
    };
    // Fourth-order differences: truncation h^4 E5 / 30 with derivatives growing by a factor of
    // about 30 an order (edges of 0.25 m, |d| about 1 an unknown); rounding 1e-16 scale / h.
    const double h = 3e-4;
    const double e1 = energy_at(h), e2 = energy_at(2 * h), m1 = energy_at(-h),
                 m2 = energy_at(-2 * h), e0 = energy_at(0);
    const double first = (8 * (e1 - m1) - (e2 - m2)) / (12 * h);
    const double second = (16 * (e1 + m1) - (e2 + m2) - 30 * e0) / (12 * h * h);
    EXPECT_NEAR(force.dot(d), first, 1e-7 * (std::abs(first) + scale)) << trial;
    const double quadratic = d.dot(tangent * d);
    EXPECT_NEAR(quadratic, second, 1e-6 * (std::abs(second) + scale)) << trial;
  }
}

INSTANTIATE_TEST_SUITE_P(Motions, AssemblyDerivatives,
                         ::testing::Values(Motion::in_plane, Motion::out_of_plane, Motion::space));

TEST(Assembly, QuadraticEnergiesAddUpToTheTangent) {
  Chain chain = Chain::from_scene(rich_scene());
  chain.settled = true;
  const Assembly assembly(chain, Motion::space);
  const ChainState state = drawn_state(chain);
  Eigen::VectorXd force(assembly.size());
  EnvelopeMatrix tangent = assembly.matrix();
  assembly.force_and_tangent(state, force, tangent);
  std::mt19937_64 random(3);
  Eigen::MatrixXd q(assembly.size(), 2);
  q.col(0) = random_vector(assembly.size(), random);
  q.col(1) = random_vector(assembly.size(), random);
  const Eigen::MatrixXd energy = assembly.stiffness_energy(state, q);
  for (int c = 0; c < 2; ++c) {
    const double expected = 0.5 * q.col(c).dot(tangent * Eigen::VectorXd(q.col(c)));
    EXPECT_NEAR(energy.col(c).sum(), expected, 1e-12 * std::abs(expected));
  }
}

TEST(Assembly, RigidMotionOfTheWholeStoresNothing) {
  Scene scene = rich_scene();
  scene.gravity.setZero();
  for (auto& node : scene.nodes) node.support = {};
  const Chain chain = Chain::from_scene(scene);
  const Assembly assembly(chain, Motion::space);
  ChainState state = drawn_state(chain);
  std::mt19937_64 random(5);
  assembly.advance(state, random_vector(assembly.size(), random), 0.05, state);
  const double before = assembly.potential(state);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  ChainState turned = state;
  turned.position = (turn * state.position).colwise() + Eigen::Vector3d(1, 2, 3);
  turned.director = turn * state.director;
  for (auto& r : turned.rotation) r = turn * r;
  EXPECT_NEAR(assembly.potential(turned), before, 1e-12 * before);
}

TEST(Chain, PlaneOfSymmetryIsFoundForAnInclinedCableAskew) {
  Scene scene = paper_cable(200, 0.6);
  scene.nodes[1].position << 1, 1, 2;
  const Chain chain = Chain::from_scene(scene);
  EXPECT_TRUE(chain.planar);
  EXPECT_LT(chain.drawn.row(2).norm(), 1e-14);
  EXPECT_NEAR(chain.gravity.y(), -kStandardGravity, 1e-13);
}

}  // namespace rigfit::model::assembly_test
