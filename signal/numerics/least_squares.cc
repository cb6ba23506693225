#include "signal/numerics/least_squares.h"

#include <Eigen/QR>
#include <limits>

namespace rigfit::signal {

LeastSquares least_squares(const Eigen::Ref<const Eigen::MatrixXd>& A,
                           const Eigen::Ref<const Eigen::MatrixXd>& y) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
  LeastSquares result;
  result.x = qr.solve(y);
  result.left_sum_squares = (y - A * result.x).colwise().squaredNorm().transpose();
  if (A.cols() > 0) {
    result.condition = qr.rank() < A.cols()
                           ? std::numeric_limits<double>::infinity()
                           : qr.maxPivot() / std::abs(qr.matrixR()(A.cols() - 1, A.cols() - 1));
  }
  return result;
}

}  // namespace rigfit::signal
