#include "signal/envelope/log_decrement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace rigfit::signal {
namespace {

using Eigen::Index;

// Band-limited interpolation between samples at eighths of a sample, from 2 * kTaps samples under a
// Kaiser window with beta = 8 (-80 dB).
constexpr int kTaps = 8;
constexpr int kPhases = 8;

double kaiser(double x) {
  if (x * x >= 1) return 0;
  constexpr double beta = 8;
  return std::cyl_bessel_i(0.0, beta * std::sqrt(1 - x * x)) / std::cyl_bessel_i(0.0, beta);
}

using Taps = std::array<std::array<double, 2 * kTaps>, kPhases>;

const Taps& taps() {
  static const Taps table = [] {
    Taps weights{};
    for (int phase = 0; phase < kPhases; ++phase) {
      auto& row = weights[static_cast<std::size_t>(phase)];
      double sum = 0;
      for (int k = 0; k < 2 * kTaps; ++k) {
        const double x = static_cast<double>(phase) / kPhases - (k - kTaps + 1);
        const double angle = std::numbers::pi * x;
        row[static_cast<std::size_t>(k)] =
            (std::abs(x) < 1e-12 ? 1.0 : std::sin(angle) / angle) * kaiser(x / kTaps);
        sum += row[static_cast<std::size_t>(k)];
      }
      for (double& w : row) w /= sum;
    }
    return weights;
  }();
  return table;
}

// At `eighths` eighths of a sample.
double interpolated(const Eigen::VectorXd& y, Index eighths) {
  const Index whole = eighths / kPhases;
  const auto& row = taps()[static_cast<std::size_t>(eighths % kPhases)];
  return y.segment<2 * kTaps>(whole - kTaps + 1)
      .dot(Eigen::Map<const Eigen::Matrix<double, 2 * kTaps, 1>>(row.data()));
}

// At any time, by a parabola through the three nearest eighths.
double value_at(const Eigen::VectorXd& y, double time) {
  const auto at = static_cast<Index>(std::lround(time * kPhases));
  const double u = time * kPhases - static_cast<double>(at);
  const double left = interpolated(y, at - 1), middle = interpolated(y, at),
               right = interpolated(y, at + 1);
  return middle + 0.5 * u * (right - left) + 0.5 * u * u * (left - 2 * middle + right);
}

struct Extreme {
  double time;  // samples
  double value;
};

// The extreme of sign * y in [from, to]: best sample, then a search between its neighbours.
bool find_extreme(const Eigen::VectorXd& y, double from, double to, double sign, Extreme& found) {
  const auto lo = std::max<Index>(kTaps, static_cast<Index>(std::ceil(from)));
  const auto hi = std::min<Index>(y.size() - kTaps - 2, static_cast<Index>(std::floor(to)));
  if (hi < lo) return false;
  Index best = lo;
  for (Index j = lo; j <= hi; ++j) {
    if (sign * y(j) > sign * y(best)) best = j;
  }
  // A slope that runs out of the range is no extreme.
  if (sign * y(best - 1) > sign * y(best) || sign * y(best + 1) > sign * y(best)) return false;
  // Eight steps a sample, then a parabola: its error is of fourth order in a tenth of a radian.
  Index at = best * kPhases;
  double value = sign * y(best);
  for (Index k = best * kPhases - kPhases; k <= best * kPhases + kPhases; ++k) {
    const double v = sign * interpolated(y, k);
    if (v > value) value = v, at = k;
  }
  double time = static_cast<double>(at) / kPhases;
  const double left = sign * interpolated(y, at - 1), right = sign * interpolated(y, at + 1);
  const double bend = left - 2 * value + right;
  if (bend < 0) {
    const double shift = std::clamp(0.5 * (left - right) / bend, -0.5, 0.5);
    value -= 0.25 * (left - right) * shift;
    time += shift / kPhases;
  }
  found = {time, sign * value};
  return true;
}

}  // namespace

