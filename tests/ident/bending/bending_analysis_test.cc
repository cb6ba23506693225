#include "ident/bending/bending_analysis.h"

#include "ident/virtual_rig/virtual_bench.h"
#include "tests/coverage.h"
#include "tests/test.h"

namespace rigfit::ident::bending_analysis_test {

// A load-deflection table straight from the equation, loading then unloading.
BendingRecord exact_record(double EI, double P, double span, double frame = 0, int points = 50) {
  BendingRecord record;
  const Index n = 2 * points;
  record.tension_N.resize(n), record.load_N.resize(n), record.deflection_m.resize(n);
  for (Index i = 0; i < n; ++i) {
    const double share =
        i < points ? static_cast<double>(i) / points : static_cast<double>(n - 1 - i) / points;
    const double d = 1e-3 * share;
    const double tension = P + frame * d * d;
    record.tension_N[i] = tension;
    record.deflection_m[i] = d;
    record.load_N[i] = d / midspan_compliance(EI, tension, span);
  }
  return record;
}

namespace simulated {

// Bending tests simulated without the estimator's assumptions: end springs in closed form, two laws
// for wire friction by their differential equations, a tension that grows, readings with noise and
// spikes.
//
// End springs of rotational stiffness k (each), lambda = sqrt(P l^2 / (4 EI)), c = k l / (2 EI
// lambda), the tensioned beam w'''' EI - P w'' = 0 with EI w'' = k w' at the ends gives
//   4 P d / (Q l) = 1 - (2 c (cosh lambda - 1) + sinh lambda) / (lambda (c sinh lambda + cosh
//   lambda))
enum class Friction { none, bilinear, dahl };

struct Bending {
  double EI_Nm2 = 0.5, tension_N = 100, span_m = 0.5;
  double clamp_Nm_rad = kInf;
  double frame_N_m = 2e4;  ///< tension gained by shortening
  double travel_m = 1e-3;  ///< largest deflection
  int rows = 200;          ///< all together
  int strokes = 4;         ///< 1: loading only
  Friction friction = Friction::none;
  double friction_N = 0, friction_travel_m = 1e-4;
  double load_noise = 0, deflection_noise = 0;  ///< relative to the largest value
  int deflection_spikes = 0, load_spikes = 0;
};

double compliance(double EI, double P, double l, double k) {
  const double lambda = std::sqrt(P * l * l / (4 * EI));
  const double F =
      std::isfinite(k)
          ? [&] {
              const double c = k * l / (2 * EI * lambda);
              return 1 - (2 * c * (std::cosh(lambda) - 1) + std::sinh(lambda)) /
                             (lambda * (c * std::sinh(lambda) + std::cosh(lambda)));
            }()
          : 1 - 2 * std::tanh(lambda / 2) / lambda;
  return F * l / (4 * P);
}

BendingRecord record(const Bending& test, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const int n = test.rows;
  BendingRecord out;
  out.tension_N.resize(n), out.load_N.resize(n), out.deflection_m.resize(n);
  const double peak =
      test.travel_m / compliance(test.EI_Nm2, test.tension_N, test.span_m, test.clamp_Nm_rad);
  double z = 0, before = 0, share_before = 0;
  for (int i = 0; i < n; ++i) {
    const double share = static_cast<double>(i) / (n - 1) * test.strokes;
    // Steps of the friction's equation between readings.
    const int steps = test.friction == Friction::none ? 1 : 200;
    double d = 0;
    for (int s = 1; s <= steps; ++s) {
      const double at = share_before + (share - share_before) * s / steps;
      const double phase = std::fmod(at, 2.0);
      d = test.travel_m * (phase <= 1 ? phase : 2 - phase);
      const double step = d - before;
      if (test.friction != Friction::none && step != 0) {
        const double sign = step > 0 ? 1 : -1;
        const double rest = std::max(0.0, 1 - sign * z);
        const double rate = test.friction == Friction::dahl ? rest : rest > 0 ? 1 : 0;
        z += step / test.friction_travel_m * rate;
        z = std::clamp(z, -1.0, 1.0);
      }
      before = d;
    }
    share_before = share;
    const double P = test.tension_N + test.frame_N_m * 2 * d * d / test.span_m;
    const double Q =
        d / compliance(test.EI_Nm2, P, test.span_m, test.clamp_Nm_rad) + test.friction_N * z;
    out.tension_N[i] = P;
    out.load_N[i] = Q + test.load_noise * peak * normal(random);
    out.deflection_m[i] = d + test.deflection_noise * test.travel_m * normal(random);
  }
  constexpr double kSpike = 3;  // height, in largest values
  std::uniform_int_distribution<int> row(1, n - 2);
  for (int k = 0; k < test.deflection_spikes; ++k) {
    out.deflection_m[row(random)] += kSpike * test.travel_m * (k % 2 == 0 ? 1 : -1);
  }
  for (int k = 0; k < test.load_spikes; ++k) {
    out.load_N[row(random)] += kSpike * peak * (k % 2 == 0 ? 1 : -1);
  }
  return out;
}

}  // namespace simulated

BendingTestOptions span_of(double span) { return {.span_m = {span, 0}}; }

std::string codes(const BendingTestResult& result) {
  std::string text;
  for (const auto& finding : result.findings) text += finding.code + ": " + finding.message + "\n";
  return text;
}

BendingRecord channels(const signal::Recording& recording) {
  return {recording.channel("tension").samples, recording.channel("load").samples,
          recording.channel("deflection").samples};
}

TEST(BendingTest, ExactTableGivesTheExactStiffness) {
  for (double P : {25.0, 100.0, 300.0}) {
    const auto result = analyse_bending_test(exact_record(0.6, P, 0.5), span_of(0.5));
    ASSERT_FALSE(result.refused) << codes(result);
    EXPECT_TRUE(result.findings.empty()) << codes(result);
    // Rounding, amplified by the conditioning of the equation (below 10 here).
    EXPECT_NEAR(result.stiffness.EI_Nm2.value, 0.6, 1e-10);
  }
}

// The tension rises by a quarter while the cable is loaded: used as measured, the straight line in
// (d g) is exact again, whatever sign and offset the deflection has. A plain slope would be off by
// more than 10 %.
TEST(BendingTest, ChangingTensionIsUsedAsMeasured) {
  auto record = exact_record(0.6, 100, 0.5, 25 / 1e-6);
  for (const double sign : {1.0, -1.0}) {
    const auto result = analyse_bending_test(record, span_of(0.5));
    ASSERT_FALSE(result.refused) << codes(result);
    EXPECT_NEAR(result.stiffness.EI_Nm2.value, 0.6, 1e-8) << sign;
    record.deflection_m = (0.0123 - record.deflection_m.array()).matrix();
  }
}

TEST(BendingTest, ASlippingClampIsRefusedOrFlagged) {
  for (double loss : {0.05, 0.3}) {
    auto record = exact_record(0.6, 100, 0.5);
    for (Index i = 25; i < record.tension_N.size(); ++i) {
      record.tension_N[i] *= 1 - loss;
      record.load_N[i] = record.deflection_m[i] / midspan_compliance(0.6, record.tension_N[i], 0.5);
    }
    const auto result = analyse_bending_test(record, span_of(0.5));
    EXPECT_TRUE(says(result.findings, "clamp_slip")) << codes(result);
    EXPECT_EQ(result.refused, loss > 0.1) << codes(result);
  }
}

// Compression counted negative, the default of testing machines: load and deflection both fall.
TEST(BendingTest, BothChannelsNegativeGiveTheSameStiffness) {
  for (const int points : {50, 8}) {
    auto record = exact_record(0.6, 100, 0.5, 25 / 1e-6, points);
    const auto plain = analyse_bending_test(record, span_of(0.5));
    record.load_N = -record.load_N, record.deflection_m = -record.deflection_m;
    const auto negative = analyse_bending_test(record, span_of(0.5));
    ASSERT_FALSE(plain.refused || negative.refused) << codes(negative);
    EXPECT_DOUBLE_EQ(negative.stiffness.EI_Nm2.value, plain.stiffness.EI_Nm2.value);
    EXPECT_NEAR(negative.stiffness.EI_Nm2.value, 0.6, 1e-6);
  }
}

// Clamps that turn with a stiffness drawn from the prior: the interval holds; taken as rigid, not.
TEST(BendingTest, ClampsThatTurnAreInTheInterval) {
  int held = 0, rigid_held = 0;
  constexpr int kTests = 60;
  for (int k = 0; k < kTests; ++k) {
    std::mt19937_64 random(static_cast<std::uint64_t>(k));
    simulated::Bending test;
    test.load_noise = test.deflection_noise = 0.001;
    test.clamp_Nm_rad = 200 / std::abs(std::normal_distribution<double>()(random));
    const auto record = simulated::record(test, random);
    auto options = span_of(test.span_m);
    const auto rigid = analyse_bending_test(record, options);
    options.clamp_stiffness_Nm_rad = 200;
    const auto result = analyse_bending_test(record, options);
    held += holds(result.stiffness, test.EI_Nm2);
    rigid_held += holds(rigid.stiffness, test.EI_Nm2);
  }
  EXPECT_GE(held, 52);  // 95 % of 60: 57 +- 1.7, three of these
  EXPECT_LT(rigid_held, 15);
}

TEST(BendingTest, NothingOrNonsenseIsRefusedWithAReason) {
  EXPECT_TRUE(analyse_bending_test({}, span_of(1)).refused);
  auto record = exact_record(0.6, 100, 0.5);
  record.load_N.setConstant(3);
  EXPECT_TRUE(says(analyse_bending_test(record, span_of(1)).findings, "no_loading"));
  record = exact_record(0.6, 100, 0.5);
  record.tension_N *= -1;
  EXPECT_TRUE(says(analyse_bending_test(record, span_of(1)).findings, "no_tension"));
  record = exact_record(0.6, 100, 0.5);
  record.load_N.setConstant(NAN);
  EXPECT_TRUE(says(analyse_bending_test(record, span_of(1)).findings, "too_few_points"));
  record.load_N.resize(3);
  EXPECT_THROW((void)analyse_bending_test(record, span_of(1)), std::invalid_argument);
  EXPECT_THROW((void)analyse_bending_test(exact_record(1, 1, 1), {}), std::invalid_argument);
}

// No line goes through noise alone.
TEST(BendingTest, NoiseAloneIsRefused) {
  Normal normal(9);
  for (int k = 0; k < 20; ++k) {
    BendingRecord record = exact_record(0.6, 200, 0.5, 0, 100);
    for (double& load : record.load_N) load = 5 + 0.01 * normal();
    for (double& d : record.deflection_m) d = 1e-6 * normal();
    const auto result = analyse_bending_test(record, span_of(0.5));
    EXPECT_TRUE(result.refused);
    const auto reason =
        std::ranges::find_if(result.findings, [](const auto& one) { return one.refused; });
    EXPECT_THAT(reason->code, ::testing::StartsWith("no_")) << codes(result);
  }
}

TEST(BendingTest, TableOfSeveralTensionsIsSplit) {
  std::vector<BendingRecord> parts;
  for (double P : {25.0, 100.0, 200.0}) parts.push_back(exact_record(0.5, P, 0.5, 0, 4));
  const auto& [a, b, c] = std::tie(parts[0], parts[1], parts[2]);
  BendingRecord table{Eigen::VectorXd(24), Eigen::VectorXd(24), Eigen::VectorXd(24)};
  table.tension_N << a.tension_N, b.tension_N, c.tension_N;
  table.load_N << a.load_N, b.load_N, c.load_N;
  table.deflection_m << a.deflection_m, b.deflection_m, c.deflection_m;
  const auto split = split_by_tension(table);
  ASSERT_EQ(split.size(), 3U);
  EXPECT_EQ(split[1].load_N, parts[1].load_N);
  EXPECT_EQ(split_by_tension(parts[0]).size(), 1U);
}

VirtualBendingTest laboratory(double EI, double P) {
  VirtualBendingTest test{.EI_Nm2 = EI, .tension_N = P};
  test.span_m = 0.5;
  test.peak_load_N = 10;
  test.load_cell.noise_std = 0.01;
  test.load_cell.offset_std = 0.05;
  test.lvdt.noise_std = 1e-6;
  test.lvdt.offset_std = 1e-4;
  test.tension_cell.noise_std = 0.1;
  return test;
}

// The virtual laboratory has friction, a growing tension and noise, none of which the estimator is
// told. 95 % intervals over 120 tests: the share lies within three binomial deviations (6 %).
TEST(BendingTest, IntervalsCoverTheTruthOfTheVirtualLaboratory) {
  int covered = 0, trials = 0;
  double bias = 0;
  for (double P : {25.0, 100.0, 300.0}) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      Random random = random_stream(seed, static_cast<std::uint64_t>(P));
      const auto recording = virtual_bending_record(laboratory(0.5, P), random);
      const auto result = analyse_bending_test(channels(recording), span_of(0.5));
      ASSERT_FALSE(result.refused) << codes(result);
      ++trials;
      covered += holds(result.stiffness, 0.5);
      bias += (result.stiffness.EI_Nm2.value - 0.5) / result.stiffness.EI_Nm2.std / 120;
    }
  }
  EXPECT_GE(covered, 0.89 * trials) << bias;
  EXPECT_LT(std::abs(bias), 1.0 / 3 + 3 / std::sqrt(120.0));
}

