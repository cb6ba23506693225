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
constexpr Index kBlock = 512;
// exp(-a j) below this adds nothing to a double and would only make denormals.
constexpr double kNegligible = 1e-150;

// One column of the Jacobian: Re(factor (j/N)^power z^j).
struct Column {
  Index power;
  Complex factor;
};

/// Linear parameters at given poles, and what is left. The background is a mode after the others,
/// of pole 0.
class Problem {
 public:
  Problem(const Eigen::Ref<const Eigen::VectorXd>& y, std::span<const Index> missing,
          std::span<const Complex> start, const DampedSinusoidsOptions& options)
      : y_(y),
        present_(Eigen::VectorXd::Ones(y.size())),
        missing_(missing),
        n_(static_cast<double>(y.size())),
        m_(static_cast<Index>(start.size())),
        poles_(Eigen::VectorXcd::Zero(m_ + 1)) {
    for (const Index j : missing) present_(j) = 0;
    for (Index k = 0; k < 4 * m_; ++k) {
      const Complex pole = start[static_cast<std::size_t>(k / 4)];
      // Parts of a pole on an axis that stay, and the amplitude's imaginary part of an offset.
      if ((k % 4 == 2 && is_tone(pole)) || (k % 2 == 1 && is_offset(pole))) continue;
      (k % 4 < 2 ? linear_ : moving_).push_back(k);
    }
    for (Index b = 0; b < options.background_terms; ++b) linear_.push_back(4 * m_ + b);
    if (m_ > 0 && is_tone(start[0])) {
      known_ = options.known.first(std::min(start.size(), options.known.size()));
    }
    fit.samples = y.size();
    fit.degrees = y.size() - std::ssize(missing) - unknowns() + 3 * std::ssize(known_);
    fit.residual = y;
    fit.jacobian_gram.resize(4 * m_ + options.background_terms, 4 * m_ + options.background_terms);
  }

  [[nodiscard]] Index unknowns() const { return std::ssize(linear_) + std::ssize(moving_); }

  DampedSinusoidsFit fit;

  /// What the steps need of the poles `at`.
  PoleStage stage_at(const Eigen::VectorXcd& at) {
    PoleStage stage;
    stage.poles = at;
    stage.usable = evaluate(at);
    stage.cost = fit.residual_sum_squares;
    if (!stage.usable) return stage;
    const auto& gram = fit.jacobian_gram;
    const Eigen::MatrixXd of_poles = gram(moving_, moving_), both = gram(linear_, moving_);
    const Eigen::MatrixXd coupling = ScaledGram(gram(linear_, linear_)).solve(both);
    const Eigen::MatrixXd plain = of_poles - both.transpose() * coupling;
    // What is left of the poles' columns must be more than rounding.
    if (!(plain.diagonal().array() > 1e-14 * of_poles.diagonal().array()).all()) return stage;
    std::vector<Index> parts;
    for (const Index k : moving_) parts.push_back(2 * (k / 4) + k % 2);
    stage.gradient.setZero(2 * m_);
    stage.information.setZero(2 * m_, 2 * m_);
    stage.gradient(parts) = gradient_(moving_) - coupling.transpose() * gradient_(linear_);
    stage.information(parts, parts) = plain;
    return stage;
  }

  void fill_covariance() {
    std::vector<Index> free = linear_;
    free.insert(free.end(), moving_.begin(), moving_.end());
    const ScaledGram factored(fit.jacobian_gram(free, free));
    if (!factored.usable()) return;
    fit.unit_covariance.setZero(fit.jacobian_gram.rows(), fit.jacobian_gram.rows());
    fit.unit_covariance(free, free) = factored.inverse();
  }

