#include "signal/sinusoids/damped_sinusoids.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "signal/numerics/numbers.h"
#include "signal/numerics/scaled_gram.h"
#include "signal/spectra/fft.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Lines on either side over which the noise's density is averaged: 66 degrees of freedom, with
// which Student's factor is 2.0.
constexpr Index kNoiseReach = 16;
// A band that begins below this line holds the offset too.
constexpr Index kOffsetLines = 4;

/// exp(z) - 1 without cancellation at small z.
Complex expm1(Complex z) {
  const double s = std::sin(0.5 * z.imag()), e = std::expm1(z.real());
  return {e * std::cos(z.imag()) - 2 * s * s, (e + 1) * std::sin(z.imag())};
}

struct Line {
  double level = 0, slope = 0;  // at t = 0, a sample
};

Line straight_line(const DecaySamples& s) {
  if (s.t.size() < 2) return {s.t.size() == 1 ? s.y(0) : 0, 0};
  const double middle = s.t.mean(), level = s.y.mean();
  const Eigen::ArrayXd x = s.t.array() - middle;
  const double slope = (x * (s.y.array() - level)).sum() / x.square().sum();
  return {level - slope * middle, slope};
}

/// What is fitted: the values, and what one pole contributes to them.
class Rows {
 public:
  Rows(const DecaySamples& samples, const DampedSinusoidsOptions& options)
      : s_(samples), n_(static_cast<double>(samples.span)), line_(straight_line(samples)) {
    const Eigen::VectorXd y = s_.y.array() - line_.level - line_.slope * s_.t.array();
    if (!s_.complete()) {
      values = y;
      present = y.size();
      return;
    }
    RealFft fft(s_.span);
    fft.time() = y;
    fft.forward();
    first_ = std::clamp<Index>(static_cast<Index>(std::ceil(options.low * n_)), 0, fft.lines() - 1);
    if (first_ < kOffsetLines) first_ = 0;
    count_ = std::clamp<Index>(static_cast<Index>(std::floor(options.high * n_)) + 1, first_ + 1,
                               fft.lines()) -
             first_;
    weight_ = Eigen::VectorXd::Constant(count_, std::sqrt(2 / n_));
    present = 2 * count_;
    for (const Index k : {Index{0}, s_.span / 2}) {
      const bool alone = k == 0 || 2 * k == s_.span;
      if (alone && k >= first_ && k < first_ + count_)
        weight_(k - first_) = std::sqrt(1 / n_), --present;
    }
    values = stacked(fft.spectrum().segment(first_, count_));
    above_ = first_ + count_ < fft.lines();
  }

  Eigen::VectorXd values;
  Index present = 0;  // real values that are not zero by symmetry

  [[nodiscard]] Index size() const { return values.size(); }
  [[nodiscard]] bool lines() const { return count_ > 0; }
  [[nodiscard]] Index first_line() const { return first_; }
  [[nodiscard]] Index line_count() const { return count_; }
  [[nodiscard]] const Line& trend() const { return line_; }

  /// Of exp(p t) and of t / N exp(p t), p and its conjugate.
  struct Mode {
    Eigen::VectorXcd zero, one, zero_conjugate, one_conjugate;
    void amplitude(const Rows& rows, Eigen::MatrixXd& columns, Index at) const {
      rows.put(1, zero, zero_conjugate, columns, at);
    }
    void pole(const Rows& rows, Complex c, Eigen::MatrixXd& columns, Index at) const {
      rows.put(c, one, one_conjugate, columns, at);
    }
  };
  [[nodiscard]] Mode mode(Complex p) const {
    Mode m;
    if (lines()) {
      sums(p, m.zero, m.one);
      if (p.imag() == 0) {
        m.zero_conjugate = m.zero, m.one_conjugate = m.one;
      } else {
        sums(std::conj(p), m.zero_conjugate, m.one_conjugate);
      }
      return m;
    }
    m.zero.resize(size());
    if (s_.even) {
      // By products from one sample to the next, anew after each 64.
      const Complex q = std::exp(p);
      Complex z = 0;
      Index at = -64;
      for (Index j = 0; j < size(); ++j) {
        const auto t = static_cast<Index>(s_.t(j));
        if (j == 0 || t - at >= 64) z = std::exp(p * static_cast<double>(t)), at = t;
        while (at < t && t - at < 64) z *= q, ++at;
        m.zero(j) = z;
        if (t % 64 == 0) z = std::exp(p * static_cast<double>(t)), m.zero(j) = z;
      }
    } else {
      for (Index j = 0; j < size(); ++j) m.zero(j) = std::exp(p * s_.t(j));
    }
    m.one = m.zero.cwiseProduct((s_.t / n_).cast<Complex>());
    m.zero_conjugate = m.zero.conjugate(), m.one_conjugate = m.one.conjugate();
    return m;
  }

