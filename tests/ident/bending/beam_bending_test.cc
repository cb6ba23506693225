// Bending without tension: the limits of the tensioned beam's equation, testing-machine records
// with toe, yield, stop and break, and tables of dead weights.
#include "ident/bending/bending_analysis.h"
#include "ident/campaign/single_tests/bending_campaign.h"
#include "tests/test.h"

namespace rigfit::ident::beam_bending_test {

BendingTestOptions options_of(BeamEnds ends, double span) {
  return {.span_m = {span, 0}, .ends = ends};
}

TEST(BeamEquation, IsTheLimitForTensionZero) {
  const double EI = 2.5, span = 0.8;
  for (const auto& [ends, factor] : {std::pair{BeamEnds::clamped, 192.0},
                                     {BeamEnds::pinned, 48.0},
                                     {BeamEnds::cantilever, 3.0}}) {
    ComplianceMeasurement measured{.compliance_m_N = {std::pow(span, 3) / (factor * EI), 0},
                                   .tension_N = {123, 0},  // not used
                                   .span_m = {span, 0},
                                   .degrees_of_freedom = 0,
                                   .ends = ends};
    const auto exact = stiffness_from_compliance(measured);
    EXPECT_EQ(exact.status, BendingStatus::solved);
    EXPECT_NEAR(exact.EI_Nm2.value, EI, 1e-14);  // rounding
    // d ln EI = -d ln s + 3 d ln L.
    EXPECT_EQ(exact.log_sensitivity_compliance, -1);
    EXPECT_EQ(exact.log_sensitivity_tension, 0);
    EXPECT_EQ(exact.log_sensitivity_span, 3);
    measured.compliance_m_N.std = 0.01 * measured.compliance_m_N.value;
    measured.span_m.std = 0.005 * span;
    const auto uncertain = stiffness_from_compliance(measured);
    // sqrt(1^2 + (3 * 0.5)^2) %, to the second order of the formula and 4096 points.
    EXPECT_NEAR(uncertain.EI_Nm2.std / EI, std::hypot(0.01, 0.015), 5e-4);
  }
  // From the tensioned side: F = lambda^2 / 12 (1 - lambda^2 / 10 ...), lambda^2 = P l^2 / (4 EI).
  const double P = 1e-6;
  const auto tensioned = stiffness_from_compliance(
      {{midspan_compliance(EI, P, span), 0}, {P, 0}, {span, 0}, 0, BeamEnds::tensioned});
  const auto without = stiffness_from_compliance(
      {{midspan_compliance(EI, P, span), 0}, {0, 0}, {span, 0}, 0, BeamEnds::clamped});
  EXPECT_NEAR(tensioned.EI_Nm2.value, EI, 1e-9);
  EXPECT_NEAR(without.EI_Nm2.value / EI, 1 + P * span * span / (40 * EI), 1e-9);
}

/// Load and deflection of a record, mm and N.
struct Record {
  std::vector<double> deflection_mm, load_N;
  [[nodiscard]] BendingRecord record() const {
    BendingRecord all;
    const auto n = static_cast<Index>(load_N.size());
    all.load_N = Eigen::Map<const Eigen::VectorXd>(load_N.data(), n);
    all.deflection_m = 1e-3 * Eigen::Map<const Eigen::VectorXd>(deflection_mm.data(), n);
    return all;
  }
};

struct Coupon {
  double K = 20;          // N/mm
  double toe_mm = 0.3;    // slack, rounded over 0.04 mm
  double elastic_mm = 2;  // then 15 % of the slope
  double beyond = 0.15;   // relative slope
  double travel_mm = 6;
  double noise_N = 0.05;
  double break_mm = 1e9;
};

Record coupon(const Coupon& c, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, c.noise_N);
  Record all;
  for (int i = 0; i < 800; ++i) {
    const double d = c.travel_mm * i / 800;
    const double x = 0.04 * std::log1p(std::exp((d - c.toe_mm) / 0.04));
    double load = c.K * (std::min(x, c.elastic_mm) + c.beyond * std::max(0.0, x - c.elastic_mm));
    if (d > c.break_mm) load *= 0.1;
    all.deflection_mm.push_back(d);
    all.load_N.push_back(load + noise(random));
  }
  return all;
}

TEST(BeamTest, ToeYieldAndBreakOfAMachineRecord) {
  const double span = 0.064;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Coupon c;
    c.K = 18 + seed;
    c.toe_mm = 0.1 * seed;
    c.elastic_mm = 1.2 + 0.15 * seed;
    if (seed % 2 == 0) c.break_mm = 5;
    const auto result =
        analyse_bending_test(coupon(c, seed).record(), options_of(BeamEnds::pinned, span));
    ASSERT_FALSE(result.refused) << seed;
    const double EI = 1e3 * c.K * std::pow(span, 3) / 48;
    // Three standard uncertainties; these are far under a percent.
    EXPECT_NEAR(result.stiffness.EI_Nm2.value, EI, 3 * result.stiffness.EI_Nm2.std) << seed;
    EXPECT_LT(result.stiffness.EI_Nm2.std, 0.01 * EI) << seed;
    EXPECT_TRUE(says(result.findings, "toe") || c.toe_mm < 0.9) << seed;
    EXPECT_TRUE(says(result.findings, "stop")) << seed;  // or yield
    EXPECT_EQ(result.tension_N.value, 0);
  }
}

