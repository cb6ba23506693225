#include "signal/poles/hessenberg_eigenvalues.h"

#include <Eigen/Householder>
#include <Eigen/Jacobi>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

namespace rigfit::signal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Complex = std::complex<double>;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Rows and columns `first` to `last`: what has not split off.
struct Active {
  Index first = 0, last = 0;
};

/// I - tau (1, e) (1, e)' from both sides on rows and columns k to k + N - 1.
template <int N>
void reflect(MatrixXd& T, Index k, Active active, const Eigen::Vector<double, N - 1>& e,
             double tau) {
  const Eigen::Vector<double, N - 1> scaled = tau * e;
  for (Index j = k; j <= active.last; ++j) {
    double* const t = &T(k, j);
    double sum = e[0] * t[1];
    if constexpr (N == 3) sum += e[1] * t[2];
    sum += t[0];
    t[0] -= tau * sum;
    for (int i = 1; i < N; ++i) t[i] -= scaled[i - 1] * sum;
  }
  const Index rows = std::min(active.last, k + 3) + 1 - active.first;
  double* const a = &T(active.first, k);
  double* const b = a + T.rows();
  double* const c = N == 3 ? b + T.rows() : b;
#pragma GCC ivdep
  for (Index i = 0; i < rows; ++i) {
    double sum = b[i] * e[0];
    if constexpr (N == 3) sum += c[i] * e[1];
    sum = tau * (sum + a[i]);
    a[i] -= sum;
    b[i] -= sum * e[0];
    if constexpr (N == 3) c[i] -= sum * e[1];
  }
}

/// The first row of the active block, at whose left a subdiagonal entry is negligible.
Index first_of_block(const MatrixXd& T, Index last, double negligible) {
  Index first = last;
  for (; first > 0; --first) {
    const double around = std::abs(T(first - 1, first - 1)) + std::abs(T(first, first));
    if (std::abs(T(first, first - 1)) <= std::max(around * kEpsilon, negligible)) break;
  }
  return first;
}

/// Two diagonal entries and the product of the others of the trailing 2 x 2 block; after 10 and 30
/// steps without convergence the matrix is shifted by a value of chance, which `shifted` sums.
Vector3d shifts_of(MatrixXd& T, Index last, Index step, double& shifted) {
  Vector3d shift(T(last, last), T(last - 1, last - 1), T(last, last - 1) * T(last - 1, last));
  if (step == 10) {
    shifted += shift[0];
    T.diagonal().head(last + 1).array() -= shift[0];
    const double s = std::abs(T(last, last - 1)) + std::abs(T(last - 1, last - 2));
    shift = {0.75 * s, 0.75 * s, -0.4375 * s * s};
  }
  if (step == 30) {
    const double half = (shift[1] - shift[0]) / 2;
    const double square = half * half + shift[2];
    if (square > 0) {
      const double root = shift[1] < shift[0] ? -std::sqrt(square) : std::sqrt(square);
      const double s = shift[0] - shift[2] / (root + half);
      shifted += s;
      T.diagonal().head(last + 1).array() -= s;
      shift.setConstant(0.964);
    }
  }
  return shift;
}

/// One double step; it starts where two subdiagonal entries are small enough.
void francis_step(MatrixXd& T, Active active, const Vector3d& shift) {
  Vector3d v = Vector3d::Zero();
  Index start = active.last - 2;
  for (; start >= active.first; --start) {
    const double middle = T(start, start), r = shift[0] - middle, s = shift[1] - middle;
    v = {(r * s - shift[2]) / T(start + 1, start) + T(start, start + 1),
         T(start + 1, start + 1) - middle - r - s, T(start + 2, start + 1)};
    if (start == active.first) break;
    const double left = T(start, start - 1) * (std::abs(v[1]) + std::abs(v[2]));
    const double right = v[0] * (std::abs(T(start - 1, start - 1)) + std::abs(middle) +
                                 std::abs(T(start + 1, start + 1)));
    if (std::abs(left) < kEpsilon * right) break;
  }
  double tau = 0, beta = 0;
  for (Index k = start; k <= active.last - 2; ++k) {
    if (k > start) v = T.block<3, 1>(k, k - 1);
    Eigen::Vector2d essential;
    v.makeHouseholder(essential, tau, beta);
    if (beta == 0) continue;
    if (k > start) {
      T(k, k - 1) = beta;
    } else if (k > active.first) {
      T(k, k - 1) = -T(k, k - 1);
    }
    reflect<3>(T, k, active, essential, tau);
  }
  const Index k = active.last - 1;
  Eigen::Vector<double, 1> essential;
  T.block<2, 1>(k, k - 1).makeHouseholder(essential, tau, beta);
  if (beta != 0) {
    T(k, k - 1) = beta;
    reflect<2>(T, k, active, essential, tau);
  }
  for (Index i = start + 2; i <= active.last; ++i) {
    T(i, i - 2) = 0;
    if (i > start + 2) T(i, i - 3) = 0;
  }
}

/// Of scale B, a pair with the positive imaginary part first; B before it was `shifted`.
void eigenvalues_of_block(Eigen::Matrix2d B, double shifted, double scale, Complex* values) {
  const double half = 0.5 * (B(0, 0) - B(1, 1)), square = half * half + B(1, 0) * B(0, 1);
  B.diagonal().array() += shifted;
  if (square >= 0) {
    const double root = half >= 0 ? std::sqrt(square) : -std::sqrt(square);
    Eigen::JacobiRotation<double> turn;
    turn.makeGivens(half + root, B(1, 0));
    B.applyOnTheLeft(0, 1, turn.adjoint());
    B.applyOnTheRight(0, 1, turn);
    for (Index i = 0; i < 2; ++i) values[i] = scale * B(i, i);
    return;
  }
  B *= scale;
  const double p = 0.5 * (B(0, 0) - B(1, 1));
  const double most = std::max({std::abs(p), std::abs(B(0, 1)), std::abs(B(1, 0))});
  const double part = p / most;
  values[0] = {B(1, 1) + p,
               most * std::sqrt(std::abs(part * part + B(1, 0) / most * (B(0, 1) / most)))};
  values[1] = std::conj(values[0]);
}

}  // namespace

Eigen::VectorXcd hessenberg_eigenvalues(MatrixXd T, double scale) {
  Eigen::VectorXcd values(T.rows());
  double norm = 0, shifted = 0;
  for (Index j = 0; j < T.cols(); ++j) {
    norm += T.col(j).head(std::min(T.rows(), j + 2)).cwiseAbs().sum();
  }
  const double negligible =
      std::max(norm * kEpsilon * kEpsilon, std::numeric_limits<double>::min());
  Index steps = 0, step = 0;
  for (Index last = T.rows() - 1; last >= 0;) {
    const Index first = first_of_block(T, last, negligible);
    if (first >= last - 1) {
      if (first == last) {
        values[last] = scale * (T(last, last) + shifted);
      } else {
        eigenvalues_of_block(T.block<2, 2>(first, first), shifted, scale, &values[first]);
      }
      last = first - 1;
      step = 0;
      continue;
    }
    const Vector3d shift = shifts_of(T, last, step, shifted);
    ++step;
    if (++steps > 40 * T.rows()) return {};
    francis_step(T, {first, last}, shift);
  }
  return values.allFinite() ? values : Eigen::VectorXcd();
}

}  // namespace rigfit::signal
