#include "model/algebra/bordered_solver.h"

#include "model/linear/modes.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::bordered_solver_test {

// Twelve tensioned spans in a row, and six.
TEST(BorderedSolver, LongLineHasItsTensions) {
  for (const int poles : {5, 11}) {
    Scene line = testing::utility_line(poles, 20, 6);
    std::vector<double> tension;
    for (Member& member : line.members) {  // unlike spans bend the poles between them
      if (member.tension)
        tension.push_back(*(member.tension = 3000 + 150.0 * (tension.size() % 3)));
    }
    const ChainModes prepared = prepare_motions(line, {});
    ASSERT_EQ(prepared.equilibrium.status, EquilibriumStatus::converged) << poles;
    EXPECT_LT(prepared.equilibrium.residual, 1e-9);
    std::size_t span = 0;
    for (const auto& member : describe(*prepared.chain, prepared.equilibrium, line).members) {
      if (member.member.rfind("conductor", 0) != 0) continue;
      ASSERT_LT(span, tension.size());
      // The residual, 1e-9 of the largest force, is also that of the tensions.
      EXPECT_NEAR(member.tension_N, tension[span++], 3000 * 1e-8) << member.member;
    }
    EXPECT_EQ(span, std::size_t(poles + 1));
  }
}

}  // namespace rigfit::model::bordered_solver_test