TEST(BeamTest, StopOfAMachineRecordAndNothingWhereNothingIs) {
  Coupon c;
  c.toe_mm = -1;  // none
  c.beyond = 12;
  c.elastic_mm = 4;
  c.travel_mm = 3.4;
  const auto stop =
      analyse_bending_test(coupon(c, 5).record(), options_of(BeamEnds::cantilever, 0.3));
  ASSERT_FALSE(stop.refused);
  EXPECT_TRUE(says(stop.findings, "stop"));
  EXPECT_NEAR(1 / stop.compliance_m_N.value, 1e3 * c.K, 0.005 * 1e3 * c.K);
  c.travel_mm = 2.5;
  const auto straight =
      analyse_bending_test(coupon(c, 6).record(), options_of(BeamEnds::cantilever, 0.3));
  ASSERT_FALSE(straight.refused);
  EXPECT_TRUE(straight.findings.empty());
  EXPECT_NEAR(1 / straight.compliance_m_N.value, 1e3 * c.K,
              3 * straight.compliance_m_N.std / std::pow(straight.compliance_m_N.value, 2));
}

TEST(BeamTest, AStiffeningRecordHasNoStiffness) {
  Record all;
  for (int i = 0; i < 600; ++i) {
    const double d = 0.01 * i;
    all.deflection_mm.push_back(d);
    all.load_N.push_back(3 * d + 1.2 * d * d);
  }
  const auto result = analyse_bending_test(all.record(), options_of(BeamEnds::clamped, 0.3));
  EXPECT_TRUE(result.refused);
  EXPECT_TRUE(says(result.findings, "curved"));
}

/// Steps of 0.5 N, deflection read to 0.01 mm with a reading error of 0.005 mm.
Record dead_weights(double K_N_mm, double stop_mm, double curve, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> reading(0, 0.005);
  Record all;
  for (int i = 0; i <= 12; ++i) {
    const double load = 0.5 * i;
    const double free = load / K_N_mm / (1 + curve * i) + reading(random);
    const double d = std::min(free, stop_mm + 0.003 * i);
    all.load_N.push_back(load);
    all.deflection_mm.push_back(0.01 * std::round(100 * d));
  }
  return all;
}

TEST(BeamTest, DeadWeightsAcceptedCurvedAndStoppedRefused) {
  const auto options = options_of(BeamEnds::cantilever, 0.3);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto analysed = [&](double stop_mm, double curve) {
      return analyse_bending_test(dead_weights(0.1947, stop_mm, curve, seed).record(), options);
    };
    const auto straight = analysed(1e9, 0);
    ASSERT_FALSE(straight.refused) << seed;
    EXPECT_NEAR(1 / straight.compliance_m_N.value, 194.7, 0.3) << seed;  // 0.005 mm of 30 mm
    EXPECT_FALSE(says(straight.findings, "stop")) << seed;
    // A corner is no line: its rows must be cut off.
    for (const auto& refused : {analysed(18, 0), analysed(1e9, 0.12)}) {
      EXPECT_TRUE(refused.refused) << seed;
      EXPECT_TRUE(says(refused.findings, "curved")) << seed;
    }
  }
}

TEST(BeamCampaign, SpecimensModulusAndLengthsInMillimetres) {
  BendingCampaign campaign{.test = options_of(BeamEnds::pinned, 0.064),
                           .section = {.rectangle_m = {0.010, 0.004}}};
  for (unsigned k = 0; k < 3; ++k) {
    Coupon c;
    c.K = 19 + k;
    campaign.sources.push_back({"coupon", coupon(c, k).record(), {}});
  }
  const auto result = analyse_bending_campaign(campaign);
  ASSERT_TRUE(result.specimens.has_value());
  EXPECT_EQ(result.specimens->count, 3u);
  const double modulus = 20e3 * std::pow(0.064, 3) / 48 / campaign.section.second_moment().value;
  EXPECT_NEAR(result.specimens->modulus_Pa, modulus, 0.01 * modulus);
  EXPECT_NEAR(result.specimens->relative_scatter, 0.05, 0.005);  // of 19, 20, 21
  EXPECT_TRUE(result.curve.empty());
  EXPECT_FALSE(says(result.findings, "length_suspected"));
  campaign.test.span_m.value = 64;
  EXPECT_TRUE(says(analyse_bending_campaign(campaign).findings, "length_suspected"));
}

}  // namespace rigfit::ident::beam_bending_test