  /// Offset and drift where their lines are in the band; a polynomial for what is beside it.
  [[nodiscard]] Eigen::MatrixXd background() const {
    if (!lines()) {
      Eigen::MatrixXd columns(size(), 2);
      columns.col(0).setOnes();
      columns.col(1) = s_.t / n_;
      return columns;
    }
    // Over less than an octave the polynomial holds the drift's skirt, 1 / f.
    const Index own = first_ == 0 ? 2 : first_ < count_ ? 1 : 0;
    const Index beside = first_ > 0 ? 6 : above_ ? 3 : 0;
    Eigen::MatrixXd columns(size(), own + beside);
    if (own > 0) {
      Eigen::VectorXcd ramp(count_);
      for (Index k = 0; k < count_; ++k) {
        ramp(k) = first_ + k == 0 ? 0.5 * (n_ - 1) : 1.0 / expm1(Complex(0, -angle(k)));
      }
      columns.col(own - 1) = stacked(ramp);
    }
    if (own > 1) {
      Eigen::VectorXcd ones = Eigen::VectorXcd::Zero(count_);
      ones(0) = n_;
      columns.col(0) = stacked(ones);
    }
    for (Index b = 0; b < beside; ++b) {
      // About zero a real signal's transform is even in its real and odd in its imaginary part.
      const Index power = first_ > 0 ? b / 2 : b;
      Eigen::VectorXcd term(count_);
      for (Index k = 0; k < count_; ++k) {
        const double middle = first_ > 0 ? 0.5 * static_cast<double>(count_ - 1) : 0;
        const double x = (static_cast<double>(k) - middle) / static_cast<double>(count_);
        term(k) =
            std::pow(2 * x, static_cast<double>(power)) * (b % 2 == 1 ? Complex(0, 1) : Complex(1));
      }
      columns.col(own + b) = stacked(term);
    }
    return columns;
  }

