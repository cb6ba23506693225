#include "model/algebra/eigenpairs.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <numeric>
#include <random>

namespace rigfit::model {
namespace {

constexpr int kLarge = 1500;  // unknowns, from which on long Lanczos spaces cost more than factors

EnvelopeMatrix shifted(const EnvelopeMatrix& k, const EnvelopeMatrix& m, double mu) {
  EnvelopeMatrix out = k;
  out.values() -= mu * m.values();
  return out;
}

Eigenpairs no_eigenpairs(int unknowns) { return {VectorXd(), MatrixXd(unknowns, 0), true}; }

class Lanczos {
 public:
  /// For `wanted` pairs: with room for what they need.
  Lanczos(const EnvelopeMatrix& k, const EnvelopeMatrix& m, double shift, int wanted)
      : m_(m.sparse()), shift_(shift), random_(20210101) {
    factor_.factor(shifted(k, m, shift));
    work_.resize(m.size());
    reserve(3 * wanted + 16);
  }

  /// One vector more; false when the space is exhausted.
  bool extend() {
    if (size_ == 0 || renew_) {
      if (!random_start()) return false;
      renew_ = false;
    }
    const int j = size_ - 1;  // the vector to apply the operator to
    work_ = mv_.col(j);
    factor_.solve_in_place(work_);
    finish_step(j);
    return true;
  }

  /// Ritz values nu = 1 / (lambda - shift) of largest magnitude first, with error bounds.
  void ritz() {
    const int s = done_;
    MatrixXd h = projected_.topLeftCorner(s, s);
    h = 0.5 * (h + h.transpose()).eval();
    if (coupled_) {
      eigen_.computeFromTridiagonal(h.diagonal(), h.diagonal(-1));
    } else {
      eigen_.compute(h);
    }
    order_.resize(std::size_t(s));
    std::iota(order_.begin(), order_.end(), 0);
    std::sort(order_.begin(), order_.end(), [&](int a, int b) {
      return std::abs(eigen_.eigenvalues()[a]) > std::abs(eigen_.eigenvalues()[b]);
    });
  }

  double nu(int i) const { return eigen_.eigenvalues()[order_[std::size_t(i)]]; }
  double lambda(int i) const { return shift_ + 1 / nu(i); }
  double bound(int i) const {
    return beta_ * std::abs(eigen_.eigenvectors()(done_ - 1, order_[std::size_t(i)]));
  }
  bool converged(int i) const { return bound(i) <= 1e-10 * std::abs(nu(i)); }
  VectorXd vector(int i) const {
    return v_.leftCols(done_) * eigen_.eigenvectors().col(order_[std::size_t(i)]);
  }
  int done() const { return done_; }
  Index rows() const { return v_.rows(); }
  /// Continue from a random vector: finds what the first start could not see.
  void renew() { renew_ = true; }

 private:
  void reserve(int columns) {
    v_.conservativeResize(m_.rows(), columns);
    mv_.conservativeResize(m_.rows(), columns);
    const auto old = projected_.rows();
    projected_.conservativeResize(columns, columns);
    projected_.rightCols(columns - old).setZero();
    projected_.bottomRows(columns - old).setZero();
  }

  /// Removes the space so far from work_, coefficients added to `coefficients`: what the three-term
  /// recurrence says first, then everything, and again where that took much away.
  void orthogonalise(VectorXd* coefficients) {
    for (int j = std::max(0, size_ - 2); j < size_; ++j) {
      const double along = mv_.col(j).dot(work_);
      work_.noalias() -= along * v_.col(j);
      if (coefficients) (*coefficients)[j] += along;
    }
    for (int pass = 0; pass < 2; ++pass) {
      const double before = work_.squaredNorm();
      small_.noalias() = mv_.leftCols(size_).transpose() * work_;
      work_.noalias() -= v_.leftCols(size_) * small_;
      if (coefficients) *coefficients += small_;
      if (work_.squaredNorm() > 0.5 * before) break;
    }
  }

