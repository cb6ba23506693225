#include "ident/update/pairing/mode_assignment.h"

#include "tests/test.h"

#include <numeric>

namespace rigfit::ident::mode_pairing_test {

using model::ModePlane;

std::vector<PairingMode> modes(const std::vector<double>& frequencies,
                               std::optional<ModePlane> plane = std::nullopt) {
  std::vector<PairingMode> result;
  for (double f : frequencies) result.push_back({.frequency_hz = f, .plane = plane});
  return result;
}

std::vector<PairingMode> both(std::vector<PairingMode> a, const std::vector<PairingMode>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// Model index by measured index; -1: unpaired.
std::vector<int> partners(const std::vector<ModePair>& pairs, std::size_t measured) {
  std::vector<int> result(measured, -1);
  for (const auto& pair : pairs) result[pair.measured] = pair.model;
  return result;
}

TEST(LeastCostAssignment, EqualsTheBestOfAllPermutations) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-3, 5);
  for (int trial = 0; trial < 200; ++trial) {
    const int rows = 1 + trial % 5, columns = rows + trial % 3;
    const Eigen::MatrixXd cost =
        Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return uniform(random); });
    std::vector<int> order(static_cast<std::size_t>(columns));
    std::iota(order.begin(), order.end(), 0);
    double best = 1e300;
    do {
      double total = 0;
      for (int i = 0; i < rows; ++i) total += cost(i, order[i]);
      best = std::min(best, total);
    } while (std::next_permutation(order.begin(), order.end()));
    const auto chosen = least_cost_assignment(cost);
    double total = 0;
    std::vector<int> used;
    for (int i = 0; i < rows; ++i) {
      total += cost(i, chosen[i]);
      used.push_back(chosen[i]);
    }
    std::sort(used.begin(), used.end());
    EXPECT_EQ(std::adjacent_find(used.begin(), used.end()), used.end());
    EXPECT_NEAR(total, best, 1e-12);  // sums of at most five numbers below 5
  }
}

TEST(PairModes, ByFrequencyAlone) {
  const struct {
    const char* what;
    std::vector<double> measured, modelled;
    std::vector<int> partner;
  } cases[] = {
      {"a missing one shifts none", {10, 20, 40, 50}, {10.2, 19.5, 30, 41, 51}, {0, 1, 3, 4}},
      {"a stranger stays unpaired", {10, 14.5, 20}, {10, 20, 80}, {0, -1, 1}},
      {"within a fifth", {10}, {11.5}, {0}},
      {"beyond a fifth", {10}, {12.3}, {-1}},
      {"none measured", {}, {1, 2}, {}},
      {"none modelled", {1, 2}, {}, {-1, -1}},
      // The bond-graph column has no value where its software found no mode.
      {"dashes of Table 5",
       {13.490, 14.537, 16.069, 26.111, 32.404, 39.604},
       {15.788, 16.740, 27.410, 33.887, 41.185},
       {-1, 0, 1, 2, 3, 4}},
  };
  for (const auto& one : cases) {
    const auto pairs = pair_modes(modes(one.measured), modes(one.modelled));
    EXPECT_EQ(partners(pairs, one.measured.size()), one.partner) << one.what;
  }
}

TEST(PairModes, ShapesSettleWhatFrequenciesLeaveOpen) {
  auto measured = modes({10.0, 10.1}), modelled = modes({10.0, 10.1});
  measured[0].shape = modelled[1].shape = Eigen::Vector3cd(1, 0.5, -0.2);
  measured[1].shape = modelled[0].shape = Eigen::Vector3cd(0.2, 1, 0.9);
  const auto pairing = pair_modes(measured, modelled);
  EXPECT_EQ(partners(pairing, 2), (std::vector<int>{1, 0}));
  EXPECT_NEAR(pairing[0].mac, 1, 1e-12);
}

// Table 4 of the paper: at 100 and 200 N the second "out-of-plane" row lies at the in-plane
// fundamental (Table 3). Out of plane the modes are those of a taut beam to some per cent, in
// plane the paper's own bond-graph values stand for the model.
TEST(PairModes, CrossPlaneLeakageOfTable4IsRecognised) {
  struct Row {
    std::vector<double> measured, in_plane, out_of_plane;
    std::vector<int> partner;  // index into in_plane then out_of_plane
  };
  // Pinned beam under tension, 2.4 m, with Table 1's EI.
  const auto string_modes = [](double tension, double EI) {
    std::vector<double> result;
    for (int n = 1; n <= 3; ++n) {
      const double k = n * kPi / 2.4;
      result.push_back(k / (2 * kPi) * std::sqrt((tension + EI * k * k) / 0.16667));
    }
    return result;
  };
  const std::vector<Row> rows{
      {{4.73, 6.08, 9.3}, {6.08, 11.30, 17.27}, string_modes(100, 0.4948), {3, 0, 4}},
      {{6.82, 8.11, 14.22}, {7.91, 15.85, 23.72}, string_modes(200, 0.5972), {3, 0, 4}},
      {{2.94, 5.97, 9.19}, {5.55, 8.08, 12.85}, string_modes(25, 0.2549), {3, 4, 5}},
      {{8.64, 17.15, 24.62}, {9.53, 19.38, 29.51}, string_modes(300, 0.8283), {3, 4, 5}},
  };
  for (const auto& row : rows) {
    const auto pairing = pair_modes(
        modes(row.measured, ModePlane::out),
        both(modes(row.in_plane, ModePlane::in), modes(row.out_of_plane, ModePlane::out)));
    const auto found = partners(pairing, 3);
    EXPECT_EQ(found, row.partner) << row.measured[0];
    for (const auto& pair : pairing) EXPECT_EQ(pair.cross_plane, pair.model < 3);
  }
}