// Strokes of 60 samples make averages of one sample or two, in which a spike would have its weight.
TEST(BendingTest, SpikesOfShortStrokesAreLeftOut) {
  simulated::Bending test;
  test.rows = 240, test.load_noise = test.deflection_noise = 0.001;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    std::mt19937_64 random(seed);
    test.load_spikes = seed % 2, test.deflection_spikes = 1;
    const auto result = analyse_bending_test(simulated::record(test, random), span_of(test.span_m));
    ASSERT_FALSE(result.refused) << codes(result);
    EXPECT_NEAR(result.stiffness.EI_Nm2.value, test.EI_Nm2, 0.02 * test.EI_Nm2) << seed;
  }
}

// At a turn the load falls by twice the friction: samples on its way down are no spikes.
TEST(BendingTest, TurnsWithFrictionAreNoSpikes) {
  simulated::Bending test;
  test.rows = 400, test.load_noise = test.deflection_noise = 1e-4;
  test.friction = simulated::Friction::bilinear, test.friction_travel_m = 1e-5;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    std::mt19937_64 random(seed);
    test.friction_N = 0.1 + 0.1 * static_cast<double>(seed);
    const auto result = analyse_bending_test(simulated::record(test, random), span_of(test.span_m));
    EXPECT_EQ(codes(result).find("spike"), std::string::npos) << seed << codes(result);
  }
}