  void append(double norm) {
    if (size_ == v_.cols()) reserve(2 * size_);
    v_.col(size_) = work_ / norm;
    mv_.col(size_) = product_ / norm;
    ++size_;
  }

  double norm() {
    product_.noalias() = m_ * work_;
    return std::sqrt(std::max(0.0, work_.dot(product_)));
  }

  bool random_start() {
    std::uniform_real_distribution<double> uniform(-1, 1);
    VectorXd start(m_.rows());
    for (Index i = 0; i < start.size(); ++i) start[i] = uniform(random_);
    work_.noalias() = m_ * start;
    factor_.solve_in_place(work_);  // into the space of finite eigenvalues
    const double before = norm();
    if (!(before > 0)) return false;
    if (size_ > 0) orthogonalise(nullptr);
    double after = norm();
    if (!(after > 1e-9 * before)) return false;
    if (size_ > 0) {
      work_ /= after;
      orthogonalise(nullptr);
      after = norm();
      coupled_ = false;
    }
    append(after);
    return true;
  }

  void finish_step(int j) {
    coefficients_.setZero(size_);
    orthogonalise(&coefficients_);
    projected_.col(j).head(size_) = coefficients_;
    done_ = size_;
    beta_ = norm();
    // Length before it was orthogonalised.
    const double before = std::hypot(coefficients_.norm(), beta_);
    if (!(beta_ > 1e-13 * before)) {
      beta_ = 0;
      renew_ = true;
      return;
    }
    append(beta_);
    projected_(j + 1, j) = beta_;
  }

  Eigen::SparseMatrix<double> m_;
  double shift_;
  std::mt19937_64 random_;
  bool coupled_ = true;  // projected_ is tridiagonal
  bool renew_ = false;
  EnvelopeFactor factor_;
  MatrixXd v_, mv_, projected_;
  VectorXd work_, product_, small_, coefficients_;
  Eigen::SelfAdjointEigenSolver<MatrixXd> eigen_;
  std::vector<int> order_;
  int size_ = 0, done_ = 0;
  double beta_ = 0;
};

Eigenpairs collect(const Lanczos& lanczos, std::vector<int> chosen) {
  std::sort(chosen.begin(), chosen.end(),
            [&](int a, int b) { return lanczos.lambda(a) < lanczos.lambda(b); });
  Eigenpairs out;
  const auto n = static_cast<Index>(chosen.size());
  out.values.resize(n);
  out.vectors.resize(lanczos.rows(), n);
  for (Index i = 0; i < n; ++i) {
    const int k = chosen[std::size_t(i)];
    out.values[i] = lanczos.lambda(k);
    const VectorXd x = lanczos.vector(k);
    // The sign: first large entry positive.
    const double large = 0.5 * x.cwiseAbs().maxCoeff();
    Index first = 0;
    while (first + 1 < x.size() && std::abs(x[first]) < large) ++first;
    out.vectors.col(i) = x[first] < 0 ? VectorXd(-x) : x;
  }
  out.steps = lanczos.done();
  return out;
}

/// All eigenvalues in an interval, by slices with few of them in each: as many Lanczos vectors as
/// a slice needs, and a shift amid them that tells even crowded ones apart.
class Slices {
 public:
  Slices(const EnvelopeMatrix& k, const EnvelopeMatrix& m) : k_(k), m_(m), shifted_(k) {}

  int below(double mu) {
    shifted_.values() = k_.values() - mu * m_.values();
    factor_.factor(shifted_);
    return factor_.negative_pivots();
  }

  /// A bound above the `count` lowest, not many more of them, from one with at least as many.
  double bound_above(int count, double high) {
    double low = 0;
    int number = below(high);
    const int enough = count + std::max(2, count / 8);
    for (int i = 0; i < kBisections && number > enough; ++i) {
      const double middle = 0.5 * (low + high);
      const int here = below(middle);
      if (here >= count) {
        high = middle, number = here;
      } else {
        low = middle;
      }
    }
    return high;
  }

