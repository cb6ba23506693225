#include "signal/decay/decay_tones.h"

#include <algorithm>
#include <cmath>
#include <limits>

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
// The slowest mode has fallen by e^-7, to a thousandth.
constexpr double kDeadTimeConstants = 7;

Eigen::VectorXd at_samples(const SteadyTone& tone, Index from, Index to) {
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

/// Modes of a fit, offset and drift, over its samples.
Eigen::VectorXd model_of(const DampedSinusoidsFit& fit) {
  Eigen::VectorXd y(fit.samples);
  for (Index j = 0; j < fit.samples; ++j) {
    y(j) = fit.offset + fit.drift * static_cast<double>(j) / static_cast<double>(fit.samples);
  }
  for (std::size_t m = 0; m < fit.poles.size(); ++m) y += fit.mode_signal(m);
  return y;
}

class ToneFit {
 public:
  ToneFit(const Eigen::Ref<const Eigen::VectorXd>& y, const ToneStretches& stretches,
          const DampedSinusoidsFit& fit, double false_alarm)
      : y_(y), at_(stretches), false_alarm_(false_alarm), fit_(fit) {}

  std::vector<SteadyTone> run() {
    for (const SteadyTone& tone : alone()) {
      tones_.push_back(tone);
      if (static_cast<int>(tones_.size()) == kMostTones) break;
    }
    if (tones_.empty()) return {};
    // A mode that the first fit spent on a tone is not needed any more.
    std::vector<Complex> poles;
    for (const Complex pole : fit_.poles) {
      const bool taken = std::any_of(tones_.begin(), tones_.end(), [&](const SteadyTone& tone) {
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
      double moved = 0;
      for (SteadyTone& tone : tones_) {
        const Complex before = tone.amplitude;
        if (!refit(tone)) return {};
        moved = std::max(moved, std::abs(tone.amplitude - before) / std::abs(tone.amplitude));
      }
      if (moved < 1e-4) break;
    }
    return tones_;
  }

 private:
  /// Lines of the stretch before the impact, else of the end where the modes have died.
  [[nodiscard]] std::vector<SteadyTone> alone() const {
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

  [[nodiscard]] std::vector<SteadyTone> lines(Index from, Index to) const {
    constexpr Index kFewest = 32;
    if (to - from < kFewest) return {};
    const DecaySamples samples = decay_samples(y_, from, to);
    if (5 * static_cast<Index>(samples.missing.size()) > to - from) return {};
    DecaySearchOptions search;
    search.candidates = kMostTones, search.lowest = 4 / static_cast<double>(to - from);
    search.energy_over_noise = detection_threshold(to - from, false_alarm_);
    std::vector<SteadyTone> found;
    for (const auto& c :
         search_lines(line_spectrum(without_trend(y_.segment(from, to - from))), search)) {
      const Complex pole(0, c.pole.imag());
      const auto free =
          fit_damped_sinusoids(samples.values, std::span(&pole, 1), {}, samples.missing);
      if (free.unit_covariance.size() == 0) continue;
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
    for (const SteadyTone& tone : tones_) {
      samples.values -= at_samples(tone, at_.start, at_.end);
    }
    for (const Index j : samples.missing) samples.values(j) = 0;
    return samples;
  }

  /// To all samples before the impact and in the window, less the modes and the other tones.
  bool refit(SteadyTone& tone) {
    DecaySamples all = decay_samples(y_, 0, at_.end);
    for (const SteadyTone& other : tones_) {
      if (&other != &tone) all.values -= at_samples(other, 0, at_.end);
    }
    all.values.segment(at_.start, fit_.samples) -= model_of(fit_);
    const double offset = at_.quiet > 0 ? all.values.head(at_.quiet).mean() : 0;
    all.values.head(at_.quiet).array() -= offset;
    std::vector<Index> missing;
    for (const Index j : all.missing) {
      if (j < at_.quiet || j >= at_.start) missing.push_back(j);
    }
    for (Index j = at_.quiet; j < at_.start; ++j) missing.push_back(j);
    std::sort(missing.begin(), missing.end());
    for (const Index j : missing) all.values(j) = 0;
    DampedSinusoidsOptions undamped;
    undamped.held = 0, undamped.background_terms = 0;
    const Complex pole(0, tone.w);
    const auto fit = fit_damped_sinusoids(all.values, std::span(&pole, 1), undamped, missing);
    if (fit.unit_covariance.size() == 0) return false;
    tone = {fit.poles[0].imag(), fit.amplitudes[0]};
    return std::abs(tone.amplitude) > 0;
  }

  const Eigen::Ref<const Eigen::VectorXd>& y_;
  const ToneStretches& at_;
  double false_alarm_;
  DampedSinusoidsFit fit_;
  std::vector<SteadyTone> tones_;
};

}  // namespace

std::vector<SteadyTone> steady_tones(const Eigen::Ref<const Eigen::VectorXd>& y,
                                     const ToneStretches& stretches, const DampedSinusoidsFit& fit,
                                     double false_alarm) {
  return ToneFit(y, stretches, fit, false_alarm).run();
}

void subtract_tones(Eigen::VectorXd& y, const std::vector<SteadyTone>& tones) {
  for (const SteadyTone& tone : tones) y -= at_samples(tone, 0, y.size());
}

Eigen::MatrixXd covariance_beside_tones(const DampedSinusoidsFit& fit,
                                        const std::vector<SteadyTone>& tones,
                                        const ToneStretches& stretches) {
  const Index own = fit.jacobian_gram.rows(), more = 3 * static_cast<Index>(tones.size());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(own + more, own + more);
  gram.topLeftCorner(own, own) = fit.jacobian_gram;
  const Index n = fit.samples;
  // Re, Im of the amplitude at the window's start, and w, of each tone.
  const auto columns = [&](Index from, Index to) {
    Eigen::MatrixXd all(to - from, more);
    for (std::size_t k = 0; k < tones.size(); ++k) {
      const double start = static_cast<double>(stretches.start);
      const Complex at_start = tones[k].amplitude * std::polar(1.0, tones[k].w * start);
      for (Index j = from; j < to; ++j) {
        const double t = static_cast<double>(j) - start;
        const Complex z = std::polar(1.0, tones[k].w * t);
        const auto c = static_cast<Index>(3 * k);
        all(j - from, c) = z.real(), all(j - from, c + 1) = -z.imag();
        all(j - from, c + 2) = -t * (at_start * z).imag();
      }
    }
    return all;
  };
  const Eigen::MatrixXd inside = columns(stretches.start, stretches.start + n);
  for (Index k = 0; k < own; ++k) {
    gram.block(k, own, 1, more) = fit.jacobian_column(k).transpose() * inside;
  }
  gram.bottomLeftCorner(more, own) = gram.topRightCorner(own, more).transpose();
  gram.bottomRightCorner(more, more) = inside.transpose() * inside;
  if (stretches.quiet > 0) {
    const Eigen::MatrixXd before = columns(0, stretches.quiet);
    gram.bottomRightCorner(more, more) += before.transpose() * before;
  }
  if (!(gram.diagonal().minCoeff() > 0)) return {};
  const ScaledGram normal(gram);
  if (!normal.usable()) return {};
  return normal.inverse().topLeftCorner(own, own);
}

}  // namespace rigfit::signal