// Weights in any order are one stroke: EI to five times its standard uncertainty of 1 %.
TEST(BendingTest, ATableInAnyOrderGivesTheStiffness) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    std::mt19937_64 random(seed);
    simulated::Bending test;
    test.rows = 24, test.strokes = 1, test.load_noise = test.deflection_noise = 0.001;
    BendingRecord table = simulated::record(test, random);
    std::vector<int> order(24);
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random);
    table.tension_N = table.tension_N(order).eval(), table.load_N = table.load_N(order).eval();
    table.deflection_m = table.deflection_m(order).eval();
    const auto result = analyse_bending_test(table, span_of(test.span_m));
    ASSERT_FALSE(result.refused) << codes(result);
    EXPECT_NEAR(result.stiffness.EI_Nm2.value, test.EI_Nm2, 0.05 * test.EI_Nm2) << seed;
  }
}

TEST(BendingTest, AMillionSamplesGiveTheStiffness) {
  std::mt19937_64 random(3);
  simulated::Bending test;
  test.rows = 1'000'000, test.strokes = 2, test.load_noise = test.deflection_noise = 0.001;
  const auto result = analyse_bending_test(simulated::record(test, random), span_of(test.span_m));
  ASSERT_FALSE(result.refused) << codes(result);
  const auto& EI = result.stiffness.EI_Nm2;
  EXPECT_NEAR(EI.value, test.EI_Nm2, 3 * EI.std);
}

