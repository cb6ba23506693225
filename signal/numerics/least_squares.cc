#include "signal/numerics/least_squares.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

namespace rigfit::signal {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Modified Gram-Schmidt, each column made orthogonal to those before it twice: as orthogonal as
// reflections make it (Giraud, Langou, Rozloznik, Comput. Math. Appl. 50 (2005) 1069).
LeastSquares least_squares(const Eigen::Ref<const MatrixXd>& A,
                           const Eigen::Ref<const MatrixXd>& y) {
  const Index columns = A.cols();
  MatrixXd Q = A;
  MatrixXd R = MatrixXd::Zero(columns, columns);
  std::vector<Index> order(static_cast<std::size_t>(columns));
  std::iota(order.begin(), order.end(), Index{0});
  Index rank = 0;
  double first = 0;
  for (; rank < std::min(columns, A.rows()); ++rank) {
    Index pivot = rank;
    Q.rightCols(columns - rank).colwise().squaredNorm().maxCoeff(&pivot);
    pivot += rank;
    Q.col(rank).swap(Q.col(pivot));
    R.col(rank).swap(R.col(pivot));
    std::swap(order[static_cast<std::size_t>(rank)], order[static_cast<std::size_t>(pivot)]);
    const VectorXd again = Q.leftCols(rank).transpose() * Q.col(rank);
    Q.col(rank) -= Q.leftCols(rank) * again;
    R.col(rank).head(rank) += again;
    const double length = Q.col(rank).norm();
    if (rank == 0) first = length;
    if (!(length > static_cast<double>(A.rows()) * std::numeric_limits<double>::epsilon() * first))
      break;
    R(rank, rank) = length;
    Q.col(rank) /= length;
    const Index rest = columns - rank - 1;
    R.row(rank).tail(rest) = Q.col(rank).transpose() * Q.rightCols(rest);
    Q.rightCols(rest) -= Q.col(rank) * R.row(rank).tail(rest);
  }
  LeastSquares result;
  result.condition = rank < columns ? std::numeric_limits<double>::infinity()
                     : columns > 0  ? R(0, 0) / R(columns - 1, columns - 1)
                                    : 0;
  MatrixXd z = Q.leftCols(rank).transpose() * y;
  result.x = MatrixXd::Zero(columns, y.cols());
  for (Index c = 0; c < y.cols(); ++c) {
    for (Index r = rank; r-- > 0;) {
      const double behind =
          R.row(r).segment(r + 1, rank - r - 1).dot(z.col(c).segment(r + 1, rank - r - 1));
      z(r, c) = (z(r, c) - behind) / R(r, r);
      result.x(order[static_cast<std::size_t>(r)], c) = z(r, c);
    }
  }
  result.left_sum_squares = (y - A * result.x).colwise().squaredNorm().transpose();
  return result;
}

}  // namespace rigfit::signal
