// End conditions that a fit takes as exact: named where they matter, with what they change.
#include "ident/update/uncertainty/exact_ends.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "ident/campaign/fit_campaign.h"
#include "model/scene/parameters.h"
#include "model/scene/read_scene.h"

namespace rigfit::ident::exact_ends_test {
namespace {

constexpr double kLength = 10, kTension = 5e5;

// A hanger of 30 kg/m; springs of `rotational` N m/rad where the support is elastic.
model::Scene hanger(model::Support::Kind kind, double EI, double rotational = 0) {
  model::Scene scene;
  scene.gravity.setZero();
  constexpr double kFixed = std::numeric_limits<double>::infinity();
  for (const double x : {0.0, kLength}) {
    model::SceneNode node;
    node.name = x == 0 ? "a" : "b";
    node.position = {x, 0, 0};
    node.support.kind = kind;
    if (kind == model::Support::Kind::elastic) {
      node.support.translational.setConstant(kFixed);
      node.support.rotational = {kFixed, rotational, rotational};
    }
    scene.nodes.push_back(node);
  }
  model::Member member;
  member.name = "h";
  member.kind = model::Member::Kind::cable;
  member.nodes = {"a", "b"};
  member.segments = 40;
  member.mass_per_length = 30;
  member.EA = 2e3 * kTension;
  member.EI = {EI, EI};
  member.GJ = EI;
  member.tension = kTension;
  scene.members.push_back(member);
  return scene;
}

std::vector<MeasuredMode> measured(const model::Scene& truth, std::size_t count, double std) {
  model::ModesOptions options;
  options.count = 3 * static_cast<int>(count);
  options.plane = model::ModePlane::in;
  std::vector<MeasuredMode> modes;
  for (const auto& mode : model::analyse_modes(truth, options).modes) {
    if (mode.plane != model::ModePlane::in || modes.size() == count) continue;
    modes.emplace_back();
    modes.back().frequency_hz = {mode.frequency_hz, std * mode.frequency_hz};
    modes.back().plane = model::ModePlane::in;
  }
  return modes;
}

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
