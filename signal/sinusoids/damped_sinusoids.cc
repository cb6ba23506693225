#include "signal/sinusoids/damped_sinusoids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "signal/estimation/pole_steps.h"
#include "signal/numerics/power_sums.h"
#include "signal/numerics/scaled_gram.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::ArrayXcd;
using Eigen::Index;

// z^(b + l) = z^b z^l: the powers l of one block, times z^b, serve all blocks.
constexpr Index kBlock = 256;
constexpr Index kTogether = 32;  // blocks in a product: what fits the cache
// exp(-a j) below this adds nothing to a double and would only make denormals.
constexpr double kNegligible = 1e-150;

double re_product(Complex a, Complex b) { return a.real() * b.real() - a.imag() * b.imag(); }

// One column of the Jacobian: Re(factor (j/N)^power z^j).
struct Column {
  std::size_t mode;
  int power;
  Complex factor;
};

/// The background is a mode after the others, of pole 0.
class Problem {
 public:
  Problem(const Eigen::Ref<const Eigen::VectorXd>& y, std::span<const Index> missing,
          std::span<const Complex> start, const DampedSinusoidsOptions& options)
      : poles(start.begin(), start.end()),
        y_(y),
        missing_(missing),
        n_(y.size()),
        m_(start.size()),
        background_(options.background_terms) {
    const auto m = static_cast<Index>(m_);
    for (Index k = 0; k < m; ++k) {
      const Complex pole = start[static_cast<std::size_t>(k)];
      linear_.push_back(2 * k);
      if (!is_offset(pole)) linear_.push_back(2 * k + 1);
      if (!is_tone(pole)) moving_.push_back(2 * k);
      if (!is_offset(pole)) moving_.push_back(2 * k + 1);
    }
    for (Index b = 0; b < background_; ++b) linear_.push_back(2 * m + b);
    const std::size_t known = std::min(m_, options.known.size());
    if (known > 0 && is_tone(start[0])) known_ = options.known.first(known);
    free_ = linear_;
    for (const Index k : moving_) free_.push_back(linear() + k);
    block_ = std::clamp<Index>(n_, 1, kBlock);
    const Index blocks = (n_ + block_ - 1) / block_;
    times_ = Eigen::ArrayXd::LinSpaced(blocks, 0, static_cast<double>((blocks - 1) * block_)) /
             static_cast<double>(n_);
    heads_.resize(blocks, m);
    basis_.resize(block_, 6 * m + 2);
    basis_.col(2 * m).setOnes();
    basis_.col(2 * m + 1) = Eigen::VectorXd::LinSpaced(block_, 0, static_cast<double>(block_ - 1)) /
                            static_cast<double>(n_);
    products_.resize(m_ + 1);
    residual_.resize(n_);
    gram.resize(parameters(), parameters());
    gradient.resize(parameters());
    curvature.setZero(parameters(), 2 * m);
  }

  Index parameters() const { return 4 * static_cast<Index>(m_) + background_; }
  Index unknowns() const { return static_cast<Index>(free_.size()); }
  Index linear() const { return 2 * static_cast<Index>(m_) + background_; }

  std::vector<Complex> poles, amplitudes;
  std::array<double, 2> background{0, 0};
  double sum_squares = 0;
  Eigen::MatrixXd gram, curvature;  // curvature: all parameters x those of the poles
  Eigen::VectorXd gradient;

  // Linear parameters, residual, Gram matrix and gradient at `poles`. False: rank-deficient.
  bool evaluate() {
    amplitudes.assign(m_, 0);
    background = {0, 0};
    for (Index m = 0; m < heads_.cols(); ++m) {
      const Complex pole = poles[static_cast<std::size_t>(m)];
      const ArrayXcd z = powers(pole, block_);
      basis_.col(2 * m) = z.real(), basis_.col(2 * m + 1) = z.imag();
      // Not by powers(), which would put one rounding of a phase into half of the blocks.
      for (Index b = 0; b < heads_.rows(); ++b) {
        heads_(b, m) = std::exp(pole * static_cast<double>(b * block_));
      }
    }
    heads_ = (heads_.abs() > kNegligible).select(heads_, Complex(0));
    const Index modes = 2 * heads_.cols();
    const auto ramp = basis_.col(modes + 1).asDiagonal();
    basis_.middleCols(modes + 2, modes) = ramp * basis_.leftCols(modes);
    basis_.rightCols(modes) = ramp * basis_.middleCols(modes + 2, modes);
    fill_pair_sums();
    fill_gram();
    Eigen::VectorXd x;
    project(false);
    if (!solve_linear(x)) return false;
    project(true);
    // Again where rounding in the normal equations leaves more than a thousandth of a std, as in
    // very long records.
    const double leaves = 1e-6 * sum_squares / static_cast<double>(n_);
    if (!solve_linear(x)) return false;
    if (x.dot(gradient.head(linear())) > leaves) project(true);
    fill_gram();
    fill_curvature();
    return std::isfinite(sum_squares);
  }

