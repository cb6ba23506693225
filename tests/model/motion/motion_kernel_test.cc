#include "model/motion/motion_kernel.h"

#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::motion_kernel_test {

// Any state will do: the drawn one, shaken by a few percent of a segment.
template <int D>
Eigen::VectorXd shaken(const MotionKernel<D>& kernel, const Chain& chain, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  ChainState state = drawn_state(chain);
  for (int k = 0; k < chain.nodes; ++k) {
    for (int c = 0; c < D; ++c) {
      const double shake = 0.01 * uniform(random);
      if (!chain.fixed(c, k)) state.position(c, k) += shake;
    }
  }
  return kernel.positions(state);
}

// M a + dV/dq = 0 in Assembly's unknowns, turning nodes included (their rows are the moments, which
// the kernel's elimination must have brought to zero). Rounding: stiffnesses of 5e6/0.1 N/m on
// differences of positions, against forces of 1e5 N.
template <int D>
void expect_same_forces(Chain chain, unsigned seed) {
  chain.settled = true;
  ASSERT_TRUE(kernel_supports(chain, D));
  MotionKernel<D> kernel(chain);
  const Assembly assembly(chain, D == 2 ? Motion::in_plane : Motion::space);
  const Eigen::VectorXd x = shaken(kernel, chain, seed);
  Eigen::VectorXd a(kernel.size());
  kernel.acceleration(x.data(), nullptr, a.data());
  Eigen::VectorXd force(assembly.size()), inertia(assembly.size());
  assembly.force(kernel.state(x), force);
  EnvelopeMatrix mass = assembly.matrix();
  assembly.mass(mass);
  mass.multiply(kernel.unknowns(a), inertia);
  const double scale = force.cwiseAbs().maxCoeff();
  EXPECT_GT(scale, 1);
  EXPECT_TRUE(MatricesNear(inertia, -force, 1e-11 * scale));
  const double twice = kernel.unknowns(a).dot(inertia);
  EXPECT_NEAR(kernel.mass_product(a, a) / twice, 1, 1e-12);
  EXPECT_TRUE(MatricesNear(kernel.entry_values(kernel.unknowns(a)), a, 0));
}

TEST(MotionKernel, CableInPlaneAndInSpace) {
  const Chain chain = Chain::from_scene(testing::released_cable(12));
  for (unsigned seed : {1u, 2u, 3u}) {
    expect_same_forces<2>(chain, seed);
    expect_same_forces<3>(chain, seed);
  }
  const Chain shortest = Chain::from_scene(testing::released_cable(2));
  expect_same_forces<3>(shortest, 4);
  // The other rotary inertia.
  expect_same_forces<2>(
      Chain::from_scene(testing::released_cable(9), {.rotary_inertia = RotaryInertia::rigid_rod}),
      5);
}

TEST(MotionKernel, BeamAndCablesWithTurningNodeTaperAndMasses) {
  for (int segments : {1, 2, 7}) {
    expect_same_forces<2>(Chain::from_scene(testing::beam_and_cables(segments)), 6);
  }
  // Bends differently in its two planes.
  Scene scene = testing::beam_and_cables(6);
  scene.members[0].EI = {2.1, 8.0};
  scene.members[0].GJ = 1.5;
  expect_same_forces<2>(Chain::from_scene(scene), 9);
}

TEST(MotionKernel, ElasticSupport) {
  Scene scene = testing::beam_and_cables(5);
  scene.nodes[0].support.kind = Support::Kind::elastic;
  scene.nodes[0].support.translational = {4e4, 5e4, 6e4};
  scene.nodes[0].support.rotational = {30, 40, 50};
  expect_same_forces<2>(Chain::from_scene(scene), 7);
  scene.nodes[1].support.kind = Support::Kind::elastic;
  scene.nodes[1].support.translational = {0, kInf, 10};
  expect_same_forces<2>(Chain::from_scene(scene), 8);
}

TEST(MotionKernel, ExternalForcesAndPoints) {
  Chain chain = Chain::from_scene(testing::beam_and_cables(6));
  chain.settled = true;
  MotionKernel<2> kernel(chain);
  const Assembly assembly(chain, Motion::in_plane);
  const Eigen::VectorXd x = shaken(kernel, chain, 10);
  const auto row = kernel.row(chain.loads[0], chain.load_direction[0]);
  const Eigen::VectorXd external = 10 * row;
  Eigen::VectorXd a(kernel.size()), b = a;
  kernel.acceleration(x.data(), nullptr, a.data());
  kernel.acceleration(x.data(), external.data(), b.data());
  EnvelopeMatrix mass = assembly.matrix();
  assembly.mass(mass);
  const Eigen::VectorXd inertia = mass * kernel.unknowns(b - a);
  EXPECT_TRUE(
      MatricesNear(inertia, 10 * assembly.row_of(chain.loads[0], chain.load_direction[0]), 1e-8));
  EXPECT_NEAR(row.dot(x),
              chain.load_direction[0].dot(position_of(chain.loads[0], kernel.state(x).position)),
              1e-14);
}

}  // namespace rigfit::model::motion_kernel_test
