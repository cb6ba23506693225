// Zeros of a matrix polynomial, as eigenvalues of its block companion matrix.
#pragma once

#include <Eigen/Core>

namespace rigfit::signal {

/// Reciprocals of the zeros z of det(I + A_1 z + ... + A_n z^n). `A`: the blocks A_1 .. A_n one
/// above the other, n size x size. Empty when the eigenvalues do not converge. `left`, if given,
/// gets w of length 1 with w^T (I + A_1 z + ...) = 0 for every zero: size x zeros.
[[nodiscard]] Eigen::VectorXcd reciprocal_zeros(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                                Eigen::Index size,
                                                Eigen::MatrixXcd* left = nullptr);

}  // namespace rigfit::signal
