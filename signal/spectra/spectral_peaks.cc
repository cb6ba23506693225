#include "signal/spectra/spectral_peaks.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "signal/estimation/groups.h"
#include "signal/spectra/fft.h"
#include "signal/spectra/line_means.h"
#include "signal/spectra/window.h"

namespace rigfit::signal {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// A Hann window correlates neighbouring lines: the variance of what is estimated from many lines
// grows by mean(w^4) / mean(w^2)^2.
constexpr double kHannVariance = 35.0 / 18;

/// Power per Hz of one windowed block, one-sided.
VectorXd block_power(const Eigen::Ref<const VectorXd>& block, const VectorXd& window,
                     double rate_hz, RealFft& fft) {
  fft.time() = (block.array() - block.mean()) * window.array();
  fft.forward();
  VectorXd power = 2 * fft.spectrum().cwiseAbs2() / (rate_hz * window.squaredNorm());
  power[0] /= 2;
  return power;
}

VectorXd welch(const Eigen::Ref<const VectorXd>& samples, Index length, double rate_hz,
               Index& averages) {
  RealFft fft(length);
  const VectorXd window = hann_window(length);
  VectorXd sum = VectorXd::Zero(length / 2 + 1);
  averages = 0;
  for (Index first = 0; first + length <= samples.size(); first += length / 2, ++averages) {
    sum += block_power(samples.segment(first, length), window, rate_hz, fft);
  }
  return sum / static_cast<double>(averages);
}

// Parts of the record that are compared, as long as a part resolves the peak into so many lines.
constexpr Index kParts = 8;
constexpr double kLinesInPart = 2;
constexpr Index kFewestPeakLines = 8;  // twice the parameters of a peak
constexpr double kPartsDiffer = 0.01;  // chance that parts which agree look so

struct Lorentzian {
  Eigen::Vector4d parameters;  // f0, ln B, ln A, ln C

