#include "model/motion/lane_loops.h"

#include "tests/test.h"

#include <cstring>

namespace rigfit::model::lane_loops_test {

// A member of unit segments, zigzag, stretched by up to `stretch`.
template <int D>
struct Zigzag {
  LaneMember member;
  int segments, slots;
  LaneVector positions, weight;
  explicit Zigzag(int n, double stretch)
      : segments(n), slots(kLanes * lane_rows(n)), positions(size(D), 0), weight(size(D), 0) {
    member.rows = lane_rows(n);
    for (LaneVector* all : {&member.axial, &member.inverse_length, &member.joint_before,
                            &member.fill[0], &member.fill[1], &member.fill[2]}) {
      all->assign(size(1), 0);
    }
    member.pad.assign(size(1), 1);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    double x[3] = {};
    for (int i = 0; i <= n; ++i) {
      const auto slot = static_cast<std::size_t>(lane_slot(i, member.rows));
      for (int c = 0; c < D; ++c) positions[slot + size(1) * static_cast<std::size_t>(c)] = x[c];
      if (i == n) break;
      const double angle = uniform(random), length = 1 + stretch * uniform(random);
      x[0] += length * std::cos(angle);
      x[1] += length * std::sin(angle);
      member.axial[slot] = 100;
      member.inverse_length[slot] = 1;
      member.pad[slot] = 0;
      member.joint_before[slot] = 0.3 + 0.1 * uniform(random);
    }
    member.inverse_square = member.inverse_length;
    member.joint_behind = member.joint_before;
  }
  [[nodiscard]] std::size_t size(int components) const {
    return static_cast<std::size_t>(components) * static_cast<std::size_t>(slots);
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
  loops.tangents(chain.member, chain.slots, chain.positions.data(), scratch);
  loops.forces(chain.member, chain.slots, scratch, chain.weight.data(), out.force.data());
  const std::vector<double> diagonal(static_cast<std::size_t>(chain.segments) + 1, 10.0 / 12);
  const std::vector<double> off(static_cast<std::size_t>(chain.segments), 1.0 / 12);
  const LaneFactors factors = lane_factors(diagonal, off, 1, chain.segments - 1, chain.member.rows);
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
    expect_same_bits<2>(segments, 0.2);
    expect_same_bits<3>(segments, 0.2);
  }
}

}  // namespace rigfit::model::lane_loops_test
