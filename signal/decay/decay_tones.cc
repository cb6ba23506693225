#include "signal/decay/decay_tones.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "signal/numerics/numbers.h"
#include "signal/numerics/scaled_gram.h"
#include "signal/sinusoids/decay_modes.h"
#include "signal/sinusoids/decay_search.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr int kMostTones = 3;
// Turns of fitting tones and modes.
constexpr int kMostTurns = 12;
// Turns end at a step this small against the standard uncertainties.
constexpr double kSmallStep = 1e-3;
// The slowest mode has fallen by e^-7, to a thousandth.
constexpr double kDeadTimeConstants = 7;

Eigen::VectorXd at_samples(const DecayTone& tone, Index from, Index to) {
  Eigen::VectorXd values(to - from);
  const Complex q = std::polar(1.0, tone.w);
  Complex z = 0;
  for (Index j = from; j < to; ++j) {
    if ((j - from) % 256 == 0) {
      z = tone.amplitude * std::polar(1.0, std::fmod(tone.w * static_cast<double>(j), kTwoPi));
    }
    values(j - from) = z.real();
    z *= q;
  }
  return values;
}

/// Modes and tones as one fit: columns of the tones (Re, Im of the amplitude at the window's start,
/// and w, of each) in the window and before it, and the inverse of all their products.
struct Joint {
  Eigen::MatrixXd inside, before, inverse;  // the last one empty: they cannot be told apart

  Joint(const DampedSinusoidsFit& fit, const std::vector<DecayTone>& tones, const ToneStretches& at)
      : inside(columns(tones, at.start, at.start, at.start + fit.samples)),
        before(columns(tones, at.start, 0, at.quiet)) {
    const Index own = fit.jacobian_gram.rows(), more = inside.cols();
    Eigen::MatrixXd gram(own + more, own + more);
    gram.topLeftCorner(own, own) = fit.jacobian_gram;
    for (Index k = 0; k < own; ++k) {
      gram.block(k, own, 1, more) = fit.jacobian_column(k).transpose() * inside;
    }
    gram.bottomLeftCorner(more, own) = gram.topRightCorner(own, more).transpose();
    gram.bottomRightCorner(more, more) = inside.transpose() * inside + before.transpose() * before;
    if (!(gram.diagonal().minCoeff() > 0)) return;
    const ScaledGram normal(gram);
    if (normal.usable()) inverse = normal.inverse();
  }

 private:
  static Eigen::MatrixXd columns(const std::vector<DecayTone>& tones, Index start, Index from,
                                 Index to) {
    Eigen::MatrixXd all(to - from, 3 * static_cast<Index>(tones.size()));
    for (std::size_t k = 0; k < tones.size(); ++k) {
      const Complex at_start = tones[k].amplitude * std::polar(1.0, tones[k].w * double(start));
      for (Index j = from; j < to; ++j) {
        const auto t = static_cast<double>(j - start);
        const Complex z = std::polar(1.0, tones[k].w * t);
        const auto c = static_cast<Index>(3 * k);
        all(j - from, c) = z.real(), all(j - from, c + 1) = -z.imag();
        all(j - from, c + 2) = -t * (at_start * z).imag();
      }
    }
    return all;
  }
};

class ToneFit {
 public:
  ToneFit(const Eigen::Ref<const Eigen::VectorXd>& y, const ToneStretches& stretches,
          const DampedSinusoidsFit& fit, double false_alarm)
      : y_(y), at_(stretches), false_alarm_(false_alarm), fit_(fit) {}

  std::vector<DecayTone> run() {
    for (const DecayTone& tone : alone()) {
      tones_.push_back(tone);
      if (static_cast<int>(tones_.size()) == kMostTones) break;
    }
    if (tones_.empty()) return {};
    // A mode that the first fit spent on a tone is not needed any more.
    std::vector<Complex> poles;
    for (const Complex pole : fit_.poles) {
      const bool taken = std::any_of(tones_.begin(), tones_.end(), [&](const DecayTone& tone) {
        const double line = kTwoPi / static_cast<double>(fit_.samples);
        return std::abs(pole.imag() - tone.w) < line &&
               std::abs(pole.real()) * static_cast<double>(fit_.samples) < 0.3;
      });
      if (!taken) poles.push_back(pole);
    }
    if (poles.empty()) return {};
    for (int turn = 0; turn < kMostTurns; ++turn) {
      DecaySamples samples = window();
      fit_ = fit_damped_sinusoids(samples.values, poles, {}, samples.missing);
      if (fit_.unit_covariance.size() == 0) return {};
      poles = fit_.poles;
      const auto moved = step();
      if (!moved) return {};
      if (*moved < kSmallStep * kSmallStep) break;
    }
    return tones_;
  }

