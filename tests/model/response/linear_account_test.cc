#include "model/response/linear_account.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/response/linear_energy.h"
#include "model/response/response.h"
#include "tests/model/motion_scenes.h"

namespace rigfit::model::linear_account_test {
namespace {

ChainModes modes_of(const Scene& scene, int count = 4) {
  ModesOptions options;
  options.count = count;
  return find_modes(scene, options);
}

EnergyAccount nothing(const Chain& chain) {
  EnergyAccount account;
  account.members.resize(chain.members.size());
  return account;
}

// The account's changes are those of the tangent stiffness in sum, and of the exact energies kind
// by kind: second differences of E(rest + e u) of every kind with e u of 1e-4 of a segment leave
// (1e-4)^2 of the third and fourth order and 1e-16 E / (1e-4)^2 of rounding.
void expect_second_order(const Scene& scene) {
  const ChainModes modes = modes_of(scene);
  ASSERT_FALSE(modes.motions.empty());
  const ChainState& rest = modes.equilibrium.state;
  for (const MotionModes& motion : modes.motions) {
    const Assembly& assembly = *motion.assembly;
    const LinearEnergy energy(assembly, rest);
    Eigen::VectorXd u(assembly.size()), zero = Eigen::VectorXd::Zero(assembly.size());
    for (int i = 0; i < u.size(); ++i) u(i) = 1e-5 * std::sin(1.0 + 1.7 * i);
    EnergyAccount change = nothing(*modes.chain);
    energy.add(u, zero, change);
    const double expected = 0.5 * u.dot(motion.stiffness * u);
    EXPECT_NEAR(change.sum().potential() / expected, 1, 1e-7);
    EXPECT_EQ(change.sum().kinetic, 0);
    EnergyAccount speed = nothing(*modes.chain);
    energy.add(zero, u, speed);
    EXPECT_NEAR(speed.sum().kinetic / (0.5 * u.dot(motion.mass * u)), 1, 1e-12);

    ChainState plus = rest, minus = rest;
    assembly.advance(rest, u, 1, plus);
    assembly.advance(rest, u, -1, minus);
    const EnergyAccount at_rest = assembly.energy(rest), ahead = assembly.energy(plus),
                        behind = assembly.energy(minus);
    EnergyAccount other = nothing(*modes.chain);
    energy.add(-u, zero, other);
    for (std::size_t m = 0; m <= modes.chain->members.size(); ++m) {
      const bool node = m == modes.chain->members.size();
      const auto of = [&](const EnergyAccount& a) { return node ? a.nodes : a.members[m]; };
      for (const auto kind :
           {&Energy::axial, &Energy::bending, &Energy::torsion, &Energy::gravity}) {
        const double even = (of(ahead).*kind + of(behind).*kind - 2 * (of(at_rest).*kind)) / 2;
        const double odd = (of(ahead).*kind - of(behind).*kind) / 2;
        const double rounding = 1e-13 * (1 + std::abs(of(at_rest).*kind));
        const double own_even = (of(change).*kind + of(other).*kind) / 2;
        const double own_odd = (of(change).*kind - of(other).*kind) / 2;
        EXPECT_NEAR(own_even, even, 1e-3 * std::abs(expected) + rounding);
        EXPECT_NEAR(own_odd, odd, 1e-3 * std::abs(expected) + rounding);
      }
    }
  }
}

TEST(LinearEnergy, IsTheExactOneToSecondOrder) {
  expect_second_order(testing::released_cable(8));
  Scene rig = testing::beam_and_cables(5);
  expect_second_order(rig);
  rig.members[0].EI = {2.1, 8.0};
  for (Member& member : rig.members) member.GJ = 1.5;
  rig.nodes[0].support.kind = Support::Kind::elastic;
  rig.nodes[0].support.translational = {4e4, 5e4, 6e4};
  rig.nodes[0].support.rotational = {30, 40, 50};
  expect_second_order(rig);
}

// Supplied, dissipated and stored energy come from three separate computations. Undamped and
// damped, by modal ratios or by joints, driven by a pulse, a record or a hung mass.
TEST(LinearAccount, ClosesWhateverTheLoadAndTheDamping) {
  ForceHistory history;
  for (int i = 0; i <= 40; ++i) {
    history.time_s.push_back(0.01 + 0.002 * i);
    history.force_N.push_back(i == 0 || i == 40 ? 0.0 : std::sin(0.9 * i) + 0.3);
  }
  for (const int damping : {0, 1, 2}) {
    for (const auto kind : {Load::Kind::impact, Load::Kind::record, Load::Kind::release}) {
      Scene scene = testing::beam_and_cables(6);
      for (Member& member : scene.members) {
        if (damping == 1) member.damping_ratio = 0.03;
        if (damping == 2) member.damping = {.axial = 3, .bending = 0.02, .torsion = 0};
      }
      scene.loads[0].kind = kind;
      scene.loads[0].mass = 0.1;
      ResponseOptions options;
      options.sampling = {.duration_s = 0.2, .rate_hz = 1000, .energy_samples = 50};
      options.solver = ResponseSolver::modal;
      options.records = {kind == Load::Kind::record ? history : ForceHistory{}};
      const ResponseResult result = simulate_response(scene, options);
      ASSERT_TRUE(result.completed) << result.reason;
      ASSERT_EQ(result.energy.time_s.size(), 51u);
      // Gauss's rule over panels of 2 / omega errs by 2^10 / (2 * 10!^3 / 5!^4 ...) < 1e-8 of the
      // fastest waves, which hold a millionth; joint dampers' poles are known to 1e-9.
      EXPECT_LT(result.energy_drift, 1e-6) << damping << " " << static_cast<int>(kind);
      if (damping > 0) {
        EXPECT_GT(result.energy.dissipated.back(), 0.05 * result.energy.account[0].sum().kinetic);
        EXPECT_GT(result.energy.dissipated.back(), 0);
      } else {
        EXPECT_EQ(result.energy.dissipated.back(), 0);
      }
      if (kind == Load::Kind::release) {
        EXPECT_EQ(result.energy.supplied.back(), 0);
      } else {
        EXPECT_GT(result.energy.supplied.back(), 0);
      }
    }
  }
}

// Kind by kind the linear account is that of the exact equations where the motion is small: 2 g on
// the cable move it by 0.1 mm, a fiftieth of its sag, which is what the energies' terms of third
// order have of those of the second. Stretch and weight exchange terms of first order, hundreds of
// times larger, in which the displacement's own difference (2e-4, from the sag's change) shows.
TEST(LinearAccount, AgreesWithTheExactOneOfASmallMotion) {
  Scene scene = testing::released_cable(12, 0.002);
  scene.members[0].damping_ratio = 0.01;
  ResponseOptions options;
  options.sampling = {.duration_s = 0.2, .rate_hz = 2000, .energy_samples = 20};
  options.solver = ResponseSolver::modal;
  const ResponseResult linear = simulate_response(scene, options);
  options.solver = ResponseSolver::explicit_motion;
  options.axial = true;
  const ResponseResult exact = simulate_response(scene, options);
  ASSERT_TRUE(linear.completed && exact.completed);
  double largest = 0;
  for (const auto& account : exact.energy.account) {
    largest = std::max(largest, account.sum().kinetic);
  }
  ASSERT_EQ(linear.energy.time_s.size(), exact.energy.time_s.size());
  const auto change = [](const ResponseResult& r, std::size_t i, double Energy::*kind) {
    return r.energy.account[i].members[0].*kind - r.energy.account[0].members[0].*kind;
  };
  for (std::size_t i = 0; i < linear.energy.time_s.size(); ++i) {
    for (const auto kind : {&Energy::kinetic, &Energy::axial, &Energy::bending, &Energy::gravity}) {
      const double expected = change(exact, i, kind);
      EXPECT_NEAR(change(linear, i, kind), expected, 2e-2 * largest + 1e-3 * std::abs(expected))
          << i;
    }
    EXPECT_NEAR(linear.energy.dissipated[i], exact.energy.dissipated[i], 2e-2 * largest);
  }
}

}  // namespace
}  // namespace rigfit::model::linear_account_test