  /// What the steps need of the poles `at`.
  PoleStage stage_at(const Eigen::VectorXcd& at) {
    poles.assign(at.begin(), at.end());
    PoleStage stage;
    stage.poles = at;
    stage.usable = evaluate();
    stage.cost = sum_squares;
    if (!stage.usable) return stage;
    const std::vector<Index> moving(free_.begin() + std::ssize(linear_), free_.end());
    const Eigen::MatrixXd of_poles = gram(moving, moving), both = gram(linear_, moving);
    const ScaledGram amplitudes_only(gram(linear_, linear_));
    if (!amplitudes_only.usable()) return stage;
    const Eigen::MatrixXd coupling = amplitudes_only.solve(both);
    const Eigen::MatrixXd plain = of_poles - both.transpose() * coupling;
    // What is left of the poles' columns must be more than rounding.
    if (!(plain.diagonal().array() > 1e-14 * of_poles.diagonal().array()).all()) return stage;
    const Eigen::MatrixXd mixed = both - curvature(linear_, moving_);
    const Eigen::MatrixXd curved =
        of_poles - curvature(moving, moving_) - mixed.transpose() * amplitudes_only.solve(mixed);
    const double n = static_cast<double>(n_);
    const Index parts = 2 * heads_.cols();
    stage.gradient.setZero(parts);
    stage.information.setZero(parts, parts);
    stage.curvature.setZero(parts, parts);
    stage.gradient(moving_) = n * (gradient(moving) - coupling.transpose() * gradient(linear_));
    stage.information(moving_, moving_) = n * n * plain;
    stage.curvature(moving_, moving_) = n * n * curved;
    return stage;
  }

  void fill(DampedSinusoidsFit& fit) const {
    fit.poles = poles;
    fit.amplitudes = amplitudes;
    fit.offset = background[0];
    fit.drift = background[1];
    fit.residual_sum_squares = sum_squares;
    fit.samples = n_;
    fit.degrees = n_ - static_cast<Index>(missing_.size()) - unknowns() +
                  3 * static_cast<Index>(known_.size());
    fit.residual = residual_;
    // From this class's order and scale (linear ones first, poles times N) to the public one.
    std::vector<Index> from, free;
    Eigen::VectorXd factor = Eigen::VectorXd::Ones(parameters());
    for (Index m = 0; m < heads_.cols(); ++m) {
      const Index pole = linear() + 2 * m;
      from.insert(from.end(), {2 * m, 2 * m + 1, pole, pole + 1});
      factor.segment<2>(4 * m + 2).setConstant(static_cast<double>(n_));
    }
    for (Index b = 2 * heads_.cols(); b < linear(); ++b) from.push_back(b);
    fit.jacobian_gram = factor.asDiagonal() * gram(from, from).eval() * factor.asDiagonal();
    for (Index k = 0; k < parameters(); ++k) {
      const Index own = from[static_cast<std::size_t>(k)];
      if (std::ranges::find(free_, own) != free_.end()) free.push_back(k);
    }
    const ScaledGram factored(fit.jacobian_gram(free, free));
    if (factored.usable()) {
      fit.unit_covariance.setZero(parameters(), parameters());
      fit.unit_covariance(free, free) = factored.inverse();
    }
    if (fit.unit_covariance.size() == 0) fit.end = StepsEnd::rank_deficient;
  }

