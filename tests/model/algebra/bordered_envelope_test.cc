#include "model/algebra/bordered_envelope.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "model/linear/modes.h"
#include "tests/expect_matrix.h"
#include "tests/reference/utility_line.h"

namespace rigfit::model::bordered_envelope_test {
namespace {

TEST(BorderedEnvelope, IsTheDenseSystem) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  constexpr int kSize = 40;
  std::vector<int> first(kSize);
  for (int i = 0; i < kSize; ++i) first[std::size_t(i)] = std::max(0, i - 1 - i % 4);
  EnvelopeMatrix k(Envelope::from_rows(first));
  for (int i = 0; i < kSize; ++i) {
    k.add(i, i, 6);
    for (int j = first[std::size_t(i)]; j < i; ++j) k.add(i, j, uniform(random));
  }
  // Two runs that end together, one inside another, one at the end.
  std::vector<BorderRun> runs{{3, {}, {}, -2}, {8, {}, {}, 3}, {10, {}, {}, -4}, {31, {}, {}, 2}};
  const int lengths[] = {14, 9, 3, 9};
  const int n = kSize + 4;
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
  dense.topLeftCorner(kSize, kSize) = k.dense();
  for (int i = 0; i < 4; ++i) {
    BorderRun& run = runs[std::size_t(i)];
    run.column.resize(lengths[i]);
    run.row.resize(lengths[i]);
    for (int c = 0; c < lengths[i]; ++c) {
      dense(run.first + c, kSize + i) = run.column[c] = uniform(random);
      dense(kSize + i, run.first + c) = run.row[c] = uniform(random);
    }
    dense(kSize + i, kSize + i) = run.diagonal;
  }
  BorderedEnvelope bordered(k.envelope(), runs);
  ASSERT_TRUE(bordered.factor(k, runs, 1e-12));
  Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(kSize, -1, 1), y(4);
  y << 1, -2, 3, 0.5;
  Eigen::VectorXd right(n);
  right << x, y;
  bordered.solve_in_place(x, y);
  Eigen::VectorXd found(n);
  found << x, y;
  // Rounding times the condition of a diagonally dominant system of 44.
  EXPECT_LT((dense * found - right).cwiseAbs().maxCoeff(), 1e-12);

  // Two border rows that are equal are singular.
  runs[1].diagonal = 0;
  runs[2] = runs[1];
  BorderedEnvelope twice(k.envelope(), runs);
  EXPECT_FALSE(twice.factor(k, runs, 1e-9));
}

// Twelve tensioned spans in a row, more than are solved for one by one, and six.
TEST(BorderedEnvelope, LongLineHasItsTensions) {
  for (const int poles : {5, 11}) {
    Scene line = apps::utility_line(poles, 20, 6);
    std::vector<double> tension;
    for (Member& member : line.members) {  // unlike spans bend the poles between them
      if (member.tension)
        tension.push_back(*(member.tension = 3000 + 150.0 * (tension.size() % 3)));
    }
    const ChainModes prepared = prepare_motions(line, {});
    ASSERT_EQ(prepared.equilibrium.status, EquilibriumStatus::converged) << poles;
    EXPECT_LT(prepared.equilibrium.residual, 1e-9);
    std::size_t span = 0;
    for (const auto& member : describe(*prepared.chain, prepared.equilibrium, line).members) {
      if (member.member.rfind("conductor", 0) != 0) continue;
      ASSERT_LT(span, tension.size());
      // The residual, 1e-9 of the largest force, is also that of the tensions.
      EXPECT_NEAR(member.tension_N, tension[span++], 3000 * 1e-8) << member.member;
    }
    EXPECT_EQ(span, std::size_t(poles + 1));
  }
}

}  // namespace
}  // namespace rigfit::model::bordered_envelope_test
