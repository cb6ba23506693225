#include "ident/stiffness/stiffness_curve.h"

#include "ident/campaign/single_tests/bending_campaign.h"
#include "ident/stiffness/stiffness_law.h"
#include "ident/virtual_rig/sensor_model.h"
#include "ident/virtual_rig/virtual_bench.h"
#include "tests/test.h"

namespace rigfit::ident::stiffness_curve_test {

StiffnessPoint point(double T, double EI, double std, double shared = 0) {
  return {T, EI, std, EI - 1.959963984540054 * std, EI + 1.959963984540054 * std, shared};
}

double sqrt_law(double T) { return 0.08 + 0.042 * std::sqrt(T); }

// Of EI at the tensions: the sum over the terms that move it at all of them together.
Eigen::MatrixXd covariance_of(const StiffnessCurve& curve, std::span<const double> tensions) {
  const auto n = static_cast<Index>(tensions.size());
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
  for (const auto& term : curve.uncertainty(tensions)) {
    sum += term.change_Nm2 * term.change_Nm2.transpose();
  }
  return sum;
}

// Tests to 0.2 % at six tensions: only the square root passes through them.
TEST(StiffnessCurve, ADecidedLawIsTheCurve) {
  std::vector<StiffnessPoint> points;
  for (double T : {300.0, 25.0, 50.0, 100.0, 150.0, 200.0}) {
    points.push_back(point(T, sqrt_law(T), 0.002 * sqrt_law(T)));
  }
  const StiffnessCurve curve(points);
  ASSERT_EQ(curve.source(), StiffnessSource::law) << curve.sentence();
  EXPECT_EQ(curve.laws().laws.front().kind, LawKind::square_root);
  // Between the tests the law, not the chord: at 37 N the chord lies 0.4 % below.
  const auto at = curve.at(37);
  EXPECT_NEAR(at.EI_Nm2, sqrt_law(37), 1e-6);
  EXPECT_NEAR(at.slope_m2, 0.021 / std::sqrt(37.0), 1e-4);
  EXPECT_FALSE(at.extrapolated);
  EXPECT_TRUE(curve.at(310).extrapolated);
  EXPECT_NEAR(at.high - at.low, 2 * 1.959963984540054 * at.std, 1e-12);
  // Terms and covariance say the same.
  const std::array<double, 3> T{25, 120, 300};
  const Eigen::MatrixXd covariance = covariance_of(curve, T);
  for (Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::sqrt(covariance(i, i)), curve.at(T[i]).std, 1e-12);
  }
  EXPECT_GT(covariance.determinant(), -1e-30);
}

// Four points to 3 %: several laws pass, their mean is taken and what they differ by is added.
TEST(StiffnessCurve, CompetingLawsAreWeighed) {
  std::vector<StiffnessPoint> points;
  for (double T : {50.0, 100.0, 200.0, 300.0})
    points.push_back(point(T, sqrt_law(T), 0.03 * sqrt_law(T)));
  const StiffnessCurve curve(points);
  ASSERT_EQ(curve.source(), StiffnessSource::weighted_laws) << curve.sentence();
  const auto at = curve.at(150);
  double mean = 0;
  for (const auto& law : curve.laws().laws) {
    if (std::isfinite(law.akaike_weight)) mean += law.akaike_weight * predict(law, 150).EI_Nm2;
  }
  EXPECT_NEAR(at.EI_Nm2, mean, 1e-12);
  EXPECT_GT(curve.at(600).std, 2 * at.std);
}

