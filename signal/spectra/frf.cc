#include "signal/spectra/frf.h"

#include "signal/spectra/fft.h"
#include "signal/spectra/line_means.h"
#include "signal/spectra/window.h"

namespace rigfit::signal {
namespace {

double mean_square(std::span<const FrfBlock> blocks, Index response) {
  double sum = 0;
  for (const FrfBlock& block : blocks) {
    if (block.response_noise_std.empty()) return 0;
    sum += std::pow(block.response_noise_std[static_cast<std::size_t>(response)], 2);
  }
  return sum / static_cast<double>(blocks.size());
}

class Averager {
 public:
  Averager(std::span<const FrfBlock> blocks, const FrfOptions& options, FrfEstimate& result)
      : blocks_(blocks),
        options_(options),
        result_(result),
        fft_(options.block_samples),
        window_(exponential_window(options.block_samples, options.sample_rate_hz,
                                   options.exponential_decay_rate_1_s)) {
    force_.resize(fft_.lines(), hits());
    for (Index i = 0; i < hits(); ++i) {
      const FrfBlock& block = blocks_[static_cast<std::size_t>(i)];
      load(block.force, block.force_offset);
      if (block.force_last >= 0) {
        fft_.time().array() *=
            force_window(fft_.length(), block.force_first, block.force_last, block.force_taper)
                .array();
      }
      fft_.forward();
      force_.col(i) = fft_.spectrum();
    }
    gxx_ = force_.abs2().rowwise().sum();
    result_.force_power = gxx_ / static_cast<double>(hits());
    // Where there is no force at all nothing is known: the floor keeps H at zero over zero finite.
    gxx_ = gxx_.max(least());
    leverage_ = force_.abs2().colwise() / gxx_;
    ForceNoise noise = force_noise_power(blocks_, fft_.length(), window_, kSmoothingLines);
    result_.force_noise = std::move(noise.power);
    noise_ = noise.broadband.array();
    if (noise_.size() == 0) noise_ = ArrayXd::Zero(gxx_.size());
    true_gxx_ = gxx_ - (static_cast<double>(hits()) * noise_).min(0.75 * gxx_);
  }

  void run() {
    const auto responses = static_cast<Index>(blocks_.front().responses.size());
    result_.H.resize(gxx_.size(), responses);
    if (hits() > 1) result_.coherence.resize(gxx_.size(), responses);
    if (hits() > 2) result_.incoherence_without.setZero(hits());
    const Index kept = std::min(options_.by_hit_lines, gxx_.size());
    if (kept > 0) result_.by_hit.assign(blocks_.size(), MatrixXcd(kept, responses));
    bool noise_known = true;
    for (Index c = 0; c < responses; ++c) noise_known &= mean_square(blocks_, c) > 0;
    if (hits() > 1 || noise_known) result_.H_std.resize(gxx_.size(), responses);
    for (Index c = 0; c < responses; ++c) average(c);
  }

 private:
  [[nodiscard]] Index hits() const { return static_cast<Index>(blocks_.size()); }
  [[nodiscard]] double least() const {
    return gxx_.maxCoeff() * 1e-30 + std::numeric_limits<double>::min();
  }

  void load(std::span<const double> samples, double offset) {
    const Index take = std::min(fft_.length(), static_cast<Index>(samples.size()));
    const Map<const ArrayXd> x(samples.data(), take);
    fft_.time().setZero();
    fft_.time().head(take).array() = (x - offset) * window_.head(take).array();
  }

  void average(Index c) {
    ArrayXXcd spectra(gxx_.size(), hits());
    for (Index i = 0; i < hits(); ++i) {
      const FrfBlock& block = blocks_[static_cast<std::size_t>(i)];
      load(block.responses[static_cast<std::size_t>(c)],
           block.response_offset.empty() ? 0 : block.response_offset[static_cast<std::size_t>(c)]);
      fft_.forward();
      spectra.col(i) = fft_.spectrum();
    }
    keep_hits(c, spectra);
    const ArrayXd gyy = spectra.abs2().rowwise().sum();
    const ArrayXcd gxy = (force_.conjugate() * spectra).rowwise().sum();
    const ArrayXd cross = gxy.abs2();
    auto H = result_.H.col(c).array();
    switch (options_.estimator) {
      case FrfEstimator::h1:
        H = gxy / true_gxx_;
        break;
      case FrfEstimator::h2:
        H = (cross > 0).select(gxy * (gyy / cross), 0.0);
        break;
      case FrfEstimator::hv:
        H = (cross > 0).select(gxy * (gyy / gxx_ / cross).sqrt(), 0.0);
        break;
    }
    if (hits() > 1) {
      // Without any response at a line: nothing of it is explained.
      result_.coherence.col(c) =
          (cross / gxx_ / gyy.max(std::numeric_limits<double>::min())).min(1.0);
    }
    if (result_.H_std.size() == 0) return;
    // What the least-squares H leaves of each hit, and |.|^2 / (1 - leverage): by so much does the
    // sum of squares fall without the hit.
    spectra -= force_.colwise() * (gxy / gxx_);
    const ArrayXXd deleted = spectra.abs2() / (1 - leverage_).max(1e-10);
    if (hits() > 2) leave_one_out(spectra.abs2().rowwise().sum(), deleted, gyy);
    error_bars(c, cross, deleted);
  }

