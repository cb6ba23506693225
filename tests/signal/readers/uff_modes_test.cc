// Fixtures are written by hand from the public description of datasets 15, 55, 164 and 2411, and by
// our own writer.
#include "signal/readers/read_recording.h"
#include "signal/writers/writers.h"
#include "tests/signal/readers/reading.h"
#include "tests/test.h"

namespace rigfit::signal::uff_modes_test {

UffModes seed(const char* name) {
  return read_uff_modes(std::string(RIGFIT_FUZZ) + "/seeds/uff_modes/" + name);
}

/// A dataset 55 of real normal modes, as its description lays it out.
std::string normal_mode(const std::string& values) {
  std::string text = "    -1\n    55\n";
  for (int k = 0; k < 5; ++k) text += "NONE\n";
  text += "         1         2         2         8         2         3\n";
  text += "         2         4         0         1\n";
  text += "  2.50000E+01  1.00000E+00  1.00000E-02  0.00000E+00\n";
  return text + values + "    -1\n";
}

std::string message(const std::string& text) {
  return refusal_of([&] { return read_uff_modes(text, "x.uff"); });
}

// Printed with six digits: 0.5e-5 of a mantissa of at least 1.
constexpr double kPrinted = 0.5e-5;

TEST(UffModes, OurOwnComeBackWithinTheirDigits) {
  Normal normal(3);
  ModalModel model;
  std::vector<NodePosition> positions;
  for (int node = 1; node <= 5; ++node) {
    positions.push_back({node * 7, {normal(), normal(), 1e-3 * normal()}});
    for (int axis = 1; axis <= 3; ++axis) {
      model.responses.push_back({"p", node * 7, node % 2 ? axis : -axis});
    }
  }
  for (int m = 0; m < 4; ++m) {
    IdentifiedMode mode;
    const double f = 10.0 * (m + 1) + normal(), zeta = 0.01 * (m + 1);
    const double w = 2 * kPi * f;
    mode.frequency_hz = {f, 0.01};
    mode.damping_ratio = {zeta, 0.001};
    mode.pole_rad_s = {-zeta * w, w * std::sqrt(1 - zeta * zeta)};
    mode.shape.resize(15);
    for (auto& value : mode.shape) value = {normal(), normal()};
    model.modes.push_back(mode);
  }
  FrfSet frf{.responses = {{"p", 1, 3}}, .inputs = {{"h", 2, 3}}};  // a dataset 58b in front
  frf.frequency_hz = VectorXd::LinSpaced(9, 1, 9), frf.H.setOnes(9, 1);
  const UffModes in = read_uff_modes(uff_text(frf) + uff_text(model, positions), "x.uff");
  EXPECT_TRUE(in.remarks.empty());
  ASSERT_EQ(in.modes.size(), 4u);
  ASSERT_EQ(in.nodes.size(), 5u);
  for (const auto& [number, wrote] : positions) {
    const UffNode& node = in.nodes.at(number);
    EXPECT_EQ(node.displacement_system, 0);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(node.position_m[k], wrote[k], kPrinted * std::abs(wrote[k]));
    }
  }
  for (std::size_t m = 0; m < 4; ++m) {
    const auto& mode = in.modes[m];
    EXPECT_NEAR(mode.frequency_hz, model.modes[m].frequency_hz.value, kPrinted * mode.frequency_hz);
    // Real and imaginary part of the eigenvalue are rounded apart.
    EXPECT_NEAR(mode.damping_ratio, model.modes[m].damping_ratio.value,
                2 * kPrinted * mode.damping_ratio);
    ASSERT_EQ(mode.shape.size(), 5u);
    for (std::size_t r = 0; r < 15; ++r) {
      const auto& at = mode.shape.at(model.responses[r].node);
      const double sign = model.responses[r].direction > 0 ? 1 : -1;
      const Complex wrote = sign * model.modes[m].shape[r];
      EXPECT_LE(std::abs(at[r % 3] - wrote), 1.5 * kPrinted * std::abs(wrote));
    }
  }
}

TEST(UffModes, NormalModesInMillimetres) {
  const UffModes in = seed("normal_mm.uff");
  ASSERT_EQ(in.modes.size(), 2u);
  EXPECT_DOUBLE_EQ(in.modes[0].frequency_hz, 2.3415);
  EXPECT_DOUBLE_EQ(in.modes[0].damping_ratio, 0.0102);
  ASSERT_EQ(in.modes[1].shape.size(), 3u);
  EXPECT_EQ(in.modes[1].shape.at(2)[0], Complex(-0.6));
  ASSERT_EQ(in.nodes.size(), 3u);
  EXPECT_DOUBLE_EQ(in.nodes.at(3).position_m[1], 0.75);
}

