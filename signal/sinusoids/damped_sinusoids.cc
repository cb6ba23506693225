#include "signal/sinusoids/damped_sinusoids.h"

#include <array>

#include "signal/numerics/factorisations.h"
#include "signal/numerics/power_sums.h"

namespace rigfit::signal {
namespace {

// z^(b + l) = z^b z^l: the powers l of one block, times z^b, serve all blocks.
constexpr Index kBlock = 256;
// exp(-a j) below this adds nothing to a double and would only make denormals.
constexpr double kNegligible = 1e-150;

// One column of the Jacobian: Re(factor (j/N)^power z^j).
struct Column {
  Index power;
  Complex factor;
};

/// Sums of (j/N)^k (z_a z_b)^j and (j/N)^k (z_a conj z_b)^j, k = 0, 1, 2.
struct PairSums {
  std::array<Complex, 3> plain, conjugate;
};

/// Real and imaginary parts in turn, down the columns.
Map<MatrixXd> parts_of(MatrixXcd& z) {
  return {reinterpret_cast<double*>(z.data()), 2 * z.rows(), z.cols()};
}

/// Linear parameters at given poles, and what is left. The background is a mode after the others,
/// of pole 0.
class Problem {
 public:
  Problem(const Ref<const VectorXd>& y, std::span<const Index> missing,
          std::span<const Complex> start, const DampedSinusoidsOptions& options)
      : missing_(missing),
        n_(static_cast<double>(y.size())),
        m_(static_cast<Index>(start.size())),
        poles_(VectorXcd::Zero(m_ + 1)),
        pairs_(static_cast<std::size_t>((m_ + 1) * (m_ + 2) / 2)) {
    const Index block = std::clamp<Index>(y.size(), 1, kBlock),
                blocks = (y.size() + block - 1) / block;
    y_.setZero(block, blocks);
    y_.reshaped().head(y.size()) = y;
    for (const Index j : missing) y_.reshaped()(j) = 0;
    times_ = VectorXd::LinSpaced(y_.size(), 0, static_cast<double>(y_.size() - 1) / n_)
                 .reshaped(block, blocks);
    residual_ = y_;
    fit.residual_sum_squares = y_.squaredNorm();
    basis_.resize(block, 2 * m_);
    heads_.resize(m_, blocks);
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
    fit.jacobian_gram.resize(4 * m_ + options.background_terms, 4 * m_ + options.background_terms);
  }

  [[nodiscard]] Index unknowns() const { return std::ssize(linear_) + std::ssize(moving_); }

  DampedSinusoidsFit fit;

