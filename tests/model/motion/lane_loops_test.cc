#include "model/motion/lane_loops.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <cstring>
#include <random>

#include "tests/expect_matrix.h"

namespace rigfit::model::lane_loops_test {
namespace {

// A member of unit segments, zigzag, stretched by up to `stretch`.
template <int D>
struct Zigzag {
  int segments, rows, slots;
  LaneVector axial, inverse, square, pad, joint, fill, positions, weight;
  explicit Zigzag(int n, double stretch)
      : segments(n), rows(lane_rows(n)), slots(kLanes * rows), positions(size(D), 0) {
    for (LaneVector* all : {&axial, &inverse, &square, &joint, &fill}) all->assign(size(1), 0);
    pad.assign(size(1), 1);
    weight.assign(size(D), 0);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    double x[3] = {};
    for (int i = 0; i <= n; ++i) {
      for (int c = 0; c < D; ++c) positions[at(i) + size(1) * static_cast<std::size_t>(c)] = x[c];
      if (i == n) break;
      const double angle = uniform(random), length = 1 + stretch * uniform(random);
      x[0] += length * std::cos(angle);
      x[1] += length * std::sin(angle);
      axial[at(i)] = 100;
      inverse[at(i)] = square[at(i)] = 1;
      pad[at(i)] = 0;
      joint[at(i)] = 0.3 + 0.1 * uniform(random);
    }
  }
  [[nodiscard]] std::size_t size(int components) const {
    return static_cast<std::size_t>(components) * static_cast<std::size_t>(slots);
  }
  [[nodiscard]] std::size_t at(int node) const {
    return static_cast<std::size_t>(lane_slot(node, rows));
  }
  [[nodiscard]] LaneMember member() const {
    return {rows,       axial.data(), inverse.data(), square.data(),
            pad.data(), joint.data(), joint.data(),   {fill.data(), fill.data(), fill.data()}};
  }
};

struct Loops {
  LaneVector direction, inverse, tension, force;
};

template <int D>
Loops run(const Zigzag<D>& chain, int widest) {
  const LaneLoops<D>& loops = lane_loops<D>(widest);
  Loops out;
  out.direction.assign(chain.size(D), 0);
  out.force.assign(chain.size(D), 0);
  out.inverse.assign(chain.size(1), 0);
  out.tension.assign(chain.size(1), 0);
  LaneScratch scratch;
  for (int c = 0; c < D; ++c) scratch.direction[c] = out.direction.data() + c * chain.slots;
  scratch.inverse = out.inverse.data();
  scratch.tension = out.tension.data();
  loops.tangents(chain.member(), chain.slots, chain.positions.data(), scratch);
  loops.forces(chain.member(), chain.slots, scratch, chain.weight.data(), out.force.data());
  const std::vector<double> diagonal(static_cast<std::size_t>(chain.segments) + 1, 10.0 / 12);
  const std::vector<double> off(static_cast<std::size_t>(chain.segments), 1.0 / 12);
  const LaneFactors factors = lane_factors(diagonal, off, 1, chain.segments - 1, chain.rows);
  const LaneFactors* const each[3] = {&factors, &factors, &factors};
  loops.solve(each, chain.slots, out.force.data());
  return out;
}

template <int D>
void expect_same_bits(int segments, double stretch) {
  const Zigzag<D> chain(segments, stretch);
  const Loops plain = run(chain, 2);
  for (const int widest : {4, 8}) {
    const Loops wide = run(chain, widest);
    const auto same = [](const LaneVector& a, const LaneVector& b) {
      return std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
    };
    EXPECT_TRUE(same(plain.direction, wide.direction)) << segments << " " << widest;
    EXPECT_TRUE(same(plain.tension, wide.tension)) << segments << " " << widest;
    EXPECT_TRUE(same(plain.force, wide.force)) << segments << " " << widest;
  }
}

TEST(LaneLoops, SameBitsWithEveryVectorOfTheProcessor) {
  for (const int segments : {1, 6, 7, 30, 45}) {
    for (const double stretch : {1e-3, 0.2}) {  // the series, square roots
      expect_same_bits<2>(segments, stretch);
      expect_same_bits<3>(segments, stretch);
    }
  }
}

// Up to the largest stretch of the series, 0.6 %, and beyond: forces to rounding, EA times a few
// units in the last place of (L / l)^2 = 1.
TEST(LaneLoops, AxialForcesAndDirections) {
  for (const double stretch : {1e-6, 1e-3, 6e-3, 7e-3, 0.3}) {
    const Zigzag<2> chain(21, stretch);
    const Loops found = run(chain, kLanes);
    for (int i = 0; i < 21; ++i) {
      const std::size_t a = chain.at(i), b = chain.at(i + 1), y = chain.size(1);
      const long double ex = static_cast<long double>(chain.positions[b]) - chain.positions[a];
      const long double ey =
          static_cast<long double>(chain.positions[y + b]) - chain.positions[y + a];
      const long double length = std::sqrt(ex * ex + ey * ey);
      EXPECT_NEAR(found.tension[a], static_cast<double>(100 * (length - 1)), 100 * 6e-16) << i;
      EXPECT_NEAR(found.inverse[a], static_cast<double>(1 / length), 6e-16) << i;
      EXPECT_NEAR(found.direction[y + a], static_cast<double>(ey / length), 6e-16) << i;
    }
  }
}

// Against a dense solution; diagonally dominant as masses are (condition number 1.5) and hardly so
// (some 4 n^2 / pi^2, as where axial waves are slowed).
TEST(LaneLoops, SolvesTridiagonalSystems) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const double dominance : {0.2, 0.9999}) {
    for (int n = 2; n <= 60; n += n < 18 ? 1 : 7) {
      const int rows = lane_rows(n), slots = kLanes * rows;
      std::vector<double> diagonal(static_cast<std::size_t>(n) + 1), off(diagonal.size() - 1);
      for (double& d : diagonal) d = 2 + 0.1 * uniform(random);
      for (std::size_t i = 0; i < off.size(); ++i) {
        off[i] = dominance * std::sqrt(diagonal[i] * diagonal[i + 1]) / 2;
      }
      Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n - 1, n - 1);
      Eigen::VectorXd right(n - 1), found(n - 1);
      LaneVector values(2 * static_cast<std::size_t>(slots), 0);
      for (int i = 0; i < n - 1; ++i) {
        const auto k = static_cast<std::size_t>(i) + 1;
        A(i, i) = diagonal[k];
        if (i > 0) A(i, i - 1) = A(i - 1, i) = off[k - 1];
        right(i) = uniform(random);
        values[static_cast<std::size_t>(lane_slot(i + 1, rows))] = right(i);
      }
      // What stands at nodes outside of the matrix neither matters nor stays.
      values[static_cast<std::size_t>(lane_slot(0, rows))] = 5;
      values[static_cast<std::size_t>(lane_slot(n, rows))] = -7;
      const LaneFactors factors = lane_factors(diagonal, off, 1, n - 1, rows);
      const LaneFactors* const each[2] = {&factors, &factors};
      lane_loops<2>().solve(each, slots, values.data());
      for (int i = 0; i < n - 1; ++i) {
        found(i) = values[static_cast<std::size_t>(lane_slot(i + 1, rows))];
      }
      const Eigen::VectorXd truth = A.partialPivLu().solve(right);
      const double condition = dominance > 0.9 ? 0.5 * n * n : 2;
      EXPECT_TRUE(rigfit::testing::MatricesNear(found, truth,
                                                4e-16 * condition * truth.cwiseAbs().maxCoeff()))
          << n;
      EXPECT_EQ(values[static_cast<std::size_t>(lane_slot(0, rows))], 0);
      EXPECT_EQ(values[static_cast<std::size_t>(lane_slot(n, rows))], 0);
    }
  }
}

}  // namespace
}  // namespace rigfit::model::lane_loops_test
