// Lowest (or nearest to a shift) eigenpairs of K x = lambda M x, K symmetric positive definite, M
// symmetric and possibly singular (unknowns without inertia), both in envelope storage.
//
// Lanczos on (K - sigma M)^-1 M in the M inner product with full reorthogonalisation (T. Ericsson
// and A. Ruhe, Math. Comp. 35, 1980). Unknowns without inertia are eliminated exactly: they belong
// to infinite eigenvalues, which the operator maps to zero. A Sturm count (negative pivots of
// K - mu M) proves that none was missed; where one was, as happens with equal eigenvalues, the
// space is extended by a new random vector until the count agrees. Where many eigenvalues crowd
// together, as in a long line of like spans, the range is cut by Sturm counts into slices of a few
// dozen with a shift in each (R. G. Grimes, J. G. Lewis, H. D. Simon, SIAM J. Matrix Anal. Appl.
// 15, 1994), so that time grows with the number of unknowns and not with the crowd.
#pragma once

#include "model/algebra/envelope_matrix.h"
#include "model/algebra/numbers.h"

namespace rigfit::model {

struct Eigenpairs {
  VectorXd values;        ///< rising
  MatrixXd vectors;       ///< unknowns x pairs, x' M x = 1
  bool complete = false;  ///< a Sturm count agrees
  int steps = 0;
};

/// Number of eigenvalues below `mu`.
[[nodiscard]] int count_below(const EnvelopeMatrix& k, const EnvelopeMatrix& m, double mu);
/// The `count` lowest (fewer when there are no more).
[[nodiscard]] Eigenpairs lowest_eigenpairs(const EnvelopeMatrix& k, const EnvelopeMatrix& m,
                                           int count);
/// All with low <= lambda <= high.
[[nodiscard]] Eigenpairs eigenpairs_between(const EnvelopeMatrix& k, const EnvelopeMatrix& m,
                                            double low, double high);

/// All eigenvalues and eigenvectors of a real square matrix: Eigen's solver, its templates compiled
/// once.
struct GeneralEigenpairs {
  VectorXcd values;
  MatrixXcd vectors;      ///< columns
  MatrixXcd coordinates;  ///< vectors^-1 right: `right` expressed in the vectors
};
/// `right` may have no columns.
[[nodiscard]] GeneralEigenpairs general_eigenpairs(const MatrixXd& matrix, const MatrixXd& right);

}  // namespace rigfit::model