// One sample in twenty with an error of forty standard deviations of the load cell.
TEST(BendingTest, IntervalsHoldWithOutliers) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform;
  testing::Coverage coverage;
  simulated::Bending test;
  test.rows = 400, test.strokes = 2, test.load_noise = test.deflection_noise = 0.001;
  for (int k = 0; k < 100; ++k) {
    BendingRecord record = simulated::record(test, random);
    const double off = 0.04 * record.load_N.maxCoeff();
    for (double& load : record.load_N) {
      if (uniform(random) < 0.05) load += uniform(random) < 0.5 ? off : -off;
    }
    const auto result = analyse_bending_test(record, span_of(test.span_m));
    ASSERT_FALSE(result.refused) << codes(result);
    const auto& EI = result.stiffness;
    coverage.add(EI.EI_Nm2.value, EI.EI_Nm2.std, EI.low, EI.high, test.EI_Nm2);
  }
  EXPECT_TRUE(coverage.holds());
}

// Friction that turns round over a part of the stroke, in which a straight line is too stiff.
// By an exponential law and one with a longer tail; over more of the stroke it is refused.
TEST(BendingTest, FrictionIsInTheIntervalOrRefused) {
  int covered = 0, given = 0, held_or_refused = 0;
  const auto analyse = [](double travel, double exponent, std::uint64_t seed) {
    VirtualBendingTest test = laboratory(0.8, 300);
    test.peak_load_N = 4;
    test.friction_load_N = 0.08;
    test.friction_travel_m = travel;
    test.friction_exponent = exponent;
    test.load_cell.noise_std = 0.005;
    Random random = random_stream(seed, 3);
    return analyse_bending_test(channels(virtual_bending_record(test, random)), span_of(0.5));
  };
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    for (const auto& [travel, exponent] : {std::pair{1e-4, 1.0}, {5e-5, 1.5}}) {
      const auto result = analyse(travel, exponent, seed);
      if (result.refused) continue;
      ++given;
      EXPECT_TRUE(says(result.findings, "friction")) << codes(result);
      covered += holds(result.stiffness, 0.8);
    }
    simulated::Bending slow;
    slow.rows = 400, slow.load_noise = slow.deflection_noise = 0.001;
    slow.friction_N = 0.1, slow.friction_travel_m = 4e-4;  // of 1 mm
    std::mt19937_64 random(seed);
    // The bilinear law is straight while it turns round: only the end of the stroke shows it.
    for (const auto law : {simulated::Friction::dahl, simulated::Friction::bilinear}) {
      slow.friction = law;
      const auto record = simulated::record(slow, random);
      const auto result = analyse_bending_test(record, span_of(slow.span_m));
      const auto& EI = result.stiffness;
      held_or_refused += result.refused || holds(EI, slow.EI_Nm2);
    }
  }
  EXPECT_GE(given, 36);
  EXPECT_GE(covered, given - 6);   // 95 % of 40: 38 +- 1.4, three of these
  EXPECT_GE(held_or_refused, 36);  // as many of 40
}