 private:
  struct Products {  // of the residual with z^j, (j/N) z^j and (j/N)^2 z^j
    Complex zero, one, two;
  };
  struct PairSums {
    std::array<Complex, 3> plain, conjugate;
  };

  // Residual at the present linear parameters, its sum of squares and the gradient; that of the
  // poles, and what the curvature needs, only where it is asked for.
  void project(bool poles_too) {
    const Index m2 = 2 * heads_.cols(), own = m2 + 2, blocks = heads_.rows();
    Eigen::MatrixXd of_block(own, blocks), with(poles_too ? basis_.cols() : own, blocks);
    for (Index m = 0; m < heads_.cols(); ++m) {
      const ArrayXcd c = heads_.col(m) * amplitudes[static_cast<std::size_t>(m)];
      of_block.row(2 * m) = c.real(), of_block.row(2 * m + 1) = -c.imag();
    }
    of_block.row(m2) = background[0] + background[1] * times_.transpose();
    of_block.row(m2 + 1).setConstant(background[1]);
    sum_squares = 0;
    Eigen::MatrixXd r;
    for (Index first = 0; first < blocks; first += kTogether) {
      const Index count = std::min(kTogether, blocks - first), start = first * block_;
      const Index length = std::min(count * block_, n_ - start);
      r.resize(block_, count);
      auto samples = r.reshaped();
      samples.head(length) = y_.segment(start, length);
      if (poles_too) {
        r.noalias() -= basis_.leftCols(own) * of_block.middleCols(first, count);
      }
      samples.tail(samples.size() - length).setZero();
      for (const Index j : missing_) {
        if (j >= start && j < start + length) samples(j - start) = 0;
      }
      residual_.segment(start, length) = samples.head(length);
      sum_squares += r.squaredNorm();
      with.middleCols(first, count).noalias() = basis_.leftCols(with.rows()).transpose() * r;
    }
    for (Index m = 0; m < heads_.cols(); ++m) {
      const auto from = [&](Index row) {
        ArrayXcd product(blocks);
        product.real() = with.row(row).transpose().array();
        product.imag() = with.row(row + 1).transpose().array();
        return (product * heads_.col(m)).eval();
      };
      auto& p = products_[static_cast<std::size_t>(m)];
      const ArrayXcd zero = from(2 * m);
      p.zero = zero.sum();
      if (!poles_too) continue;
      const ArrayXcd one = from(own + 2 * m), two = from(own + m2 + 2 * m);
      p.one = (one + times_ * zero).sum();
      p.two = (two + times_ * (2.0 * one + times_ * zero)).sum();
    }
    products_[m_].zero = with.row(m2).sum();
    products_[m_].one = with.row(m2 + 1).sum() + with.row(m2).dot(times_.matrix());
    const auto list = columns();
    for (std::size_t k = 0; k < list.size(); ++k) {
      const auto& p = products_[list[k].mode];
      gradient(static_cast<Index>(k)) = re_product(list[k].factor, list[k].power ? p.one : p.zero);
    }
    for (std::size_t k = 0; k < known_.size(); ++k) {
      const auto& [value, information] = known_[k];
      const Eigen::Vector3d apart =
          value - Eigen::Vector3d(amplitudes[k].real(), amplitudes[k].imag(), poles[k].imag());
      const Eigen::Vector3d pull = information * apart;
      sum_squares += apart.dot(pull);
      gradient(of_tone(k)) += per_parameter().cwiseProduct(pull);
    }
  }

  /// Moves the linear parameters by `x` to where the gradient says that they belong.
  bool solve_linear(Eigen::VectorXd& x) {
    const ScaledGram factor(gram(linear_, linear_));
    if (!factor.usable()) return false;
    x.setZero(linear());
    x(linear_) = factor.solve_vector(gradient(linear_));
    for (std::size_t m = 0; m < m_; ++m) {
      amplitudes[m] += Complex(x(2 * static_cast<Index>(m)), x(2 * static_cast<Index>(m) + 1));
    }
    for (Index b = 0; b < background_; ++b) {
      background[static_cast<std::size_t>(b)] += x(2 * heads_.cols() + b);
    }
    return x.allFinite();
  }

