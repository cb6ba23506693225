#include "ident/axial/axial_identification.h"

#include "ident/virtual_rig/virtual_bench.h"
#include "tests/reference/axial_rig.h"
#include "tests/test.h"

namespace rigfit::ident::axial_identification_test {

struct Rig {
  double EA = 221780, zeta = 0.017, mass = 2.2, per_length = 0.16667, adapter = 0;
};

// The rod, the adapter and the mass, forwards (virtual_bench.h: by bisection to 1e-15).
AxialDecay decay_of(const Rig& rig, double length) {
  VirtualAxialTest test{.EA_N = rig.EA,
                        .mass_per_length_kg_m = rig.per_length,
                        .length_m = length,
                        .hung_mass_kg = rig.mass,
                        .adapter_stiffness_N_m = rig.adapter,
                        .damping_ratio = rig.zeta};
  return {.name = "record",
          .length_m = length,
          .damped_frequency_hz = {axial_frequency_hz(test), 0.01},
          .damping_ratio = {rig.zeta, 2e-4}};
}

AxialSetup setup_of(const Rig& rig) {
  return {.mass_kg = {rig.mass, 0.001},
          .mass_per_length_kg_m = {rig.per_length, 0.0005},
          .length_std_m = 0.001,
          .adapter_stiffness_N_m = {rig.adapter, 0.01 * rig.adapter}};
}

// The same where the frame is known to be rigid.
AxialSetup rigid(const Rig& rig) {
  AxialSetup s = setup_of(rig);
  s.series_compliance_std_m_N = 0;
  return s;
}

std::vector<AxialDecay> exact(const Rig& rig) {
  std::vector<AxialDecay> list;
  for (double length : {0.7, 1.0, 1.3}) {
    for (int i = 0; i < 5; ++i) list.push_back(decay_of(rig, length));
  }
  return list;
}

TEST(AxialTest, InvertsItsOwnModelWithAndWithoutAdapter) {
  for (const double adapter : {0.0, 2e7, 6e5}) {
    Rig rig;
    rig.adapter = adapter;
    const auto r = identify_axial(exact(rig), setup_of(rig));
    EXPECT_NEAR(r.EA_N.value, rig.EA, 1e-9 * rig.EA);
    EXPECT_NEAR(r.damping_ratio.value, rig.zeta, 1e-12);
    EXPECT_EQ(r.between_lengths_std_N, 0);
    EXPECT_NEAR(r.series_compliance_m_N.value, 0, 1e-3 * r.series_compliance_m_N.std);
    EXPECT_GT(r.homogeneity_p, 0.99);
    const double kc = rig.EA / 1.0;
    const double k = adapter > 0 ? 1 / (1 / kc + 1 / adapter) : kc;
    EXPECT_NEAR(r.damping_Ns_m.value, 2 * rig.zeta * std::sqrt(k * rig.mass), 1e-6);
    EXPECT_NEAR(r.reference_length_m, 1.0, 1e-12);
  }
}

TEST(AxialTest, BudgetSensitivitiesAreDifferenceQuotients) {
  Rig rig;
  rig.adapter = 6e5;
  const auto decays = exact(rig);
  const auto base = rigid(rig);
  const auto result = identify_axial(decays, base);
  const auto slope = [&](auto change, double h) {
    auto up = base, down = base;
    change(up, h), change(down, -h);
    return (identify_axial(decays, up).EA_N.value - identify_axial(decays, down).EA_N.value) /
           (2 * h);
  };
  // Central differences: h^2 against the curvature (relative 1e-8) and the change of the weights
  // with the input, of second order in the (vanishing) disagreement between lengths.
  for (const auto& row : result.budget) {
    double expected = 0;
    if (row.source == "hung mass") {
      expected = slope([](AxialSetup& s, double h) { s.mass_kg.value += h; }, 1e-4);
    } else if (row.source == "cable mass per length") {
      expected = slope([](AxialSetup& s, double h) { s.mass_per_length_kg_m.value += h; }, 1e-4);
    } else if (row.source == "adapter stiffness") {
      expected = slope([](AxialSetup& s, double h) { s.adapter_stiffness_N_m.value += h; }, 100.0);
    } else {
      continue;
    }
    EXPECT_NEAR(row.sensitivity, expected, 1e-3 * std::abs(expected)) << row.source;
  }
  double share = 0, variance = 0;
  for (const auto& row : result.budget) {
    share += row.share, variance += row.contribution_N * row.contribution_N;
  }
  EXPECT_NEAR(share, 1, 1e-12);
  EXPECT_NEAR(std::sqrt(variance), result.EA_N.std, 1e-9 * result.EA_N.std);
}

TEST(AxialTest, LengthsThatDisagreeWidenTheAnswerAndAreNamed) {
  Rig rig;
  auto decays = exact(rig);
  for (auto& d : decays) {
    if (d.length_m == 1.0) d.damped_frequency_hz.value *= 1.03;  // 6 % in EA, not along a line
  }
  const auto r = identify_axial(decays, setup_of(rig));
  EXPECT_LT(r.homogeneity_p, 1e-3);
  EXPECT_GT(r.between_lengths_std_N, 0.02 * rig.EA);
  EXPECT_GT(r.EA_N.high - r.EA_N.low, 0.1 * rig.EA);  // t of one degree: 12.7 standard deviations
  EXPECT_LT(r.EA_N.low, rig.EA);
  EXPECT_GT(r.EA_N.high, rig.EA);
  EXPECT_EQ(r.budget.front().source, "between lengths");
  EXPECT_TRUE(says(r.notes, "lengths_disagree"));
}

// An adapter that is not told has a sixth or two thirds of the chain's compliance. A place of the
// compliance without bounds once made EA 0 N, one that ran to an end 10 % less.
TEST(AxialTest, ALargeComplianceIsNoCollapse) {
  Rig rig;
  rig.EA = 205000;
  for (const double shift : {-1e-3, 0.0, 1e-3, 1e-5}) {
    rig.adapter = shift == 1e-5 ? 1e5 : 1e6;
    auto decays = exact(rig);
    for (auto& d : decays) {
      d.damped_frequency_hz.std = 2.5e-4, d.damping_ratio.std = 3e-6;
      if (d.length_m == 1.0) d.damped_frequency_hz.value *= 1 + shift;
    }
    auto setup = setup_of(rig);
    setup.adapter_stiffness_N_m = {0, 0}, setup.mass_kg.std = 0.002;
    const auto r = identify_axial(decays, setup);
    EXPECT_NEAR(r.EA_N.value, rig.EA, (shift == 1e-5 ? 0.1 : 0.02) * rig.EA) << shift;
    EXPECT_LT(r.EA_N.low, rig.EA) << shift;
    EXPECT_GT(r.EA_N.high, rig.EA) << shift;
    EXPECT_GT(r.EA_N.low, 0.7 * rig.EA) << shift;
  }
}

TEST(AxialTest, WithoutTheLengthsUncertaintyThatOfEAIsNotKnown) {
  Rig rig;
  auto setup = setup_of(rig);
  setup.length_std_m.reset();
  const auto r = identify_axial(exact(rig), setup);
  EXPECT_NEAR(r.EA_N.value, rig.EA, 1e-6 * rig.EA);
  EXPECT_TRUE(std::isnan(r.EA_N.std) && std::isnan(r.EA_N.low) && std::isnan(r.EA_N.high));
  const auto said = std::ranges::find(r.notes, "length_std", &signal::Note::code);
  ASSERT_NE(said, r.notes.end());
  EXPECT_THAT(said->message, HasSubstr("--length-std"));
  // What 1 mm of each length changes: the slope's, EA / sqrt(2 * 0.3^2) * 1 mm = 523 N.
  const double effect = std::stod(said->message.substr(said->message.find(" EA by ") + 7));
  EXPECT_NEAR(effect, 523, 30) << said->message;
  setup.length_std_m = 0.001;
  const auto given = identify_axial(exact(rig), setup);
  EXPECT_GT(given.EA_N.std, 500);
  EXPECT_LT(given.EA_N.std, 800);
}

TEST(AxialTest, SaysThatThePapersValueIsAnEighthOfTheCatalogues) {
  Rig rig;
  const auto r = identify_axial(exact(rig), setup_of(rig));
  // 80 GPa x 0.16667 kg/m / 7850 kg/m3 = 1.70 MN.
  EXPECT_NEAR(r.catalogue_EA_N, 1.6986e6, 1e3);
  EXPECT_NEAR(r.share_of_catalogue, 0.13, 0.005);
}

// Records that agree to the last digit and claim to know it: the lengths' own uncertainty is all
// there is, k = EA / L gives its share: the slope of L / EA, through zero or, with an unknown
// compliance in series, about the mean.
TEST(AxialTest, RecordsWithoutErrorHaveTheUncertaintyOfTheirLengths) {
  constexpr double kMass = 2.2, kEA = 205000, kLengthStd = 0.001;
  std::vector<AxialDecay> decays;
  for (const double length : {0.7, 1.0, 1.3}) {
    AxialDecay decay{.length_m = length};
    decay.damped_frequency_hz = {std::sqrt(kEA / length / kMass) / (2 * kPi), 0};
    decay.damping_ratio = {0, 0};
    decays.insert(decays.end(), 5, decay);
  }
  AxialSetup setup{.mass_kg = {kMass, 0}, .length_std_m = kLengthStd};
  const double alone = kEA * kLengthStd / std::sqrt(0.7 * 0.7 + 1.0 * 1.0 + 1.3 * 1.3);
  const double in_series = kEA * kLengthStd / std::sqrt(2 * 0.3 * 0.3);
  const auto open = identify_axial(decays, setup);
  EXPECT_GT(open.EA_N.std, alone);
  EXPECT_LT(open.EA_N.std, 1.01 * in_series);
  setup.series_compliance_std_m_N = 0;
  const auto found = identify_axial(decays, setup);
  EXPECT_NEAR(open.EA_N.value / kEA, 1, 1e-9);
  EXPECT_NEAR(found.EA_N.value / kEA, 1, 1e-9);
  EXPECT_NEAR(found.EA_N.std / alone, 1, 1e-3);
}

TEST(AxialTest, RefusesWhatMakesNoSense) {
  Rig rig;
  auto setup = setup_of(rig);
  EXPECT_THROW((void)identify_axial({}, setup), std::invalid_argument);
  auto decays = exact(rig);
  decays[0].length_m = 0;
  EXPECT_THROW((void)identify_axial(decays, setup), std::invalid_argument);
  decays = exact(rig);
  setup.adapter_stiffness_N_m.value = 1e5;
  EXPECT_THROW((void)identify_axial(decays, setup), std::invalid_argument);
  setup = setup_of(rig);
  setup.mass_kg.value = kNaN;
  EXPECT_THROW((void)identify_axial(decays, setup), std::invalid_argument);
}

TEST(AxialBound, OneLengthGivesTheChainAndEAFromBelow) {
  AxialSetup setup{
      .mass_kg = {2.2, 0.001}, .mass_per_length_kg_m = {0.16667, 0.0005}, .length_std_m = 0.001};
  for (const double adapter : {0.0, 5e6, 2e6, 5e5}) {
    const auto r =
        identify_axial(std::vector{decay_of({.EA = 205000, .adapter = adapter}, 1)}, setup);
    ASSERT_TRUE(r.conditional);
    EXPECT_LT(r.EA_N.low, 205000);
    EXPECT_EQ(r.EA_N.high, 0.16667 / 7850 * 210e9);
    EXPECT_GT(r.EA_N.std, 0.2 * r.EA_N.value);  // never narrow
    EXPECT_LT(r.EA_if_rigid_N.std, 0.005 * r.EA_N.value);
    EXPECT_EQ(r.budget.front().source, "what else gives way, not told");
    const double chain = 1 / (1 / 205000.0 + (adapter > 0 ? 1 / adapter : 0));
    // How much of the cable's mass moves is not known: a third of 0.167 kg over sqrt(3), of 2.2 kg.
    EXPECT_NEAR(r.assembly_stiffness_N_m.value, chain, 2 * r.assembly_stiffness_N_m.std);
    EXPECT_NEAR(r.assembly_stiffness_N_m.std / chain, 0.0146, 0.001);
  }
  setup.mass_per_length_kg_m = {0, 0};
  const auto open = identify_axial(std::vector{decay_of({.EA = 205000, .adapter = 2e6}, 1)}, setup);
  EXPECT_TRUE(std::isinf(open.EA_N.high));
  // A statement makes it a value again, and so does a second length.
  setup.mass_per_length_kg_m = {0.16667, 0.0005};
  setup.frame_stated = true;
  EXPECT_FALSE(
      identify_axial(std::vector{decay_of({.EA = 205000, .adapter = 0}, 1)}, setup).conditional);
}

TEST(AxialBound, AFrameThatIsToldGivesEAFromOneLength) {
  // Finite elements, frame 5e6 N/m: 4 % of EA. 95 % of 20 are 19 +- 1; three less.
  reference::AxialStudy study{.rig = {.frame_N_m = 5e6}, .lengths_m = {1.0}};
  const auto untold = reference::axial_coverage(study, 10, 3);
  EXPECT_EQ(untold.covered, 10);
  EXPECT_EQ(untold.warned, 10);
  study.frame_told_relative_std = 0.1;
  const auto told = reference::axial_coverage(study, 20, 3);
  EXPECT_GE(told.covered, 16);
  EXPECT_EQ(told.warned, 0);
  // A tenth of the frame's 4 %, and frequency, mass and length to 0.2 %.
  EXPECT_LT(told.relative_std, 0.006);
  EXPECT_LT(std::abs(told.bias), 1.0);
}

// Lowest frequency of mass, rod and frame by the transfer matrix of the rod, by bisection:
// at the top the frame's force kf u0, below u' EA = kf u0; at the bottom W M u = EA u'.
double omega_squared(double kc, double mc, double M, double kf, double km) {
  const double quarter_wave = std::pow(kPi / 2, 2) * kc / mc;  // without the mass
  double low = 0, high = std::min(2 * kc / M, quarter_wave);
  for (int i = 0; i < 200; ++i) {
    const double W = 0.5 * (low + high), x = std::sqrt(W * mc / kc);
    const double u = std::cos(x) + kf / kc * std::sin(x) / x;  // relative to u0
    const double force = kc * (-x * std::sin(x)) + kf * std::cos(x);
    (force > W * M * (u + force / km) ? low : high) = W;
  }
  return low;
}

TEST(RodStiffness, InvertsTheRodFromFeatherToFarHeavierThanItsMass) {
  constexpr double kRigid = 1e18;
  for (const double per_length : {1e-9, 1e-4, 0.16667, 1.0, 5.0, 100.0}) {
    for (const double frame : {5e5, 5e6, kRigid}) {
      for (const double adapter : {2e6, kRigid}) {
        const double kc = 1.6e5, L = 1.3;
        const double W = omega_squared(kc, per_length * L, 2.2, frame, adapter);
        const auto told = [&](double k) { return k == kRigid ? 0 : k; };
        const auto k = rod_stiffness({W, 2.2, per_length, L, told(adapter), told(frame)});
        // Both round to some 1e-15; what cancels in 1/k less the told compliances costs ten of
        // those, near x = pi/2 (cable 60 times the mass) the small difference kr a hundred.
        EXPECT_NEAR(k.cable_N_m, kc, 1e-12 * kc) << per_length << " " << frame << " " << adapter;
        EXPECT_NEAR(k.series_N_m, 1 / (1 / kc + 1 / frame + 1 / adapter), 1e-6);
      }
    }
  }
}

TEST(RodStiffness, DerivativesAreDifferenceQuotients) {
  for (const double per_length : {1e-6, 0.16667, 5.0}) {
    const RodOnMass rod{9.5e4, 2.2, per_length, 1.3, 6e5};
    const auto k = rod_stiffness(rod);
    const auto slope = [&](double RodOnMass::*input) {
      const double h = 1e-5;
      RodOnMass up = rod, down = rod;
      up.*input *= 1 + h, down.*input *= 1 - h;
      return std::log(rod_stiffness(up).cable_N_m / rod_stiffness(down).cable_N_m) /
             std::log((1 + h) / (1 - h));
    };
    // h^2 and rounding over h: 1e-10; ten of them.
    EXPECT_NEAR(k.by_omega_squared, slope(&RodOnMass::omega_squared), 1e-9);
    EXPECT_NEAR(k.by_length, slope(&RodOnMass::length_m), 1e-9);
  }
}

TEST(RodStiffness, AnAdapterOrFrameSofterThanTheWholeHasNoAnswer) {
  EXPECT_TRUE(std::isnan(rod_stiffness({1e5, 2.2, 0.1, 1, 2e5}).cable_N_m));
  EXPECT_TRUE(std::isnan(rod_stiffness({1e5, 2.2, 0.1, 1, 0, 2e5}).cable_N_m));
}

}  // namespace rigfit::ident::axial_identification_test
