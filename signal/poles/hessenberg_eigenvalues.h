// Eigenvalues alone of real upper Hessenberg matrices: implicit double shifts (Francis).
//
// Each step reflects the rows and columns of the block that has not split off yet, and no others.
// Eigen's solver transforms those beside it as well, as a Schur form needs; its eigenvalues are the
// same bits at twice to three times the cost. Source: Golub, Van Loan, Matrix Computations, 4th
// ed., sec. 7.5; shifts and tests of convergence are those of Eigen's RealSchur.
#pragma once

#include <Eigen/Core>

namespace rigfit::signal {

/// Of `scale` H; entries below the first subdiagonal of `H` count as 0. Pairs lie together, the
/// positive imaginary part first. Empty when they do not converge.
[[nodiscard]] Eigen::VectorXcd hessenberg_eigenvalues(Eigen::MatrixXd H, double scale = 1);

}  // namespace rigfit::signal