TEST(StiffnessCurve, WithoutALawItIsLinearBetweenTheTests) {
  const StiffnessCurve published({{100, 0.5}, {25, 0.25}, {200, 0.6}, {300, 0.8}});
  ASSERT_EQ(published.source(), StiffnessSource::interpolation);
  EXPECT_DOUBLE_EQ(published.at(100).EI_Nm2, 0.5);
  EXPECT_NEAR(published.at(150).EI_Nm2, 0.55, 1e-15);
  EXPECT_NEAR(published.at(150).slope_m2, 0.001, 1e-15);
  EXPECT_NEAR(published.at(300).slope_m2, 0.002, 1e-15);
  EXPECT_DOUBLE_EQ(published.at(10).EI_Nm2, 0.25);
  EXPECT_DOUBLE_EQ(published.at(1000).EI_Nm2, 0.8);
  EXPECT_TRUE(std::isnan(published.at(150).std));
  EXPECT_TRUE(published.uncertainty(std::array<double, 1>{150}).empty());

  // Known tests: neighbours share a test, far tensions share nothing.
  const StiffnessCurve known({point(100, 0.5, 0.01), point(200, 0.6, 0.02)});
  const std::array<double, 3> T{100, 150, 200};
  const Eigen::MatrixXd covariance = covariance_of(known, T);
  EXPECT_NEAR(covariance(0, 0), 1e-4, 1e-12);
  EXPECT_NEAR(covariance(1, 1), 0.25 * (1e-4 + 4e-4), 1e-12);
  EXPECT_NEAR(covariance(0, 1), 0.5e-4, 1e-12);
  EXPECT_NEAR(covariance(0, 2), 0, 1e-15);
}

// Points that no law passes through: the tests themselves, known to what they scatter by.
TEST(StiffnessCurve, PointsThatContradictEveryLawAreKept) {
  std::vector<StiffnessPoint> points;
  const std::array<double, 6> EI{0.3, 0.5, 0.45, 0.7, 0.62, 0.9};
  for (std::size_t k = 0; k < EI.size(); ++k) {
    points.push_back(point(50 + 50 * static_cast<double>(k), EI[k], 0.005));
  }
  const StiffnessCurve curve(points);
  ASSERT_EQ(curve.source(), StiffnessSource::interpolation) << curve.sentence();
  EXPECT_THAT(curve.sentence(), HasSubstr("chi-square"));
  EXPECT_DOUBLE_EQ(curve.at(100).EI_Nm2, 0.5);
  EXPECT_GT(curve.at(100).std, 0.03);
}

// What tests share moves all tensions alike, and is no part of the weights.
TEST(StiffnessCurve, SharedUncertaintyIsCorrelatedAndNoWeight) {
  std::vector<StiffnessPoint> own, shared;
  for (double T : {25.0, 50.0, 100.0, 200.0, 300.0}) {
    const double EI = sqrt_law(T), std = 0.004 * EI;
    own.push_back(point(T, EI * (T == 100 ? 1.004 : 1), std));
    shared.push_back(point(T, own.back().EI_Nm2, std::hypot(std, 0.02 * own.back().EI_Nm2), 0.02));
  }
  const StiffnessCurve plain(own), wide(shared);
  EXPECT_EQ(plain.source(), wide.source());
  EXPECT_NEAR(plain.at(150).EI_Nm2, wide.at(150).EI_Nm2, 1e-4 * plain.at(150).EI_Nm2);
  const std::array<double, 2> T{25, 300};
  const Eigen::MatrixXd covariance = covariance_of(wide, T);
  EXPECT_GT(covariance(0, 1) / std::sqrt(covariance(0, 0) * covariance(1, 1)), 0.8);
  EXPECT_NEAR(wide.at(150).std, std::hypot(plain.at(150).std, 0.02 * wide.at(150).EI_Nm2), 1e-4);
}

// Five tests of which the lowest changes its tension by 3 %: the interval there holds EI whether it
// belongs to the tension at rest or to the mean, and repeats do not make it smaller.
TEST(StiffnessCurve, SpreadOfTensionWithinATestWidensAndIsNotAveraged) {
  std::vector<StiffnessPoint> points;
  for (double T : {25.0, 50.0, 100.0, 200.0, 300.0}) {
    points.push_back(point(T + (T < 30 ? 0.86 : 0), sqrt_law(T), 0.002 * sqrt_law(T)));
    if (T < 30) points.back().tension_std_N = 0.86;
  }
  const StiffnessCurve curve(points);
  const auto at = curve.at(25);
  EXPECT_TRUE(holds(at, sqrt_law(25)));
  const std::array<double, 1> T{25};
  // One test alone at its tension, and repeats of it: EI is known to no more than the tension is.
  std::vector<StiffnessPoint> two{point(25, 0.29, 0.0005), point(300, 0.807, 0.0005)};
  two[0].tension_std_N = 0.86;
  const double once = StiffnessCurve(two).at(25).std;
  for (int k = 0; k < 9; ++k) two.push_back(two[0]);
  EXPECT_GT(once, 0.002);
  EXPECT_NEAR(StiffnessCurve(two).at(25).std, once, 0.3 * once);
  // Terms and covariance say the same.
  EXPECT_NEAR(std::sqrt(covariance_of(curve, T)(0, 0)), at.std, 1e-12);
}

