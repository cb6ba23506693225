#include "ident/bending/bending_equation.h"

#include "tests/coverage.h"
#include "tests/test.h"

namespace rigfit::ident::bending_equation_test {

TEST(BendingRatio, LimitsAreBeamAndString) {
  EXPECT_DOUBLE_EQ(bending_ratio(1e-6), 1e-12 / 12 * (1 - 1e-13));  // next term: lambda^2 / 10
  EXPECT_EQ(bending_ratio(0), 0);
  EXPECT_DOUBLE_EQ(bending_ratio_complement(1e4), 2e-4);
  EXPECT_DOUBLE_EQ(bending_ratio_complement(1e300), 2e-300);
}

// F(lambda) with a mantissa of 64 bits:
//
//   F = 1 - 2 tanh(lambda / 2) / lambda = (x cosh x - sinh x) / (x cosh x),   x = lambda / 2
//
// the numerator by its power series sum x^(2k+1) 2k / (2k+1)!, whose terms are all positive.
long double exact_bending_ratio(long double lambda) {
  const long double x = lambda / 2;
  if (x > 25) return 1 - 1 / x;  // 1 - tanh x < 4e-22
  long double term = x, numerator = 0;
  for (int k = 1; k < 200; ++k) {
    term *= x * x / ((2.0L * k) * (2.0L * k + 1));
    numerator += term * 2 * k;
  }
  return numerator / (x * std::cosh(x));
}

// Four units in the last place from a lambda of 1e-6 to 1e4.
TEST(BendingRatio, IsTheExactOneOverTenDecades) {
  constexpr double kRounding = std::numeric_limits<double>::epsilon() / 2;
  for (int i = 0; i <= 2000; ++i) {
    const double lambda = std::pow(10.0, -6 + i / 200.0);
    const long double exact = exact_bending_ratio(lambda);
    const auto truth = static_cast<double>(exact), rest = static_cast<double>(1 - exact);
    EXPECT_NEAR(bending_ratio(lambda) / truth, 1, 8 * kRounding) << lambda;
    EXPECT_NEAR(bending_ratio_complement(lambda) / rest, 1, 8 * kRounding) << lambda;
  }
}

TEST(LambdaFromBendingRatio, WorksAtTheVeryEnds) {
  const double smallest = lambda_from_bending_ratio(1e-300);
  EXPECT_NEAR(smallest, std::sqrt(12e-300), 1e-13 * smallest);
  const double nearly_one = std::nextafter(1.0, 0.0);
  EXPECT_NEAR(lambda_from_bending_ratio(nearly_one), 2 / (1 - nearly_one),
              1e-13 / (1 - nearly_one));
  for (const double wrong : {0.0, 1.0, kNaN}) {
    EXPECT_THROW((void)lambda_from_bending_ratio(wrong), std::invalid_argument);
  }
}

// Second algorithm: the differential equation EI w'''' - P w'' = 0 on half of the span, solved by
// central differences; w = w' = 0 at the clamp, w' = 0 and EI w''' = Q/2 at mid-span. Third-order
// boundary treatment is avoided by integrating for w': EI s'' = P s - Q/2, s(0) = s(l/2) = 0.
double compliance_by_differences(double EI, double P, double l, int n) {
  const double h = l / 2 / n;
  std::vector<double> diagonal(static_cast<std::size_t>(n)), right(static_cast<std::size_t>(n));
  // (s[i-1] - 2 s[i] + s[i+1]) EI/h^2 - P s[i] = -1/2 for Q = 1; Thomas' algorithm.
  const double off = EI / (h * h);
  const auto last = static_cast<std::size_t>(n - 1);
  for (std::size_t i = 1; i <= last; ++i) {
    diagonal[i] = -2 * off - P;
    right[i] = -0.5;
    if (i > 1) {
      const double factor = off / diagonal[i - 1];
      diagonal[i] -= factor * off;
      right[i] -= factor * right[i - 1];
    }
  }
  double slope = 0, deflection = 0;
  for (std::size_t i = last; i >= 1; --i) {
    slope = (right[i] - off * slope) / diagonal[i];
    deflection += slope * h;  // trapezium; both end slopes are zero
  }
  return deflection;
}

TEST(MidspanCompliance, AgreesWithADifferenceSolution) {
  for (double P : {0.0, 25.0, 300.0}) {
    const double EI = 0.6, l = 0.5;
    // Richardson from n and 2n removes the h^2 term; (h alpha)^4/100 is left, below 1e-10.
    const double coarse = compliance_by_differences(EI, P, l, 1000);
    const double fine = compliance_by_differences(EI, P, l, 2000);
    const double expected = (4 * fine - coarse) / 3;
    EXPECT_NEAR(midspan_compliance(EI, P, l), expected, 1e-9 * expected) << P;
  }
}

TEST(MidspanCompliance, RefusesWhatIsNotPositive) {
  EXPECT_THROW((void)midspan_compliance(0, 1, 1), std::invalid_argument);
  EXPECT_THROW((void)midspan_compliance(1, -1, 1), std::invalid_argument);
  EXPECT_THROW((void)midspan_compliance(1, 1, INFINITY), std::invalid_argument);
}

// From EI to the compliance and back. F is good to eight roundings, there and back; with the
// products around it 32 roundings times the sensitivity that the result states itself.
TEST(StiffnessFromCompliance, GivesEIBackOverTenDecades) {
  constexpr double kRounding = std::numeric_limits<double>::epsilon() / 2;
  const double span = 0.6, tension = 100;
  for (int i = 0; i <= 200; ++i) {
    const double lambda = std::pow(10.0, -6 + i / 20.0);
    const double EI = tension * span * span / (4 * lambda * lambda);
    const auto found = stiffness_from_compliance(
        {{midspan_compliance(EI, tension, span), 0}, {tension, 0}, {span, 0}});
    ASSERT_EQ(found.status, BendingStatus::solved) << found.reason;
    EXPECT_NEAR(found.EI_Nm2.value / EI, 1,
                32 * kRounding * (1 + std::abs(found.log_sensitivity_compliance)))
        << lambda;
  }
}

// A slope known to 0.5 % at both bounds of the paper's strand.
TEST(StiffnessFromCompliance, IntervalsHoldAtTheBoundsOfTheStrand) {
  testing::Coverage coverage;
  Normal normal(11);
  const double span = 0.5;
  for (const double EI : {0.0306, 15.5632}) {
    for (const double tension : {25.0, 300.0}) {
      const double slope = midspan_compliance(EI, tension, span);
      for (int k = 0; k < 150; ++k) {
        const auto found =
            stiffness_from_compliance({{slope * (1 + 0.005 * normal()), 0.005 * slope},
                                       {tension * (1 + 0.002 * normal()), 0.002 * tension},
                                       {span, 0}});
        ASSERT_EQ(found.status, BendingStatus::solved) << found.reason;
        coverage.add(found.EI_Nm2.value, found.EI_Nm2.std, found.low, found.high, EI);
      }
    }
  }
  EXPECT_TRUE(coverage.holds());
}

TEST(StiffnessFromCompliance, SensitivitiesMatchDifferences) {
  const ComplianceMeasurement at{{midspan_compliance(0.5, 100, 0.5), 0}, {100, 0}, {0.5, 0}};
  const auto log_EI = [&](double ds, double dP, double dl) {
    auto moved = at;
    moved.compliance_m_N.value *= std::exp(ds);
    moved.tension_N.value *= std::exp(dP);
    moved.span_m.value *= std::exp(dl);
    return std::log(stiffness_from_compliance(moved).EI_Nm2.value);
  };
  const auto result = stiffness_from_compliance(at);
  const double h = 1e-5;  // error h^2 times third derivatives of order 10
  EXPECT_NEAR(result.log_sensitivity_compliance, (log_EI(h, 0, 0) - log_EI(-h, 0, 0)) / (2 * h),
              1e-7);
  EXPECT_NEAR(result.log_sensitivity_tension, (log_EI(0, h, 0) - log_EI(0, -h, 0)) / (2 * h), 1e-7);
  EXPECT_NEAR(result.log_sensitivity_span, (log_EI(0, 0, h) - log_EI(0, 0, -h)) / (2 * h), 1e-7);
}

TEST(StiffnessFromCompliance, SmallUncertaintyIsTheLinearFormula) {
  const double slope = midspan_compliance(0.5, 25, 0.4);
  const auto result =
      stiffness_from_compliance({{slope, 1e-4 * slope}, {25, 25e-4}, {0.4, 0.4e-4}});
  const double expected = 0.5 * 1e-4 *
                          std::hypot(result.log_sensitivity_compliance,
                                     result.log_sensitivity_tension, result.log_sensitivity_span);
  // 4096 Sobol points give a quantile of three normal variables to some parts in a thousand.
  EXPECT_NEAR(result.EI_Nm2.std, expected, 0.01 * expected);
  EXPECT_NEAR(result.high - result.low, 2 * 1.95996 * expected, 0.02 * 2 * 1.95996 * expected);
}

// EI falls as the slope rises, so the interval must be that of the slope, mapped exactly: also
// where it is far from symmetric.
TEST(StiffnessFromCompliance, IntervalIsRightNearAString) {
  const double EI = 0.02, P = 200, l = 0.5;
  const double slope = midspan_compliance(EI, P, l), std = 0.01 * slope;
  const auto EI_at = [&](double d) {
    return stiffness_from_compliance({{d, 0}, {P, 0}, {l, 0}}).EI_Nm2.value;
  };
  const auto result = stiffness_from_compliance({{slope, std}, {P, 0}, {l, 0}});
  ASSERT_EQ(result.status, BendingStatus::solved) << result.reason;
  const double low = EI_at(slope + 1.959964 * std), high = EI_at(slope - 1.959964 * std);
  EXPECT_NEAR(result.low, low, 0.02 * (EI - low));
  EXPECT_NEAR(result.high, high, 0.02 * (high - EI));
  EXPECT_GT(high - EI, 1.1 * (EI - low));  // the case is one where a symmetric interval is wrong
}

TEST(StiffnessFromCompliance, StudentsTWidensTheInterval) {
  const double slope = midspan_compliance(0.5, 25, 0.4);
  ComplianceMeasurement measured{{slope, 1e-4 * slope}, {25, 0}, {0.4, 0}};
  const auto normal = stiffness_from_compliance(measured);
  measured.degrees_of_freedom = 4;
  const auto few = stiffness_from_compliance(measured);
  // t quantiles: 2.776 for 4 degrees of freedom against 1.960.
  EXPECT_NEAR((few.high - few.low) / (normal.high - normal.low), 2.776 / 1.960, 0.02);
}

TEST(StiffnessFromCompliance, RefusesWithTheReason) {
  const auto string_like =
      stiffness_from_compliance({{0.5 / 400 * 1.001, 1e-6}, {100, 0}, {0.5, 0}});
  EXPECT_EQ(string_like.status, BendingStatus::string_like);
  EXPECT_THAT(string_like.reason, HasSubstr("not below 1"));
  EXPECT_TRUE(std::isnan(string_like.EI_Nm2.value));

  const auto negative = stiffness_from_compliance({{-1e-4, 0}, {100, 0}, {0.5, 0}});
  EXPECT_EQ(negative.status, BendingStatus::not_positive);

  const double slope = midspan_compliance(0.001, 200, 0.5);
  const auto bound = stiffness_from_compliance({{slope, 0.02 * slope}, {200, 0}, {0.5, 0}});
  EXPECT_EQ(bound.status, BendingStatus::upper_bound_only);
  EXPECT_EQ(bound.low, 0);
  EXPECT_GT(bound.high, 0.001);

  const auto vague = stiffness_from_compliance({{1e-4, 1e-4}, {100, 0}, {0.5, 0}});
  EXPECT_EQ(vague.status, BendingStatus::not_positive);
  EXPECT_TRUE(std::isnan(vague.high));
}

TEST(StiffnessFromCompliance, UnknownUncertaintyGivesNoInterval) {
  const auto result =
      stiffness_from_compliance({{midspan_compliance(0.5, 25, 0.4), NAN}, {25, 0}, {0.4, 0}});
  EXPECT_EQ(result.status, BendingStatus::solved);
  EXPECT_TRUE(std::isnan(result.EI_Nm2.std));
  EXPECT_TRUE(std::isnan(result.low));
}

}  // namespace rigfit::ident::bending_equation_test
