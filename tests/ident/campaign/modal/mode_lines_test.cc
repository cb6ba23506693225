#include "ident/campaign/modal/mode_lines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "model/linear/modal_analysis.h"
#include "model/scene/read_scene.h"

namespace rigfit::ident {
namespace {

ModeLine line(int first, std::vector<double> frequency_hz) {
  return {model::ModePlane::in, 1, first, std::move(frequency_hz)};
}

TEST(ModeLines, CrossWhereStraightLinesDo) {
  const std::vector<double> tension{100, 200, 300, 400, 500};
  // 10 + 0.01 (T - 100) and 12 - 0.01 (T - 100) meet at T = 200, 11 Hz; moved by half a step: 250.
  const auto exact =
      crossings_of(tension, {line(0, {10, 11, 12, 13, 14}), line(0, {12.5, 11.5, 10.5, 9.5, 8.5})});
  ASSERT_EQ(exact.size(), 1u);
  EXPECT_NEAR(exact[0].tension_N, 225, 1e-9);
  EXPECT_NEAR(exact[0].frequency_hz, 11.25, 1e-9);
  // One line begins later: only the steps that both have count.
  EXPECT_EQ(crossings_of(tension, {line(0, {10, 11, 12, 13, 14}), line(3, {9.5, 8.5})}).size(), 0u);
  EXPECT_EQ(crossings_of(tension, {line(0, {10, 11, 12, 13, 14}), line(2, {12.5, 11, 10})}).size(),
            1u);
}

// Two lines that are one to within the model's accuracy change their order by chance.
TEST(ModeLines, LinesThatLieOnEachOtherDoNotCross) {
  const std::vector<double> tension{100, 200, 300, 400};
  EXPECT_TRUE(crossings_of(tension, {line(0, {10, 11, 12, 13}),
                                     line(0, {10.0001, 10.9999, 12.0001, 12.9999})})
                  .empty());
  EXPECT_TRUE(
      crossings_of(tension, {line(0, {10, 11, 12, 13}), line(0, {11, 12, 12.0001, 12.9999})})
          .empty());
}

// Irvine: the first symmetric mode in plane, 1 - cos(k x) with k = 2 pi / L, has the frequency of
// the first antisymmetric one, sin(k x), where (m g L / T)^2 EA / T = 4 pi^2, at T0 = ((m g L)^2 EA
// / (4 pi^2))^(1/3). With EI, by Rayleigh's quotient of these shapes, omega^2 m is
//   k^2 T / 3 + (2/3) k^2 T0^3 / T^2 + c EI k^4 / 3   and   k^2 T + EI k^4,
// c = 1 for that shape, less where its ends give way until they carry no moment, and not below 0:
// equal where T^3 + (3 - c) / 2 EI k^2 T^2 = T0^3. The sag's own length (8 (sag / L)^2 = 1e-3)
// moves T by 3e-4, lines that are straight over steps of 5 % by 2e-3: 0.5 % beyond the two roots.
TEST(ModeLines, CableCrossesWhereIrvineSays) {
  const auto scene =
      model::read_scene(std::string(RIGFIT_TESTDATA) + "/jalali2021/scenes/cable.toml");
  const auto at = [&](double tension) {
    model::Scene set = scene;
    model::set_parameter(set, "cable.tension", tension);
    set.members[0].segments = 40;
    return set;
  };
  const ModeLines followed = follow_modes(at, 25, 300, 48, 30);
  const double weight = 0.16667 * 9.80665 * 2.4, k = 2 * std::numbers::pi / 2.4;
  const double cube = weight * weight * 221780 / (4 * std::numbers::pi * std::numbers::pi);
  const auto root = [&](double c) {
    double T = std::cbrt(cube);
    for (int i = 0; i < 50; ++i) T = std::cbrt(cube - (3 - c) / 2 * 0.5972 * k * k * T * T);
    return T;
  };
  const double low = 0.995 * root(0), high = 1.005 * root(1);
  bool found = false;
  for (const auto& crossing : followed.crossings) {
    const auto& one = followed.lines[crossing.one];
    const auto& other = followed.lines[crossing.other];
    if (one.plane != model::ModePlane::in || other.plane != model::ModePlane::in) continue;
    found = found || (crossing.tension_N > low && crossing.tension_N < high);
  }
  EXPECT_TRUE(found) << "no crossing in plane between " << low << " and " << high << " N";
  // Each line is one mode: its frequency never jumps by more than a step of 5 % in tension and the
  // sag's stiffness can turn it (omega^2 ~ T^-2 at most: 5 %).
  for (const auto& line : followed.lines) {
    for (std::size_t i = 1; i < line.frequency_hz.size(); ++i) {
      EXPECT_LT(std::abs(line.frequency_hz[i] / line.frequency_hz[i - 1] - 1), 0.06);
    }
  }
}

// "auto" cuts a cable by its waves, which change with the tension; shapes must compare all along.
TEST(ModeLines, SegmentsLeftToTheProgramGiveTheSameLines) {
  const auto scene =
      model::read_scene(std::string(RIGFIT_TESTDATA) + "/jalali2021/scenes/cable.toml");
  const auto follow = [&](int segments) {
    return follow_modes(
        [&](double tension) {
          model::Scene set = scene;
          model::set_parameter(set, "cable.tension", tension);
          set.members[0].segments = segments;
          return set;
        },
        25, 300, 24, 30);
  };
  const ModeLines given = follow(400), left = follow(0);
  ASSERT_EQ(left.lines.size(), given.lines.size());
  for (std::size_t l = 0; l < given.lines.size(); ++l) {
    const auto &one = given.lines[l], &other = left.lines[l];
    ASSERT_EQ(other.first, one.first) << l;
    ASSERT_EQ(other.frequency_hz.size(), one.frequency_hz.size()) << l;
    for (std::size_t i = 0; i < one.frequency_hz.size(); ++i) {
      // The accuracy asked of "auto"; 400 segments err by 6e-5 at the lowest tension.
      EXPECT_NEAR(other.frequency_hz[i] / one.frequency_hz[i], 1, 1.6e-4) << l;
    }
  }
}

}  // namespace
}  // namespace rigfit::ident
