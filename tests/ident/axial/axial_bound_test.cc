#include "ident/axial/axial_identification.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ident/virtual_rig/virtual_axial.h"
#include "tests/reference/axial_study.h"

namespace rigfit::ident::axial_bound_test {
namespace {

AxialDecay decay_of(double EA, double adapter) {
  VirtualAxialTest test;
  test.EA_N = EA, test.mass_per_length_kg_m = 0.16667, test.length_m = 1;
  test.hung_mass_kg = 2.2, test.adapter_stiffness_N_m = adapter, test.damping_ratio = 0.017;
  return {"record", 1, {axial_truth(test).frequency_hz, 0.01}, {0.017, 2e-4}};
}

TEST(AxialBound, OneLengthGivesTheChainAndEAFromBelow) {
  AxialSetup setup;
  setup.mass_kg = {2.2, 0.001}, setup.mass_per_length_kg_m = {0.16667, 0.0005};
  setup.length_std_m = 0.001;
  for (const double adapter : {0.0, 5e6, 2e6, 5e5}) {
    const auto r = identify_axial(std::vector{decay_of(205000, adapter)}, setup);
    ASSERT_TRUE(r.conditional);
    EXPECT_LT(r.EA_low_N, 205000);
    EXPECT_EQ(r.EA_high_N, 0.16667 / 7850 * 210e9);
    EXPECT_GT(r.EA_N.std, 0.2 * r.EA_N.value);  // never narrow
    EXPECT_LT(r.EA_if_rigid_N.std, 0.005 * r.EA_N.value);
    EXPECT_EQ(r.budget.front().source, "what else gives way, not told");
    const double chain = 1 / (1 / 205000.0 + (adapter > 0 ? 1 / adapter : 0));
    // How much of the cable's mass moves is not known: a third of 0.167 kg over sqrt(3), of 2.2 kg.
    EXPECT_NEAR(r.assembly_stiffness_N_m.value, chain, 2 * r.assembly_stiffness_N_m.std);
    EXPECT_NEAR(r.assembly_stiffness_N_m.std / chain, 0.0146, 0.001);
  }
  setup.mass_per_length_kg_m = {0, 0};
  const auto open = identify_axial(std::vector{decay_of(205000, 2e6)}, setup);
  EXPECT_TRUE(std::isinf(open.EA_high_N));
  // A statement makes it a value again, and so does a second length.
  setup.mass_per_length_kg_m = {0.16667, 0.0005};
  setup.frame_stated = true;
  EXPECT_FALSE(identify_axial(std::vector{decay_of(205000, 0)}, setup).conditional);
}

TEST(AxialBound, AFrameThatIsToldGivesEAFromOneLength) {
  // Finite elements, frame 5e6 N/m: 4 % of EA. 95 % of 20 are 19 +- 1; three less.
  reference::AxialStudy study;
  study.rig.frame_N_m = 5e6;
  study.lengths_m = {1.0};
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

}  // namespace
}  // namespace rigfit::ident::axial_bound_test