  /// S at f and its derivatives.
  double at(double f, Eigen::Vector4d& rate) const {
    const double d = f - parameters[0], h = std::exp(parameters[1]) / 2,
                 a = std::exp(parameters[2]);
    const double c = std::exp(parameters[3]), q = d * d + h * h, l = h * h / q;
    rate = {2 * a * d * h * h / (q * q), 2 * a * h * h * d * d / (q * q), a * l, c};
    return a * l + c;
  }
};

struct WhittleFit {
  Lorentzian shape;
  Eigen::Matrix4d covariance;
  bool converged = false;
};

double minus_log_likelihood(const VectorXd& power, double first_hz, double step_hz,
                            const Lorentzian& shape) {
  double sum = 0;
  Eigen::Vector4d rate;
  for (Index k = 0; k < power.size(); ++k) {
    const double s = shape.at(first_hz + step_hz * static_cast<double>(k), rate);
    sum += std::log(s) + power[k] / s;
  }
  return sum;
}

/// Fisher scoring, damped while the likelihood falls.
WhittleFit fit_peak(const VectorXd& power, double first_hz, double step_hz,
                    const Eigen::Vector4d& start) {
  WhittleFit fit;
  fit.shape.parameters = start;
  double cost = minus_log_likelihood(power, first_hz, step_hz, fit.shape), damping = 1e-3;
  for (int iteration = 0; iteration < 200 && !fit.converged; ++iteration) {
    Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
    Eigen::Vector4d score = Eigen::Vector4d::Zero(), rate;
    for (Index k = 0; k < power.size(); ++k) {
      const double s = fit.shape.at(first_hz + step_hz * static_cast<double>(k), rate);
      rate /= s;
      information += rate * rate.transpose();
      score += (power[k] / s - 1) * rate;
    }
    const Eigen::Vector4d scale =
        information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::Matrix4d scaled = scale.asDiagonal() * information * scale.asDiagonal();
    fit.covariance =
        scale.asDiagonal() *
        (scaled + 1e-12 * Eigen::Matrix4d::Identity()).ldlt().solve(Eigen::Matrix4d::Identity()) *
        scale.asDiagonal();
    bool lower = false;
    for (; damping < 1e12; damping *= 10) {
      const Eigen::Vector4d step = scale.cwiseProduct(
          (scaled + damping * Eigen::Matrix4d::Identity()).ldlt().solve(scale.cwiseProduct(score)));
      Lorentzian next{fit.shape.parameters + step};
      const double there = minus_log_likelihood(power, first_hz, step_hz, next);
      if (!(there <= cost)) continue;
      fit.converged = cost - there < 1e-9 * (1 + std::abs(cost));
      fit.shape = next;
      cost = there;
      lower = true;
      damping = std::max(1e-12, damping / 10);
      break;
    }
    if (!lower) fit.converged = true;  // no step lowers it any more
  }
  return fit;
}

/// Frequency of the peak `whole` over parts of the record; `between_parts_hz` where they differ.
/// `from`, `to`: its band, Hz.
void compare_parts(const VectorXd& samples, double rate_hz, double from, double to,
                   const WhittleFit& whole, SpectralPeak& peak) {
  const Index length = good_fft_length_below(samples.size() / kParts);
  const double line = rate_hz / static_cast<double>(length);
  if (!(peak.bandwidth_hz > kLinesInPart * line)) return;
  const Index first = std::max<Index>(1, std::lround(from / line));
  const Index count = std::min(length / 2, static_cast<Index>(std::lround(to / line))) - first + 1;
  if (count < kFewestPeakLines) return;
  RealFft fft(length);
  const VectorXd window = hann_window(length);
  std::vector<double> values, variances;
  for (Index k = 0; k < kParts; ++k) {
    const VectorXd power =
        block_power(samples.segment(k * (samples.size() / kParts), length), window, rate_hz, fft);
    const auto part = fit_peak(power.segment(first, count), line * static_cast<double>(first), line,
                               whole.shape.parameters);
    const double center = part.shape.parameters[0];
    if (!part.converged || !(std::abs(center - peak.frequency_hz.value) < 2 * peak.bandwidth_hz)) {
      continue;
    }
    values.push_back(center);
    variances.push_back(kHannVariance * part.covariance(0, 0));
  }
  if (static_cast<Index>(values.size()) < kParts / 2) return;
  const GroupMean mean = mean_over_groups(values, variances);
  if (mean.chance > kPartsDiffer) return;
  peak.between_parts_hz = std::sqrt(mean.between_variance);
  peak.frequency_hz = {mean.mean,
                       std::max(peak.frequency_hz.std, std::sqrt(mean.variance) *
                                                           coverage_factor(0.95, mean.degrees) /
                                                           coverage_factor(0.95, 0))};
}

/// Local maxima of Welch's spectrum that stand out of the floor, strongest first.
std::vector<Index> candidates(const VectorXd& spectrum, const VectorXd& floor, Index first,
                              Index last, double limit) {
  std::vector<Index> found;
  for (Index k = std::max<Index>(1, first); k <= std::min(last, spectrum.size() - 2); ++k) {
    if (spectrum[k] < spectrum[k - 1] || spectrum[k] < spectrum[k + 1] ||
        spectrum[k] < limit * floor[k])
      continue;
    // A ripple on a stronger peak's flank: the spectrum does not fall to half of this one between
    // them.
    const bool ripple = std::any_of(found.begin(), found.end(), [&](Index other) {
      return spectrum.segment(other, k - other + 1).minCoeff() >
             0.5 * std::min(spectrum[k], spectrum[other]);
    });
    if (!ripple) {
      found.push_back(k);
    } else if (spectrum[k] > spectrum[found.back()]) {
      found.back() = k;
    }
  }
  return found;
}

void sort_tones(std::vector<SteadyTone>& tones) {
  std::sort(tones.begin(), tones.end(),
            [](const auto& a, const auto& b) { return a.frequency_hz < b.frequency_hz; });
}

}  // namespace