  /// Residual at even times.
  [[nodiscard]] Eigen::VectorXd in_time(const Eigen::VectorXd& residual) const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(s_.span);
    if (lines()) {
      RealFft fft(s_.span);
      fft.spectrum().setZero();
      for (Index k = 0; k < count_; ++k) {
        fft.spectrum()(first_ + k) = Complex(residual(k), residual(count_ + k)) / weight_(k);
      }
      fft.inverse();
      return fft.time();
    }
    if (s_.even) {
      for (Index j = 0; j < s_.t.size(); ++j) out(static_cast<Index>(s_.t(j))) = residual(j);
      return out;
    }
    DecaySamples left = s_;
    left.y = residual;
    return left.trendless();
  }

 private:
  [[nodiscard]] double angle(Index k) const {
    return kTwoPi * static_cast<double>(first_ + k) / n_;
  }

  [[nodiscard]] Eigen::VectorXd stacked(const Eigen::Ref<const Eigen::VectorXcd>& x) const {
    if (!lines()) return x.real();
    Eigen::VectorXd out(2 * count_);
    out.head(count_) = weight_.cwiseProduct(x.real());
    out.tail(count_) = weight_.cwiseProduct(x.imag());
    return out;
  }

  /// (c x + c* y) / 2 and i (c x - c* y) / 2, y of the conjugate pole.
  void put(Complex c, const Eigen::VectorXcd& x, const Eigen::VectorXcd& y,
           Eigen::MatrixXd& columns, Index at) const {
    const double a = 0.5 * c.real(), b = 0.5 * c.imag();
    double *first = columns.col(at).data(), *second = columns.col(at + 1).data();
    for (Index k = 0; k < x.size(); ++k) {
      const double xr = x(k).real(), xi = x(k).imag(), yr = y(k).real(), yi = y(k).imag();
      const double ur = a * xr - b * xi, ui = a * xi + b * xr;
      const double vr = a * yr + b * yi, vi = a * yi - b * yr;
      const double w = lines() ? weight_(k) : 1;
      first[k] = w * (ur + vr), second[k] = w * (vi - ui);
      if (lines()) first[count_ + k] = w * (ui + vi), second[count_ + k] = w * (ur - vr);
    }
  }

  // sum_j exp(d j) and sum_j j / N exp(d j), d = p - i w_k.
  void sums(Complex p, Eigen::VectorXcd& zero, Eigen::VectorXcd& one) const {
    zero.resize(count_), one.resize(count_);
    const Complex whole(p.real() * n_, std::remainder(p.imag() * n_, kTwoPi));
    const Complex less = expm1(whole), end = 1.0 + less;
    const Complex turned = std::exp(p), back = std::polar(1.0, -kTwoPi / n_);
    Complex turn = 0;
    for (Index k = 0; k < count_; ++k) {
      if (k % 64 == 0) {
        turn = turned * std::polar(1.0, -angle(k));
      } else {
        turn = product(turn, back);
      }
      Complex step = turn - 1.0;
      if (std::norm(step) < 1e-4) {  // cancels
        const Complex d(p.real(), std::remainder(p.imag() - angle(k), kTwoPi));
        if (std::norm(d) * n_ * n_ < 1e-6) {
          const double half = 0.5 * (n_ - 1);
          zero(k) = n_ * (1.0 + d * half * (1.0 + d * (2 * n_ - 1) / 6.0));
          one(k) = half * (1.0 + d * (2 * n_ - 1) / 3.0 * (1.0 + 0.375 * d * n_));
          continue;
        }
        step = expm1(d);
      }
      const Complex inverse = std::conj(step) / std::norm(step);
      zero(k) = product(less, inverse);
      one(k) = product(end - product(turn, zero(k)) / n_, inverse);
    }
  }
  static Complex product(Complex a, Complex b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
  }

  const DecaySamples& s_;
  double n_;
  Line line_;
  Index first_ = 0, count_ = 0;  // lines; count 0: samples
  Eigen::VectorXd weight_;
  bool above_ = false;
};

/// Columns of the linear parameters (amplitudes, background, b), then those of the poles and of r;
/// poles and r are in 1 / N.
class Problem {
 public:
  Problem(const Rows& rows, std::span<const Complex> start, std::optional<double> relaxation)
      : poles(start.begin(), start.end()),
        r(relaxation),
        rows_(&rows),
        background_(rows.background()) {}

  std::vector<Complex> poles, amplitudes;
  std::optional<double> r;
  Eigen::VectorXd linear, residual;
  Eigen::MatrixXd J;
  double sum_squares = 0;

  [[nodiscard]] Index modes() const { return static_cast<Index>(poles.size()); }
  [[nodiscard]] Index linear_count() const {
    return 2 * modes() + background_.cols() + (r ? 1 : 0);
  }
  [[nodiscard]] Index parameters() const { return linear_count() + 2 * modes() + (r ? 1 : 0); }

