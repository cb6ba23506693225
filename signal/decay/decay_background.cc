#include "signal/decay/decay_background.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "signal/numerics/numbers.h"
#include "signal/numerics/power_sums.h"
#include "signal/numerics/scaled_gram.h"
#include "signal/sinusoids/decay_modes.h"
#include "signal/sinusoids/decay_search.h"
#include "signal/sinusoids/residual_noise.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr std::size_t kMostSteadyTones = 3;
// The slowest mode has fallen by e^-7, to a thousandth.
constexpr double kDeadTimeConstants = 7;
// Slower than this over the window, an offset is a drift, which the fit has.
constexpr double kLeastFall = 1;
// Turns of fitting background and modes end at a step this small in standard uncertainties.
constexpr double kSmallStep = 1e-3;
constexpr int kMostTurns = 20;
constexpr Index kRows = 8192;  // rows of the Jacobian that are held at a time

DecaySamples less(const Eigen::Ref<const Eigen::VectorXd>& y, const BackgroundStretches& at,
                  const DecayBackground& background) {
  return decay_samples(y - background.at_samples(0, y.size()), at.start, at.end);
}

/// The background's columns beside the fit's own, and what is left of them when the fit's are taken
/// out: E'J, E'E - E'J (J'J)^-1 J'E, E' residual.
struct Beside {
  Eigen::MatrixXd cross, gram;
  Eigen::VectorXd gradient;
  bool determined = false;

  /// `columns(from, to)`: rows of E, samples of the record.
  template <class Columns>
  Beside(const Eigen::Ref<const Eigen::VectorXd>& y, const BackgroundStretches& at,
         const DampedSinusoidsFit& fit, Index count, const Columns& columns)
      : cross(Eigen::MatrixXd::Zero(fit.jacobian_gram.rows(), count)),
        gram(Eigen::MatrixXd::Zero(count, count)),
        gradient(Eigen::VectorXd::Zero(count)) {
    for (Index first = 0; first < fit.samples; first += kRows) {
      const Index rows = std::min(kRows, fit.samples - first), from = at.start + first;
      Eigen::MatrixXd e = columns(from, from + rows);
      for (Index j = 0; j < rows; ++j) {
        if (!std::isfinite(y(from + j))) e.row(j).setZero();
      }
      cross += fit.jacobian_rows(first, rows).transpose() * e;
      gram += e.transpose() * e;
      gradient += e.transpose() * fit.residual.segment(first, rows);
    }
  }
  /// The samples before the impact, which no mode has.
  void add_quiet(const Eigen::Ref<const Eigen::VectorXd>& y, const BackgroundStretches& at,
                 const DecayBackground& background) {
    if (at.quiet < 1) return;
    Eigen::VectorXd left = y.head(at.quiet) - background.at_samples(0, at.quiet);
    Eigen::MatrixXd e = background.columns(0, at.quiet);
    double sum = 0, present = 0;
    for (const double v : left) {
      if (std::isfinite(v)) sum += v, ++present;
    }
    for (Index j = 0; j < at.quiet; ++j) {
      const bool there = std::isfinite(left(j));
      left(j) = there ? left(j) - sum / present : 0;
      if (!there) e.row(j).setZero();
    }
    gram += e.transpose() * e;
    gradient += e.transpose() * left;
  }
  /// Takes the fit's columns out. What lies in them is left with rounding alone.
  void project(const DampedSinusoidsFit& fit) {
    const Eigen::VectorXd least = 1e-9 * gram.diagonal();
    gram -= cross.transpose() * fit.unit_covariance * cross;
    determined = (gram.diagonal().array() > least.array()).all();
    gram.diagonal() = gram.diagonal().cwiseMax(least);
  }
};

Beside beside(const Eigen::Ref<const Eigen::VectorXd>& y, const BackgroundStretches& at,
              const DampedSinusoidsFit& fit, const DecayBackground& background) {
  Beside all(y, at, fit, background.parameters(),
             [&](Index from, Index to) { return background.columns(from, to); });
  all.add_quiet(y, at, background);
  all.project(fit);
  return all;
}

/// One step of every term; false where one leaves what it can be.
bool take_step(DecayBackground& background, const Eigen::VectorXd& step, Index samples) {
  Index k = 0;
  for (auto& term : background.terms) {
    if (term.tone()) {
      term.amplitude += Complex(step(k), step(k + 1));
      term.rate += Complex(0, step(k + 2));
      k += 3;
      if (!(term.rate.imag() > 0 && term.rate.imag() < 0.5 * kTwoPi)) return false;
    } else {
      const double b = -term.rate.real();
      term.amplitude += step(k);
      term.rate = -std::clamp(b + step(k + 1), 0.5 * b, 2 * b);
      k += 2;
      if (!(-term.rate.real() * static_cast<double>(samples) > kLeastFall)) return false;
    }
    if (!(std::abs(term.amplitude) > 0)) return false;
  }
  return true;
}

