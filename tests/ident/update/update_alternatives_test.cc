#include "ident/update/assignment/update_alternatives.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "ident/update/model_update.h"
#include "tests/ident/update/laboratory_rig.h"

namespace rigfit::ident {
namespace {

// Damping ratios are known far better than any model far from the answer gives them. They must not
// lead there: the answer was lost then by changes of 1e-11 in what was measured.
TEST(FindAnswers, RoundingOfTheMeasuredModesChangesNothing) {
  const std::string laboratory = RIGFIT_TESTDATA "/virtual_laboratory";
  std::mt19937_64 random(11);
  std::vector<UpdateState> measured;
  for (const double tension : {200.0, 300.0}) {
    measured.push_back({"", testing::laboratory_rig(laboratory, "scenes", tension, 30),
                        testing::laboratory_modes(laboratory, tension, 30, 2e-6, 2e-4, random)});
    measured.back().band_hz = {2.0, 60.0};
    ASSERT_GE(measured.back().measured.size(), 7U);
  }
  UpdateOptions options;
  options.starts = 1;
  options.model_relative_std = 1e-3;
  std::normal_distribution<double> normal;
  for (int draw = 0; draw < 20; ++draw) {
    SCOPED_TRACE(draw);
    auto states = measured;
    for (auto& state : states) {
      for (auto& mode : state.measured) mode.frequency_hz.value *= 1 + 1e-11 * normal(random);
    }
    const UpdateProblem problem(states, testing::laboratory_parameters(), options);
    int fits = 0;
    std::string failure;
    const auto answers = find_answers(problem, options, fits, failure);
    ASSERT_EQ(answers.size(), 1U) << failure;
    const auto& answer = answers.front();
    const double ln_EI = answer.solution.q[0];
    const double std = std::sqrt(answer.hessian.inverse()(0, 0));
    // Of ln EI: twice the 0.1 % of one mode's frequency, and half as much again.
    EXPECT_LT(std, 3e-3);
    EXPECT_NEAR(ln_EI, std::log(testing::kLaboratoryEI), 4 * std);
    EXPECT_EQ(answer.solution.matches.unpaired_measured, 0);
    EXPECT_TRUE(answer.solution.converged);
  }
}

}  // namespace
}  // namespace rigfit::ident