  /// H of each hit by itself, the noise taken off its force as far as half of its power.
  void keep_hits(Index c, const ArrayXXcd& spectra) {
    for (Index i = 0; i < std::ssize(result_.by_hit); ++i) {
      auto hit = result_.by_hit[static_cast<std::size_t>(i)].col(c).array();
      const ArrayXcd x = force_.col(i).head(hit.size());
      const ArrayXd power = x.abs2() - noise_.head(hit.size()).min(0.5 * x.abs2());
      hit = x.conjugate() * spectra.col(i).head(hit.size()) / power.max(least());
    }
  }

  void error_bars(Index c, const ArrayXd& cross, const ArrayXXd& deleted) {
    const double of_response = mean_square(blocks_, c) * window_.squaredNorm();
    const auto H = result_.H.col(c).array();
    const bool force_noise_known = result_.force_noise.size() > 0;
    // Power that the noise of the force gives the response.
    const ArrayXd through_force = force_noise_known
                                      ? ArrayXd(result_.force_noise.array() * H.abs2())
                                      : ArrayXd::Zero(H.size()).eval();
    if (hits() == 1) {
      result_.H_std.col(c) = ((of_response + through_force) / (2 * true_gxx_)).sqrt();
      return;
    }
    const bool h1 = options_.estimator == FrfEstimator::h1;
    const auto degrees = static_cast<double>(hits() - 1);
    ArrayXd residual = degrees * (leverage_ * deleted).rowwise().sum();
    // What H, no longer the least-squares one, leaves of the responses.
    if (h1) residual += cross / gxx_ * (gxx_ / true_gxx_ - 1).square();
    // The known shape of the noise power, up to a factor that the residuals give locally.
    ArrayXd shape = ArrayXd::Ones(H.size());
    if (of_response > 0) shape += through_force / of_response;
    const double bandwidth = static_cast<double>(fft_.length()) * window_.squaredNorm() /
                             std::pow(window_.sum(), 2);  // the window's noise's, lines
    const auto smooth = [&](Index independent) {
      return mean_over_lines(
          residual / shape,
          static_cast<Index>(std::ceil(static_cast<double>(independent) * bandwidth)));
    };
    residual = shape * narrow_where_raised(smooth(kNarrow), smooth(kSmoothingLines),
                                           2 * degrees * (2 * kNarrow + 1));
    auto std = result_.H_std.col(c).array();
    std = (residual * gxx_ / (2 * degrees)).sqrt() / (h1 ? true_gxx_ : gxx_);
    // The relative error is that of H1 (Bendat and Piersol).
    if (!h1) std *= H.abs() / (cross.sqrt() / gxx_).max(std::numeric_limits<double>::min());
  }

  /// Residual power per degree of freedom relative to the response's power: all hits and without
  /// each.
  void leave_one_out(const ArrayXd& left, const ArrayXXd& deleted, const ArrayXd& gyy) {
    const double weakest = gxx_.maxCoeff() * std::pow(10, -kMostSpectrumDrop / 10);
    ArrayXd counts = (gxx_ >= weakest).cast<double>();
    counts[0] = 0;
    const double power = (counts * gyy).sum() * static_cast<double>(result_.H.cols());
    if (power <= 0) return;
    const auto n = static_cast<double>(hits());
    const double total = (counts * left).sum();
    result_.incoherence += total / power * n / (n - 1);
    const ArrayXd of_hits = (deleted.colwise() * counts).colwise().sum().transpose();
    result_.incoherence_without.array() += (total - of_hits).max(0.0) / power * n / (n - 2);
  }

  std::span<const FrfBlock> blocks_;
  const FrfOptions& options_;
  FrfEstimate& result_;
  RealFft fft_;
  VectorXd window_;         ///< exponential
  ArrayXXcd force_;         ///< lines x hits
  ArrayXd gxx_, true_gxx_;  ///< the second without the noise
  ArrayXXd leverage_;       ///< lines x hits: share of the hit's force in gxx_
  ArrayXd noise_;           ///< broadband noise on the force, mean over hits; 0: not known
};

}  // namespace

const char* name_of(FrfEstimator estimator) {
  constexpr const char* kNames[] = {"h1", "h2", "hv"};
  return kNames[static_cast<std::size_t>(estimator)];
}

FrfEstimate average_frfs(std::span<const FrfBlock> blocks, const FrfOptions& options) {
  if (blocks.empty() || options.block_samples < 2 || !(options.sample_rate_hz > 0)) {
    throw std::invalid_argument("FRFs need at least one hit, a block and a sample rate");
  }
  for (const FrfBlock& block : blocks) {
    if (block.responses.size() != blocks.front().responses.size()) {
      throw std::invalid_argument("every hit needs the same responses");
    }
  }
  FrfEstimate result;
  result.frequency_hz = line_frequencies(options.block_samples, options.sample_rate_hz);
  result.averages = static_cast<int>(blocks.size());
  result.exponential_decay_rate_1_s = options.exponential_decay_rate_1_s;
  Averager averager(blocks, options, result);
  averager.run();
  return result;
}

}  // namespace rigfit::signal