  bool evaluate() {
    const Index l = linear_count();
    J.resize(rows_->size(), parameters());
    std::vector<Rows::Mode> all;
    for (std::size_t m = 0; m < poles.size(); ++m) {
      all.push_back(rows_->mode(poles[m]));
      all.back().amplitude(*rows_, J, 2 * static_cast<Index>(m));
    }
    J.middleCols(2 * modes(), background_.cols()) = background_;
    Eigen::MatrixXd relaxing(rows_->size(), 2);
    Rows::Mode decay;
    if (r) {
      decay = rows_->mode(Complex(-*r, 0));
      decay.amplitude(*rows_, relaxing, 0);
      J.col(l - 1) = relaxing.col(0);
    }
    const auto columns = J.leftCols(l);
    const ScaledGram gram(gram_of(columns));
    if (!gram.usable()) return false;
    linear = gram.solve_vector(columns.transpose() * rows_->values);
    residual = rows_->values - columns * linear;
    // What rounding in the normal equations left.
    const Eigen::VectorXd more = gram.solve_vector(columns.transpose() * residual);
    linear += more;
    residual -= columns * more;
    sum_squares = residual.squaredNorm();
    amplitudes.clear();
    for (Index m = 0; m < modes(); ++m) {
      amplitudes.emplace_back(linear(2 * m), linear(2 * m + 1));
      all[static_cast<std::size_t>(m)].pole(*rows_, amplitudes.back(), J, l + 2 * m);
    }
    if (r) {
      decay.pole(*rows_, linear(l - 1), relaxing, 0);
      J.col(parameters() - 1) = -relaxing.col(0);
    }
    return std::isfinite(sum_squares) && J.allFinite();
  }

 private:
  const Rows* rows_;
  Eigen::MatrixXd background_;
};

/// Sums of `x` over lines within the reach of each, both parts of a line together.
Eigen::VectorXd around(const Eigen::VectorXd& x, Index reach) {
  const Index count = x.size() / 2;
  Eigen::VectorXd sums(count + 1), out(count);
  sums(0) = 0;
  for (Index k = 0; k < count; ++k) sums(k + 1) = sums(k) + x(k) + x(count + k);
  for (Index k = 0; k < count; ++k) {
    // A whole window at the band's ends too.
    const Index from = std::clamp<Index>(k - reach, 0, std::max<Index>(0, count - 2 * reach - 1));
    out(k) = sums(std::min(count, from + 2 * reach + 1)) - sums(from);
  }
  return out;
}

