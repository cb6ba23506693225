#include "model/motion/vector_loops.h"

// Sanitizers instrument the choice of a clone before they are ready for it.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define RIGFIT_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define RIGFIT_VECTOR_CLONES
#endif

namespace rigfit::model {
namespace {

RIGFIT_VECTOR_CLONES void add_columns(Eigen::Index rows, Eigen::Index columns, const float* A,
                                      const float* x, float* __restrict y) {
  Eigen::Index c = 0;
  for (; c + 4 <= columns; c += 4, A += 4 * rows) {
    const float *a1 = A + rows, *a2 = a1 + rows, *a3 = a2 + rows;
    const float x0 = x[c], x1 = x[c + 1], x2 = x[c + 2], x3 = x[c + 3];
    for (Eigen::Index i = 0; i < rows; ++i) {
      y[i] += (A[i] * x0 + a1[i] * x1) + (a2[i] * x2 + a3[i] * x3);
    }
  }
  for (; c < columns; ++c, A += rows) {
    for (Eigen::Index i = 0; i < rows; ++i) y[i] += A[i] * x[c];
  }
}

}  // namespace

void add_product(const Eigen::MatrixXf& A, const Eigen::VectorXf& x, Eigen::VectorXf& y) {
  add_columns(A.rows(), A.cols(), A.data(), x.data(), y.data());
}

}  // namespace rigfit::model