 private:
  // Linear parameters, residual, Gram matrix and gradient at the poles `at`. False: rank-deficient.
  bool evaluate(const Eigen::VectorXcd& at) {
    poles_.head(m_) = at;
    fit.poles.assign(at.begin(), at.end());
    fit.amplitudes.assign(fit.poles.size(), 0);
    fit.offset = fit.drift = 0;
    powers_.resize(std::min(kBlock, fit.samples), 2 * m_);
    for (Index m = 0; m < m_; ++m) {
      const ArrayXcd z = powers(poles_(m), powers_.rows());
      powers_.col(2 * m) = z.real(), powers_.col(2 * m + 1) = z.imag();
    }
    fill_gram();
    const ScaledGram factor(fit.jacobian_gram(linear_, linear_));
    if (!factor.usable()) return false;
    // A third time where rounding in the normal equations leaves more than a thousandth of a std,
    // as in very long records.
    for (int pass = 0; pass < 3; ++pass) {
      project();
      const Eigen::VectorXd x = factor.solve_vector(gradient_(linear_));
      if (!x.allFinite()) return false;
      const double leaves = 1e-6 * fit.residual_sum_squares / n_;
      if (pass == 2 || (pass == 1 && x.dot(gradient_(linear_)) <= leaves)) break;
      for (Index k = 0; k < x.size(); ++k) move(linear_[static_cast<std::size_t>(k)], x(k));
    }
    fill_gram();
    return std::isfinite(fit.residual_sum_squares);
  }

  void move(Index parameter, double by) {
    if (parameter >= 4 * m_) {
      (parameter == 4 * m_ ? fit.offset : fit.drift) += by;
    } else {
      fit.amplitudes[static_cast<std::size_t>(parameter / 4)] +=
          parameter % 4 == 0 ? Complex(by) : Complex(0, by);
    }
  }

  // Residual at the present linear parameters, its sum of squares and the gradient.
  void project() {
    // Columns Re z and Im z of each mode, 1 and j/N, and what belongs to them.
    Eigen::VectorXd coefficients(2 * m_ + 2);
    for (Index m = 0; m < m_; ++m) {
      const Complex c = fit.amplitudes[static_cast<std::size_t>(m)];
      coefficients.segment<2>(2 * m) << c.real(), -c.imag();
    }
    coefficients.tail<2>() << fit.offset, fit.drift;
    Eigen::MatrixXd basis(powers_.rows(), 2 * m_ + 2);
    basis.col(2 * m_).setOnes();
    auto t = basis.col(2 * m_ + 1);
    // Of the residual, and of that times j/N, with the columns.
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(2 * m_ + 2, 2);
    fit.residual_sum_squares = 0;
    for (Index start = 0; start < fit.samples; start += kBlock) {
      const auto first = static_cast<double>(start);
      const Index length = std::min(kBlock, fit.samples - start);
      for (Index m = 0; m < m_; ++m) {
        // Not by powers(), which would put one rounding of a phase into half of the blocks.
        Complex head = std::exp(poles_(m) * first);
        if (std::abs(head) < kNegligible) head = 0;
        basis.col(2 * m) = head.real() * powers_.col(2 * m) - head.imag() * powers_.col(2 * m + 1);
        basis.col(2 * m + 1) =
            head.real() * powers_.col(2 * m + 1) + head.imag() * powers_.col(2 * m);
      }
      t.setLinSpaced(first / n_, (first + static_cast<double>(t.size() - 1)) / n_);
      const auto rows = basis.topRows(length);
      auto r = fit.residual.segment(start, length);
      r = (y_.segment(start, length) - rows * coefficients)
              .cwiseProduct(present_.segment(start, length));
      fit.residual_sum_squares += r.squaredNorm();
      products.col(0).noalias() += rows.transpose() * r;
      products.col(1).noalias() += rows.transpose() * t.head(length).cwiseProduct(r);
    }
    gradient_.resize(fit.jacobian_gram.rows());
    for (Index k = 0; k < gradient_.size(); ++k) {
      const auto [power, factor] = column(k);
      gradient_(k) =
          k < 4 * m_
              ? (factor * Complex(products(k / 4 * 2, power), products(k / 4 * 2 + 1, power)))
                    .real()
              : products(2 * m_ + power, 0);
    }
    for (std::size_t k = 0; k < known_.size(); ++k) {
      const auto& [value, information] = known_[k];
      const Eigen::Vector3d apart =
          value -
          Eigen::Vector3d(fit.amplitudes[k].real(), fit.amplitudes[k].imag(), fit.poles[k].imag());
      const Eigen::Vector3d pull = information * apart;
      fit.residual_sum_squares += apart.dot(pull);
      gradient_(of_tone(k)) += pull;
    }
  }