 private:
  /// Lines of the stretch before the impact, else of the end where the modes have died.
  [[nodiscard]] std::vector<DecayTone> alone() const {
    double slowest = std::numeric_limits<double>::infinity();
    for (const Complex p : fit_.poles) {
      if (-p.real() * static_cast<double>(fit_.samples) > 1) slowest = std::min(slowest, -p.real());
    }
    const auto dead = std::isfinite(slowest)
                          ? at_.start + static_cast<Index>(kDeadTimeConstants / slowest)
                          : at_.end;
    if (at_.quiet >= at_.end - dead) return lines(0, at_.quiet);
    return lines(dead, at_.end);
  }

  [[nodiscard]] std::vector<DecayTone> lines(Index from, Index to) const {
    constexpr Index kFewest = 32;
    if (to - from < kFewest) return {};
    Eigen::VectorXd left = y_.segment(from, to - from);
    DecaySearchOptions search;
    search.candidates = 1, search.lowest = 4 / static_cast<double>(to - from);
    search.energy_over_noise = detection_threshold(to - from, false_alarm_);
    std::vector<DecayTone> found;
    // One at a time: beside a strong one stand the side lobes of its line.
    for (int k = 0; k < kMostTones; ++k) {
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
      const double n = static_cast<double>(to - from);
      const double std = std::sqrt(free.residual_sum_squares / static_cast<double>(free.degrees) *
                                   free.unit_covariance(2, 2));
      const double fall = std::abs(free.poles[0].real()) * n;
      if (fall > std::max(3 * std * n, 0.02) || 2 * std * n > 1) continue;
      DampedSinusoidsOptions undamped;
      undamped.held = 0;
      const auto fit =
          fit_damped_sinusoids(samples.values, std::span(&pole, 1), undamped, samples.missing);
      const double w = fit.poles[0].imag();
      found.push_back({w, fit.amplitudes[0] * std::polar(1.0, -w * static_cast<double>(from))});
    }
    return found;
  }

  /// The window without the tones.
  [[nodiscard]] DecaySamples window() const {
    DecaySamples samples = decay_samples(y_, at_.start, at_.end);
    for (const DecayTone& tone : tones_) {
      samples.values -= at_samples(tone, at_.start, at_.end);
    }
    for (const Index j : samples.missing) samples.values(j) = 0;
    return samples;
  }

  /// Gauss and Newton's step of the tones, the modes following; its square in standard
  /// uncertainties. Fitting either in turns would creep where they are close.
  std::optional<double> step() {
    const Joint joint(fit_, tones_, at_);
    const Index more = joint.inside.cols();
    if (joint.inverse.size() == 0) return {};
    Eigen::VectorXd quiet = decay_samples(y_, 0, at_.quiet).values;
    for (const DecayTone& tone : tones_) quiet -= at_samples(tone, 0, at_.quiet);
    if (at_.quiet > 0) quiet.array() -= quiet.mean();
    for (Index j = 0; j < at_.quiet; ++j) {
      if (!std::isfinite(y_(j))) quiet(j) = 0;
    }
    const Eigen::VectorXd gradient =
        joint.inside.transpose() * fit_.residual + joint.before.transpose() * quiet;
    Eigen::VectorXd delta = joint.inverse.bottomRightCorner(more, more) * gradient;
    const double squared = gradient.dot(delta) * static_cast<double>(fit_.degrees) /
                           std::max(fit_.residual_sum_squares, 1e-300);
    const auto start = static_cast<double>(at_.start);
    for (std::size_t k = 0; k < tones_.size(); ++k) {
      DecayTone& tone = tones_[k];
      const auto own = delta.segment<3>(static_cast<Index>(3 * k));
      const Complex at_start =
          tone.amplitude * std::polar(1.0, tone.w * start) + Complex(own(0), own(1));
      tone.w += own(2);
      tone.amplitude = at_start * std::polar(1.0, -tone.w * start);
      if (!(tone.w > 0 && tone.w < 0.5 * kTwoPi && std::abs(tone.amplitude) > 0)) return {};
    }
    return squared;
  }

  const Eigen::Ref<const Eigen::VectorXd>& y_;
  const ToneStretches& at_;
  double false_alarm_;
  DampedSinusoidsFit fit_;
  std::vector<DecayTone> tones_;
};

}  // namespace

std::vector<DecayTone> steady_tones(const Eigen::Ref<const Eigen::VectorXd>& y,
                                    const ToneStretches& stretches, const DampedSinusoidsFit& fit,
                                    double false_alarm) {
  return ToneFit(y, stretches, fit, false_alarm).run();
}

void subtract_tones(Eigen::VectorXd& y, const std::vector<DecayTone>& tones) {
  for (const DecayTone& tone : tones) y -= at_samples(tone, 0, y.size());
}

Eigen::MatrixXd covariance_beside_tones(const DampedSinusoidsFit& fit,
                                        const std::vector<DecayTone>& tones,
                                        const ToneStretches& stretches) {
  const Joint joint(fit, tones, stretches);
  const Index own = fit.jacobian_gram.rows();
  if (joint.inverse.size() == 0) return {};
  return joint.inverse.topLeftCorner(own, own);
}

}  // namespace rigfit::signal
