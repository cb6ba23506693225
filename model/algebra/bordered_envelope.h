// A symmetric envelope matrix with a border of few unknowns, each coupled to a run of unknowns
// only:
//
//   [ K   B ] [x]   [r]
//   [ G'  D ] [y] = [s]      K n x n symmetric, B and G n x k, D diagonal
//
// Solving K for every column of B costs n k. Here each border unknown is put among the others,
// right after the last one it is coupled to, and the whole is factored as L U without pivoting in
// the envelope that results: time grows with n and the lengths of the runs, not with their product.
// (A. George and J. W. Liu, Computer Solution of Large Sparse Positive Definite Systems, ch. 4:
// what an envelope fills.)
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "model/algebra/envelope_matrix.h"

namespace rigfit::model {

/// Unknowns `first` to `first + column.size() - 1`.
struct BorderRun {
  int first = 0;
  Eigen::VectorXd column;  ///< of B
  Eigen::VectorXd row;     ///< of G, the same run
  double diagonal = 0;     ///< of D
};

class BorderedEnvelope {
 public:
  /// The runs' places must stay the same from one factorisation to the next; their values may
  /// change.
  BorderedEnvelope(std::shared_ptr<const Envelope> envelope, const std::vector<BorderRun>& runs);

  /// False when a pivot is below `singular` times the largest term it came from: the factor is then
  /// not to be used.
  bool factor(const EnvelopeMatrix& k, const std::vector<BorderRun>& runs, double singular);
  /// (r, s) -> (x, y), in place.
  void solve_in_place(Eigen::VectorXd& x, Eigen::VectorXd& y) const;

 private:
  std::shared_ptr<const Envelope> inner_;
  std::shared_ptr<const Envelope> whole_;
  std::vector<int> place_;         // place of each unknown of K in the whole
  std::vector<int> border_place_;  // place of each border unknown in the whole
  Eigen::VectorXd lower_, upper_;  // by rows of L and by columns of U, in the whole's envelope
  Eigen::VectorXd pivot_;
  mutable Eigen::VectorXd work_;
};

}  // namespace rigfit::model
