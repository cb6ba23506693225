#include "ident/stiffness/stiffness_law.h"

#include "tests/test.h"

namespace rigfit::ident::stiffness_law_test {

std::vector<StiffnessPoint> points_of(const std::function<double(double)>& law, double relative_std,
                                      const std::vector<double>& tensions) {
  std::vector<StiffnessPoint> points;
  for (double T : tensions) {
    const double EI = law(T);
    points.push_back({T, EI, relative_std * EI});
  }
  return points;
}

const std::vector<double> kTensions{10, 25, 50, 100, 150, 200, 250, 300};

const FittedLaw& law_of(const StiffnessLaws& laws, LawKind kind) {
  for (const auto& law : laws.laws) {
    if (law.kind == kind) return law;
  }
  throw std::runtime_error("law not fitted");
}

struct Case {
  LawKind kind;
  std::function<double(double)> truth;
  std::vector<double> parameters;
};

std::vector<Case> cases() {
  return {
      {LawKind::linear, [](double T) { return 0.2 + 0.002 * T; }, {0.2, 0.002}},
      {LawKind::square_root, [](double T) { return 0.05 + 0.04 * std::sqrt(T); }, {0.05, 0.04}},
      {LawKind::power, [](double T) { return 0.1 * std::pow(T / 80, 0.45); }, {0, 0.45}},
      {LawKind::saturating, [](double T) { return 0.03 + 0.9 * T / (T + 70); }, {0.03, 0.93, 70}},
  };
}

TEST(StiffnessLaws, FindTheLawThatMadeThePoints) {
  for (const auto& test : cases()) {
    const auto laws = fit_stiffness_laws(points_of(test.truth, 0.005, kTensions));
    ASSERT_FALSE(laws.laws.empty());
    EXPECT_TRUE(laws.decided) << laws.sentence;
    EXPECT_EQ(laws.laws[0].kind, test.kind) << laws.sentence;
    for (std::size_t j = 0; j < test.parameters.size(); ++j) {
      if (test.parameters[j] == 0) continue;  // the power law's, which depends on T0
      // Points without noise: what is left is Ceres' tolerance, 1e-13 in the cost.
      EXPECT_NEAR(laws.laws[0].parameters[j].value, test.parameters[j], 1e-5 * test.parameters[j]);
    }
    for (double T : {15.0, 80.0, 280.0}) {
      EXPECT_NEAR(predict(laws.laws[0], T).EI_Nm2, test.truth(T), 1e-5 * test.truth(T));
    }
  }
}

// A straight line has a closed form: the weighted normal equations.
TEST(StiffnessLaws, CovarianceOfALineIsThatOfTheNormalEquations) {
  const auto points = points_of([](double T) { return 0.2 + 0.002 * T; }, 0.02, kTensions);
  const auto laws = fit_stiffness_laws(points);
  const auto& line = law_of(laws, LawKind::linear);
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  for (const auto& point : points) {
    const Eigen::Vector2d row = Eigen::Vector2d(1, point.tension_N) / point.std;
    normal += row * row.transpose();
  }
  const Eigen::Matrix2d expected = normal.inverse();
  EXPECT_NEAR(line.parameters[0].std, std::sqrt(expected(0, 0)), 1e-9);
  EXPECT_NEAR(line.parameters[1].std, std::sqrt(expected(1, 1)), 1e-11);
  const Eigen::Vector2d at(1, 120);
  const double std = std::sqrt(at.dot(expected * at));
  const auto prediction = predict(line, 120);
  EXPECT_NEAR(prediction.std, std, 1e-9);
  EXPECT_NEAR(prediction.high - prediction.low, 2 * 1.959963984540054 * std, 1e-8);
}

// Table 1 of the paper: four points without uncertainty. Four laws fit within a few per cent and
// nothing chooses between them.
TEST(StiffnessLaws, ThePapersFourPointsCannotChoose) {
  const std::vector<StiffnessPoint> points{
      {25, 0.2549}, {100, 0.4948}, {200, 0.5972}, {300, 0.8283}};
  const auto laws = fit_stiffness_laws(points);
  EXPECT_FALSE(laws.weighted);
  EXPECT_FALSE(laws.decided);
  EXPECT_THAT(laws.sentence, HasSubstr("too few to choose"));
  EXPECT_EQ(laws.laws.size(), 4U);
  for (const auto& law : laws.laws) {
    EXPECT_TRUE(law.converged) << law.message;
    EXPECT_LT(law.rms_relative_error, 0.15);
    EXPECT_TRUE(std::isnan(law.akaike_weight));
  }
  // The power law's exponent by hand: regression of ln EI on ln T gives 0.459; the fit weighs by
  // relative error, the same to first order.
  EXPECT_NEAR(law_of(laws, LawKind::power).parameters[1].value, 0.459, 0.02);
}

TEST(StiffnessLaws, TwoPointsAreALineAndDecideNothing) {
  const auto laws =
      fit_stiffness_laws({{100, 0.5, 0.01, 0.48, 0.52}, {300, 0.8, 0.01, 0.78, 0.82}});
  const auto half_way = predict(law_of(laws, LawKind::linear), 200);
  EXPECT_NEAR(half_way.EI_Nm2, 0.65, 1e-9);
  EXPECT_NEAR(half_way.std / (0.01 / std::sqrt(2.0)), 1, 0.05);  // each known to 0.01
  EXPECT_FALSE(laws.decided);
}

TEST(StiffnessLaws, StrandBoundsFixTheSaturatingLaw) {
  const StiffnessBounds bounds{0.0306, 15.5632};
  const auto points = points_of([&](double T) { return 0.0306 + 15.5326 * T / (T + 5000); }, 0.02,
                                {25, 100, 200, 300});
  const auto laws = fit_stiffness_laws(points, {.bounds = bounds});
  const auto& law = law_of(laws, LawKind::saturating);
  EXPECT_TRUE(law.parameters[0].fixed && law.parameters[1].fixed);
  EXPECT_NEAR(law.parameters[2].value, 5000, 0.01);
  EXPECT_GT(law.parameters[2].std, 0);
  EXPECT_TRUE(std::isfinite(law.aicc));  // one parameter: four points are enough for a ranking
}

TEST(StiffnessLaws, BandsCover) {
  Normal normal(11);
  const auto truth = [](double T) { return 0.05 + 0.04 * std::sqrt(T); };
  int covered = 0;
  constexpr int kTrials = 400;
  for (int trial = 0; trial < kTrials; ++trial) {
    auto points = points_of(truth, 0.03, kTensions);
    for (auto& point : points) point.EI_Nm2 *= 1 + 0.03 * normal();
    const auto laws = fit_stiffness_laws(points);
    const auto band = predict(law_of(laws, LawKind::square_root), 120);
    covered += holds(band, truth(120));
  }
  // The variance is raised when the scatter exceeds the weights and never lowered, so coverage is
  // at least nominal: 95 % less three binomial deviations (3.3 %), and not everything.
  EXPECT_GE(covered, 0.917 * kTrials);
  EXPECT_LE(covered, kTrials - 2);
}

TEST(StiffnessLaws, CommonUncertaintyWidensTheBandOnly) {
  auto points = points_of([](double T) { return 0.2 + 0.002 * T; }, 0.01, kTensions);
  const auto plain_laws = fit_stiffness_laws(points);
  for (auto& point : points) {
    point.shared_relative_std = 0.03;
    point.std = std::hypot(point.std, 0.03 * point.EI_Nm2);
  }
  const auto common_laws = fit_stiffness_laws(points);
  const auto& plain = law_of(plain_laws, LawKind::linear);
  const auto& common = law_of(common_laws, LawKind::linear);
  EXPECT_NEAR(plain.parameters[0].value, common.parameters[0].value, 1e-12);
  const double wide = predict(common, 100).std, narrow = predict(plain, 100).std;
  EXPECT_NEAR(wide * wide - narrow * narrow, std::pow(0.03 * 0.4, 2), 1e-9);
}

TEST(StiffnessLaws, RefuseWhatIsNotPositive) {
  EXPECT_THROW((void)fit_stiffness_laws({{100, 0.5}}), std::invalid_argument);
  EXPECT_THROW((void)fit_stiffness_laws({{100, 0.5}, {0, 0.7}}), std::invalid_argument);
  EXPECT_THROW((void)fit_stiffness_laws({{100, 0.5}, {200, NAN}}), std::invalid_argument);
}

}  // namespace rigfit::ident::stiffness_law_test
