#include <Eigen/Cholesky>

#include "model/chain/index.h"
#include "model/motion/lane_loops.h"

namespace rigfit::model {
namespace {

// A lane's rows but the last: pivots, and the corners of their inverse.
struct LaneCorners {
  double first = 0, last = 0, across = 0;
};

}  // namespace

LaneFactors lane_factors(const std::vector<double>& diagonal, const std::vector<double>& off,
                         int first, int last, int rows) {
  LaneFactors out;
  out.rows = rows;
  for (LaneVector* all : {&out.toward, &out.inverse, &out.from_before, &out.from_behind}) {
    all->assign(at(kLanes * rows), 0);
  }
  // Off-diagonals between a lane's last row but one and its last, the last and the next lane's
  // first.
  double before[kLanes] = {}, behind[kLanes] = {};
  const auto inside = [&](int node) { return node >= first && node <= last; };
  const auto coupling = [&](int node) {  // to the node behind
    return inside(node) && inside(node + 1) ? off[at(node)] : 0;
  };
  const int rest = rows - 1;  // rows that are eliminated in each lane
  LaneCorners corner[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) {
    const int node = lane * rows;
    const auto slot = [&](int row) { return at(kLanes * row + lane); };
    for (int r = 0; r < rest; ++r) {
      if (!inside(node + r)) continue;
      double pivot = diagonal[at(node + r)];
      if (r > 0) {
        out.toward[slot(r)] = coupling(node + r - 1) * out.inverse[slot(r - 1)];
        pivot -= coupling(node + r - 1) * out.toward[slot(r)];
      }
      out.inverse[slot(r)] = 1 / pivot;
    }
    // Columns of the inverse for the first row and the last.
    std::vector<double> of_first(at(rest), 0), of_last(at(rest), 0);
    for (int column = 0; column < 2 && rest > 0; ++column) {
      std::vector<double>& y = column == 0 ? of_first : of_last;
      y[column == 0 ? 0 : at(rest - 1)] = 1;
      for (int r = 1; r < rest; ++r) y[at(r)] -= out.toward[slot(r)] * y[at(r - 1)];
      for (int r = rest - 1; r >= 0; --r) {
        y[at(r)] *= out.inverse[slot(r)];
        if (r + 1 < rest) y[at(r)] -= out.toward[slot(r + 1)] * y[at(r + 1)];
      }
    }
    const double from_before = lane > 0 && rest > 0 ? coupling(node - 1) : 0;
    if (rest > 0) before[lane] = coupling(node + rest - 1);
    behind[lane] = coupling(node + rest);
    for (int r = 0; r < rest; ++r) {
      out.from_before[slot(r)] = from_before * of_first[at(r)];
      out.from_behind[slot(r)] = before[lane] * of_last[at(r)];
    }
    if (rest > 0) corner[lane] = {of_first.front(), of_last.back(), of_first.back()};
  }
  Eigen::Matrix<double, kLanes, kLanes> schur = Eigen::Matrix<double, kLanes, kLanes>::Zero();
  for (int lane = 0; lane < kLanes; ++lane) {
    const int node = lane * rows + rest;
    schur(lane, lane) = 1;
    if (!inside(node)) continue;
    schur(lane, lane) = diagonal[at(node)] - before[lane] * before[lane] * corner[lane].last;
    if (lane + 1 == kLanes || behind[lane] == 0) continue;
    if (rest == 0) {
      schur(lane, lane + 1) = schur(lane + 1, lane) = behind[lane];
      continue;
    }
    schur(lane, lane) -= behind[lane] * behind[lane] * corner[lane + 1].first;
    schur(lane, lane + 1) = schur(lane + 1, lane) =
        -behind[lane] * corner[lane + 1].across * before[lane + 1];
  }
  const Eigen::Matrix<double, kLanes, kLanes> inverse =
      schur.llt().solve(Eigen::Matrix<double, kLanes, kLanes>::Identity());
  out.separators.assign(at(kLanes * kLanes), 0);
  for (int lane = 0; lane < kLanes; ++lane) {
    for (int k = 0; k < kLanes; ++k) {
      const int other = (lane + k) % kLanes;
      if (inside(lane * rows + rest) && inside(other * rows + rest)) {
        out.separators[at(kLanes * k + lane)] = inverse(lane, other);
      }
    }
  }
  return out;
}

}  // namespace rigfit::model