/// Covariances and the noise at each mode.
void describe(const Problem& problem, const Rows& rows, const ScaledGram& gram,
              DampedSinusoidsFit& fit) {
  const Index modes = problem.modes(), l = problem.linear_count(), size = problem.parameters();
  const Eigen::MatrixXd unit = gram.inverse();
  std::vector<Index> own;
  for (Index m = 0; m < modes; ++m) {
    own.insert(own.end(), {2 * m, 2 * m + 1, l + 2 * m, l + 2 * m + 1});
  }
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(4 * modes);  // poles were times N
  for (Index m = 0; m < modes; ++m)
    scale.segment<2>(4 * m + 2).setConstant(1 / static_cast<double>(fit.samples));
  const auto of_modes = [&](const Eigen::MatrixXd& all) -> Eigen::MatrixXd {
    return scale.asDiagonal() * all(own, own) * scale.asDiagonal();
  };
  fit.unit_covariance = of_modes(unit);
  const double white = fit.variance();
  fit.noise.assign(static_cast<std::size_t>(modes), white);
  fit.noise_degrees = static_cast<double>(fit.degrees);
  Eigen::MatrixXd all = white * unit;
  const Index lines = rows.lines() ? rows.line_count() : fit.samples / 2 + 1;
  if (lines >= 4 * kNoiseReach && white > 0) {
    Eigen::VectorXd density;
    Index first = 0;
    if (rows.lines()) {
      const Eigen::VectorXd leverage = (problem.J * unit).cwiseProduct(problem.J).rowwise().sum();
      const Eigen::VectorXd power = problem.residual.cwiseAbs2(),
                            left = (1 - leverage.array()).max(0);
      density = around(power, kNoiseReach).cwiseQuotient(around(left, kNoiseReach));
      first = rows.first_line();
      Eigen::VectorXd weights(2 * density.size());
      weights << density, density;
      const Eigen::MatrixXd influence = problem.J * unit;
      all = influence.transpose() * weights.asDiagonal() * influence;
    } else {
      // Gaps: the colour of the residual with zeros in them, at each mode.
      RealFft fft(fit.samples);
      fft.time() = fit.residual;
      fft.forward();
      Eigen::VectorXd power(2 * fft.lines());
      power << fft.spectrum().real().cwiseAbs2(), fft.spectrum().imag().cwiseAbs2();
      density = around(power, kNoiseReach);
      density *= white / density.mean();
    }
    fit.noise_degrees = 4 * kNoiseReach;
    Eigen::VectorXd wider = Eigen::VectorXd::Ones(size);
    for (Index m = 0; m < modes; ++m) {
      const double at = problem.poles[static_cast<std::size_t>(m)].imag() / kTwoPi *
                        static_cast<double>(fit.samples);
      const Index k = std::clamp<Index>(std::lround(at) - first, 0, density.size() - 1);
      fit.noise[static_cast<std::size_t>(m)] = density(k);
      for (const Index i : {2 * m, 2 * m + 1, l + 2 * m, l + 2 * m + 1}) {
        wider(i) = std::sqrt(density(k) / white);
      }
    }
    if (!rows.lines()) all = wider.asDiagonal() * all * wider.asDiagonal();
  }
  fit.covariance = of_modes(all);
  // Of amplitudes alone, the poles kept.
  const ScaledGram linear(gram_of(problem.J.leftCols(l)));
  const Eigen::MatrixXd inverse = linear.inverse();
  for (Index m = 0; m < modes; ++m) {
    const Eigen::Matrix2d b = inverse.block<2, 2>(2 * m, 2 * m);
    const Eigen::Vector2d c = problem.linear.segment<2>(2 * m);
    const double determinant = b(0, 0) * b(1, 1) - b(0, 1) * b(1, 0);
    const double scaled = b(1, 1) * c(0) * c(0) - 2 * b(0, 1) * c(0) * c(1) + b(0, 0) * c(1) * c(1);
    fit.energy.push_back(determinant > 0 ? std::max(0.0, scaled / determinant) : 0);
  }
}

}  // namespace

DecaySamples even_samples(const Eigen::Ref<const Eigen::VectorXd>& y) {
  DecaySamples s;
  s.span = y.size();
  s.t.resize(y.size()), s.y.resize(y.size());
  Index present = 0;
  for (Index j = 0; j < y.size(); ++j) {
    if (std::isfinite(y(j))) s.t(present) = static_cast<double>(j), s.y(present++) = y(j);
  }
  s.t.conservativeResize(present), s.y.conservativeResize(present);
  return s;
}

Eigen::VectorXd DecaySamples::trendless() const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(span);
  const Line line = straight_line(*this);
  const auto left = [&](Index j) { return y(j) - line.level - line.slope * t(j); };
  if (even) {
    for (Index j = 0; j < t.size(); ++j) out(static_cast<Index>(t(j))) = left(j);
    return out;
  }
  Index next = 0;
  for (Index j = 0; j < span; ++j) {
    const auto at = static_cast<double>(j);
    while (next < t.size() && t(next) < at) ++next;
    if (next == 0 || next == t.size()) continue;
    const double share = (at - t(next - 1)) / (t(next) - t(next - 1));
    // Across a gap there is nothing to go by.
    if (t(next) - t(next - 1) < 2.5) out(j) = (1 - share) * left(next - 1) + share * left(next);
  }
  return out;
}

Eigen::VectorXd DampedSinusoidsFit::mode_signal(std::size_t m) const {
  constexpr Index kRestart = 256;  // rounding of products grows
  Eigen::VectorXd signal(samples);
  const Complex q = std::exp(poles[m]);
  Complex z = 0;
  for (Index j = 0; j < samples; ++j) {
    if (j % kRestart == 0) z = amplitudes[m] * std::exp(poles[m] * static_cast<double>(j));
    signal(j) = z.real();
    z *= q;
  }
  return signal;
}