  /// What the steps need of the poles `at`.
  PoleStage stage_at(const VectorXcd& at) {
    PoleStage stage;
    stage.poles = at;
    stage.usable = evaluate(at);
    stage.cost = fit.residual_sum_squares;
    if (!stage.usable) return stage;
    const auto& gram = fit.jacobian_gram;
    const MatrixXd of_poles = gram(moving_, moving_), both = gram(linear_, moving_);
    const MatrixXd coupling = ScaledGram(gram(linear_, linear_)).solve(both);
    const MatrixXd plain = of_poles - both.transpose() * coupling;
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

  /// The residual and, of a model that is `usable`, the covariance.
  void finish(bool usable) {
    fit.residual = residual_.reshaped().head(fit.samples);
    if (!usable) return;
    std::vector<Index> free = linear_;
    free.insert(free.end(), moving_.begin(), moving_.end());
    const ScaledGram factored(fit.jacobian_gram(free, free));
    if (!factored.usable()) return;
    fit.unit_covariance.setZero(fit.jacobian_gram.rows(), fit.jacobian_gram.rows());
    fit.unit_covariance(free, free) = factored.inverse();
  }

 private:
  // Linear parameters, residual, Gram matrix and gradient at the poles `at`. False: rank-deficient.
  bool evaluate(const VectorXcd& at) {
    poles_.head(m_) = at;
    fit.poles.assign(at.begin(), at.end());
    fit.amplitudes.assign(fit.poles.size(), 0);
    fit.offset = fit.drift = 0;
    for (Index m = 0; m < m_; ++m) {
      const ArrayXcd z = powers(at(m), basis_.rows());
      basis_.col(2 * m) = z.real(), basis_.col(2 * m + 1) = z.imag();
      // Not by powers(), which would put one rounding of a phase into half of the blocks.
      for (Index b = 0; b < heads_.cols(); ++b) {
        heads_(m, b) = std::exp(at(m) * static_cast<double>(b * basis_.rows()));
      }
    }
    heads_ = (heads_.abs() > kNegligible).select(heads_, Complex(0));
    sum_pairs();
    fill_gram();
    const ScaledGram factor(fit.jacobian_gram(linear_, linear_));
    if (!factor.usable()) return false;
    // A third time where rounding in the normal equations leaves more than a thousandth of a std,
    // as in very long records.
    for (int pass = 0; pass < 3; ++pass) {
      project(pass == 0);
      const VectorXd x = factor.solve_vector(gradient_(linear_));
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

  // Residual at the present linear parameters, its sum of squares and the gradient. `first`: all of
  // them are 0, and only their part of the gradient is asked for.
  void project(bool first) {
    residual_ = y_;
    if (!first) {
      const Map<const VectorXcd> c(fit.amplitudes.data(), m_);
      // Conjugated: Re(c z) is the product of (Re, Im) of conj(c) with those of z.
      MatrixXcd factors = (c.asDiagonal() * heads_.matrix()).conjugate();
      residual_.noalias() -= basis_ * parts_of(factors);
      residual_.array() -= fit.offset + fit.drift * times_.array();
      residual_.reshaped().tail(residual_.size() - fit.samples).setZero();
      for (const Index j : missing_) residual_.reshaped()(j) = 0;
    }
    fit.residual_sum_squares = residual_.squaredNorm();
    // Sums of the residual with z^j and (j/N) z^j, by mode, the background's 1 and j/N.
    MatrixXcd products = MatrixXcd::Zero(m_ + 1, 2), with(m_, heads_.cols());
    const auto multiply = [&](const MatrixXd& samples, Index power) {
      products(m_, power) = samples.sum();
      if (first && power == 1) return;
      parts_of(with).noalias() = basis_.transpose() * samples;
      products.col(power).head(m_) = (with.array() * heads_).rowwise().sum();
    };
    multiply(residual_, 0);
    multiply(residual_.cwiseProduct(times_), 1);
    gradient_.resize(fit.jacobian_gram.rows());
    for (Index k = 0; k < gradient_.size(); ++k) {
      const auto [power, factor] = column(k);
      gradient_(k) = (factor * products(k / 4, power)).real();
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

  void sum_pairs() {
    auto pair = pairs_.begin();
    for (Index a = 0; a <= m_; ++a) {
      for (Index b = 0; b <= a; ++b, ++pair) {
        pair->plain = power_sums(std::exp(poles_(a) + poles_(b)), fit.samples);
        pair->conjugate = power_sums(std::exp(poles_(a) + std::conj(poles_(b))), fit.samples);
      }
    }
  }

  void fill_gram() {
    auto& gram = fit.jacobian_gram;
    auto pair = pairs_.begin();
    for (Index a = 0; a <= m_; ++a) {
      for (Index b = 0; b <= a; ++b) {
        const auto& [plain, conjugate] = *pair++;
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
      const MatrixXd row = fit.jacobian_rows(j, 1);
      gram -= row.transpose() * row;
    }
    for (std::size_t k = 0; k < known_.size(); ++k) {
      gram(of_tone(k), of_tone(k)) += known_[k].information;
    }
  }

  // A block a column; 0 where missing and behind the end.
  MatrixXd y_, residual_;
  MatrixXd times_;  // j/N
  std::span<const Index> missing_;
  double n_;
  Index m_;
  VectorXcd poles_;                   // with the background's
  std::vector<PairSums> pairs_;       // each pole's with those before it and itself
  std::span<const KnownTone> known_;  // the first poles'
  // Parameters that are free, in the order of `jacobian_gram`: linear ones, and parts of poles.
  std::vector<Index> linear_, moving_;
  MatrixXd basis_;   // in a block: Re z^l and Im z^l of each mode
  ArrayXXcd heads_;  // modes x blocks: z^b, b the first sample of each
  VectorXd gradient_;
};

}  // namespace

DampedSinusoidsFit fit_damped_sinusoids(const Ref<const VectorXd>& y,
                                        std::span<const Complex> poles,
                                        const DampedSinusoidsOptions& options,
                                        std::span<const Index> missing) {
  Problem problem(y, missing, poles, options);
  const auto present = y.size() - std::ssize(missing);
  if (present <= problem.unknowns()) {
    throw std::invalid_argument("damped sinusoids: fewer samples than parameters");
  }
  const double n = static_cast<double>(y.size());
  PoleStage stage =
      problem.stage_at(Map<const VectorXcd>(poles.data(), static_cast<Index>(poles.size())));
  PoleStepOptions steps;
  steps.max_iterations = options.max_iterations;
  steps.freedom = static_cast<double>(present - problem.unknowns());
  steps.step_in_std = options.step_in_std;
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
  problem.finish(stage.usable);
  if (fit.unit_covariance.size() == 0) fit.end = StepsEnd::rank_deficient;
  fit.missing.assign(missing.begin(), missing.end());
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

VectorXd DampedSinusoidsFit::mode_signal(std::size_t m) const {
  return (amplitudes[m] * powers(poles[m], samples)).real();
}

double DampedSinusoidsFit::change(double j, double late) const {
  double change = drift * late / static_cast<double>(samples);
  for (std::size_t m = 0; m < poles.size(); ++m) {
    change += (amplitudes[m] * std::exp(poles[m] * j) * (std::exp(poles[m] * late) - 1.0)).real();
  }
  return change;
}

VectorXd DampedSinusoidsFit::signal() const {
  const double last = 1 - 1 / static_cast<double>(samples);
  VectorXd y = VectorXd::LinSpaced(samples, offset, offset + drift * last);
  for (std::size_t m = 0; m < poles.size(); ++m) y += mode_signal(m);
  return y;
}

MatrixXd DampedSinusoidsFit::jacobian_rows(Index first, Index count) const {
  MatrixXd rows(count, jacobian_gram.rows());
  const auto modes = static_cast<Index>(poles.size());
  const ArrayXd j =
      ArrayXd::LinSpaced(count, static_cast<double>(first), static_cast<double>(first + count - 1));
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
