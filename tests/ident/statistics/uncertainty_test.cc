#include "ident/statistics/uncertainty.h"

#include "tests/test.h"

namespace rigfit::ident::uncertainty_test {

Eigen::MatrixXd random_matrix(int rows, int columns) {
  Normal normal(3);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return 100 * normal(); });
}

TEST(Identifiability, IsTheInverseNormalMatrixWhenAllIsDetermined) {
  const Eigen::MatrixXd J = random_matrix(12, 3);
  const auto known = identifiability(J, Eigen::Vector3d(1, 2, 0.5), {"a", "b", "c"});
  EXPECT_TRUE(known.open.empty());
  const Eigen::MatrixXd expected = (J.transpose() * J).inverse();
  // Condition of J is below 10: rounding only.
  EXPECT_TRUE(MatricesNear(known.covariance, expected, 1e-13 * expected.norm()));
}

TEST(Identifiability, NamesTwoThatOnlyActTogether) {
  Eigen::MatrixXd J = random_matrix(12, 3);
  J.col(2) = -2 * J.col(0);  // p0 up by 2 and p2 up by 1: nothing changes
  const auto known = identifiability(J, Eigen::Vector3d(1, 1, 1), {"EI", "tension", "span"});
  ASSERT_EQ(known.open.size(), 1U);
  EXPECT_THAT(known.open[0].message, HasSubstr("EI and span"));
  EXPECT_THAT(known.open[0].message, Not(HasSubstr("tension")));
  EXPECT_FALSE(known.identifiable[0]);
  EXPECT_TRUE(known.identifiable[1]);
  EXPECT_FALSE(known.identifiable[2]);
  EXPECT_TRUE(std::isnan(known.std[0]));
  // What is determined keeps the variance it has with the other two reduced to one.
  const Eigen::MatrixXd reduced = J.leftCols(2);
  EXPECT_NEAR(known.std[1], std::sqrt((reduced.transpose() * reduced).inverse()(1, 1)),
              1e-9 * known.std[1]);
}

TEST(Identifiability, VagueIsNotDetermined) {
  // One residual of standard deviation 1 per parameter: relative standard deviations 0.8 and 1.25.
  const auto known = identifiability(Eigen::Vector2d(1.25, 0.8).asDiagonal().toDenseMatrix(),
                                     Eigen::Vector2d(1, 1), {"a", "b"});
  EXPECT_TRUE(known.identifiable[0]);
  EXPECT_FALSE(known.identifiable[1]);
  EXPECT_NEAR(known.std[0], 0.8, 1e-14);
  EXPECT_EQ(known.open.size(), 1U);
}

TEST(Identifiability, NothingFiniteDeterminesNothing) {
  const auto known =
      identifiability(Eigen::MatrixXd::Constant(3, 2, NAN), Eigen::Vector2d(1, 1), {"a", "b"});
  EXPECT_EQ(known.open.size(), 2U);
  EXPECT_FALSE(known.identifiable[0]);
}

TEST(ProbabilityText, HasTwoDigitsAndALeastValue) {
  for (const auto& [p, text] : {std::pair{0.01234, "0.012"},
                                {2e-6, "2e-06"},
                                {9.9e-146, "below 1e-6"},
                                {0.0, "below 1e-6"},
                                {kNaN, "-"}}) {
    EXPECT_EQ(probability_text(p), text);
  }
}

}  // namespace rigfit::ident::uncertainty_test