  [[nodiscard]] Column column(Index parameter) const {
    if (parameter >= 4 * m_) return {parameter - 4 * m_, 1.0};
    const Complex part = parameter % 2 == 0 ? Complex(1) : Complex(0, 1);
    if (parameter % 4 < 2) return {0, part};
    return {1, n_ * part * fit.amplitudes[static_cast<std::size_t>(parameter / 4)]};
  }

  /// Re C, Im C and Im p of a tone.
  static std::array<Index, 3> of_tone(std::size_t k) {
    const auto first = static_cast<Index>(4 * k);
    return {first, first + 1, first + 3};
  }

  void fill_gram() {
    auto& gram = fit.jacobian_gram;
    for (Index a = 0; a <= m_; ++a) {
      for (Index b = 0; b <= a; ++b) {
        std::array<Complex, 3> plain, conjugate;
        power_sums(std::exp(poles_(a) + poles_(b)), fit.samples, plain);
        power_sums(std::exp(poles_(a) + std::conj(poles_(b))), fit.samples, conjugate);
        for (Index k = 4 * a; k < std::min(4 * a + 4, gram.rows()); ++k) {
          const Column p = column(k);
          for (Index l = 4 * b; l < std::min(4 * b + 4, gram.rows()); ++l) {
            const Column q = column(l);
            const auto power = static_cast<std::size_t>(p.power + q.power);
            gram(k, l) = gram(l, k) = 0.5 * (p.factor * q.factor * plain[power] +
                                             p.factor * std::conj(q.factor) * conjugate[power])
                                                .real();
          }
        }
      }
    }
    for (const Index j : missing_) {
      const Eigen::MatrixXd row = fit.jacobian_rows(j, 1);
      gram -= row.transpose() * row;
    }
    for (std::size_t k = 0; k < known_.size(); ++k) {
      gram(of_tone(k), of_tone(k)) += known_[k].information;
    }
  }

  const Eigen::Ref<const Eigen::VectorXd> y_;
  Eigen::VectorXd present_;  // 0 where missing, else 1
  std::span<const Index> missing_;
  double n_;
  Index m_;
  Eigen::VectorXcd poles_;            // with the background's
  std::span<const KnownTone> known_;  // of the first poles
  // Parameters that are free, in the order of `jacobian_gram`: linear ones, and parts of poles.
  std::vector<Index> linear_, moving_;
  Eigen::MatrixXd powers_;  // Re z^l and Im z^l of a block, by mode
  Eigen::VectorXd gradient_;
};

}  // namespace

DampedSinusoidsFit fit_damped_sinusoids(const Eigen::Ref<const Eigen::VectorXd>& y,
                                        std::span<const Complex> poles,
                                        const DampedSinusoidsOptions& options,
                                        std::span<const Index> missing) {
  Problem problem(y, missing, poles, options);
  const auto present = y.size() - std::ssize(missing);
  if (present <= problem.unknowns()) {
    throw std::invalid_argument("damped sinusoids: fewer samples than parameters");
  }
  const double n = static_cast<double>(y.size());
  PoleStage stage = problem.stage_at(
      Eigen::Map<const Eigen::VectorXcd>(poles.data(), static_cast<Index>(poles.size())));
  PoleStepOptions steps;
  steps.max_iterations = options.max_iterations;
  steps.freedom = static_cast<double>(present - problem.unknowns());
  steps.rounding = 1e-28 * y.squaredNorm();
  // The functional is smooth over about the width of the line and no further. A pole may grow by no
  // more than e^3 over the record, so that nothing overflows; below a quarter of a cycle a sinusoid
  // is a polynomial that the background has already.
  steps.resolution = std::numbers::pi / n;
  steps.fastest = -30, steps.slowest = 3 / n;
  steps.low = 0.5 * std::numbers::pi / n, steps.high = std::numbers::pi;
  DampedSinusoidsFit& fit = problem.fit;
  fit.end = take_pole_steps(
      steps, [&](const auto& at) { return problem.stage_at(at); }, stage, &fit.iterations);
  if (!std::ranges::equal(fit.poles, stage.poles)) problem.stage_at(stage.poles);
  if (stage.usable) problem.fill_covariance();
  if (fit.unit_covariance.size() == 0) fit.end = StepsEnd::rank_deficient;
  return std::move(fit);
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