  /// The eigenpairs between two bounds with `n_low` and `n_high` eigenvalues below them.
  void find(double low, int n_low, double high, int n_high) {
    if (n_high <= n_low) return;
    if (n_high - n_low > kMostInSlice) {
      double a = low, b = high;
      for (int i = 0; i < kBisections; ++i) {
        const double middle = 0.5 * (a + b);
        const int here = below(middle);
        const int part = here - n_low;
        if (part >= (n_high - n_low) / 4 && part <= 3 * (n_high - n_low) / 4) {
          find(low, n_low, middle, here);
          find(middle, here, high, n_high);
          return;
        }
        (part < (n_high - n_low) / 2 ? a : b) = middle;
      }
    }
    // The bounds close in on the eigenvalues until the shift lies among them: in a crowd that is
    // narrow for its place, Lanczos' method would else have to tell the whole crowd apart.
    double a = low, b = high, shift = 0.5 * (low + high);
    for (int i = 0; n_high - n_low > kFew && i < kBisections; ++i, shift = 0.5 * (a + b)) {
      const int here = below(shift);
      const int part = here - n_low;
      if (part >= (n_high - n_low + 3) / 4 && part <= 3 * (n_high - n_low) / 4) break;
      (2 * part < n_high - n_low ? a : b) = shift;
      if (!(b - a > 1e-14 * b)) break;  // equal ones
    }
    solve(low, high, shift, n_high - n_low);
  }

  Eigenpairs take(int count) {
    std::sort(found_.begin(), found_.end(),
              [](const auto& x, const auto& y) { return x.first < y.first; });
    if (static_cast<int>(found_.size()) > count) found_.resize(std::size_t(count));
    Eigenpairs out;
    out.values.resize(static_cast<Index>(found_.size()));
    out.vectors.resize(k_.size(), out.values.size());
    for (std::size_t i = 0; i < found_.size(); ++i) {
      out.values[Index(i)] = found_[i].first;
      out.vectors.col(Index(i)) = found_[i].second;
    }
    out.complete = complete_;
    out.steps = steps_;
    return out;
  }

 private:
  static constexpr int kMostInSlice = 32, kBisections = 60;
  static constexpr int kFew = 8;  ///< so many are no crowd

  void solve(double low, double high, double shift, int wanted) {
    Lanczos lanczos(k_, m_, shift, wanted);
    // Far more than such a slice needs: what is lacking then is said, not sought for ever.
    const int n = std::min(k_.size(), 10 * wanted + 200);
    int next_check = std::min(n, 2 * wanted + 10), stalled = 0;
    std::vector<int> inside;
    while (lanczos.done() < n) {
      const bool grew = lanczos.extend();
      if (grew && lanczos.done() < next_check && lanczos.done() < n) continue;
      lanczos.ritz();
      inside.clear();
      bool pending = false;
      for (int i = 0; i < lanczos.done(); ++i) {
        if (!(lanczos.lambda(i) >= low && lanczos.lambda(i) < high)) continue;
        if (lanczos.converged(i)) {
          inside.push_back(i);
        } else {
          pending = true;
        }
      }
      if (static_cast<int>(inside.size()) >= wanted || !grew) break;
      if (!pending && ++stalled > 2) {  // equal ones, which this start cannot see
        lanczos.renew();
        stalled = 0;
      }
      next_check = lanczos.done() + std::max(4, wanted / 4);
    }
    steps_ += lanczos.done();
    complete_ = complete_ && static_cast<int>(inside.size()) == wanted;
    const Eigenpairs pairs = collect(lanczos, inside);
    for (Index i = 0; i < pairs.values.size(); ++i) {
      found_.emplace_back(pairs.values[i], pairs.vectors.col(i));
    }
  }