TEST(PairModes, OneModelledModeServesBothTests) {
  const auto measured = both(modes({6.33}, ModePlane::in), modes({4.9, 6.08}, ModePlane::out));
  const auto modelled = both(modes({6.2}, ModePlane::in), modes({5.1}, ModePlane::out));
  const auto pairing = pair_modes(measured, modelled);
  EXPECT_EQ(partners(pairing, 3), (std::vector<int>{0, 1, 0}));
  EXPECT_FALSE(pairing[0].cross_plane);
  EXPECT_TRUE(pairing[2].cross_plane);
}

TEST(ShapeCorrelation, IsBlindToScaleAndPhase) {
  const Eigen::Vector3cd a(1, 2, -1);
  EXPECT_NEAR(shape_correlation(a, Complex(0, -3) * a), 1, 1e-15);
  EXPECT_NEAR(shape_correlation(a, Eigen::Vector3cd(1, 0, 1)), 0, 1e-15);
  EXPECT_TRUE(std::isnan(shape_correlation(a, Eigen::Vector2cd(1, 0))));
  EXPECT_TRUE(std::isnan(shape_correlation(a, Eigen::Vector3cd::Zero())));
}

// One pair, one mode between that was not measured, one false one: the sum of the header's terms.
TEST(ModeAssignment, LikelihoodIsTheSumOfItsParts) {
  const AssignmentOptions options;
  const double s = 0.01;
  const auto measured = modes({10, 17, 30}, ModePlane::in);
  const auto result = assign_modes(measured, {s, s, s}, modes({10.1, 20, 30}, ModePlane::in),
                                   std::nullopt, options);
  ASSERT_EQ(result.pairs.size(), 2U);
  EXPECT_EQ(result.unpaired_measured, std::vector<int>{1});
  ASSERT_EQ(result.missed.size(), 1U);
  EXPECT_EQ(result.missed[0].model, 1);
  // All equally visible: the strongest's own visibility.
  const double v = 1 / (1 + options.visible_ratio * options.visible_ratio);
  const double seen = (1 - options.missed) * (options.leaked + (1 - options.leaked) * v);
  const double normal =
      -2 * std::log(s * std::sqrt(2 * kPi)) - 0.5 * std::pow(std::log(1.01) / s, 2);
  const double expected = normal + 2 * std::log((1 - options.false_mode) * seen) +
                          std::log(options.false_mode) + std::log(1 - seen);
  EXPECT_NEAR(result.log_likelihood, expected, 1e-9);
}

// Below the lowest measured mode, too, a visible mode counts as missed; an invisible one hardly,
// and none where the test did not look.
TEST(ModeAssignment, VisibleModesBelowTheMeasuredOnesAreCharged) {
  const AssignmentOptions options;
  const auto measured = modes({10, 20}, ModePlane::in);
  const std::vector<double> stds{0.01, 0.01};
  auto modelled = modes({2, 10, 20}, ModePlane::in);
  for (auto& mode : modelled) mode.visibility = 1;
  const auto charged = assign_modes(measured, stds, modelled, std::nullopt, options);
  EXPECT_NEAR(charged.log_missed, std::log(1 - charged.missed.at(0).probability), 1e-12);
  modelled[0].visibility = 1e-6;
  const auto unseen = assign_modes(measured, stds, modelled, std::nullopt, options);
  EXPECT_NEAR(unseen.log_missed, std::log(1 - (1 - options.missed) * options.leaked), 1e-6);
  EXPECT_TRUE(unseen.missed.empty());
  modelled[0].visibility = 1;
  const auto outside = assign_modes(measured, stds, modelled, {{5, 50}}, options);
  EXPECT_NEAR(outside.log_missed, 0, 1e-9);
}

// Of a test that does not tell the planes apart a peak that they share is missed once.
TEST(ModeAssignment, APeakOfBothPlanesIsMissedOnce) {
  const auto modelled = both(modes({10, 20, 30, 40}, ModePlane::in),
                             modes({10.01, 20.01, 30.01, 40.01}, ModePlane::out));
  const auto found = assign_modes(modes({10, 40}), {1e-3, 1e-3}, modelled, {}, {});
  EXPECT_EQ(found.missed.size(), 2U);
  EXPECT_NEAR(found.log_missed, 2 * std::log(1 - found.missed.at(0).probability), 1e-9);
}

}  // namespace rigfit::ident::mode_pairing_test