TEST(StiffnessCurve, RepeatedTestsAreAveraged) {
  const StiffnessCurve curve(
      {point(100, 0.50, 0.01), point(100, 0.52, 0.01), point(101, 0.51, 0.01)});
  EXPECT_NEAR(curve.at(100).EI_Nm2, 0.51, 1e-12);
  EXPECT_NEAR(curve.at(100).std, 0.01 / std::sqrt(3.0), 1e-4);
  EXPECT_THROW((void)StiffnessCurve().at(100), std::invalid_argument);
  EXPECT_THROW((void)curve.at(NAN), std::invalid_argument);
}

// Intervals between the tensions hold the truth of a law that is among the four: 300 campaigns of
// five tests, three tensions each; 0.95 within four binomial deviations (sqrt(0.0475 / 900) = 0.7
// %, three tensions of one campaign count as one and a half).
TEST(StiffnessCurve, IntervalsHoldTheTruth) {
  Normal normal(5);
  int held = 0, all = 0;
  for (int k = 0; k < 300; ++k) {
    std::vector<StiffnessPoint> points;
    for (double T : {25.0, 60.0, 100.0, 200.0, 300.0}) {
      const double std = 0.02 * sqrt_law(T);
      points.push_back(point(T, sqrt_law(T) + std * normal(), std));
    }
    const StiffnessCurve curve(points);
    for (double T : {40.0, 120.0, 250.0}) {
      const auto at = curve.at(T);
      held += holds(at, sqrt_law(T));
      ++all;
    }
  }
  EXPECT_GT(held, 0.92 * all);
}

// EI(T) of a virtual strand whose EI is that of the tension at rest or follows the tension of the
// moment: bending tests at 25 to 300 N, 12 seeds of each. The load raises the tension of the lowest
// test by some 10 %; its own interval is that of the mean tension and does not know which of the
// two it is. The curve holds EI in 42 of 48 or more (0.95 of 48 less two deviations of 1.5 by the
// binomial law).
TEST(StiffnessCurve, HoldsEIOfTheTensionAtRestAndOfTheMoment) {
  const VirtualInstruments instruments;
  for (const bool of_the_moment : {false, true}) {
    int held = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      BendingCampaign campaign{.test = {.span_m = {0.5, 0.0005}}};
      campaign.test.tension_zero_std_N = instruments.tension_cell.offset_std;
      Random draws = random_stream(seed, 77);
      const double span = 0.5 + 0.0005 * std::normal_distribution<double>()(draws);
      for (const double T : {25.0, 100.0, 200.0, 300.0}) {
        Random random = random_stream(seed, static_cast<std::uint64_t>(T));
        const auto record =
            virtual_bending_record({.EI_Nm2 = sqrt_law(T),
                                    .EI_by_tension_m2 = of_the_moment ? 0.021 / std::sqrt(T) : 0,
                                    .span_m = span,
                                    .tension_N = T,
                                    .peak_load_N = 4,
                                    .sample_rate_hz = 5,
                                    .tension_cell = instruments.tension_cell,
                                    .load_cell = instruments.load_cell,
                                    .lvdt = instruments.lvdt},
                                   random);
        campaign.sources.push_back(
            {std::to_string(T),
             {record.channel("tension").samples, record.channel("load").samples,
              record.channel("deflection").samples},
             {}});
      }
      const auto result = analyse_bending_campaign(campaign);
      ASSERT_FALSE(result.curve.empty());
      for (const double T : {25.0, 100.0, 200.0, 300.0})
        held += holds(result.curve.at(T), sqrt_law(T));
    }
    EXPECT_GE(held, 42) << of_the_moment;
  }
}

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

}  // namespace rigfit::ident::stiffness_curve_test
