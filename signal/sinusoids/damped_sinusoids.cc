#include "signal/sinusoids/damped_sinusoids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "signal/numerics/scaled_gram.h"
#include "signal/sinusoids/power_sums.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr Index kBlock = 256;
// Gauss and Newton's steps are sure from afar, but where the residual is no noise they creep: from
// then on Newton's own, which costs one more product with the data.
constexpr int kGaussNewtonSteps = 4;
// exp(-a j) below this adds nothing to a double and would only make denormals.
constexpr double kNegligible = 1e-150;

double re_product(Complex a, Complex b) { return a.real() * b.real() - a.imag() * b.imag(); }

// The columns Re z^l and Im z^l of one block; z^(b + l) = z^b z^l serves all blocks.
struct BlockBasis {
  Eigen::Matrix<double, kBlock, 2> columns;

  void set(Complex pole, Index n) {
    constexpr int kLanes = 8;
    const Index length = std::min(kBlock, (n + kLanes - 1) / kLanes * kLanes);
    std::array<double, kLanes> re, im;
    for (int l = 0; l < kLanes; ++l) {
      const Complex z = std::exp(pole * static_cast<double>(l));
      re[static_cast<std::size_t>(l)] = z.real(), im[static_cast<std::size_t>(l)] = z.imag();
    }
    const Complex stride = std::exp(pole * static_cast<double>(kLanes));
    const double sr = stride.real(), si = stride.imag();
    double* c0 = columns.data();
    double* c1 = c0 + kBlock;
    for (Index l = 0; l < length; l += kLanes) {
      for (std::size_t k = 0; k < kLanes; ++k) {
        c0[l + static_cast<Index>(k)] = re[k], c1[l + static_cast<Index>(k)] = im[k];
        const double r = re[k] * sr - im[k] * si;
        im[k] = re[k] * si + im[k] * sr;
        re[k] = r;
      }
    }
  }
};

struct Products {  // with z^j, (j/N) z^j and (j/N)^2 z^j
  Complex zero, one, two;
};

// Samples of a block, four at a time.
using Four = Eigen::Array4d;
Eigen::Map<const Four> four(const double* x) { return Eigen::Map<const Four>(x); }
Eigen::Map<Four> four(double* x) { return Eigen::Map<Four>(x); }

// One column of the Jacobian: Re(factor (j/N)^power z^j).
struct Column {
  int mode;  // -1: background, z = 1
  int power;
  Complex factor;
};

class Problem {
 public:
  Problem(const Eigen::Ref<const Eigen::VectorXd>& y, std::span<const Index> missing,
          std::size_t modes, int background_terms)
      : y_(y), missing_(missing), n_(y.size()), m_(modes), background_(background_terms) {
    basis_.resize(m_);
    heads_.resize((n_ + kBlock - 1) / kBlock, static_cast<Index>(m_));
    products_.resize(m_);
    residual_.resize(n_);
    const Index size = parameters();
    gram_.resize(size, size);
    gradient_.resize(size);
    curvature_.setZero(size, 2 * static_cast<Index>(m_));
  }

  Index parameters() const { return 4 * static_cast<Index>(m_) + background_; }
  Index linear() const { return 2 * static_cast<Index>(m_) + background_; }

  std::vector<Complex> poles, amplitudes;
  std::array<double, 2> background{0, 0};
  double sum_squares = 0;

  /// What `step` needs of a point.
  struct Normal {
    Eigen::MatrixXd gram, curvature;
    Eigen::VectorXd gradient;
  };
  void keep(Normal& normal) const {
    normal.gram = gram_, normal.curvature = curvature_, normal.gradient = gradient_;
  }
  void go_back_to(const Normal& normal) {
    gram_ = normal.gram, curvature_ = normal.curvature, gradient_ = normal.gradient;
  }

  // Linear parameters, residual, Gram matrix and gradient at `poles`. False: rank-deficient.
  bool evaluate() {
    amplitudes.assign(m_, 1.0);  // scale of the derivative columns; set again below
    background = {0, 0};
    residual_ = y_;
    for (std::size_t m = 0; m < m_; ++m) {
      basis_[m].set(poles[m], n_);
      for (Index block = 0; block < heads_.rows(); ++block) {
        heads_(block, static_cast<Index>(m)) =
            std::exp(poles[m] * static_cast<double>(block * kBlock));
      }
    }
    fill_pair_sums();
    fill_gram();
    // Twice: the second pass takes away what rounding in the normal equations left.
    for (int pass = 0; pass < 2; ++pass) {
      project(false);
      if (!solve_linear()) return false;
    }
    project(true);
    fill_gram();
    fill_gradient();
    fill_curvature();
    return std::isfinite(sum_squares);
  }