/// The fit of modes, from `poles` on, and background; nothing where they cannot be told apart.
std::optional<DampedSinusoidsFit> fit_all(const Eigen::Ref<const Eigen::VectorXd>& y,
                                          const BackgroundStretches& at, std::vector<Complex> poles,
                                          DecayBackground& background) {
  const Index more = background.parameters();
  for (int turn = 0;; ++turn) {
    const DecaySamples samples = less(y, at, background);
    auto fit = fit_damped_sinusoids(samples.values, poles, {}, samples.missing);
    if (fit.unit_covariance.size() == 0 || fit.degrees <= more) return {};
    if (turn == kMostTurns) return fit;
    const Beside all = beside(y, at, fit, background);
    const ScaledGram gram(all.gram);
    if (!all.determined || !gram.usable()) return {};
    const Eigen::VectorXd step = gram.solve_vector(all.gradient);
    const double squared = all.gradient.dot(step) * static_cast<double>(fit.degrees - more) /
                           std::max(fit.residual_sum_squares, 1e-300);
    if (!std::isfinite(squared)) return {};
    if (squared < kSmallStep * kSmallStep) return fit;
    if (!take_step(background, step, fit.samples)) return {};
    poles = fit.poles;
  }
}

/// Steady lines of samples [from, to).
std::vector<DecayBackground::Term> steady_lines(const Eigen::Ref<const Eigen::VectorXd>& y,
                                                Index from, Index to, Index origin,
                                                double false_alarm) {
  constexpr Index kFewest = 32;
  if (to - from < kFewest) return {};
  Eigen::VectorXd left = y.segment(from, to - from);
  const auto n = static_cast<double>(to - from);
  DecaySearchOptions search;
  search.candidates = 1, search.lowest = 4 / n;
  search.energy_over_noise = detection_threshold(to - from, false_alarm);
  std::vector<DecayBackground::Term> found;
  // One at a time: beside a strong one stand the side lobes of its line.
  for (std::size_t k = 0; k < kMostSteadyTones; ++k) {
    const DecaySamples samples = decay_samples(left, 0, to - from);
    if (5 * static_cast<Index>(samples.missing.size()) > to - from) break;
    const auto lines = search_lines(line_spectrum(without_trend(left)), search);
    if (lines.empty()) break;
    const Complex pole(0, lines.front().pole.imag());
    const auto free =
        fit_damped_sinusoids(samples.values, std::span(&pole, 1), {}, samples.missing);
    if (free.unit_covariance.size() == 0) break;
    left -= free.mode_signal(0);
    // A tone neither falls nor grows by more than its uncertainty, or by hardly anything.
    const double std = std::sqrt(free.residual_sum_squares / static_cast<double>(free.degrees) *
                                 free.unit_covariance(2, 2));
    const double fall = std::abs(free.poles[0].real()) * n;
    if (fall > std::max(3 * std * n, 0.02) || 2 * std * n > 1) continue;
    DampedSinusoidsOptions undamped;
    undamped.held = 0;
    const auto fit =
        fit_damped_sinusoids(samples.values, std::span(&pole, 1), undamped, samples.missing);
    const Complex rate(0, fit.poles[0].imag());
    found.push_back(
        {rate, fit.amplitudes[0] * std::exp(rate * static_cast<double>(origin - from))});
  }
  return found;
}

/// The rate, of those a factor of 2 apart, whose offset explains most.
DecayBackground::Term first_offset(const Eigen::Ref<const Eigen::VectorXd>& y,
                                   const BackgroundStretches& at, const DampedSinusoidsFit& fit,
                                   double fastest) {
  DecayBackground trial;
  trial.origin = at.start;
  const double slowest = 2 * kLeastFall / static_cast<double>(fit.samples);
  for (double rate = slowest; rate <= fastest; rate *= 2) trial.terms.push_back({-rate, 1});
  const auto count = static_cast<Index>(trial.terms.size());
  Beside all(y, at, fit, count, [&](Index from, Index to) {
    const Eigen::MatrixXd both = trial.columns(from, to);
    Eigen::MatrixXd shapes(to - from, count);
    for (Index k = 0; k < count; ++k) shapes.col(k) = both.col(2 * k);
    return shapes;
  });
  all.project(fit);
  Index best = 0;
  const Eigen::ArrayXd left = all.gram.diagonal().array().max(1e-300);
  (all.gradient.array().square() / left).maxCoeff(&best);
  return {trial.terms[static_cast<std::size_t>(best)].rate, all.gradient(best) / left(best)};
}

}  // namespace

Eigen::ArrayXcd DecayBackground::Term::at(Index first, Index count) const {
  return std::exp(rate * static_cast<double>(first)) * powers(rate, count);
}

