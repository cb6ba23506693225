#include "signal/poles/lscf.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "signal/spectra/fft.h"

namespace rigfit::signal {
namespace {

/// s_m = sum_k Re(g_k z_k^m) for m = -order..order, by one FFT when the lines are uniform.
class MomentSums {
 public:
  MomentSums(const Ref<const VectorXd>& frequency_hz, int order)
      : lines_(frequency_hz.size()), order_(order) {
    const double low = frequency_hz[0];
    const double step = (frequency_hz[lines_ - 1] - low) / static_cast<double>(lines_ - 1);
    length_ = good_fft_length(std::max<Index>(2 * (lines_ - 1), 2 * order + 2));
    period_hz_ = step * static_cast<double>(length_);
    const VectorXd uniform = VectorXd::LinSpaced(lines_, low, frequency_hz[lines_ - 1]);
    uniform_ = (frequency_hz - uniform).cwiseAbs().maxCoeff() < 1e-6 * step;
    if (uniform_) {
      transform_.emplace(length_);
    } else {
      powers_.resize(2 * lines_, 2 * order + 1);
      for (Index k = 0; k < lines_; ++k) {
        const double angle = kTwoPi * (frequency_hz[k] - low) / period_hz_;
        for (int m = -order; m <= order; ++m) {
          powers_(k, m + order) = std::cos(m * angle);
          powers_(lines_ + k, m + order) = -std::sin(m * angle);
        }
      }
    }
  }

  double period_hz() const { return period_hz_; }

  /// Column m + order of the result is s_m.
  template <typename Vector>
  void operator()(const Vector& g, Ref<VectorXd> sums) {
    if (!uniform_) {
      stacked_.resize(2 * lines_);
      stacked_ << g.real(), g.imag();
      sums.noalias() = powers_.transpose() * stacked_;
      return;
    }
    // The transform to real samples adds the conjugate of all but the first and the middle line.
    auto spectrum = transform_->spectrum();
    spectrum.setZero();
    spectrum.head(lines_) = (0.5 * static_cast<double>(length_)) * g;
    spectrum[0] *= 2;
    if (lines_ == length_ / 2 + 1) spectrum[lines_ - 1] *= 2;
    transform_->inverse();
    const auto time = transform_->time();
    sums.tail(order_ + 1) = time.head(order_ + 1);
    sums.head(order_) = time.tail(order_);
  }