DampedSinusoidsFit fit_damped_sinusoids(const DecaySamples& samples, std::span<const Complex> poles,
                                        const DampedSinusoidsOptions& options) {
  DampedSinusoidsFit fit;
  fit.poles.assign(poles.begin(), poles.end());
  fit.amplitudes.assign(poles.size(), 0.0);
  fit.samples = samples.span;
  if (samples.complete()) fit.low = options.low, fit.high = options.high;
  const Rows rows(samples, options);
  Problem problem(rows, poles, options.relaxation);
  fit.degrees = rows.present - problem.parameters();
  const double n = static_cast<double>(samples.span), total = rows.values.squaredNorm();
  if (fit.degrees < 1 || !problem.evaluate()) {
    fit.residual = rows.in_time(rows.values);
    fit.residual_sum_squares = total;
    return fit;
  }
  const Index l = problem.linear_count(), movable = problem.parameters() - l;
  double lambda = 1e-3;
  const auto tolerance =
      options.step_in_std * options.step_in_std / static_cast<double>(fit.degrees);
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    Eigen::MatrixXd normal = gram_of(problem.J);
    normal.diagonal().tail(movable) *= 1 + lambda;
    const ScaledGram gram(normal);
    if (!gram.usable()) break;
    const Eigen::VectorXd gradient = problem.J.transpose() * problem.residual;
    const Eigen::VectorXd step = gram.solve_vector(gradient).tail(movable);
    const double gain = gradient.tail(movable).dot(step);  // its square in standard uncertainties
    fit.converged =
        gain <= tolerance * problem.sum_squares || gain <= 1e-26 * total || lambda > 1e8;
    if (fit.converged) break;
    Problem next = problem;
    for (std::size_t m = 0; m < poles.size(); ++m) {
      Complex delta(step(2 * static_cast<Index>(m)), step(2 * static_cast<Index>(m) + 1));
      delta /= n;
      // The functional is smooth over about the width of the line and no further.
      const double reach = std::numbers::pi / n + 0.5 * std::abs(problem.poles[m].real());
      if (std::abs(delta) > reach) delta *= reach / std::abs(delta);
      const Complex moved = problem.poles[m] + delta;
      // No overflow in growing by e^3; below a quarter of a cycle a sinusoid is background.
      next.poles[m] = {std::clamp(moved.real(), -30.0, 3.0 / n),
                       std::clamp(moved.imag(), 0.5 * std::numbers::pi / n, std::numbers::pi)};
    }
    if (problem.r) {
      const double limit = 0.5 * *problem.r;
      next.r =
          std::clamp(*problem.r + std::clamp(step(movable - 1) / n, -limit, limit), 0.3 / n, 3.0);
    }
    if (next.evaluate() && next.sum_squares <= problem.sum_squares) {
      problem = std::move(next);
      lambda = std::max(lambda / 10, 1e-12);
    } else {
      lambda = std::max(lambda * 10, 1e-6);
    }
  }
  fit.poles = problem.poles, fit.amplitudes = problem.amplitudes, fit.relaxation = problem.r;
  fit.residual_sum_squares = problem.sum_squares;
  fit.residual = rows.in_time(problem.residual);
  const bool has_offset = !rows.lines() || rows.first_line() == 0;
  const Index c0 = 2 * problem.modes();
  fit.offset = rows.trend().level + (has_offset ? problem.linear(c0) : 0);
  fit.drift = rows.trend().slope * n + (has_offset ? problem.linear(c0 + 1) : 0);
  if (problem.r) fit.relaxation_amplitude = problem.linear(l - 1);
  const ScaledGram gram(gram_of(problem.J));
  if (gram.usable()) describe(problem, rows, gram, fit);
  return fit;
}

}  // namespace rigfit::signal
