// The minimiser of an update: coordinates that come to their bounds, steps of springs in fixity.
#include "ident/update/problem/update_problem.h"

#include "tests/ident/update/fit_data.h"
#include "tests/ident/update/hanger.h"
#include "tests/test.h"

namespace rigfit::ident::update_solver_test {

using model::Support;

constexpr double kEI = 2e5;
const double kHalf = 3 * kEI / testing::kLength + std::sqrt(kEI * testing::kTension);

// Tension and one spring at both ends, which lies within `low` and `high` times half held; modes of
// a hanger with springs of `truth` times that.
UpdateProblem springs(double truth, double low, double high, const UpdateOptions& options) {
  const auto scene = testing::hanger(Support::Kind::elastic, kEI, truth * kHalf);
  auto fitted = testing::hanger(Support::Kind::elastic, kEI, std::sqrt(low * high) * kHalf);
  std::vector<FreeParameter> free{{"h.tension"}, {"k", {"a.rotational_z", "b.rotational_z"}}};
  free[1].low = low * kHalf, free[1].high = high * kHalf;
  return UpdateProblem({{"hanger", fitted, testing::measured(scene, 6, 1e-3)}}, free, options);
}

TEST(UpdateSolver, LeavesABoundWhereTheSlopeLeadsInwards) {
  const UpdateOptions options = testing::plain_options();
  const UpdateProblem problem = springs(0.7, 1e-4, 1e4, options);
  std::string failure;
  const auto matches = problem.match(problem.start(), failure).matches;
  for (const double start : {1e-4, 1e4}) {
    Eigen::VectorXd q(2);
    q << std::log(0.9 * testing::kTension), std::log(start * kHalf);
    double cost = 0;
    EXPECT_TRUE(minimise(problem, matches, q, cost));
    EXPECT_NEAR(std::exp(q[0]), testing::kTension, 1e-6 * testing::kTension) << start;
    EXPECT_NEAR(std::exp(q[1]), 0.7 * kHalf, 1e-5 * kHalf) << start;
  }
}

/// Targets of one input count as those of one input each, also beside one that leaves the plane of
/// symmetry, by which all modes are found anew without their damping.
TEST(UpdateProblem, TargetsOfAnInputAddUp) {
  auto scene = model::testing::cable_beam_rig(100, 0.4948, 8);
  for (auto& member : scene.members) member.damping_ratio = 0.01;
  auto measured = testing::modes_of(scene, model::ModePlane::in, 3, 1e-3);
  for (auto& mode : measured) mode.damping_ratio = {0.01, 1e-4};
  const auto jacobian = [&](const std::vector<UncertainInput>& inputs) {
    UpdateOptions options = testing::plain_options();
    options.inputs = inputs;
    const UpdateProblem problem({{"beam", scene, measured}},
                                {{"beam.EI_z"}, {"beam.damping_ratio"}}, options);
    std::string failure;
    const auto matches = problem.match(problem.start(), failure).matches;
    Eigen::VectorXd r;
    Eigen::MatrixXd J;
    EXPECT_TRUE(problem.residuals(problem.start(), matches, r, &J)) << failure;
    return J;
  };
  const UncertainInput::Effect damping{0, "left cable.damping_ratio", 1e-3},
      mass{0, "beam.mass_per_length", -1e-3}, place{0, "tip.z", 1e-3};
  const auto together = jacobian({{"all", {damping, mass, place}}});
  const auto each = jacobian({{"d", {damping}}, {"m", {mass}}, {"z", {place}}});
  const Eigen::VectorXd sum = each.topRightCorner(6, 3).rowwise().sum();
  EXPECT_GT(sum.norm(), 1);
  EXPECT_LT((together.col(2).head(6) - sum).norm(), 1e-6 * sum.norm());
}

}  // namespace rigfit::ident::update_solver_test
