#include "ident/stiffness/stiffness_law.h"

#include "tests/test.h"

namespace rigfit::ident::strand_test {

// Jalali and Rideout 2021, eq. (21): EImax = 15.5632 N m2 for the 6.35 mm strand. With E = 195 GPa
// the formula gives 15.5630; E is printed with three digits, so 0.3 % is what can be asked.
TEST(StiffnessBounds, MatchThePapersUpperBound) {
  const auto bounds = stiffness_bounds({195e9, 133, 0.397e-3, 6.35e-3});
  EXPECT_NEAR(bounds.EI_max_Nm2, 15.5632, 0.003 * 15.5632);
  EXPECT_LT(bounds.EI_min_Nm2, bounds.EI_max_Nm2);
}

TEST(StiffnessBounds, OneElementOfFullDiameterIsSolid) {
  const auto bounds = stiffness_bounds({2e11, 1, 5e-3, 5e-3});
  EXPECT_DOUBLE_EQ(bounds.EI_min_Nm2, bounds.EI_max_Nm2);
}

TEST(StiffnessBounds, RefuseWhatIsNotPositive) {
  EXPECT_THROW((void)stiffness_bounds({195e9, 0, 1e-3, 1e-2}), std::invalid_argument);
  EXPECT_THROW((void)stiffness_bounds({NAN, 7, 1e-3, 1e-2}), std::invalid_argument);
}

}  // namespace rigfit::ident::strand_test
