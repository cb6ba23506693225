#include "signal/decay/narrow_record.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "signal/decay/decay_window.h"
#include "signal/numerics/numbers.h"
#include "signal/spectra/fft.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Half the width of the filter's edges, in samples' rates of the narrow record: what lies between
// 0.1 and 0.4 of that rate is unchanged.
constexpr double kBandEdge = 0.1;
// Narrow samples at either end of a block that its neighbours touch: the filter's response has
// fallen by 1e-7 there.
constexpr Index kGuard = 48;
// At least as much noise beside the rms of the record: under it lie the filter's ends.
constexpr double kLeastNoise = 1e-5;
constexpr Index kLeastStep = 4;
constexpr Index kFewestSpectra = 16;
// Lines on either side that the noise is read from, lines of the offset and its drift, and lines
// that Hann's window spreads a tone over.
constexpr Index kAround = 64, kOffsetLines = 4, kSpread = 4;

struct RecordLine {
  double offset = 0, slope = 0;
};

/// Straight line of least squares; nothing where a sample is missing.
std::optional<RecordLine> straight_line_of(const Eigen::Ref<const Eigen::VectorXd>& y) {
  const Index n = y.size();
  const double middle = 0.5 * static_cast<double>(n - 1);
  double sum = 0, moment = 0;
  for (Index j = 0; j < n; ++j) {
    sum += y(j);
    moment += (static_cast<double>(j) - middle) * y(j);
  }
  if (!std::isfinite(sum) || !std::isfinite(moment)) return {};
  const auto count = static_cast<double>(n);
  const double slope = moment * 12 / (count * (count * count - 1));
  return RecordLine{sum / count - slope * middle, slope};
}

/// Samples [from, from + size) less the line, zero beyond the record's ends.
void load_block(const Eigen::Ref<const Eigen::VectorXd>& y, const RecordLine& line, Index from,
                Eigen::Map<Eigen::VectorXd> block) {
  const Index begin = std::clamp<Index>(-from, 0, block.size());
  const Index end = std::clamp<Index>(y.size() - from, begin, block.size());
  block.head(begin).setZero();
  block.tail(block.size() - end).setZero();
  for (Index j = begin; j < end; ++j) {
    block(j) = y(from + j) - line.offset - line.slope * static_cast<double>(from + j);
  }
}

struct BlockSpectra {
  Eigen::ArrayXd mean, most;  // power over the blocks
  Index blocks = 0;
};

BlockSpectra block_spectra(const Eigen::Ref<const Eigen::VectorXd>& y, const RecordLine& line,
                           Index size) {
  RealFft fft(size);
  const Eigen::ArrayXd window =
      0.5 - 0.5 * (Eigen::ArrayXd::LinSpaced(size, 0, static_cast<double>(size - 1)) *
                   (kTwoPi / static_cast<double>(size)))
                      .cos();
  BlockSpectra spectra;
  spectra.mean.setZero(fft.lines());
  spectra.most.setZero(fft.lines());
  spectra.blocks = y.size() / size;
  Eigen::ArrayXd power(fft.lines());
  for (Index b = 0; b < spectra.blocks; ++b) {
    load_block(y, line, b * size, fft.time());
    fft.time().array() *= window;
    fft.forward();
    power = fft.spectrum().array().abs2();
    spectra.mean += power;
    spectra.most = spectra.most.max(power);
  }
  spectra.mean /= static_cast<double>(spectra.blocks);
  return spectra;
}

/// Whether the noise, by the median of the spectrum, stands above what the filter leaves.
bool noisy_enough(const BlockSpectra& spectra) {
  std::vector<double> power(spectra.mean.begin(), spectra.mean.end());
  const auto middle = power.begin() + static_cast<std::ptrdiff_t>(power.size() / 2);
  std::nth_element(power.begin(), middle, power.end());
  return *middle > kLeastNoise * kLeastNoise * spectra.mean.mean();
}

struct Occupied {
  double low, high;  // cycles per sample
};

/// From the lowest to the highest line within `band` that stands out of the noise around it.
std::optional<Occupied> occupied_band(const BlockSpectra& spectra, Index size,
                                      const DecayBand& band) {
  const Index lines = spectra.mean.size();
  const auto blocks = static_cast<double>(spectra.blocks);
  const double of_mean = 1 + 10 / std::sqrt(blocks);
  const double of_most = std::log(0.5 * blocks * static_cast<double>(size) / 1e-6);
  const auto per_cycle = static_cast<double>(size);
  const Index from = std::max<Index>(kOffsetLines, static_cast<Index>(band.low * per_cycle));
  const Index to = std::min<Index>(lines - 1, static_cast<Index>(band.high * per_cycle) + 1);
  Index lowest = lines, highest = -1;
  std::vector<double> around;
  for (Index k = from; k <= to; ++k) {
    const Index first = std::max(kOffsetLines, k - kAround), last = std::min(lines, k + kAround);
    around.assign(spectra.mean.data() + first, spectra.mean.data() + last);
    const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
    std::nth_element(around.begin(), middle, around.end());
    if (spectra.mean(k) > of_mean * *middle || spectra.most(k) > of_most * *middle) {
      lowest = std::min(lowest, k), highest = k;
    }
  }
  if (highest < 0) return {};
  return Occupied{static_cast<double>(std::max(kOffsetLines, lowest - kSpread)) / per_cycle,
                  std::min(0.5, static_cast<double>(highest + kSpread) / per_cycle)};
}

