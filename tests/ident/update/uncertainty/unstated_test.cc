// End conditions that a fit takes as exact: named where they matter, with what they change.
#include "ident/update/unstated.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "ident/campaign/fit_campaign.h"
#include "model/scene/parameters.h"
#include "model/scene/read_scene.h"
#include "tests/ident/update/hanger.h"

namespace rigfit::ident::exact_ends_test {
namespace {

using testing::hanger;
using testing::kLength;
using testing::kTension;
using testing::measured;

UpdateResult tension_of(const model::Scene& truth, const model::Scene& fitted, double std,
                        std::vector<FreeParameter> free = {{"h.tension"}}) {
  UpdateOptions options;
  options.segment_uncertainty = false;  // the data have the model's segments
  return update_model({{"hanger", fitted, measured(truth, 6, std)}}, free, options);
}

bool named(const UpdateResult& result) {
  for (const auto& finding : fit_findings(result)) {
    if (finding.code == "exact_ends") return true;
  }
  return false;
}

using Kind = model::Support::Kind;
constexpr double kEI = 2e5, kSpring = 10 * kEI / kLength;

const ExactInput* ends_of(const UpdateResult& result) {
  for (const auto& input : result.exact_inputs) {
    if (input.name.starts_with("ends ")) return &input;
  }
  return nullptr;
}

// The data come from springs; taken as pinned or clamped, the tension follows, out of its interval.
// Where it moves is known to first order in the fixity, its way to the truth to a half.
TEST(ExactEnds, NamesWhatSpringsWouldChange) {
  const auto truth = hanger(Kind::elastic, kEI, kSpring);
  for (const Kind wrong : {Kind::pinned, Kind::clamped}) {
    const auto fit = tension_of(truth, hanger(wrong, kEI), 5e-3);
    const auto* ends = ends_of(fit);
    ASSERT_NE(ends, nullptr);
    EXPECT_EQ(ends->name, wrong == Kind::pinned ? "ends a, b (pinned)" : "ends a, b (clamped)");
    const double off = kTension - fit.parameters[0].value;
    EXPECT_GT(std::abs(off), 2 * fit.parameters[0].std);
    EXPECT_GT(ends->shift[0] * off, 0);
    EXPECT_GT(std::abs(ends->shift[0]), 0.5 * std::abs(off));
    EXPECT_TRUE(named(fit));
  }
}

// Springs as given, of a third of the truth; fitted springs are none that are taken as exact.
TEST(ExactEnds, NamesGivenSprings) {
  const auto truth = hanger(Kind::elastic, kEI, kSpring);
  const auto fit = tension_of(truth, hanger(Kind::elastic, kEI, kSpring / 3), 1e-3);
  ASSERT_NE(ends_of(fit), nullptr);
  EXPECT_EQ(ends_of(fit)->name, "ends a, b (springs)");
  EXPECT_TRUE(named(fit));
  const auto free = tension_of(truth, hanger(Kind::elastic, kEI, kSpring / 3), 1e-3,
                               {{"h.tension"}, {"k", {"a.rotational_z", "b.rotational_z"}}});
  EXPECT_FALSE(named(free));
}

// A string: clamps shorten it by 2 sqrt(EI / T), here 1.3e-4 of its length, which makes 2.5e-4 of
// its tension; six frequencies to 1 % know that to 2 / 6^(1/2) %. Ends do not matter.
TEST(ExactEnds, SilentWhereEndsMoveNothing) {
  const auto fit = tension_of(hanger(Kind::pinned, 0.2), hanger(Kind::pinned, 0.2), 0.01);
  ASSERT_NE(ends_of(fit), nullptr);
  EXPECT_LT(std::abs(ends_of(fit)->shift[0]), 0.1 * fit.parameters[0].std);
  EXPECT_FALSE(named(fit));
}

// A point mass at the middle of a pinned string of mass m L loads its odd modes: by Rayleigh's
// quotient 2 x 1 % of omega^2 and so of the tension, nothing of the even ones; the mean of three
// odd and three even modes has half of that.
TEST(ExactInputs, AMassOfOnePercentThatTheSceneLacksIsNamed) {
  const auto fit = tension_of(hanger(Kind::pinned, 0.2), hanger(Kind::pinned, 0.2), 1e-4);
  for (const auto& input : fit.exact_inputs) {
    if (input.name != "mass at 0.5 of h") continue;
    EXPECT_EQ(input.relative_change, 0.01);
    EXPECT_NEAR(input.shift[0], 0.01 * kTension, 0.01 * 0.01 * kTension);
    return;
  }
  FAIL() << "no such row";
}

}  // namespace
}  // namespace rigfit::ident::exact_ends_test