 private:
  Index lines_ = 0, length_ = 0;
  int order_ = 0;
  double period_hz_ = 0;
  bool uniform_ = true;
  std::optional<RealFft> transform_;
  MatrixXd powers_;
  VectorXd stacked_;
};

/// The reduced normal matrix M, (order + 1) Ni square.
MatrixXd reduced_normal_matrix(MomentSums& sums_of, const Ref<const MatrixXcd>& H, Index inputs,
                               int order, const VectorXd& line_weight,
                               const VectorXd& response_weight) {
  const Index terms = order + 1, unknowns = terms * inputs, responses = H.cols() / inputs;
  const VectorXd squared = line_weight.cwiseAbs2();
  VectorXd sums(2 * order + 1);

  sums_of(squared.cast<Complex>().eval(), sums);
  MatrixXd R(terms, terms);
  for (Index r = 0; r < terms; ++r) {
    for (Index s = 0; s < terms; ++s) R(r, s) = sums[s - r + order];
  }
  const Eigen::LLT<MatrixXd> R_factor(R);

  // sum_o Y_o^H Y_o, Toeplitz in blocks of Ni.
  MatrixXd M(unknowns, unknowns);
  VectorXcd g(H.rows());
  for (Index i = 0; i < inputs; ++i) {
    for (Index j = 0; j < inputs; ++j) {
      g.setZero();
      for (Index o = 0; o < responses; ++o) {
        const double w2 = response_weight[o] * response_weight[o];
        g.array() += w2 * H.col(o * inputs + i).array().conjugate() * H.col(o * inputs + j).array();
      }
      g.array() *= squared.array();
      sums_of(g, sums);
      for (Index r = 0; r < terms; ++r) {
        for (Index s = 0; s < terms; ++s) {
          M(r * inputs + i, s * inputs + j) = sums[s - r + order];
        }
      }
    }
  }

  // minus sum_o S_o^T R^-1 S_o, S_o = X^H Y_o, several responses in one product.
  const Index together = std::max<Index>(1, 4096 / unknowns);
  MatrixXd S;
  for (Index first = 0; first < responses; first += together) {
    const Index count = std::min(together, responses - first);
    S.resize(terms, unknowns * count);
    for (Index c = 0; c < count; ++c) {
      for (Index i = 0; i < inputs; ++i) {
        const Index o = first + c;
        g = response_weight[o] * squared.cast<Complex>().cwiseProduct(H.col(o * inputs + i));
        sums_of(g, sums);
        for (Index s = 0; s < terms; ++s) {
          S.col(c * unknowns + s * inputs + i) = sums.segment(s, terms).reverse();
        }
      }
    }
    // Column s holds s_{s - r} for r = 0..order: sums[order + s - r].
    R_factor.matrixL().solveInPlace(S);
    for (Index c = 0; c < count; ++c) {
      M.selfadjointView<Eigen::Lower>().rankUpdate(S.middleCols(c * unknowns, unknowns).transpose(),
                                                   -1.0);
    }
  }
  M.triangularView<Eigen::StrictlyUpper>() = M.transpose();
  return M;
}

/// Reciprocals of the zeros z of det(I + A_1 z + ... + A_n z^n), as eigenvalues of the block
/// companion matrix. `A`: the blocks A_1 .. A_n one above the other, n size x size. Empty when they
/// do not converge. `left`, if given, gets w of length 1 with w^T (I + A_1 z + ...) = 0 for every
/// zero: size x zeros.
VectorXcd reciprocal_zeros(const MatrixXd& A, Index size, MatrixXcd* left) {
  MatrixXd companion = MatrixXd::Zero(A.rows(), A.rows());
  for (Index first = 0; first < A.rows(); first += size) {
    // The transposed blocks have the same zeros, and the left vectors for eigenvectors.
    companion.block(0, first, size, size) = -A.middleRows(first, size);
    if (left) companion.block(0, first, size, size).transposeInPlace();
  }
  companion.bottomLeftCorner(A.rows() - size, A.rows() - size).setIdentity();
  const Eigen::EigenSolver<MatrixXd> solver(companion, left != nullptr);
  if (solver.info() != Eigen::Success) return {};
  if (left) *left = solver.eigenvectors().bottomRows(size).colwise().normalized();
  return solver.eigenvalues();
}

/// Compares the poles of an order with those of the order `below`: stable is what the nearest one
/// there differs from by less than 1 % (damping: 5 %), the customary limits of a diagram.
void mark_stable(std::span<StabilisationPole> poles, std::span<const StabilisationPole> below) {
  if (below.empty()) return;
  for (StabilisationPole& pole : poles) {
    const StabilisationPole& nearest = *std::ranges::min_element(
        below, {}, [&](const auto& other) { return std::abs(other.pole_rad_s - pole.pole_rad_s); });
    pole.stable_frequency =
        std::abs(nearest.frequency_hz - pole.frequency_hz) < 0.01 * pole.frequency_hz;
    pole.stable_damping =
        pole.stable_frequency &&
        std::abs(nearest.damping_ratio - pole.damping_ratio) < 0.05 * pole.damping_ratio;
  }
}

}  // namespace

LscfResult lscf(const Ref<const VectorXd>& frequency_hz, const Ref<const MatrixXcd>& H,
                Index inputs, const VectorXd& line_weight, const VectorXd& column_weight,
                const LscfOptions& options) {
  const Index lines = frequency_hz.size();
  if (inputs < 1 || H.cols() < 1 || H.cols() % inputs != 0 || H.rows() != lines ||
      (line_weight.size() != 0 && line_weight.size() != lines) ||
      (column_weight.size() != 0 && column_weight.size() != H.cols()) || options.max_order < 1) {
    throw std::invalid_argument("lscf: sizes do not fit");
  }
  LscfResult result;
  // 2 lines (real and imaginary) an FRF against order + 1 numerator terms and the common
  // denominator.
  const Index responses = H.cols() / inputs;
  const Index supported = (2 * lines * responses - responses) / (responses + inputs) - 1;
  const int order = static_cast<int>(std::min<Index>({options.max_order, supported, lines - 2}));
  if (lines < 3 || order < 1) return result;

  const VectorXd weights = line_weight.size() ? line_weight : VectorXd::Ones(lines);
  VectorXd response_weight = VectorXd::Ones(responses);
  if (column_weight.size()) {
    for (Index o = 0; o < responses; ++o) {
      response_weight[o] = column_weight.segment(o * inputs, inputs).mean();
    }
  }

  MomentSums sums_of(frequency_hz, order);
  MatrixXd M = reduced_normal_matrix(sums_of, H, inputs, order, weights, response_weight);
  const Index unknowns = order * inputs;
  MatrixXd normal = M.bottomRightCorner(unknowns, unknowns);
  // Data without noise leave M singular beyond the true order; rounding of that size keeps its
  // factor real and is far below any measurement's noise.
  normal.diagonal().array() += 1e-13 * normal.diagonal().mean();
  const Eigen::LLT<MatrixXd> factor(normal);
  if (factor.info() != Eigen::Success) return result;
  const MatrixXd L = factor.matrixL();
  MatrixXd forward = -M.bottomLeftCorner(unknowns, inputs);
  L.triangularView<Eigen::Lower>().solveInPlace(forward);

  const double low = frequency_hz[0], high = frequency_hz[lines - 1];
  std::size_t below = 0;
  for (int n = 1; n <= order; ++n) {
    const Index size = n * inputs;
    MatrixXd A = forward.topRows(size);
    L.topLeftCorner(size, size).transpose().triangularView<Eigen::Upper>().solveInPlace(A);
    MatrixXcd left;
    const VectorXcd y = reciprocal_zeros(A, inputs, options.participation ? &left : nullptr);
    const std::size_t present = result.poles.size();
    for (Index i = 0; i < y.size(); ++i) {
      if (!(std::abs(y[i]) > 1) || y[i].imag() >= 0) continue;  // unstable, or a conjugate
      // z = 1 / y = exp((p - i 2 pi f_low) / f_period)
      const Complex relative = -std::log(y[i]) * sums_of.period_hz();
      StabilisationPole pole;
      pole.order = n;
      if (options.participation) pole.participation = left.col(i);
      pole.pole_rad_s = relative + Complex(0, kTwoPi * low);
      const double magnitude = std::abs(pole.pole_rad_s);
      pole.frequency_hz = magnitude / kTwoPi;
      pole.damping_ratio = -pole.pole_rad_s.real() / magnitude;
      const double damped = pole.pole_rad_s.imag() / kTwoPi;
      if (damped <= low || damped >= high || pole.damping_ratio > options.max_damping_ratio) {
        continue;
      }
      result.poles.push_back(pole);
    }
    const std::span all(result.poles), now = all.subspan(present);
    std::ranges::sort(now, {}, &StabilisationPole::frequency_hz);
    mark_stable(now, all.subspan(below, present - below));
    below = present;
    result.orders_solved = n;
  }
  return result;
}

}  // namespace rigfit::signal
