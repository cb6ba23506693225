// End conditions that a fit takes as exact: named where they matter, with what they change.
#include "ident/update/uncertainty/exact_ends.h"

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

// The data come from springs; taken as pinned or clamped, the tension follows. What is named is
// where a fit with free springs ends.
TEST(ExactEnds, NamesWhatSpringsWouldChange) {
  const auto truth = hanger(Kind::elastic, kEI, kSpring);
  for (const Kind wrong : {Kind::pinned, Kind::clamped}) {
    const auto fit = tension_of(truth, hanger(wrong, kEI), 5e-3);
    ASSERT_EQ(fit.exact_ends.size(), 1u);
    const auto& ends = fit.exact_ends[0];
    EXPECT_EQ(ends.nodes, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(ends.taken_as, wrong == Kind::pinned ? "pinned" : "clamped");
    EXPECT_GT(std::abs(fit.parameters[0].value - kTension), 2 * fit.parameters[0].std);
    EXPECT_TRUE(named(fit));
    // The data are exact: the fit with springs ends at the truth, its tolerance of 1e-5 of the cost
    // well within a tenth of the standard uncertainty.
    EXPECT_NEAR(fit.parameters[0].value + ends.shift[0], kTension, 0.1 * fit.parameters[0].std);
    EXPECT_NEAR(ends.stiffness, kSpring, 0.05 * kSpring);
    EXPECT_NEAR(ends.chi2_less, fit.fit.chi2, 0.01 * fit.fit.chi2 + 0.01);
    EXPECT_GE(std::abs(ends.largest_shift[0]), std::abs(ends.shift[0]));
  }
}

// Springs as given, of a third of the truth.
TEST(ExactEnds, NamesGivenSprings) {
  const auto truth = hanger(Kind::elastic, kEI, kSpring);
  const auto fit = tension_of(truth, hanger(Kind::elastic, kEI, kSpring / 3), 1e-3);
  ASSERT_EQ(fit.exact_ends.size(), 1u);
  EXPECT_EQ(fit.exact_ends[0].taken_as, "springs");
  EXPECT_NEAR(fit.exact_ends[0].stiffness, kSpring, 0.05 * kSpring);
  EXPECT_TRUE(named(fit));
  // Fitted springs are none that are taken as exact.
  const auto free = tension_of(truth, hanger(Kind::elastic, kEI, kSpring / 3), 1e-3,
                               {{"h.tension"}, {"k", {"a.rotational_z", "b.rotational_z"}}});
  for (const auto& ends : free.exact_ends) {
    EXPECT_NEAR(ends.largest_shift[0], 0, 0.01 * free.parameters[0].std);  // about the other axis
  }
  EXPECT_FALSE(named(free));
}

// A string: clamps shorten it by 2 sqrt(EI / T), here 1.3e-4 of its length, which makes 2.5e-4 of
// its tension; six frequencies to 1 % know that to 2 / 6^(1/2) %. Ends do not matter.
TEST(ExactEnds, SilentWhereEndsMoveNothing) {
  const auto fit = tension_of(hanger(Kind::pinned, 0.2), hanger(Kind::pinned, 0.2), 0.01);
  ASSERT_EQ(fit.exact_ends.size(), 1u);
  EXPECT_LT(std::abs(fit.exact_ends[0].largest_shift[0]), 0.1 * fit.parameters[0].std);
  EXPECT_FALSE(named(fit));
}

// A fixity is a value and back; its derivative against a central difference of step 1e-6, whose own
// error is below 1e-9 of it there.
TEST(UpdateCoordinate, OfAFixity) {
  UpdateCoordinate q;
  q.logarithmic = false, q.fixity = true, q.scale = 3;
  for (const double at : {0.1, 0.5, 0.9}) {
    EXPECT_NEAR(q.coordinate(q.value(at)), at, 1e-15);
    const double difference = (q.value(at + 1e-6) - q.value(at - 1e-6)) / 2e-6;
    EXPECT_NEAR(q.derivative(at), difference, 1e-8 * q.derivative(at));
  }
}

}  // namespace
}  // namespace rigfit::ident::exact_ends_test
