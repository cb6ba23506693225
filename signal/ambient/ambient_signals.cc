#include "signal/ambient/ambient_steps.h"

#include <future>

#include "signal/numerics/power_sums.h"
#include "signal/recording/recording.h"
#include "signal/spectra/fft.h"

namespace rigfit::signal {

namespace {

constexpr Index kSide = 14;           // lines 3 to 14 beside a line are its neighbours
constexpr Index kLobe = 3;            // a Hann window's lobe ends before
constexpr double kFalseTones = 1e-3;  // chance of one in a recording of noise
constexpr std::size_t kMostTones = 40;

struct Line {
  Index k = 0, channel = 0;
  double F = 0;
};

/// Leaves the spectrum in `fft`: of a day of samples a copy is large.
void hann_spectrum(const AmbientSignals& signals, Index channel, RealFft& fft) {
  signals.read(channel, 0, fft.time());
  const Index n = fft.length(), block = std::min<Index>(n, 1 << 16);
  const double turn = kTwoPi / static_cast<double>(n);
  const VectorXcd turns = powers({0, turn}, block);
  for (Index k = 0; k < n; k += block) {
    const Index count = std::min(block, n - k);
    const Complex first = std::polar(0.5, turn * static_cast<double>(k));
    fft.time().segment(k, count).array() *= 0.5 - (first * turns.head(count)).real().array();
  }
  fft.forward();
}

/// Lines of exp(i 2 pi f n), f in lines, under a Hann window: at k - kSide .. k + kSide.
VectorXcd hann_lines(double f, Index k, Index n) {
  const auto sum = [n](double d) {  // of exp(2 pi i d m / n) over m
    const double u = kTwoPi * d / static_cast<double>(n);
    if (std::abs(d) < 1e-9) return Complex(static_cast<double>(n));
    return (1.0 - std::polar(1.0, kTwoPi * d)) / (1.0 - std::polar(1.0, u));
  };
  VectorXcd lines(2 * kSide + 1);
  for (Index j = -kSide; j <= kSide; ++j) {
    const double d = f - static_cast<double>(k + j);
    lines[j + kSide] = 0.5 * sum(d) - 0.25 * sum(d + 1) - 0.25 * sum(d - 1);
  }
  return lines;
}

/// The strongest outstanding lines; no two within a lobe.
std::vector<Line> outstanding(const AmbientSignals& signals, RealFft& fft, Index low, Index high) {
  const double tests = static_cast<double>((high - low) * signals.channels());
  const double limit = 12 * (std::pow(tests / kFalseTones, 1.0 / 12) - 1);
  std::vector<Line> all, kept;
  for (Index c = 0; c < signals.channels(); ++c) {
    hann_spectrum(signals, c, fft);
    const VectorXd power = fft.spectrum().cwiseAbs2();
    for (Index k = low; k < high; ++k) {
      if (power[k] < power[k - 1] || power[k] < power[k + 1]) continue;
      const double beside = power.segment(k - kSide, 12).sum() + power.segment(k + kLobe, 12).sum();
      if (24 * power[k] > limit * beside) all.push_back({k, c, 24 * power[k] / beside});
    }
  }
  std::ranges::sort(all, std::greater(), &Line::F);
  for (const Line& line : all) {
    const bool known =
        std::ranges::any_of(kept, [&](const Line& l) { return std::abs(l.k - line.k) < kLobe; });
    if (!known && kept.size() < kMostTones) kept.push_back(line);
  }
  return kept;
}

/// Sums of products with x(t), t in [from, to), by lag. `block`: samples of all channels.
MatrixXd correlation(const std::function<MatrixXd(Index first, Index count)>& block,
                     const MatrixXd& filters, Index from, Index to, Index lags) {
  const Index channels = filters.rows(), signals = filters.cols(), span = 2 * lags + 1;
  // Half of a transform is wasted, but spectra of all pairs are held: twice as long ones would take
  // 0.16 GB more of 16 channels and 20000 lags. 2^16 samples stay in a processor's cache.
  const Index usual = std::max<Index>(1 << 16, 4 * lags);
  const Index length = good_fft_length(std::min(to - from + 2 * lags, usual));
  const Index piece = length - 2 * lags;
  RealFft fft(length);
  MatrixXcd sums = MatrixXcd::Zero(fft.lines(), channels * signals);
  for (; from < to; from += piece) {
    const Index count = std::min(piece, to - from);
    const MatrixXd wide = block(from - lags, count + 2 * lags);
    const MatrixXcd Y = real_spectra(wide, length);
    const MatrixXcd X = real_spectra(wide.middleRows(lags, count) * filters, length);
    for (Index p = 0; p < sums.cols(); ++p) {
      sums.col(p).array() += X.col(p / channels).array().conjugate() * Y.col(p % channels).array();
    }
  }
  MatrixXd R(span, sums.cols());
  for (Index p = 0; p < sums.cols(); ++p) {
    fft.spectrum() = sums.col(p);
    fft.inverse();
    R.col(p) = fft.time().head(span);
  }
  return R;
}

}  // namespace

AmbientSignals::AmbientSignals(const Recording& recording, const std::vector<Index>& channels,
                               double low_hz)
    : samples_(recording.samples()), rate_hz_(recording.sample_rate_hz) {
  const std::string file = recording.path.string();
  if (!(rate_hz_ > 0) || recording.time_s.size() > 0) {
    throw file_error(file, "the samples are not evenly spaced in time, or their rate is unknown",
                     "resample it (rigfit resample), or state the sample rate");
  }
  for (const Index c : channels) {
    x_.push_back(&recording.channels[static_cast<std::size_t>(c)].samples);
  }
  Index missing = 0;
  for (Index i = 0; i < samples_; ++i) {
    const bool gap =
        std::ranges::any_of(x_, [&](const VectorXd* x) { return !std::isfinite((*x)[i]); });
    if (!gap) continue;
    if (gaps_.empty() || gaps_.back().second < i) gaps_.emplace_back(i, i);
    ++gaps_.back().second, ++missing;
  }
  const double count = static_cast<double>(samples_ - missing);
  present_ = samples_ > 0 ? count / static_cast<double>(samples_) : 0;
  if (present_ < 0.5) {
    throw file_error(file, "at less than half of the times all channels have a sample",
                     "leave out the channels that miss samples");
  }
  scale_ = VectorXd::Ones(this->channels());
  find_drift(low_hz);
  VectorXd samples(samples_);
  for (Index c = 0; c < this->channels(); ++c) {
    read(c, 0, samples);
    scale_[c] = samples.norm() / std::sqrt(count);
    if (!(scale_[c] > 1e-12 * drift_.col(c).cwiseAbs().maxCoeff())) {
      const auto& name = recording.channels[static_cast<std::size_t>(channels[c])].name;
      throw RecordingError({file, 0, 0, name}, "the channel is constant", "leave it out");
    }
  }
}

void AmbientSignals::find_drift(double low_hz) {
  const double half = 3 / low_hz * rate_hz_;
  const auto reach = static_cast<Index>(std::min(half, static_cast<double>(samples_)));
  const auto far = static_cast<double>(reach);
  const VectorXd t = VectorXd::LinSpaced(2 * reach + 1, -far, far);
  const VectorXd window = (t.array() * (kTwoPi / 4 / half)).cos().square().square();
  knot_apart_ = std::max<Index>(reach / 16, 1);
  drift_ = MatrixXd::Zero((samples_ - 1) / knot_apart_ + 4, channels());
  for (Index i = 0; i < drift_.rows(); ++i) {
    const Index begin = (i - 1) * knot_apart_ - reach, first = std::max<Index>(begin, 0);
    const Index count = std::min(begin + 2 * reach + 1, samples_) - first;
    if (count < 1) continue;
    VectorXd w = window.segment(first - begin, count);
    blank(first, w);
    const double sum = w.sum(), mean = w.dot(t.segment(first - begin, count)) / sum;
    if (!(sum > 0)) continue;
    const VectorXd off = t.segment(first - begin, count).array() - mean;
    const double spread = w.dot(off.cwiseAbs2());
    // One sample alone has no slope.
    if (spread > 1e-6 * sum) w.array() *= 1 - off.array() * (mean * sum / spread);
    for (Index c = 0; c < channels(); ++c) {
      VectorXd samples = x_[static_cast<std::size_t>(c)]->segment(first, count);
      blank(first, samples);
      drift_(i, c) = w.dot(samples) / sum;
    }
  }
}

void AmbientSignals::blank(Index first, Ref<VectorXd> samples) const {
  const Index size = samples.size(), end = first + size;
  samples.head(std::clamp<Index>(-first, 0, size)).setZero();
  samples.tail(std::clamp<Index>(end - samples_, 0, size)).setZero();
  for (const auto& [from, to] : gaps_) {
    const Index a = std::max(from, first), b = std::min(to, end);
    if (a < b) samples.segment(a - first, b - a).setZero();
  }
}

void AmbientSignals::read(Index channel, Index first, Ref<VectorXd> samples) const {
  const VectorXd& x = *x_[static_cast<std::size_t>(channel)];
  const Index a = std::clamp<Index>(-first, 0, samples.size());
  const Index b = std::clamp<Index>(samples_ - first, a, samples.size());
  const auto apart = static_cast<double>(knot_apart_);
  for (Index at = first + a; at < first + b;) {
    const Index knot = at / knot_apart_, end = std::min((knot + 1) * knot_apart_, first + b);
    const Eigen::Vector4d p = drift_.col(channel).segment(knot, 4);
    const double c1 = (p[2] - p[0]) / 2, c3 = (p[3] - p[0]) / 2 + 1.5 * (p[1] - p[2]);
    const double c2 = p[2] - p[1] - c1 - c3;
    for (; at < end; ++at) {
      const double u = static_cast<double>(at - knot * knot_apart_) / apart;
      samples[at - first] = x[at] - (p[1] + u * (c1 + u * (c2 + u * c3)));
    }
  }
  samples.segment(a, b - a) /= scale_[channel];
  for (const auto& [omega, amplitude] : tones_) {
    const auto begins =
        amplitude[channel] * std::polar(1.0, omega * static_cast<double>(first + a));
    samples.segment(a, b - a) -= (begins * powers({0, omega}, b - a)).real().matrix();
  }
  blank(first, samples);
}

MatrixXd AmbientSignals::block(Index first, Index count) const {
  MatrixXd result(count, channels());
  for (Index c = 0; c < channels(); ++c) read(c, first, result.col(c));
  return result;
}

MatrixXd AmbientSignals::mask(Index first, Index count) const {
  VectorXd result = VectorXd::Ones(count);
  blank(first, result);
  return result;
}

std::vector<AmbientTone> AmbientSignals::take_out_tones(double low_hz, double high_hz) {
  std::vector<AmbientTone> tones;
  if (samples() < 256) return tones;
  RealFft fft(good_fft_length_below(samples()));
  const Index n = fft.length();
  const double line_hz = rate_hz() / static_cast<double>(n);
  const Index low = std::max<Index>(kSide + 1, static_cast<Index>(low_hz / line_hz));
  const Index high = std::min(fft.lines() - kSide - 1, static_cast<Index>(high_hz / line_hz));
  const auto lines = low < high ? outstanding(*this, fft, low, high) : std::vector<Line>();
  if (lines.empty()) return tones;
  std::vector<MatrixXcd> around(lines.size(), MatrixXcd(2 * kSide + 1, channels()));
  for (Index c = 0; c < channels(); ++c) {
    hann_spectrum(*this, c, fft);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      around[i].col(c) = fft.spectrum().segment(lines[i].k - kSide, 2 * kSide + 1);
    }
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Index k = lines[i].k;
    // Beside its largest line a steady tone has r = (1 + d) / (2 - d) of it, d lines further on.
    const Eigen::Vector3d size =
        (around[i].middleRows(kSide - 1, 3) * around[i].row(kSide).adjoint()).cwiseAbs();
    const double side = size[2] > size[0] ? 1 : -1, r = std::max(size[0], size[2]) / size[1];
    const double f = static_cast<double>(k) + side * (2 * r - 1) / (1 + r);
    const VectorXcd kernel = hann_lines(f, k, n);
    const auto middle = kernel.segment(kSide - kLobe, 2 * kLobe + 1);
    VectorXcd amplitude =
        (middle.adjoint() * around[i].middleRows(kSide - kLobe, 2 * kLobe + 1)).transpose() /
        middle.squaredNorm();
    const VectorXd left =
        (around[i].col(lines[i].channel) - kernel * amplitude[lines[i].channel]).cwiseAbs2();
    const double beside = (left.head(12).sum() + left.tail(12).sum()) / 24;
    if (left.segment(kSide - 2, 5).mean() > 4 * beside) continue;
    amplitude *= 2 / present();  // both halves of the spectrum, of what samples there are
    tones_.emplace_back(kTwoPi * f / static_cast<double>(n), amplitude);
    tones.push_back({f * line_hz, amplitude.cwiseAbs().cwiseProduct(scale()).maxCoeff()});
  }
  std::ranges::sort(tones, {}, &AmbientTone::frequency_hz);
  return tones;
}