  // Pole steps (per sample) for the Levenberg-Marquardt parameter; false when singular. `newton`:
  // with the second derivatives, where they leave the functional convex.
  bool step(double lambda, std::optional<Index> held, bool newton, Eigen::VectorXd& pole_step,
            double& step_norm_squared) {
    const Index nl = linear(), nn = 2 * static_cast<Index>(m_);
    if (!(gram_.diagonal().minCoeff() > 0)) return false;
    const ScaledGram amplitudes_only(gram_.topLeftCorner(nl, nl));
    if (!amplitudes_only.usable()) return false;
    const Eigen::MatrixXd coupling = amplitudes_only.solve(gram_.topRightCorner(nl, nn));
    Eigen::MatrixXd plain =
        gram_.bottomRightCorner(nn, nn) - gram_.bottomLeftCorner(nn, nl) * coupling;
    // What is left of the poles' columns must be more than rounding.
    if (!(plain.diagonal().array() > 1e-14 * gram_.diagonal().tail(nn).array()).all()) return false;
    Eigen::VectorXd g = gradient_.tail(nn) - coupling.transpose() * gradient_.head(nl);
    const auto hold = [&](Eigen::MatrixXd& matrix) {
      if (!held) return;
      const double own = matrix(*held, *held);
      matrix.row(*held).setZero();
      matrix.col(*held).setZero();
      matrix(*held, *held) = own;
    };
    hold(plain);
    if (held) g(*held) = 0;
    const auto solve = [&](Eigen::MatrixXd matrix) {
      matrix.diagonal() *= 1 + lambda;
      const ScaledGram factor(matrix);
      if (!factor.usable()) return false;
      const Eigen::VectorXd delta = factor.solve_vector(g);
      step_norm_squared = delta.dot(plain * delta);
      pole_step = delta / static_cast<double>(n_);
      return pole_step.allFinite();
    };
    if (newton) {
      Eigen::MatrixXd mixed = gram_.topRightCorner(nl, nn) - curvature_.topRows(nl);
      Eigen::MatrixXd curved = gram_.bottomRightCorner(nn, nn) - curvature_.bottomRows(nn) -
                               mixed.transpose() * amplitudes_only.solve(mixed);
      hold(curved);
      if ((curved.diagonal().array() > 0).all() && solve(std::move(curved))) return true;
    }
    return solve(plain);
  }

  void fill(DampedSinusoidsFit& fit) const {
    fit.poles = poles;
    fit.amplitudes = amplitudes;
    fit.offset = background[0];
    fit.drift = background[1];
    fit.residual_sum_squares = sum_squares;
    fit.samples = n_;
    fit.degrees = n_ - static_cast<Index>(missing_.size()) - parameters();
    fit.residual = residual_;
    // From this class's order and scale (linear ones first, poles times N) to the public one.
    const Index size = parameters();
    Eigen::VectorXi from(size);
    Eigen::VectorXd factor = Eigen::VectorXd::Ones(size);
    const auto modes = static_cast<Index>(m_);
    for (Index m = 0; m < modes; ++m) {
      from.segment<4>(4 * m) << int(2 * m), int(2 * m + 1), int(linear() + 2 * m),
          int(linear() + 2 * m + 1);
      factor.segment<2>(4 * m + 2).setConstant(static_cast<double>(n_));
    }
    for (Index b = 0; b < background_; ++b) from(4 * modes + b) = static_cast<int>(2 * modes + b);
    fit.jacobian_gram.resize(size, size);
    for (Index i = 0; i < size; ++i) {
      for (Index k = 0; k < size; ++k) {
        fit.jacobian_gram(i, k) = gram_(from(i), from(k)) * factor(i) * factor(k);
      }
    }
    if (fit.jacobian_gram.diagonal().minCoeff() > 0) {
      const ScaledGram normal(fit.jacobian_gram);
      if (normal.usable()) fit.unit_covariance = normal.inverse();
    }
    if (fit.unit_covariance.size() == 0) fit.end = DampedSinusoidsFit::End::rank_deficient;
  }