SpectralPeaks spectral_peaks(const Eigen::Ref<const VectorXd>& recorded, double rate_hz,
                             const SpectralPeakOptions& options) {
  if (recorded.size() < 256 || !(rate_hz > 0)) {
    throw std::invalid_argument("spectral peaks need at least 256 samples and a sample rate");
  }
  if (!recorded.allFinite()) throw std::invalid_argument("a sample is missing or not finite");
  const double high = options.high_hz > 0 ? std::min(options.high_hz, rate_hz / 2) : rate_hz / 2;
  if (!(high > options.low_hz))
    throw std::invalid_argument("the band holds no line below half the sample rate");
  SpectralPeaks result;
  auto removed = remove_steady_tones(recorded, rate_hz, options.low_hz, high);
  result.tones = std::move(removed.tones);
  const VectorXd& samples = removed.samples;

  // At least 8 averages of half-overlapping blocks: a block of 2 / 9 of the record.
  Index length = good_fft_length_below(std::max<Index>(64, samples.size() * 2 / 9));
  length = std::min(length, good_fft_length(std::max<Index>(2048, samples.size() / 100)));
  Index averages = 0;
  result.spectrum = welch(samples, length, rate_hz, averages);
  result.frequency_hz = line_frequencies(length, rate_hz);
  if (recorded.minCoeff() == recorded.maxCoeff()) {
    result.reason = "every sample is the same: nothing moves, or the channel is not connected";
    return result;
  }
  const double step = rate_hz / static_cast<double>(length);
  const Index first = static_cast<Index>(std::ceil(options.low_hz / step));
  const Index last = static_cast<Index>(std::floor(high / step));
  // Peaks included: the floor beside a peak.
  const VectorXd floor =
      median_over_lines(result.spectrum, std::max<Index>(10, result.spectrum.size() / 40));
  // The largest of n averages of K powers of noise: about 1 + sqrt(2 ln(n / 0.01) / K) + ln(n /
  // 0.01) / K means.
  const double rare = std::log(static_cast<double>(std::max<Index>(2, last - first + 1)) / 0.01);
  const double k =
      0.6 * static_cast<double>(averages);  // overlapping blocks count less than one each
  const double limit = 1 + std::sqrt(2 * rare / k) + rare / k;
  auto found = candidates(result.spectrum, floor, first, last, limit);
  std::sort(found.begin(), found.end(),
            [&](Index a, Index b) { return result.spectrum[a] > result.spectrum[b]; });
  if (found.size() > static_cast<std::size_t>(options.max_peaks))
    found.resize(static_cast<std::size_t>(options.max_peaks));
  std::sort(found.begin(), found.end());
  if (found.empty()) {
    sort_tones(result.tones);
    result.reason =
        fmt::format("no peak stands {:.1f} times out of the floor of the averaged spectrum", limit);
    return result;
  }

  const Index whole = good_fft_length_below(samples.size());
  RealFft fft(whole);
  const VectorXd periodogram = block_power(samples.head(whole), hann_window(whole), rate_hz, fft);
  const double line = rate_hz / static_cast<double>(whole);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double f0 = step * static_cast<double>(found[i]);
    // Half-way to the neighbours, but no wider than needed for the floor.
    const double below = i > 0 ? 0.5 * (f0 - step * static_cast<double>(found[i - 1])) : 40 * step;
    const double above =
        i + 1 < found.size() ? 0.5 * (step * static_cast<double>(found[i + 1]) - f0) : 40 * step;
    const Index from = std::max<Index>(1, std::lround((f0 - std::min(below, 40 * step)) / line));
    const Index to =
        std::min(periodogram.size() - 1, std::lround((f0 + std::min(above, 40 * step)) / line));
    if (to - from < kFewestPeakLines) continue;
    const double top = result.spectrum[found[i]], base = std::min(floor[found[i]], 0.5 * top);
    const auto fit =
        fit_peak(periodogram.segment(from, to - from + 1), line * static_cast<double>(from), line,
                 {f0, std::log(2 * step), std::log(top), std::log(std::max(base, 1e-12 * top))});
    const double B = std::exp(fit.shape.parameters[1]), center = fit.shape.parameters[0];
    if (!fit.converged || !(center > line * static_cast<double>(from)) ||
        !(center < line * static_cast<double>(to)))
      continue;
    SpectralPeak peak;
    peak.bandwidth_hz = B;
    peak.tone = B < 4 * line;
    peak.signal_to_noise = std::exp(fit.shape.parameters[2] - fit.shape.parameters[3]);
    // A tone's frequency is known to a part of a line; the resonance's formula does not hold there.
    const double std = std::sqrt(kHannVariance * fit.covariance(0, 0));
    peak.frequency_hz = {center, peak.tone ? std::max(std, line / std::sqrt(12.0)) : std};
    compare_parts(samples, rate_hz, line * static_cast<double>(from),
                  line * static_cast<double>(to), fit, peak);
    const auto within = [&](double reach, bool wanders) {
      return std::any_of(result.tones.begin(), result.tones.end(), [&](const auto& tone) {
        return (tone.reach_hz > 0) == wanders &&
               std::abs(tone.frequency_hz - center) < std::max(reach, tone.reach_hz);
      });
    };
    if (within(0, true)) continue;  // the peak belongs to a tone whose frequency wanders
    SteadyTone tone;
    const auto nature = nature_of_line(samples, rate_hz, center, tone);
    if (nature == LineNature::steady) {
      result.tones.push_back(tone);
      continue;
    }
    const double near = tone_resolution_hz(static_cast<double>(samples.size()), rate_hz);
    peak.undecided = nature == LineNature::undecided || within(near, false);
    result.peaks.push_back(peak);
  }
  sort_tones(result.tones);
  if (result.peaks.empty()) {
    result.reason = result.tones.empty()
                        ? "the peaks of the averaged spectrum have no shape of a resonance"
                        : "the peaks of the averaged spectrum are tones of constant amplitude";
  }
  return result;
}

}  // namespace rigfit::signal
