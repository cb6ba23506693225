#include "model/algebra/envelope_matrix.h"
#include "model/chain/index.h"
#include "model/motion/lane_loops.h"

namespace rigfit::model {

LaneFactors lane_factors(const std::vector<double>& diagonal, const std::vector<double>& off,
                         int first, int last, int rows) {
  LaneFactors out;
  out.rows = rows;
  for (LaneVector* all : {&out.toward, &out.inverse, &out.from_before, &out.from_behind}) {
    all->assign(at(kLanes * rows), 0);
  }
  const auto inside = [&](int node) { return node >= first && node <= last; };
  const auto coupling = [&](int node) {  // to the node behind
    return inside(node) && inside(node + 1) ? off[at(node)] : 0;
  };
  const int rest = rows - 1;  // rows that are eliminated in each lane
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
    for (int r = 0; r < rest; ++r) {
      out.from_before[slot(r)] = from_before * of_first[at(r)];
      out.from_behind[slot(r)] = coupling(node + rest - 1) * of_last[at(r)];
    }
  }
  // The inverse of the separators' Schur complement is their part of the whole inverse.
  std::vector<int> begin(at(kLanes * rows), 0);
  for (int node = 1; node < kLanes * rows; ++node) begin[at(node)] = node - 1;
  EnvelopeMatrix whole(Envelope::from_rows(std::move(begin)));
  for (int node = 0; node < kLanes * rows; ++node) {
    whole.add(node, node, inside(node) ? diagonal[at(node)] : 1);
    if (node > 0) whole.add(node, node - 1, coupling(node - 1));
  }
  EnvelopeFactor factor;
  factor.factor(whole);
  out.separators.assign(at(kLanes * kLanes), 0);
  for (int lane = 0; lane < kLanes; ++lane) {
    const int own = lane * rows + rest;
    Eigen::VectorXd column = Eigen::VectorXd::Unit(kLanes * rows, own);
    factor.solve_in_place(column);
    for (int k = 0; k < kLanes; ++k) {
      const int other = (lane + k) % kLanes * rows + rest;
      if (inside(own) && inside(other)) out.separators[at(kLanes * k + lane)] = column(other);
    }
  }
  return out;
}

}  // namespace rigfit::model