Index DecayBackground::parameters() const {
  Index count = 0;
  for (const Term& term : terms) count += term.tone() ? 3 : 2;
  return count;
}

Eigen::VectorXd DecayBackground::at_samples(Index from, Index to) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(to - from);
  for (const Term& term : terms) {
    const Index first = term.tone() ? from : std::max(from, origin);
    if (first < to)
      sum.tail(to - first) +=
          (term.amplitude * term.at(first - origin, to - first)).real().matrix();
  }
  return sum;
}

Eigen::MatrixXd DecayBackground::columns(Index from, Index to) const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(to - from, parameters());
  Index k = 0;
  for (const Term& term : terms) {
    const Index first = term.tone() ? from : std::max(from, origin), count = to - first;
    if (count > 0) {
      const auto t0 = static_cast<double>(first - origin);
      const Eigen::ArrayXcd z = term.at(first - origin, count);
      const Eigen::ArrayXcd moved =
          term.amplitude *
          (Eigen::ArrayXd::LinSpaced(count, t0, t0 + static_cast<double>(count - 1)) * z);
      all.col(k).tail(count) = z.real();
      if (term.tone()) {
        all.col(k + 1).tail(count) = -z.imag(), all.col(k + 2).tail(count) = -moved.imag();
      } else {
        all.col(k + 1).tail(count) = -moved.real();
      }
    }
    k += term.tone() ? 3 : 2;
  }
  return all;
}

DecayBackground find_tones(const Eigen::Ref<const Eigen::VectorXd>& y,
                           const BackgroundStretches& at, const DampedSinusoidsFit& fit,
                           double false_alarm) {
  const auto n = static_cast<double>(fit.samples);
  double slowest = std::numeric_limits<double>::infinity();
  for (const Complex p : fit.poles) {
    if (-p.real() * n > 1) slowest = std::min(slowest, -p.real());
  }
  const auto dead =
      std::isfinite(slowest) ? at.start + static_cast<Index>(kDeadTimeConstants / slowest) : at.end;
  DecayBackground background;
  background.origin = at.start;
  background.terms = at.quiet >= at.end - dead
                         ? steady_lines(y, 0, at.quiet, at.start, false_alarm)
                         : steady_lines(y, dead, at.end, at.start, false_alarm);
  if (background.terms.empty()) return {};
  // A mode that the first fit spent on a tone is not needed any more.
  std::vector<Complex> poles = fit.poles;
  std::erase_if(poles, [&](Complex pole) {
    return std::any_of(background.terms.begin(), background.terms.end(), [&](const auto& tone) {
      return std::abs(pole.imag() - tone.rate.imag()) < kTwoPi / n &&
             std::abs(pole.real()) * n < 0.3;
    });
  });
  if (poles.empty() || !fit_all(y, at, std::move(poles), background)) return {};
  return background;
}

bool add_offset(const Eigen::Ref<const Eigen::VectorXd>& y, const BackgroundStretches& at,
                const DampedSinusoidsFit& fit, double false_alarm, DecayBackground& background) {
  if (fit.unit_covariance.size() == 0) return false;
  double slowest_mode = std::numeric_limits<double>::infinity();
  for (const auto pole : fit.poles) slowest_mode = std::min(slowest_mode, std::abs(pole));
  // What falls within half a cycle is the impact, or a mode.
  const double fastest = 2 * slowest_mode / kTwoPi;
  if (!(fastest * static_cast<double>(fit.samples) > 2 * kLeastFall)) return false;
  DecayBackground with = background;
  with.origin = at.start;
  with.terms.push_back(first_offset(y, at, fit, fastest));
  const auto joint = fit_all(y, at, fit.poles, with);
  if (!joint) return false;
  const double rate = -with.terms.back().rate.real();
  const double explained = fit.residual_sum_squares - joint->residual_sum_squares;
  const double noise =
      residual_noise(joint->residual, joint->degrees - 2).white_equivalent(rate / kTwoPi);
  if (!(rate < fastest && explained > detection_threshold(fit.samples, false_alarm) * noise)) {
    return false;
  }
  background = std::move(with);
  return true;
}

Eigen::MatrixXd covariance_beside(const Eigen::Ref<const Eigen::VectorXd>& y,
                                  const BackgroundStretches& at, const DampedSinusoidsFit& fit,
                                  const DecayBackground& background) {
  if (fit.unit_covariance.size() == 0 || background.terms.empty()) return fit.unit_covariance;
  const Beside all = beside(y, at, fit, background);
  const ScaledGram gram(all.gram);
  if (!all.determined || !gram.usable()) return {};
  const Eigen::MatrixXd shared = fit.unit_covariance * all.cross;
  return fit.unit_covariance + shared * gram.solve(shared.transpose());
}

}  // namespace rigfit::signal