TEST(UffModes, ComplexModesWithRotationsAndTheirConjugates) {
  const UffModes in = seed("complex_six_pairs.uff");
  ASSERT_EQ(in.modes.size(), 2u);  // the conjugate is no mode of its own
  const double modulus = std::hypot(0.1, 14.7);
  EXPECT_NEAR(in.modes[0].frequency_hz, modulus / (2 * kPi), 1e-12);
  EXPECT_NEAR(in.modes[0].damping_ratio, 0.1 / modulus, 1e-15);
  ASSERT_EQ(in.modes[0].shape.size(), 2u);
  EXPECT_EQ(in.modes[0].shape.at(101)[2], Complex(0.5, 0.2));
  ASSERT_EQ(in.nodes.size(), 2u);
  EXPECT_DOUBLE_EQ(in.nodes.at(102).position_m[1], 0.65);
  EXPECT_EQ(in.nodes.at(102).displacement_system, 1);
}

TEST(UffModes, ConjugatesAloneAreTurnedRound) {
  std::string text = "    -1\n    55\n";
  for (int k = 0; k < 5; ++k) text += "NONE\n";
  text +=
      "         1         3         2         8         5         3\n"
      "         2         6         0         1\n"
      " -1.00000E+00 -5.00000E+01  0.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00\n"
      "         3\n"
      "  1.00000E+00  2.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00\n"
      "    -1\n";
  const UffModes in = read_uff_modes(text, "x.uff");
  ASSERT_EQ(in.modes.size(), 1u);
  EXPECT_EQ(in.modes[0].shape.at(3)[0], Complex(1, -2));
}

TEST(UffModes, WhatIsNoModeIsSaidAndPassedOver) {
  const UffModes in = seed("mixed_kinds.uff");
  // A scalar complex mode and a hysteretic normal one; static deflection and 0 Hz are left out.
  ASSERT_EQ(in.modes.size(), 2u);
  EXPECT_TRUE(in.modes[0].shape.empty());
  EXPECT_NEAR(in.modes[1].frequency_hz, 33.3, 1e-12);
  EXPECT_NEAR(in.modes[1].damping_ratio, 0.015, 1e-15);
  // 13 columns each, no blank between.
  EXPECT_EQ(in.modes[1].shape.begin()->second[1], Complex(-100));
  EXPECT_EQ(in.modes[1].shape.begin()->second[2], Complex(-1e-100));
  EXPECT_EQ(in.remarks.size(), 3u);
}

TEST(UffModes, BinaryFunctionsBeforeThemArePassedOver) {
  const UffModes in = seed("behind_binary.uff");
  ASSERT_EQ(in.modes.size(), 1u);
  EXPECT_DOUBLE_EQ(in.modes[0].frequency_hz, 7);
}

TEST(UffModes, FaultsAreNamedWithTheirLine) {
  using ::testing::HasSubstr;
  const std::string good = normal_mode("         1\n  1.00000E+00  0.00000E+00  0.00000E+00\n");
  EXPECT_EQ(read_uff_modes(good, "x.uff").modes.size(), 1u);
  // Lines: mark, number, five of identification, three records; the first node is line 11.
  EXPECT_THAT(message(normal_mode("        1x\n  1.0  0.0  0.0\n")), HasSubstr("x.uff:11:"));
  EXPECT_THAT(message(normal_mode("         1\n  1.0  zero  0.0\n")),
              AllOf(HasSubstr("x.uff:12:8"), HasSubstr("not a number")));
  EXPECT_THAT(message(normal_mode("         1\n  1.0  0.0  0.0  4.0\n")),
              HasSubstr("node 1 has 4 values, not 3"));
  EXPECT_THAT(message(normal_mode("         1\n  1.0  0.0\n")), HasSubstr("breaks off"));
  EXPECT_THAT(message(normal_mode("         1  1.0  0.0  0.0\n")), HasSubstr("stands alone"));
  EXPECT_THAT(message(normal_mode("         1\n  1.0  1e999  0.0\n")), HasSubstr("too large"));
  EXPECT_THAT(
      message("    -1\n    15\n         1         0         0         0  1.0  2.0\n    -1\n"),
      HasSubstr("three coordinates, not 2"));
  EXPECT_THAT(message("    -1\n    58\nx\n    -1\n"), HasSubstr("holds no mode"));
  EXPECT_THAT(message("frequency_hz\n10\n"), HasSubstr("holds no dataset"));
  std::string kind = good;
  kind.replace(kind.find("         8         2         3") + 19, 1, "9");
  EXPECT_THAT(message(kind), HasSubstr("unknown kind of numbers"));
  // Cut at the end mark: what is there is whole, and the missing mark is said.
  const UffModes cut = read_uff_modes(good.substr(0, good.rfind("    -1")), "x.uff");
  EXPECT_EQ(cut.modes.size(), 1u);
  EXPECT_THAT(cut.remarks, ElementsAre(HasSubstr("no end mark")));
}

}  // namespace rigfit::signal::uff_modes_test