 private:
  // Residual at the present linear parameters, its sum of squares and its products with the basis;
  // those with (j/N) z^j and (j/N)^2 z^j only where they are asked for.
  void project(bool poles_too) {
    for (auto& p : products_) p = {};
    background_products_ = {0, 0};
    sum_squares = 0;
    const double per = 1.0 / static_cast<double>(n_);
    std::array<double, kBlock> r, tr, ttr;  // residual, times l/N, times (l/N)^2
    for (Index start = 0; start < n_; start += kBlock) {
      const Index length = std::min(kBlock, n_ - start), padded = (length + 3) / 4 * 4;
      std::copy_n(y_.data() + start, length, r.data());
      if (background_ > 0 && (background[0] != 0 || background[1] != 0)) {
        const double first = background[0] + background[1] * static_cast<double>(start) * per;
        const double slope = background[1] * per;
        for (Index l = 0; l < length; ++l) {
          r[static_cast<std::size_t>(l)] -= first + slope * static_cast<double>(l);
        }
      }
      for (std::size_t m = 0; m < m_; ++m) {
        const Complex head = heads_(start / kBlock, static_cast<Index>(m));
        if (std::norm(head) < kNegligible * kNegligible) continue;
        const Complex c = amplitudes_now_[m] * head;
        if (c == 0.0) continue;
        const double *re = basis_[m].columns.data(), *im = re + kBlock;
        for (Index l = 0; l < padded; l += 4) {
          four(r.data() + l) -= c.real() * four(re + l) - c.imag() * four(im + l);
        }
      }
      std::fill(r.data() + length, r.data() + padded, 0.0);
      for (Index j : missing_) {
        if (j >= start && j < start + length) r[static_cast<std::size_t>(j - start)] = 0;
      }
      const Eigen::Map<const Eigen::VectorXd> all(r.data(), length);
      if (poles_too) {
        residual_.segment(start, length) = all;
        for (std::size_t l = 0; l < static_cast<std::size_t>(padded); ++l) {
          const double t = static_cast<double>(l) * per;
          tr[l] = t * r[l], ttr[l] = t * tr[l];
        }
      }
      sum_squares += all.squaredNorm();
      const double t0 = static_cast<double>(start) * per;
      for (std::size_t m = 0; m < m_; ++m) {
        const Complex head = heads_(start / kBlock, static_cast<Index>(m));
        if (std::norm(head) < kNegligible * kNegligible) continue;
        const double *re = basis_[m].columns.data(), *im = re + kBlock;
        const Complex zero = with_basis(re, im, r.data(), padded);
        products_[m].zero += head * zero;
        if (!poles_too) continue;
        const Complex one = with_basis(re, im, tr.data(), padded);
        const Complex two = with_basis(re, im, ttr.data(), padded);
        products_[m].one += head * (one + t0 * zero);
        products_[m].two += head * (two + 2 * t0 * one + t0 * t0 * zero);
      }
      if (background_ > 0) {
        const double sum = all.sum();
        background_products_[0] += sum;
        if (background_ > 1) {
          double ramp = 0;
          for (Index l = 0; l < length; ++l) ramp += static_cast<double>(l) * all(l);
          background_products_[1] += per * (ramp + static_cast<double>(start) * sum);
        }
      }
    }
  }

  static Complex with_basis(const double* re, const double* im, const double* x, Index padded) {
    Four with_re = Four::Zero(), with_im = Four::Zero();
    for (Index l = 0; l < padded; l += 4) {
      with_re += four(re + l) * four(x + l);
      with_im += four(im + l) * four(x + l);
    }
    return {with_re.sum(), with_im.sum()};
  }

  bool solve_linear() {
    const Index nl = linear();
    Eigen::VectorXd right(nl);
    for (std::size_t m = 0; m < m_; ++m) {
      right(2 * static_cast<Index>(m)) = products_[m].zero.real();
      right(2 * static_cast<Index>(m) + 1) = -products_[m].zero.imag();
    }
    for (int b = 0; b < background_; ++b) {
      right(2 * static_cast<Index>(m_) + b) = background_products_[static_cast<std::size_t>(b)];
    }
    if (!(gram_.diagonal().head(nl).minCoeff() > 0)) return false;
    const ScaledGram factor(gram_.topLeftCorner(nl, nl));
    if (!factor.usable()) return false;
    const Eigen::VectorXd x = factor.solve_vector(right);
    if (!x.allFinite()) return false;
    for (std::size_t m = 0; m < m_; ++m) {
      amplitudes_now_[m] += Complex(x(2 * static_cast<Index>(m)), x(2 * static_cast<Index>(m) + 1));
    }
    for (int b = 0; b < background_; ++b) {
      background[static_cast<std::size_t>(b)] += x(2 * static_cast<Index>(m_) + b);
    }
    amplitudes = amplitudes_now_;
    return true;
  }

