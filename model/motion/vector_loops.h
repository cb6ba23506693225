// A dense product as the processor runs it best (AVX-512). Eigen's for any x86-64 in its place
// takes 1.4 times as long in `rigfit synthesize testdata/jalali2021/scenes/cable.toml` (143 against
// 104 s of processor time, side by side).
#pragma once

#include <Eigen/Core>

namespace rigfit::model {

/// y += A x.
void add_product(const Eigen::MatrixXf& A, const Eigen::VectorXf& x, Eigen::VectorXf& y);

}  // namespace rigfit::model