// Six weights in grams on a dial, steady by chance: at 0.7, 1 and 2.5 mm each, as straight as steps
// of 0.1, 1 and 0.5 mm let one see; and in steps of 0.05 mm.
TEST(BendingTest, ReadingsAreNoFinerThanTheyAreWritten) {
  Eigen::VectorXd steady = Eigen::VectorXd::LinSpaced(6, 0, 350), dial = steady;
  dial << 15, 85, 155, 225, 295, 365;
  for (const auto& [hundredths, step] :
       {std::pair{steady, 10}, {steady / 0.7, 100}, {steady / 0.28, 50}, {dial, 5}}) {
    const auto result =
        analyse_bending_test({{}, 9.80665e-3 * 500 * steady / 70, 1e-5 * hundredths},
                             {.span_m = {0.6, 0}, .ends = BeamEnds::pinned});
    const double travel = hundredths[5] - hundredths[0];
    EXPECT_NEAR(result.compliance_m_N.std / result.compliance_m_N.value,
                step / (travel / 5) / std::sqrt(12 * 17.5), 1e-9);
  }
}

// Deflected to both sides, the cable is unloaded from either end to the middle.
TEST(BendingTest, StrokesToBothSidesGiveTheStiffness) {
  BendingRecord record = exact_record(0.6, 25, 0.5, 3 / 1e-6);
  const BendingRecord other = record;
  record.tension_N.resize(200), record.load_N.resize(200), record.deflection_m.resize(200);
  record.tension_N << other.tension_N, other.tension_N;
  record.load_N << other.load_N, -other.load_N;
  record.deflection_m << other.deflection_m, -other.deflection_m;
  for (const double offset : {0.0, -0.5}) {  // of the load cell, with strokes to one side
    const auto& some = offset == 0 ? record : other;
    const auto result = analyse_bending_test(
        {some.tension_N, some.load_N.array() + offset, some.deflection_m}, span_of(0.5));
    ASSERT_TRUE(!result.refused && result.findings.empty()) << codes(result);
    EXPECT_NEAR(result.stiffness.EI_Nm2.value, 0.6, 1e-6) << offset;
  }
}

}  // namespace rigfit::ident::bending_analysis_test
