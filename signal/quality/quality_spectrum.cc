#include "signal/quality/quality_spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "signal/estimation/robust.h"
#include "signal/numerics/numbers.h"
#include "signal/spectra/fft.h"

namespace rigfit::signal {
namespace {

Eigen::VectorXd hann(Eigen::Index n) {
  return (0.5 - 0.5 * (Eigen::ArrayXd::LinSpaced(n, 0, static_cast<double>(n - 1)) * kTwoPi /
                       static_cast<double>(n))
                          .cos())
      .matrix();
}

/// Power density of Hann-windowed pieces, averaged; unit^2 / Hz.
Eigen::VectorXd power_density(const Eigen::Ref<const Eigen::VectorXd>& samples, Eigen::Index length,
                              double rate, int most, int& averages) {
  const Eigen::VectorXd window = hann(length);
  RealFft fft(length);
  Eigen::VectorXd density = Eigen::VectorXd::Zero(fft.lines());
  const Eigen::Index room = samples.size() - length;
  averages = static_cast<int>(std::min<Eigen::Index>(most, 1 + 2 * room / length));
  for (int k = 0; k < averages; ++k) {
    const Eigen::Index at = averages == 1 ? 0 : room * k / (averages - 1);
    const auto piece = samples.segment(at, length);
    fft.time() = ((piece.array() - piece.mean()) * window.array()).matrix();
    fft.forward();
    density += fft.spectrum().cwiseAbs2();
  }
  return density * (2 / (rate * window.squaredNorm() * averages));
}

/// Rms of the sinusoid of that frequency in `samples` under a Hann window.
double line_rms(const Eigen::Ref<const Eigen::VectorXd>& samples, double frequency, double rate) {
  const Eigen::Index n = samples.size();
  std::complex<double> sum = 0;
  double weight = 0;
  const double mean = samples.mean();
  for (Eigen::Index k = 0; k < n; ++k) {
    const double w = 0.5 - 0.5 * std::cos(kTwoPi * static_cast<double>(k) / static_cast<double>(n));
    sum += w * (samples[k] - mean) *
           std::polar(1.0, -kTwoPi * frequency * static_cast<double>(k) / rate);
    weight += w;
  }
  return std::numbers::sqrt2 * std::abs(sum) / weight;
}

struct SpectralLine {
  bool found = false;
  double rms = 0;
};

/// A narrow, steady line near `frequency`.
SpectralLine find_line(const Eigen::Ref<const Eigen::VectorXd>& samples,
                       const Eigen::VectorXd& density, double frequency, double rate,
                       const QualityOptions& options) {
  SpectralLine line;
  const double spacing = rate / static_cast<double>(samples.size());
  // European and American grids keep within 0.2 Hz.
  const double search = 0.004 * frequency + spacing;
  const auto low = static_cast<Eigen::Index>(std::floor((frequency - search) / spacing));
  const auto high = static_cast<Eigen::Index>(std::ceil((frequency + search) / spacing));
  if (low < 8 || high + 8 >= density.size()) return line;
  Eigen::Index peak = 0;
  density.segment(low, high - low + 1).maxCoeff(&peak);
  peak += low;
  // The neighbourhood: some 40 lines on either side, without the window's main lobe.
  std::vector<double> around;
  for (Eigen::Index k = std::max<Eigen::Index>(1, peak - 44);
       k <= std::min(density.size() - 1, peak + 44); ++k) {
    if (std::abs(k - peak) > 3) around.push_back(density[k]);
  }
  const double floor = median(around);
  const double ratio = options.hum_ratio * options.hum_ratio;
  if (!(density[peak] > ratio * floor)) return line;
  // As narrow as the window: from the fourth line on a steady sinusoid has below 1e-3 of its power.
  for (const Eigen::Index offset : {-6, -5, -4, 4, 5, 6}) {
    if (density[peak + offset] > 0.02 * density[peak]) return line;
  }
  const double at = static_cast<double>(peak) * spacing;
  double least = 0, most = 0;
  const Eigen::Index quarter = samples.size() / 4;
  for (int q = 0; q < 4; ++q) {
    const double rms = line_rms(samples.segment(q * quarter, quarter), at, rate);
    least = q == 0 ? rms : std::min(least, rms);
    most = std::max(most, rms);
  }
  if (most > options.hum_steadiness * least) return line;
  // The lobe's power is that of the line.
  line.rms = std::sqrt(density.segment(peak - 3, 7).sum() * spacing);
  line.found = true;
  return line;
}

}  // namespace

SpectralQuality spectral_quality(const Eigen::Ref<const Eigen::VectorXd>& samples,
                                 double sample_rate_hz, const QualityOptions& options) {
  SpectralQuality result;
  const Eigen::Index n = samples.size();
  if (n < 64 || !(sample_rate_hz > 0)) return result;
  constexpr Eigen::Index kPiece = 8192;
  int averages = 1;
  const Eigen::VectorXd density = power_density(samples, good_fft_length_below(std::min(n, kPiece)),
                                                sample_rate_hz, 64, averages);
  std::vector<double> lines(density.data() + 1, density.data() + density.size());
  // Pieces overlap by half: with a Hann window about 0.95 of them count as independent.
  const double independent = 1 + 0.95 * (averages - 1);
  const double bias = std::pow(1 - 1 / (9 * independent), 3);
  result.noise_floor = std::sqrt(median(std::move(lines)) / bias * sample_rate_hz / 2);

  // Hum: one transform of up to a million samples from the middle; two seconds separate 50 from 51
  // Hz.
  constexpr Eigen::Index kLong = Eigen::Index{1} << 20;
  const Eigen::Index length = good_fft_length_below(std::min(n, kLong));
  if (static_cast<double>(length) < 2 * sample_rate_hz) return result;
  const auto middle = samples.segment((n - length) / 2, length);
  const Eigen::VectorXd fine = power_density(middle, length, sample_rate_hz, 1, averages);
  for (const double mains : {50.0, 60.0}) {
    double power = 0;
    int found = 0;
    bool fundamental = false;
    for (int harmonic = 1; harmonic <= 6; ++harmonic) {
      const SpectralLine line = find_line(middle, fine, mains * harmonic, sample_rate_hz, options);
      if (!line.found) continue;
      ++found;
      fundamental = fundamental || harmonic == 1;
      power += line.rms * line.rms;
    }
    // Rectified hum may lack its fundamental, but then has several multiples; one or two alone are
    // as likely a machine or a shaker.
    if ((fundamental || found >= 3) && power > result.mains_rms * result.mains_rms) {
      result.mains_hz = mains;
      result.mains_rms = std::sqrt(power);
      result.harmonics = found;
    }
  }
  return result;
}

}  // namespace rigfit::signal
