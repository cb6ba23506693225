#include "signal/numerics/least_squares.h"

#include <Eigen/QR>

namespace rigfit::signal {

double least_sum_squares(const Eigen::Ref<const Eigen::MatrixXd>& A,
                         const Eigen::Ref<const Eigen::VectorXd>& y) {
  return (y - A * A.colPivHouseholderQr().solve(y)).squaredNorm();
}

}  // namespace rigfit::signal