LogDecrementResult log_decrement(const Eigen::Ref<const Eigen::VectorXd>& y, double sample_rate_hz,
                                 double frequency_hz, const LogDecrementOptions& options) {
  if (!(sample_rate_hz > 0) || !(frequency_hz > 0)) {
    throw std::invalid_argument("log_decrement: sample rate and frequency must be positive");
  }
  LogDecrementResult result;
  double per_cycle = sample_rate_hz / frequency_hz;
  if (per_cycle < 2.5) {
    result.refusal = "fewer than 2.5 samples a cycle: peaks cannot be interpolated";
    return result;
  }
  // Many samples a cycle: means over blocks, 16 to 32 a cycle, so that noise does not make peaks.
  const auto block = std::max<Index>(1, static_cast<Index>(per_cycle / 16));
  Eigen::VectorXd x(y.size() / block);
  for (Index j = 0; j < x.size(); ++j) x(j) = y.segment(j * block, block).mean();
  per_cycle /= static_cast<double>(block);
  const double rate = sample_rate_hz / static_cast<double>(block);
  const double noise = options.noise_std / std::sqrt(static_cast<double>(block));

  // First pass: when the extremes are, from one to the next half a cycle on.
  std::vector<Extreme> extremes;
  Extreme high;
  for (int quarter = 0; quarter < 4 && extremes.empty(); ++quarter) {
    const double begin = kTaps + 0.25 * quarter * per_cycle;
    if (!find_extreme(x, begin, begin + 0.6 * per_cycle, 1, high)) continue;
    extremes.push_back(high);
  }
  double sign = -1;
  while (!extremes.empty()) {
    const double expected = extremes.back().time + 0.5 * per_cycle;
    Extreme next;
    if (!find_extreme(x, expected - 0.2 * per_cycle, expected + 0.2 * per_cycle, sign, next)) break;
    const double swing = sign * (next.value - extremes.back().value);
    if (!(swing > options.least_swing * noise) || !(swing > 0)) break;
    extremes.push_back(next);
    sign = -sign;
  }
  if (extremes.size() < 4) {
    result.refusal = "fewer than three swings above the noise";
    return result;
  }
  // Second pass: extremes lie half a damped cycle apart, so a line through their times, weighted
  // with their swings, says when they were; read there, values are not biased by noise that looks
  // for the highest sample.
  {
    double w = 0, wk = 0, wt = 0;
    for (std::size_t k = 1; k < extremes.size(); ++k) {
      const double d = extremes[k].value - extremes[k - 1].value;
      w += d * d, wk += d * d * static_cast<double>(k), wt += d * d * extremes[k].time;
    }
    double kk = 0, kt = 0;
    for (std::size_t k = 1; k < extremes.size(); ++k) {
      const double d = extremes[k].value - extremes[k - 1].value;
      kk += d * d * (static_cast<double>(k) - wk / w) * (static_cast<double>(k) - wk / w);
      kt += d * d * (static_cast<double>(k) - wk / w) * (extremes[k].time - wt / w);
    }
    for (std::size_t k = 0; k < extremes.size(); ++k) {
      const double time = wt / w + kt / kk * (static_cast<double>(k) - wk / w);
      extremes[k].value = value_at(x, std::clamp(time, static_cast<double>(kTaps),
                                                 static_cast<double>(x.size() - kTaps - 2)));
    }
  }
  double sw = 0, sk = 0, sl = 0, st = 0;
  const std::size_t count = extremes.size() - 1;
  std::vector<double> log_swing(count), weight(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double d = std::max(std::abs(extremes[k + 1].value - extremes[k].value), 1e-300);
    const double t = 0.5 * (extremes[k].time + extremes[k + 1].time);
    result.swing.push_back(d);
    result.time_s.push_back(
        (t + 0.5 * static_cast<double>(block - 1) / static_cast<double>(block)) / rate);
    log_swing[k] = std::log(d), weight[k] = d * d;
    sw += weight[k], sk += weight[k] * static_cast<double>(k), sl += weight[k] * log_swing[k];
    st += weight[k] * t;
  }
  const double mean_k = sk / sw, mean_l = sl / sw, mean_t = st / sw;
  double skk = 0, skl = 0, sll = 0, skt = 0, stt = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double dk = static_cast<double>(k) - mean_k, dl = log_swing[k] - mean_l;
    const double dt = 0.5 * (extremes[k].time + extremes[k + 1].time) - mean_t;
    skk += weight[k] * dk * dk, skl += weight[k] * dk * dl, sll += weight[k] * dl * dl;
    skt += weight[k] * dk * dt, stt += weight[k] * dt * dt;
  }
  const double slope = skl / skk;
  const double misfit = std::max(0.0, sll - slope * skl);
  // Neighbouring swings share an extreme: their errors correlate by 1/2, which doubles the
  // variance of a slope over that of independent errors.
  const double slope_std = std::sqrt(2 * misfit / static_cast<double>(count - 2) / skk);
  const double delta = -2 * slope, delta_std = 2 * slope_std;
  const double root = std::sqrt(4 * std::numbers::pi * std::numbers::pi + delta * delta);
  result.log_decrement = {delta, delta_std};
  result.damping_ratio = {
      delta / root, delta_std * 4 * std::numbers::pi * std::numbers::pi / (root * root * root)};
  const double half_period = skt / skk / rate;
  const double half_period_std =
      std::sqrt(std::max(0.0, stt - skt * skt / skk) / static_cast<double>(count - 2) / skk) / rate;
  result.frequency_hz = {0.5 / half_period, 0.5 / (half_period * half_period) * half_period_std};
  result.r_squared = sll > 0 ? 1 - misfit / sll : 1;
  return result;
}

}  // namespace rigfit::signal
