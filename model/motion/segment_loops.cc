#include "model/motion/segment_loops.h"

#include <cmath>

// Compiled without errno and floating-point traps (CMakeLists.txt): a square root is then one
// instruction. Sanitizers instrument the choice of a clone before they are ready for it.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define RIGFIT_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define RIGFIT_VECTOR_CLONES
#endif

namespace rigfit::model {

RIGFIT_VECTOR_CLONES void segment_tangents(int n, const double* __restrict x,
                                           const double* __restrict y, const double* __restrict k,
                                           const double* __restrict l, double* __restrict tx,
                                           double* __restrict ty, double* __restrict inverse,
                                           double* __restrict tension) {
  for (int i = 0; i < n; ++i) {
    const double ex = x[i + 1] - x[i], ey = y[i + 1] - y[i];
    const double L = std::sqrt(ex * ex + ey * ey), r = 1 / L;
    tx[i + 1] = ex * r;
    ty[i + 1] = ey * r;
    inverse[i] = r;
    tension[i] = k[i] * (L - l[i]);
  }
}

RIGFIT_VECTOR_CLONES void segment_tangents(int n, const double* __restrict x,
                                           const double* __restrict y, const double* __restrict z,
                                           const double* __restrict k, const double* __restrict l,
                                           double* __restrict tx, double* __restrict ty,
                                           double* __restrict tz, double* __restrict inverse,
                                           double* __restrict tension) {
  for (int i = 0; i < n; ++i) {
    const double ex = x[i + 1] - x[i], ey = y[i + 1] - y[i], ez = z[i + 1] - z[i];
    const double L = std::sqrt(ex * ex + ey * ey + ez * ez), r = 1 / L;
    tx[i + 1] = ex * r;
    ty[i + 1] = ey * r;
    tz[i + 1] = ez * r;
    inverse[i] = r;
    tension[i] = k[i] * (L - l[i]);
  }
}

RIGFIT_VECTOR_CLONES void segment_forces(int n, const double* __restrict joint,
                                         const double* __restrict inverse,
                                         const double* __restrict tension,
                                         const double* __restrict tx, const double* __restrict ty,
                                         double* __restrict fx, double* __restrict fy) {
  for (int i = 0; i < n; ++i) {
    const double gx = joint[i] * tx[i] + joint[i + 1] * tx[i + 2];
    const double gy = joint[i] * ty[i] + joint[i + 1] * ty[i + 2];
    const double along = tension[i] + (gx * tx[i + 1] + gy * ty[i + 1]) * inverse[i];
    fx[i] = along * tx[i + 1] - gx * inverse[i];
    fy[i] = along * ty[i + 1] - gy * inverse[i];
  }
}

RIGFIT_VECTOR_CLONES void segment_forces(int n, const double* __restrict joint,
                                         const double* __restrict inverse,
                                         const double* __restrict tension,
                                         const double* __restrict tx, const double* __restrict ty,
                                         const double* __restrict tz, double* __restrict fx,
                                         double* __restrict fy, double* __restrict fz) {
  for (int i = 0; i < n; ++i) {
    const double gx = joint[i] * tx[i] + joint[i + 1] * tx[i + 2];
    const double gy = joint[i] * ty[i] + joint[i + 1] * ty[i + 2];
    const double gz = joint[i] * tz[i] + joint[i + 1] * tz[i + 2];
    const double along =
        tension[i] + (gx * tx[i + 1] + gy * ty[i + 1] + gz * tz[i + 1]) * inverse[i];
    fx[i] = along * tx[i + 1] - gx * inverse[i];
    fy[i] = along * ty[i + 1] - gy * inverse[i];
    fz[i] = along * tz[i + 1] - gz * inverse[i];
  }
}

RIGFIT_VECTOR_CLONES void node_forces(int n, const double* __restrict f,
                                      const double* __restrict weight, double* __restrict a) {
  for (int i = 1; i < n; ++i) a[i] = f[i] - f[i - 1] + weight[i];
}

RIGFIT_VECTOR_CLONES void add_multiple(int n, const double* x, double factor,
                                       const double* __restrict y, double* out) {
  for (int i = 0; i < n; ++i) out[i] = x[i] + factor * y[i];
}

RIGFIT_VECTOR_CLONES void kick_and_drift(int n, double half, double h, const double* __restrict a,
                                         double* __restrict v, double* __restrict q) {
  for (int i = 0; i < n; ++i) {
    v[i] += half * a[i];
    q[i] += h * v[i];
  }
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

namespace {

// Each of `Count` systems keeps its last values of both sides in registers, so that 2 Count chains
// of dependent operations run side by side. All have the same m and middle.
template <int Count>
void solve_side_by_side(const TwistedFactors* const* f, double* const* a) {
  const int m = f[0]->m, k = f[0]->middle;
  if (m <= 0) return;
  double left[Count], right[Count];
  for (int c = 0; c < Count; ++c) left[c] = a[c][1], right[c] = a[c][m];
  const int pairs = k - 2 < m - k - 1 ? k - 2 : m - k - 1;
  int i = 2, j = m - 1;
  for (int step = 0; step < pairs; ++step, ++i, --j) {
    for (int c = 0; c < Count; ++c) {
      a[c][i] = left[c] = a[c][i] - f[c]->toward[i - 1] * left[c];
      a[c][j] = right[c] = a[c][j] - f[c]->toward[j] * right[c];
    }
  }
  for (; i < k; ++i) {
    for (int c = 0; c < Count; ++c) a[c][i] -= f[c]->toward[i - 1] * a[c][i - 1];
  }
  for (; j > k; --j) {
    for (int c = 0; c < Count; ++c) a[c][j] -= f[c]->toward[j] * a[c][j + 1];
  }
  for (int c = 0; c < Count; ++c) {
    double value = a[c][k];
    if (k > 1) value -= f[c]->toward[k - 1] * a[c][k - 1];
    if (k < m) value -= f[c]->toward[k] * a[c][k + 1];
    a[c][k] = left[c] = right[c] = value * f[c]->inverse[k];
  }
  i = k - 1, j = k + 1;
  for (; i > 0 && j <= m; --i, ++j) {
    for (int c = 0; c < Count; ++c) {
      a[c][i] = left[c] = a[c][i] * f[c]->inverse[i] - f[c]->toward[i] * left[c];
      a[c][j] = right[c] = a[c][j] * f[c]->inverse[j] - f[c]->toward[j - 1] * right[c];
    }
  }
  for (; i > 0; --i) {
    for (int c = 0; c < Count; ++c) {
      a[c][i] = a[c][i] * f[c]->inverse[i] - f[c]->toward[i] * a[c][i + 1];
    }
  }
  for (; j <= m; ++j) {
    for (int c = 0; c < Count; ++c) {
      a[c][j] = a[c][j] * f[c]->inverse[j] - f[c]->toward[j - 1] * a[c][j - 1];
    }
  }
}

}  // namespace

void solve_twisted(const TwistedFactors& f, double* a) {
  const TwistedFactors* factors[] = {&f};
  double* const right[] = {a};
  solve_side_by_side<1>(factors, right);
}

void solve_twisted(const TwistedFactors& f, const TwistedFactors& g, double* a, double* b) {
  const TwistedFactors* factors[] = {&f, &g};
  double* const right[] = {a, b};
  solve_side_by_side<2>(factors, right);
}

void solve_twisted(const TwistedFactors& f, const TwistedFactors& g, const TwistedFactors& h,
                   double* a, double* b, double* c) {
  const TwistedFactors* factors[] = {&f, &g, &h};
  double* const right[] = {a, b, c};
  solve_side_by_side<3>(factors, right);
}

}  // namespace rigfit::model