  std::vector<Column> columns() const {
    std::vector<Column> list;
    const Complex i(0, 1);
    for (std::size_t m = 0; m < m_; ++m) {
      list.push_back({m, 0, 1.0});
      list.push_back({m, 0, i});
    }
    for (int b = 0; b < background_; ++b) list.push_back({m_, b, 1.0});
    for (std::size_t m = 0; m < m_; ++m) {
      list.push_back({m, 1, amplitudes[m]});
      list.push_back({m, 1, i * amplitudes[m]});
    }
    return list;
  }

  /// Re C, Im C and Im p of a tone, and their change with this class's parameters.
  std::array<Index, 3> of_tone(std::size_t k) const {
    const auto c = static_cast<Index>(2 * k);
    return {c, c + 1, linear() + c + 1};
  }
  Eigen::Vector3d per_parameter() const { return {1, 1, 1 / static_cast<double>(n_)}; }

  Complex pole_of(std::size_t mode) const { return mode == m_ ? Complex(0) : poles[mode]; }

  // S_k(z_a z_b) and S_k(z_a conj z_b) for every pair of modes.
  void fill_pair_sums() {
    sums_.resize((m_ + 1) * (m_ + 1));
    for (std::size_t a = 0; a <= m_; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        auto& sums = sums_[a * (m_ + 1) + b];
        power_sums(std::exp(pole_of(a) + pole_of(b)), n_, sums.plain);
        power_sums(std::exp(pole_of(a) + std::conj(pole_of(b))), n_, sums.conjugate);
      }
    }
  }

  void fill_gram() {
    const auto list = columns();
    for (std::size_t k = 0; k < list.size(); ++k) {
      for (std::size_t l = 0; l <= k; ++l) {
        const Column *p = &list[k], *q = &list[l];
        if (p->mode < q->mode) std::swap(p, q);
        const auto& s = sums_[p->mode * (m_ + 1) + q->mode];
        const auto power = static_cast<std::size_t>(p->power) + static_cast<std::size_t>(q->power);
        const double value =
            0.5 * (re_product(p->factor * q->factor, s.plain[power]) +
                   re_product(p->factor * std::conj(q->factor), s.conjugate[power]));
        gram(static_cast<Index>(k), static_cast<Index>(l)) = value;
        gram(static_cast<Index>(l), static_cast<Index>(k)) = value;
      }
    }
    Eigen::VectorXd row(parameters());
    for (Index j : missing_) {
      const double t = static_cast<double>(j) / static_cast<double>(n_);
      for (std::size_t k = 0; k < list.size(); ++k) {
        const Complex z = std::exp(pole_of(list[k].mode) * static_cast<double>(j));
        row(static_cast<Index>(k)) = re_product(list[k].factor, z) * (list[k].power ? t : 1.0);
      }
      gram -= row * row.transpose();
    }
    for (std::size_t k = 0; k < known_.size(); ++k) {
      const Eigen::DiagonalMatrix<double, 3> scale(per_parameter());
      gram(of_tone(k), of_tone(k)) += scale * known_[k].information * scale;
    }
  }

  // The residual's products with second derivatives: each mode's with its own parameters only.
  void fill_curvature() {
    const Complex i(0, 1);
    for (std::size_t m = 0; m < m_; ++m) {
      const auto c = static_cast<Index>(2 * m), p = linear() + c;
      const Complex one = products_[m].one, two = amplitudes[m] * products_[m].two;
      const double re = one.real(), im = (i * one).real();
      curvature.block<2, 2>(c, c) << re, im, im, -re;
      curvature.block<2, 2>(p, c) << two.real(), (i * two).real(), (i * two).real(), -two.real();
    }
  }

  const Eigen::Ref<const Eigen::VectorXd> y_;
  std::span<const Index> missing_;
  Index n_, block_;
  std::size_t m_;
  int background_;
  std::span<const KnownTone> known_;  // of the first poles
  // What is free: linear parameters, parts of poles (2 m real, 2 m + 1 imaginary), all parameters.
  std::vector<Index> linear_, moving_, free_;
  Eigen::ArrayXd times_;    // j/N of the first sample of each block
  Eigen::ArrayXXcd heads_;  // z^j there, by block and mode
  // Re z^l and Im z^l of each mode, 1 and l/N; the modes' times l/N, and times its square.
  Eigen::MatrixXd basis_;
  std::vector<Products> products_;
  std::vector<PairSums> sums_;
  Eigen::VectorXd residual_;
};

}  // namespace

