// The loops in which explicit time integration spends its time, over arrays of one member: plain
// element-wise arithmetic that the compiler turns into full vectors, compiled for AVX2 too where
// the machine has it (without fused multiply-add, so that the numbers are the same everywhere).
//
// Arrays hold n segments, n + 1 nodes, or n + 2 directions: those of the segments with the end
// joints' node sides before and behind. No two arrays may overlap.
#pragma once

namespace rigfit::model {

/// Directions (into t[1..n]), 1/L and axial force k (L - l) of every segment.
void segment_tangents(int n, const double* x, const double* y, const double* k, const double* l,
                      double* tx, double* ty, double* inverse, double* tension);
void segment_tangents(int n, const double* x, const double* y, const double* z, const double* k,
                      const double* l, double* tx, double* ty, double* tz, double* inverse,
                      double* tension);

/// dV/de = N t - (I - t t') g / L of every segment, g = joint[i] t[i - 1] + joint[i + 1] t[i + 1].
void segment_forces(int n, const double* joint, const double* inverse, const double* tension,
                    const double* tx, const double* ty, double* fx, double* fy);
void segment_forces(int n, const double* joint, const double* inverse, const double* tension,
                    const double* tx, const double* ty, const double* tz, double* fx, double* fy,
                    double* fz);

/// a[i] = f[i] - f[i - 1] + weight[i] of the inner nodes, 0 < i < n.
void node_forces(int n, const double* f, const double* weight, double* a);

/// out = x + factor y; `out` may be x.
void add_multiple(int n, const double* x, double factor, const double* y, double* out);
/// v += half a, q += h v.
void kick_and_drift(int n, double half, double h, const double* a, double* v, double* q);

/// y += A x, A of rows x columns stored column after column.
void add_product(int rows, int columns, const double* A, const double* x, double* y);

/// Factors of a symmetric tridiagonal matrix of the inner nodes 1..m from both ends to the middle,
/// which halves the chain of dependent operations.
struct TwistedFactors {
  int m = 0, middle = 0;
  const double* toward = nullptr;   ///< [i] between i and i + 1: multiplier towards the middle
  const double* inverse = nullptr;  ///< of the pivots
};
/// a[1..m] = A^-1 a; several right-hand sides at once, each with its own factors.
void solve_twisted(const TwistedFactors& f, double* a);
void solve_twisted(const TwistedFactors& f, const TwistedFactors& g, double* a, double* b);
void solve_twisted(const TwistedFactors& f, const TwistedFactors& g, const TwistedFactors& h,
                   double* a, double* b, double* c);

}  // namespace rigfit::model
