#include "signal/poles/pole_clusters.h"

#include "tests/test.h"

namespace rigfit::signal::pole_clusters_test {

/// Orders 1..40: `modes` from an order on with scatter (of their half bandwidth), and poles
/// anywhere.
LscfResult diagram(const std::vector<Complex>& modes, int from, double scatter, int stray,
                   unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  LscfResult result{.orders_solved = 40};
  for (int order = 1; order <= 40; ++order) {
    if (order >= from) {
      for (const Complex& p : modes) {
        const double size = scatter * std::abs(p.real());
        result.poles.push_back(
            {order, p + size * Complex(normal(random), normal(random)), 0, 0, false, false});
      }
    }
    for (int i = 0; i < stray; ++i) {
      result.poles.push_back(
          {order, Complex(-20 * uniform(random), 5000 * uniform(random)), 0, 0, false, false});
    }
  }
  return result;
}

TEST(PoleClusters, TwoCloseModesAreTwo) {
  // 312 and 318 Hz at 0.3 %: resonances 3 half bandwidths apart.
  const Complex a(-5.9, 1960.4), b(-7.0, 1998.0);
  const auto clusters = cluster_poles(diagram({a, b}, 8, 0.03, 2, 1), 0.25);
  ASSERT_EQ(clusters.size(), 2u);
  // Medians of 20 with 3 % scatter: 0.03 * 1.25 / sqrt(20) = 0.8 % of a half bandwidth, four times.
  EXPECT_LT(std::abs(clusters[0].pole_rad_s - a), 0.035 * 5.9 * 1.5);
  EXPECT_LT(std::abs(clusters[1].pole_rad_s - b), 0.035 * 7.0 * 1.5);
  EXPECT_EQ(clusters[0].presence, 1);
  // Both parts scatter: sqrt(2) of 3 %.
  EXPECT_NEAR(clusters[0].scatter, 0.042, 0.02);
}

TEST(PoleClusters, StrayPolesAreNone) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    EXPECT_TRUE(cluster_poles(diagram({}, 1, 0, 6, seed), 0.25).empty()) << seed;
  }
}

TEST(PoleClusters, PresenceIsTheShareOfTheUpperHalf) {
  const auto late = cluster_poles(diagram({Complex(-5, 1000)}, 31, 0.01, 0, 1), 0.25);
  ASSERT_EQ(late.size(), 1u);
  EXPECT_EQ(late[0].presence, 0.5);
  // 7 of the upper 20 orders, less than 0.4 of them.
  EXPECT_TRUE(cluster_poles(diagram({Complex(-5, 1000)}, 34, 0.01, 0, 1), 0.25).empty());
  EXPECT_TRUE(cluster_poles({}, 0.25).empty());
}

TEST(PoleClusters, BelowTheLineSpacingPolesAreNotToldApart) {
  // Lines 10 Hz apart and half bandwidths of 1e-3 rad/s: the same mode found 1 rad/s apart.
  const auto clusters = cluster_poles(diagram({Complex(-1e-3, 1000)}, 5, 1000, 0, 3), 10);
  EXPECT_EQ(clusters.size(), 1u);
}

}  // namespace rigfit::signal::pole_clusters_test