  std::vector<Column> columns() const {
    std::vector<Column> list;
    list.reserve(static_cast<std::size_t>(parameters()));
    const Complex i(0, 1);
    for (int m = 0; m < static_cast<int>(m_); ++m) {
      list.push_back({m, 0, 1.0});
      list.push_back({m, 0, i});
    }
    for (int b = 0; b < background_; ++b) list.push_back({-1, b, 1.0});
    for (int m = 0; m < static_cast<int>(m_); ++m) {
      const Complex c = amplitudes[static_cast<std::size_t>(m)];
      list.push_back({m, 1, c});
      list.push_back({m, 1, i * c});
    }
    return list;
  }

  Complex pole_of(int mode) const {
    return mode < 0 ? Complex(0) : poles[static_cast<std::size_t>(mode)];
  }

  // S_k(z_a z_b) and S_k(z_a conj z_b) for every pair of modes, the background being mode "m_".
  void fill_pair_sums() {
    amplitudes_now_.assign(m_, 0.0);
    const std::size_t count = m_ + 1;
    sums_.resize(count * count);
    for (std::size_t a = 0; a < count; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        const Complex pa = a == m_ ? Complex(0) : poles[a];
        const Complex pb = b == m_ ? Complex(0) : poles[b];
        power_sums(std::exp(pa + pb), n_, sums_[a * count + b].plain);
        power_sums(std::exp(pa + std::conj(pb)), n_, sums_[a * count + b].conjugate);
      }
    }
  }

  void fill_gram() {
    const auto list = columns();
    const std::size_t count = m_ + 1;
    for (std::size_t k = 0; k < list.size(); ++k) {
      for (std::size_t l = 0; l <= k; ++l) {
        const Column *p = &list[k], *q = &list[l];
        std::size_t a = p->mode < 0 ? m_ : static_cast<std::size_t>(p->mode);
        std::size_t b = q->mode < 0 ? m_ : static_cast<std::size_t>(q->mode);
        if (a < b) std::swap(a, b), std::swap(p, q);
        const auto& s = sums_[a * count + b];
        const auto power = static_cast<std::size_t>(p->power) + static_cast<std::size_t>(q->power);
        const double value =
            0.5 * (re_product(p->factor * q->factor, s.plain[power]) +
                   re_product(p->factor * std::conj(q->factor), s.conjugate[power]));
        gram_(static_cast<Index>(k), static_cast<Index>(l)) = value;
        gram_(static_cast<Index>(l), static_cast<Index>(k)) = value;
      }
    }
    if (missing_.empty()) return;
    Eigen::VectorXd row(parameters());
    for (Index j : missing_) {
      const double t = static_cast<double>(j) / static_cast<double>(n_);
      for (std::size_t k = 0; k < list.size(); ++k) {
        const Complex z = std::exp(pole_of(list[k].mode) * static_cast<double>(j));
        row(static_cast<Index>(k)) = re_product(list[k].factor, z) * (list[k].power ? t : 1.0);
      }
      gram_ -= row * row.transpose();
    }
  }

  void fill_gradient() {
    const auto list = columns();
    for (std::size_t k = 0; k < list.size(); ++k) {
      const auto& c = list[k];
      double value;
      if (c.mode < 0) {
        value = background_products_[static_cast<std::size_t>(c.power)];
      } else {
        const auto& p = products_[static_cast<std::size_t>(c.mode)];
        value = re_product(c.factor, c.power ? p.one : p.zero);
      }
      gradient_(static_cast<Index>(k)) = value;
    }
  }

  // The residual's products with second derivatives: each mode's with its own parameters only.
  void fill_curvature() {
    const Complex i(0, 1);
    for (std::size_t m = 0; m < m_; ++m) {
      const auto c = static_cast<Index>(2 * m), p = linear() + c;
      const Complex one = products_[m].one, two = amplitudes[m] * products_[m].two;
      const double re = one.real(), im = (i * one).real();
      curvature_.block<2, 2>(c, c) << re, im, im, -re;
      curvature_.block<2, 2>(p, c) << two.real(), (i * two).real(), (i * two).real(), -two.real();
    }
  }

  struct PairSums {
    std::array<Complex, 3> plain, conjugate;
  };

  const Eigen::Ref<const Eigen::VectorXd> y_;
  std::span<const Index> missing_;
  Index n_;
  std::size_t m_;
  int background_;
  std::vector<BlockBasis> basis_;
  Eigen::MatrixXcd heads_;  // z at the first sample of each block, by block and mode
  std::vector<Products> products_;
  std::array<double, 2> background_products_{0, 0};
  std::vector<Complex> amplitudes_now_;
  std::vector<PairSums> sums_;
  Eigen::VectorXd residual_, gradient_;
  Eigen::MatrixXd gram_;
  Eigen::MatrixXd curvature_;  // all parameters x those of the poles
};

}  // namespace