/// Step, transform and shift that keep what is occupied; false: no step of four and more does.
bool choose_step(const Occupied& occupied, Index samples, const NarrowOptions& options,
                 NarrowRecord& out) {
  Index step = 1;
  while (samples / (2 * step) >= options.samples_left) step *= 2;
  for (; step >= kLeastStep; step /= 2) {
    const double rate = 1 / static_cast<double>(step);
    const Index narrow = std::max<Index>(1024, options.block / step);  // samples of a transform
    const Index length = narrow * step;
    out.step = step, out.length = length, out.shift_line = 0;
    out.low = 0, out.high = (0.5 - kBandEdge) * rate;
    if (occupied.high <= out.high) return true;
    // Both edges of the filter stay between zero and half the record's rate.
    const double reach = (0.25 + kBandEdge) * rate + 1 / static_cast<double>(length);
    const double centre =
        std::clamp(0.5 * (occupied.low + occupied.high), reach, std::max(reach, 0.5 - reach));
    out.shift_line = std::lround((centre - 0.25 * rate) * static_cast<double>(length));
    const double shift = static_cast<double>(out.shift_line) / static_cast<double>(length);
    out.low = shift + kBandEdge * rate, out.high = shift + (0.5 - kBandEdge) * rate;
    if (out.low <= occupied.low && occupied.high <= out.high) return true;
  }
  return false;
}

/// Meyer's edge: 0 below, 1 above, with three smooth derivatives; edge(u)^2 + edge(1 - u)^2 = 1.
double edge(double u) {
  if (u <= 0) return 0;
  if (u >= 1) return 1;
  const double u4 = u * u * u * u;
  return std::sin(0.5 * std::numbers::pi * u4 * (35 + u * (-84 + u * (70 - 20 * u))));
}

/// The band of one transform after another, folded into those of the narrow record.
class Narrowing {
 public:
  explicit Narrowing(NarrowRecord& out)
      : out_(out),
        narrow_(out.length / out.step),
        margin_(static_cast<Index>(std::ceil(kBandEdge * static_cast<double>(narrow_)))),
        wide_fft_(out.length),
        narrow_fft_(narrow_) {
    gain_.resize(narrow_ / 2 + 2 * margin_ + 1);
    const double width = kBandEdge * static_cast<double>(narrow_);
    for (Index k = 0; k < gain_.size(); ++k) {
      const auto m = static_cast<double>(k - margin_);
      const double upper = edge(0.5 - 0.5 * (m - 0.5 * static_cast<double>(narrow_)) / width);
      const double lower = out.shift_line == 0 ? (m < 0 ? 0.0 : 1.0) : edge(0.5 + 0.5 * m / width);
      gain_(k) = upper * lower / static_cast<double>(out.step);
    }
  }

  void run(const Eigen::Ref<const Eigen::VectorXd>& y, const RecordLine& line) {
    const Index all = (y.size() + out_.step - 1) / out_.step;
    // At its ends the filter sees the record begin and stop.
    const Index count = std::max<Index>(0, all - 2 * kGuard), fresh = narrow_ - 2 * kGuard;
    out_.first = kGuard * out_.step;
    out_.samples.resize(count);
    for (Index at = 0; at < count; at += fresh) {
      transform(y, line, at * out_.step);
      const Index take = std::min(fresh, count - at);
      out_.samples.segment(at, take) = narrow_fft_.time().segment(kGuard, take);
    }
  }

 private:
  void transform(const Eigen::Ref<const Eigen::VectorXd>& y, const RecordLine& line, Index from) {
    load_block(y, line, from, wide_fft_.time());
    wide_fft_.forward();
    const auto wide = wide_fft_.spectrum();
    auto folded = narrow_fft_.spectrum();
    folded.setZero();
    const Index half = narrow_ / 2;
    // The shift begins at the record's sample 0, whatever the block.
    const Index turn = (out_.shift_line * (from % out_.length)) % out_.length;
    const Complex phase =
        std::polar(1.0, -kTwoPi * static_cast<double>(turn) / static_cast<double>(out_.length));
    for (Index k = 0; k < gain_.size(); ++k) {
      const Index m = k - margin_, line_of_wide = out_.shift_line + m;
      if (line_of_wide < 0 || line_of_wide >= wide.size()) continue;
      const Complex value = gain_(k) * phase * wide(line_of_wide);
      if (m == half || (m == 0 && out_.shift_line > 0)) {
        folded(m) += 2 * value.real();
      } else if (m < 0) {
        folded(-m) += std::conj(value);
      } else if (m > half) {
        folded(narrow_ - m) += std::conj(value);
      } else {
        folded(m) += value;
      }
    }
    narrow_fft_.inverse();
  }

  NarrowRecord& out_;
  Index narrow_, margin_;  // samples of the narrow transform; lines of an edge beyond the band
  RealFft wide_fft_, narrow_fft_;
  Eigen::ArrayXd gain_;
};

}  // namespace

std::optional<NarrowRecord> narrow_record(const Eigen::Ref<const Eigen::VectorXd>& y,
                                          const DecayBand& band, const NarrowOptions& options) {
  if (y.size() < options.least_samples || y.size() / options.block < kFewestSpectra) return {};
  const auto line = straight_line_of(y);
  if (!line || recorded_until(y) < y.size()) return {};
  const BlockSpectra spectra = block_spectra(y, *line, options.block);
  if (!noisy_enough(spectra)) return {};
  const auto occupied = occupied_band(spectra, options.block, band);
  NarrowRecord out;
  if (!occupied || !choose_step(*occupied, y.size(), options, out)) return {};
  if (clipped_until(y, 0.5 * (occupied->low + occupied->high)) > 0) return {};
  out.offset = line->offset, out.slope = line->slope;
  Narrowing(out).run(y, *line);
  return out;
}

}  // namespace rigfit::signal