DampedSinusoidsFit fit_damped_sinusoids(const Eigen::Ref<const Eigen::VectorXd>& y,
                                        std::span<const Complex> poles,
                                        const DampedSinusoidsOptions& options,
                                        std::span<const Index> missing) {
  Problem problem(y, missing, poles, options);
  const auto present = y.size() - static_cast<Index>(missing.size());
  if (present <= problem.unknowns()) {
    throw std::invalid_argument("damped sinusoids: fewer samples than parameters");
  }
  const double n = static_cast<double>(y.size()), total = y.squaredNorm();
  DampedSinusoidsFit fit;
  PoleStage stage = problem.stage_at(
      Eigen::Map<const Eigen::VectorXcd>(poles.data(), static_cast<Index>(poles.size())));
  if (!stage.usable) {
    fit.poles = problem.poles;
    fit.amplitudes.assign(poles.size(), 0.0);
    fit.samples = y.size();
    fit.residual = y;
    fit.residual_sum_squares = total;
    fit.end = StepsEnd::rank_deficient;
    return fit;
  }
  PoleStepOptions steps;
  steps.max_iterations = options.max_iterations;
  steps.step_in_std = options.step_in_std;
  steps.freedom = static_cast<double>(present - problem.unknowns());
  steps.rounding = 1e-28 * total;
  // The functional is smooth over about the width of the line and no further. A pole may grow by no
  // more than e^3 over the record, so that nothing overflows; below a quarter of a cycle a sinusoid
  // is a polynomial that the background has already.
  steps.resolution = std::numbers::pi / n;
  steps.fastest = -30, steps.slowest = 3 / n;
  steps.low = 0.5 * std::numbers::pi / n, steps.high = std::numbers::pi;
  const StepsEnd end = take_pole_steps(
      steps, [&](const auto& at) { return problem.stage_at(at); }, stage, &fit.iterations);
  if (!std::ranges::equal(problem.poles, stage.poles)) problem.stage_at(stage.poles);
  problem.fill(fit);
  if (fit.end != StepsEnd::rank_deficient) fit.end = end;
  return fit;
}

KnownTone KnownTone::at(Index later) const {
  const Complex turn = std::polar(1.0, value(2) * static_cast<double>(later));
  const Complex c = Complex(value(0), value(1)) * turn;
  Eigen::Matrix3d back;  // derivatives of these by those
  back << turn.real(), turn.imag(), 0, -turn.imag(), turn.real(), 0, 0, 0, 1;
  back.topRightCorner<2, 1>() = static_cast<double>(later) * Eigen::Vector2d(value(1), -value(0));
  return {{c.real(), c.imag(), value(2)}, back.transpose() * information * back};
}

Eigen::VectorXd DampedSinusoidsFit::mode_signal(std::size_t m) const {
  return (amplitudes[m] * powers(poles[m], samples)).real();
}

Eigen::MatrixXd DampedSinusoidsFit::jacobian_rows(Index first, Index count) const {
  Eigen::MatrixXd rows(count, jacobian_gram.rows());
  const auto modes = static_cast<Index>(poles.size());
  const Eigen::ArrayXd j = Eigen::ArrayXd::LinSpaced(count, static_cast<double>(first),
                                                     static_cast<double>(first + count - 1));
  for (Index m = 0; m < modes; ++m) {
    const auto k = static_cast<std::size_t>(m);
    const ArrayXcd z = std::exp(poles[k] * static_cast<double>(first)) * powers(poles[k], count);
    const ArrayXcd moved = amplitudes[k] * (j * z);
    rows.col(4 * m) = z.real(), rows.col(4 * m + 1) = -z.imag();
    rows.col(4 * m + 2) = moved.real(), rows.col(4 * m + 3) = -moved.imag();
  }
  if (rows.cols() > 4 * modes) rows.col(4 * modes).setOnes();
  if (rows.cols() > 4 * modes + 1) rows.col(4 * modes + 1) = j / static_cast<double>(samples);
  return rows;
}

}  // namespace rigfit::signal