void group_correlations(const AmbientSignals& signals, const MatrixXd& filters, Index lags,
                        int groups, int threads,
                        const std::function<void(int group, const MatrixXd& R)>& receive) {
  const Index n = signals.samples();
  const auto summed = [&](Index g, const auto& block, const MatrixXd& combined) {
    return correlation(block, combined, n * g / groups, n * (g + 1) / groups, lags);
  };
  ArrayXd products = ArrayXd::Zero(2 * lags + 1);
  const auto mask = [&](Index first, Index count) { return signals.mask(first, count); };
  for (Index g = 0; g < groups; ++g) products += summed(g, mask, MatrixXd::Ones(1, 1)).array();
  products = products.round().max(1);
  const auto block = [&](Index first, Index count) { return signals.block(first, count); };
  const auto mean = [&](Index g) {
    return MatrixXd(summed(g, block, filters).array().colwise() / products);
  };
  for (Index first = 0; first < groups; first += threads) {
    std::vector<std::future<MatrixXd>> made;
    for (Index g = first; g < std::min<Index>(first + threads, groups); ++g) {
      made.push_back(std::async(threads > 1 ? std::launch::async : std::launch::deferred, mean, g));
    }
    for (Index k = 0; k < std::ssize(made); ++k) {
      receive(static_cast<int>(first + k), made[static_cast<std::size_t>(k)].get());
    }
  }
}

}  // namespace rigfit::signal
