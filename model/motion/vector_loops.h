// Loops of explicit_motion.cc as the processor runs them best. Eigen's product for any x86-64 takes
// 1.4 times as long in `rigfit synthesize testdata/jalali2021/scenes/cable.toml` (143 against
// 104 s of processor time, side by side).
#pragma once

#include <Eigen/Core>

namespace rigfit::model {

/// y += A x.
void add_product(const Eigen::MatrixXf& A, const Eigen::VectorXf& x, Eigen::VectorXf& y);

/// out = x + factor y, of n values; `out` may be x or y.
void add_multiple(Eigen::Index n, const double* x, double factor, const double* y, double* out);

}  // namespace rigfit::model