  const EnvelopeMatrix& k_;
  const EnvelopeMatrix& m_;
  EnvelopeMatrix shifted_;
  EnvelopeFactor factor_;
  std::vector<std::pair<double, VectorXd>> found_;
  bool complete_ = true;
  int steps_ = 0;
};

}  // namespace

int count_below(const EnvelopeMatrix& k, const EnvelopeMatrix& m, double mu) {
  EnvelopeFactor factor;
  factor.factor(shifted(k, m, mu));
  return factor.negative_pivots();
}

Eigenpairs lowest_eigenpairs(const EnvelopeMatrix& k, const EnvelopeMatrix& m, int count) {
  if (k.size() == 0 || count <= 0) return no_eigenpairs(k.size());
  Lanczos lanczos(k, m, 0, count);
  const int n = k.size();
  int next_check = std::min(n, 2 * count + 6);
  bool may_slice = true;
  for (;;) {
    const bool grew = lanczos.extend();
    if (grew && lanczos.done() < next_check && lanczos.done() < n) continue;
    lanczos.ritz();
    const bool all = !grew || lanczos.done() >= n;
    int good = 0;
    while (good < lanczos.done() && good < count && lanczos.converged(good)) ++good;
    if (may_slice && good < count && !all && n > kLarge &&
        lanczos.done() >= std::max(60, 2 * count + 6) && lanczos.nu(count - 1) > 0) {
      // Crowded: one space for all would grow with the crowd. Ritz values lie above the
      // eigenvalues, so that there are at least as many below.
      Slices slices(k, m);
      const double high = slices.bound_above(count, lanczos.lambda(count - 1) * (1 + 1e-9));
      slices.find(0, 0, high, slices.below(high));
      Eigenpairs out = slices.take(count);
      if (out.complete && out.values.size() == count) return out;
      may_slice = false;
    }
    // One more than wanted, at least roughly, to place the count between two.
    if (!all && (good < count || lanczos.done() <= count)) {
      next_check = lanczos.done() + std::max(4, count / 3);
      continue;
    }
    std::vector<int> chosen;
    for (int i = 0; i < std::min(lanczos.done(), count); ++i) {
      if (lanczos.nu(i) > 0) chosen.push_back(i);
    }
    // Count just above the last wanted that has a gap behind it.
    bool complete = true;
    if (!chosen.empty()) {
      int edge = static_cast<int>(chosen.size()) - 1;
      const auto gap_after = [&](int i) {
        return i + 1 >= lanczos.done() ||
               lanczos.lambda(i + 1) - lanczos.lambda(i) > 1e-7 * std::abs(lanczos.lambda(i));
      };
      while (edge > 0 && !gap_after(edge)) --edge;
      const double above = edge + 1 < lanczos.done() && lanczos.nu(edge + 1) > 0
                               ? lanczos.lambda(edge + 1)
                               : 1.01 * lanczos.lambda(edge);
      const double here = lanczos.lambda(edge);
      const double mu = here + std::min(0.5 * (above - here), 0.01 * here);
      complete = gap_after(edge) ? count_below(k, m, mu) == edge + 1 : all;
    }
    if (complete || all) {
      Eigenpairs out = collect(lanczos, chosen);
      out.complete = complete;
      return out;
    }
    lanczos.renew();
    next_check = lanczos.done() + std::max(6, count / 2);
  }
}

Eigenpairs eigenpairs_between(const EnvelopeMatrix& k, const EnvelopeMatrix& m, double low,
                              double high) {
  if (k.size() == 0) return no_eigenpairs(0);
  Slices slices(k, m);
  low = low > 0 ? low * (1 - 1e-12) : 0, high *= 1 + 1e-12;
  const int first = low > 0 ? slices.below(low) : 0, last = slices.below(high);
  if (last <= first) return no_eigenpairs(k.size());
  slices.find(low, first, high, last);
  return slices.take(last - first);
}

GeneralEigenpairs general_eigenpairs(const MatrixXd& matrix, const MatrixXd& right) {
  GeneralEigenpairs out;
  const Eigen::EigenSolver<MatrixXd> eigen(matrix);
  out.values = eigen.eigenvalues();
  out.vectors = eigen.eigenvectors();
  if (right.cols() > 0) {
    out.coordinates = out.vectors.partialPivLu().solve(right.cast<Complex>());
  }
  return out;
}

}  // namespace rigfit::model
