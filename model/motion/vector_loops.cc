#include "model/motion/vector_loops.h"

// Sanitizers instrument the choice of a clone before they are ready for it.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define RIGFIT_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define RIGFIT_VECTOR_CLONES
#endif

namespace rigfit::model {

RIGFIT_VECTOR_CLONES void add_multiple(int n, const double* x, double factor,
                                       const double* __restrict y, double* out) {
  for (int i = 0; i < n; ++i) out[i] = x[i] + factor * y[i];
}

RIGFIT_VECTOR_CLONES void add_product(int rows, int columns, const double* __restrict A,
                                      const double* __restrict x, double* __restrict y) {
  int c = 0;
  for (; c + 4 <= columns; c += 4) {
    const double *a0 = A, *a1 = a0 + rows, *a2 = a1 + rows, *a3 = a2 + rows;
    const double x0 = x[c], x1 = x[c + 1], x2 = x[c + 2], x3 = x[c + 3];
    for (int i = 0; i < rows; ++i) y[i] += (a0[i] * x0 + a1[i] * x1) + (a2[i] * x2 + a3[i] * x3);
    A = a3 + rows;
  }
  for (; c < columns; ++c, A += rows) {
    for (int i = 0; i < rows; ++i) y[i] += A[i] * x[c];
  }
}

}  // namespace rigfit::model