DampedSinusoidsFit fit_damped_sinusoids(const Eigen::Ref<const Eigen::VectorXd>& y,
                                        std::span<const Complex> poles,
                                        const DampedSinusoidsOptions& options,
                                        std::span<const Index> missing) {
  Problem problem(y, missing, poles.size(), options.background_terms);
  const auto present = y.size() - static_cast<Index>(missing.size());
  if (present <= problem.parameters()) {
    throw std::invalid_argument("damped sinusoids: fewer samples than parameters");
  }
  const double n = static_cast<double>(y.size());
  const auto degrees = static_cast<double>(present - problem.parameters());
  const double total = y.squaredNorm();
  DampedSinusoidsFit fit;
  problem.poles.assign(poles.begin(), poles.end());
  if (!problem.evaluate()) {
    fit.poles = problem.poles;
    fit.amplitudes.assign(poles.size(), 0.0);
    fit.samples = y.size();
    fit.residual = y;
    fit.residual_sum_squares = total;
    fit.end = DampedSinusoidsFit::End::rank_deficient;
    return fit;
  }
  double lambda = 1e-3;
  Eigen::VectorXd step;
  std::vector<Complex> accepted = problem.poles;
  double best = problem.sum_squares;
  bool stale = false;  // problem holds a refused trial, but for its normal equations
  Problem::Normal normal;
  problem.keep(normal);
  for (fit.iterations = 0; fit.iterations < options.max_iterations; ++fit.iterations) {
    double norm_squared = 0;
    if (!problem.step(lambda, options.held, fit.iterations >= kGaussNewtonSteps, step,
                      norm_squared)) {
      fit.end = DampedSinusoidsFit::End::rank_deficient;
      break;
    }
    // Small against the noise, or at rounding where there is no noise.
    const double tolerance = options.step_in_std * options.step_in_std;
    if (norm_squared <= tolerance * best / degrees || norm_squared <= 1e-28 * total) {
      fit.end = DampedSinusoidsFit::End::converged;
      break;
    }
    for (std::size_t m = 0; m < poles.size(); ++m) {
      Complex delta(step(2 * static_cast<Index>(m)), step(2 * static_cast<Index>(m) + 1));
      // The functional is smooth over about the width of the line and no further.
      const double reach = std::numbers::pi / n + 0.5 * std::abs(accepted[m].real());
      if (std::abs(delta) > reach) delta *= reach / std::abs(delta);
      Complex next = accepted[m] + delta;
      // A pole may grow by no more than e^3 over the record, so that nothing overflows; below a
      // quarter of a cycle a sinusoid is a polynomial that the background has already.
      next.real(std::clamp(next.real(), -30.0, 3.0 / n));
      next.imag(std::clamp(next.imag(), 0.5 * std::numbers::pi / n, std::numbers::pi));
      problem.poles[m] = next;
    }
    const bool better = problem.evaluate() && problem.sum_squares <= best;
    if (better) {
      best = problem.sum_squares;
      accepted = problem.poles;
      problem.keep(normal);
      lambda = std::max(lambda / 10, 1e-12);
      stale = false;
    } else {
      stale = true;
      problem.go_back_to(normal);
      if (lambda > 1e8) {  // no downhill step is left: a minimum to rounding
        fit.end = DampedSinusoidsFit::End::converged;
        break;
      }
      lambda = std::max(lambda * 10, 1e-6);
    }
  }
  if (stale) {
    problem.poles = accepted;
    problem.evaluate();
  }
  const auto end = fit.end;
  problem.fill(fit);
  if (fit.end != DampedSinusoidsFit::End::rank_deficient) fit.end = end;
  return fit;
}

}  // namespace rigfit::signal
