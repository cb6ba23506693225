#include "signal/spectra/frf.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>
#include <limits>
#include <stdexcept>
#include <thread>

#include "signal/spectra/fft.h"
#include "signal/spectra/line_means.h"
#include "signal/spectra/window.h"

namespace rigfit::signal {
namespace {
using Eigen::Index;
using Complex = std::complex<double>;

/// Window energies: noise of variance v per sample has E|N_k|^2 = v * energy in every line.
struct Windows {
  Eigen::VectorXd shared;  ///< exponential; empty: none
  double energy = 0;
  double bandwidth_lines = 1;  ///< noise bandwidth in lines: N sum w^2 / (sum w)^2
};

void load(RealFft& fft, std::span<const double> samples, double offset, const Windows& windows) {
  auto time = fft.time();
  const Index n = time.size();
  const Index take = std::min(n, static_cast<Index>(samples.size()));
  const Eigen::Map<const Eigen::VectorXd> x(samples.data(), take);
  if (windows.shared.size() > 0) {
    time.head(take).array() = (x.array() - offset) * windows.shared.head(take).array();
  } else {
    time.head(take).array() = x.array() - offset;
  }
  time.tail(n - take).setZero();
}

/// Gyy and Gxy of one response, and the transforms themselves where they are needed.
struct Sums {
  Eigen::ArrayXd gyy;
  Eigen::ArrayXcd gxy;
  Eigen::ArrayXXcd spectra;  ///< lines x hits, only for leave-one-out
  Eigen::ArrayXd cross, residual, narrow, shape, cumulative;  ///< work space

  explicit Sums(Index lines)
      : gyy(lines),
        gxy(lines),
        cross(lines),
        residual(lines),
        narrow(lines),
        shape(lines),
        cumulative(lines + 1) {}
};

/// gyy += |y|^2, gxy += conj(x) y, in one pass over real and imaginary parts side by side.
void accumulate(const Complex* x_values, const Complex* y_values, Sums& sums) {
  const auto* x = reinterpret_cast<const double*>(x_values);
  const auto* y = reinterpret_cast<const double*>(y_values);
  auto* gxy = reinterpret_cast<double*>(sums.gxy.data());
  double* gyy = sums.gyy.data();
  const Index lines = sums.gyy.size();
  for (Index k = 0; k < lines; ++k) {
    const double xr = x[2 * k], xi = x[2 * k + 1], yr = y[2 * k], yi = y[2 * k + 1];
    gyy[k] += yr * yr + yi * yi;
    gxy[2 * k] += xr * yr + xi * yi;
    gxy[2 * k + 1] += xr * yi - xi * yr;
  }
}

/// Sums before each line, from which an average over any stretch of lines follows.
void accumulate_lines(const Eigen::ArrayXd& values, Eigen::ArrayXd& cumulative) {
  cumulative[0] = 0;
  for (Index k = 0; k < values.size(); ++k) cumulative[k + 1] = cumulative[k] + values[k];
}

/// Average over lines k - half .. k + half (fewer at the ends).
void average_lines(const Eigen::ArrayXd& cumulative, Index half, Eigen::ArrayXd& values) {
  const Index n = values.size();
  const auto average = [&](Index k) {
    const Index first = std::max<Index>(0, k - half), last = std::min(n, k + half + 1);
    return std::max(0.0,
                    (cumulative[last] - cumulative[first]) / static_cast<double>(last - first));
  };
  const Index inner_first = std::min(n, half), inner_last = std::max(inner_first, n - half);
  // Lines inner_first .. inner_last - 1 have all their neighbours.
  for (Index k = 0; k < inner_first; ++k) values[k] = average(k);
  const Index inner = inner_last - inner_first;
  values.segment(inner_first, inner) = ((cumulative.segment(inner_first + half + 1, inner) -
                                         cumulative.segment(inner_first - half, inner)) *
                                        (1 / static_cast<double>(2 * half + 1)))
                                           .max(0.0);
  for (Index k = inner_last; k < n; ++k) values[k] = average(k);
}

double mean_square(std::span<const FrfBlock> blocks, Index response) {
  double sum = 0;
  for (const FrfBlock& block : blocks) {
    const double std = block.response_noise_std.empty()
                           ? 0
                           : block.response_noise_std[static_cast<std::size_t>(response)];
    sum += std * std;
  }
  return sum / static_cast<double>(blocks.size());
}

class Averager {
 public:
  Averager(std::span<const FrfBlock> blocks, const FrfOptions& options, FrfEstimate& result)
      : blocks_(blocks), options_(options), result_(result) {
    const Index n = options.block_samples;
    if (options.exponential_decay_rate_1_s != 0) {
      windows_.shared =
          exponential_window(n, options.sample_rate_hz, options.exponential_decay_rate_1_s);
      windows_.energy = windows_.shared.squaredNorm();
      windows_.bandwidth_lines =
          static_cast<double>(n) * windows_.energy / std::pow(windows_.shared.sum(), 2);
    } else {
      windows_.energy = static_cast<double>(n);
    }
    transform_force();
    select_lines();
  }

  void average(Index first, Index last) {
    RealFft fft(options_.block_samples);
    const Index lines = fft.lines();
    Sums sums(lines);
    if (options_.leave_one_out) sums.spectra.resize(lines, hits());
    for (Index c = first; c < last; ++c) {
      transform_response(fft, c, sums);
      estimate(c, sums);
      if (options_.leave_one_out) leave_one_out(c, sums);
    }
  }

  void finish() {
    if (!options_.leave_one_out) return;
    const auto responses = static_cast<double>(share_.cols());
    result_.incoherence = share_.row(hits()).sum() / responses;
    result_.incoherence_without = share_.topRows(hits()).rowwise().sum() / responses;
  }

 private:
  Index hits() const { return static_cast<Index>(blocks_.size()); }

  void transform_force() {
    RealFft fft(options_.block_samples);
    force_.resize(fft.lines(), hits());
    for (Index i = 0; i < hits(); ++i) {
      const FrfBlock& block = blocks_[static_cast<std::size_t>(i)];
      load(fft, block.force, block.force_offset, windows_);
      if (block.force_last >= 0) {
        fft.time().array() *= force_window(options_.block_samples, block.force_first,
                                           block.force_last, block.force_taper)
                                  .array();
      }
      fft.forward();
      force_.col(i) = fft.spectrum();
    }
    gxx_ = force_.abs2().rowwise().sum();
    result_.force_power = gxx_ / static_cast<double>(hits());
    // Where there is no force at all nothing is known: the floor keeps H at zero over zero finite.
    gxx_ = gxx_.max(gxx_.maxCoeff() * 1e-30 + std::numeric_limits<double>::min());
    inverse_gxx_ = gxx_.inverse();
    ForceNoise noise = force_noise_power(blocks_, options_.block_samples, windows_.shared,
                                         FrfOptions{}.error_smoothing_lines);
    result_.force_noise = std::move(noise.power);
    noise_ = result_.force_noise.array();
    if (options_.subtract_force_noise) subtracted_ = noise.broadband.array();
    if (subtracted_.size() > 0) {
      constexpr double kMost = 0.75;
      true_gxx_ = gxx_ - (static_cast<double>(hits()) * subtracted_).min(kMost * gxx_);
      inverse_true_gxx_ = true_gxx_.inverse();
    } else {
      true_gxx_ = gxx_;
      inverse_true_gxx_ = inverse_gxx_;
    }
    fill_single();
    share_ = Eigen::ArrayXXd::Zero(hits() + 1, result_.H.cols());
  }

  /// One over the force's power of each hit, its noise taken off as far as half of it.
  void fill_single() {
    const Index lines = std::min(options_.by_hit_lines, gxx_.size());
    if (lines <= 0) return;
    result_.by_hit.assign(blocks_.size(), Eigen::MatrixXcd::Zero(lines, result_.H.cols()));
    single_ = force_.topRows(lines).abs2();
    for (Index i = 0; i < hits(); ++i) {
      auto power = single_.col(i);
      if (subtracted_.size() > 0) power -= subtracted_.head(lines).min(0.5 * power);
      power = power.max(gxx_.maxCoeff() * 1e-30 + std::numeric_limits<double>::min()).inverse();
    }
  }

  void select_lines() {
    const double least = gxx_.maxCoeff() * std::pow(10, -options_.leave_one_out_range_db / 10);
    for (Index k = 1; k < gxx_.size(); ++k) {
      if (gxx_[k] >= least) lines_.push_back(k);
    }
  }

  void transform_response(RealFft& fft, Index c, Sums& sums) const {
    for (Index i = 0; i < hits(); ++i) {
      const FrfBlock& block = blocks_[static_cast<std::size_t>(i)];
      const double offset =
          block.response_offset.empty() ? 0 : block.response_offset[static_cast<std::size_t>(c)];
      load(fft, block.responses[static_cast<std::size_t>(c)], offset, windows_);
      fft.forward();
      if (i == 0) sums.gyy.setZero(), sums.gxy.setZero();
      accumulate(force_.col(i).data(), fft.spectrum().data(), sums);
      if (options_.leave_one_out) sums.spectra.col(i) = fft.spectrum();
      if (!result_.by_hit.empty()) {
        auto hit = result_.by_hit[static_cast<std::size_t>(i)].col(c).array();
        hit = force_.col(i).head(hit.size()).conjugate() * fft.spectrum().head(hit.size()).array() *
              single_.col(i).head(hit.size());
      }
    }
  }

  void estimate(Index c, Sums& sums) {
    const Index lines = gxx_.size();
    auto H = result_.H.col(c);
    sums.cross = sums.gxy.abs2();
    sums.residual = (sums.gyy - sums.cross * inverse_gxx_).max(0.0);
    switch (options_.estimator) {
      case FrfEstimator::h1:
        H.array() = sums.gxy * inverse_true_gxx_;
        // What H, no longer the least-squares one, leaves of the responses.
        sums.residual += sums.cross * inverse_gxx_ * (gxx_ * inverse_true_gxx_ - 1).square();
        break;
      case FrfEstimator::h2:
        for (Index k = 0; k < lines; ++k) {
          H[k] = sums.cross[k] > 0 ? sums.gyy[k] / sums.cross[k] * sums.gxy[k] : 0;
        }
        break;
      case FrfEstimator::hv:
        for (Index k = 0; k < lines; ++k) {
          H[k] = sums.cross[k] > 0
                     ? std::sqrt(sums.gyy[k] * inverse_gxx_[k] / sums.cross[k]) * sums.gxy[k]
                     : 0;
        }
        break;
    }
    if (hits() > 1) {
      // Without any response at a line: nothing of it is explained.
      result_.coherence.col(c).array() =
          (sums.cross * inverse_gxx_ / sums.gyy.max(std::numeric_limits<double>::min())).min(1.0);
    }
    if (result_.H_std.size() > 0) error_bars(c, sums);
  }

  void error_bars(Index c, Sums& sums) {
    const double of_response = mean_square(blocks_, c) * windows_.energy;
    const auto H = result_.H.col(c).array();
    auto std = result_.H_std.col(c).array();
    if (hits() == 1) {
      std = ((of_response + through_force(H)) / (2 * true_gxx_)).sqrt();
      return;
    }
    if (options_.error_smoothing_lines > 0) {
      // The known shape of the noise power, up to a factor that the residuals give locally.
      const bool shaped = of_response > 0 && noise_.size() > 0;
      if (shaped) {
        sums.shape = 1 + through_force(H) / of_response;
        sums.residual /= sums.shape;
      }
      smooth_residual(sums);
      if (shaped) sums.residual *= sums.shape;
    }
    const bool h1 = options_.estimator == FrfEstimator::h1;
    std = (sums.residual * gxx_ * (0.5 / static_cast<double>(hits() - 1))).sqrt() *
          (h1 ? inverse_true_gxx_ : inverse_gxx_);
    if (!h1) {
      // The relative error is that of H1 (Bendat and Piersol).
      std *= H.abs() / (sums.gxy.abs() / gxx_).max(std::numeric_limits<double>::min());
    }
  }

  /// Power that the noise of the force gives a response.
  template <typename Values>
  [[nodiscard]] Eigen::ArrayXd through_force(const Values& H) const {
    if (noise_.size() == 0) return Eigen::ArrayXd::Zero(H.size());
    return noise_ * H.abs2();
  }

  void smooth_residual(Sums& sums) const {
    const auto lines_of = [&](Index independent) {
      return std::min(sums.residual.size(),
                      static_cast<Index>(
                          std::ceil(static_cast<double>(independent) * windows_.bandwidth_lines)));
    };
    accumulate_lines(sums.residual, sums.cumulative);
    average_lines(sums.cumulative, lines_of(options_.error_smoothing_lines), sums.residual);
    if (options_.error_smoothing_lines <= kNarrow) return;
    average_lines(sums.cumulative, lines_of(kNarrow), sums.narrow);
    sums.residual = narrow_where_raised(sums.narrow, sums.residual,
                                        2.0 * static_cast<double>(hits() - 1) * (2 * kNarrow + 1));
  }

  /// Residual power per degree of freedom relative to the response's power: all hits (last row) and
  /// without each.
  void leave_one_out(Index c, const Sums& sums) {
    const Index n = hits();
    double total = 0, power = 0;
    Eigen::ArrayXd without = Eigen::ArrayXd::Zero(n);
    for (const Index k : lines_) {
      const double gxx = gxx_[k], gyy = sums.gyy[k];
      const Complex gxy = sums.gxy[k];
      total += gyy - std::norm(gxy) / gxx;
      power += gyy;
      for (Index i = 0; i < n; ++i) {
        const Complex x = force_(k, i), y = sums.spectra(k, i);
        const double rest = gxx - std::norm(x);
        if (rest > 0) {
          without[i] += gyy - std::norm(y) - std::norm(gxy - std::conj(x) * y) / rest;
        }
      }
    }
    if (power <= 0) return;
    const auto dof = static_cast<double>(n);
    share_(n, c) = std::max(0.0, total) / power * dof / std::max(1.0, dof - 1);
    share_.col(c).head(n) = without.max(0.0) / power * dof / std::max(1.0, dof - 2);
  }

  std::span<const FrfBlock> blocks_;
  const FrfOptions& options_;
  FrfEstimate& result_;
  Windows windows_;
  Eigen::ArrayXXcd force_;  ///< lines x hits
  Eigen::ArrayXd gxx_, inverse_gxx_;
  Eigen::ArrayXXd single_;                      ///< lines x hits, for single hits
  Eigen::ArrayXd true_gxx_, inverse_true_gxx_;  ///< without the noise
  /// Noise on the force, mean over hits; empty: not known.
  Eigen::ArrayXd noise_;
  Eigen::ArrayXd subtracted_;  ///< its broadband part; empty: nothing
  std::vector<Index> lines_;   ///< lines used in leave-one-out
  Eigen::ArrayXXd share_;      ///< hits + 1 x responses
};

bool noise_is_known(std::span<const FrfBlock> blocks) {
  return std::all_of(blocks.begin(), blocks.end(), [](const FrfBlock& block) {
    return !block.response_noise_std.empty() &&
           *std::min_element(block.response_noise_std.begin(), block.response_noise_std.end()) > 0;
  });
}

}  // namespace

const char* name_of(FrfEstimator estimator) {
  constexpr const char* kNames[] = {"h1", "h2", "hv"};
  return kNames[static_cast<std::size_t>(estimator)];
}

FrfEstimate average_frfs(std::span<const FrfBlock> blocks, const FrfOptions& options) {
  if (blocks.empty() || options.block_samples < 2 || !(options.sample_rate_hz > 0)) {
    throw std::invalid_argument("FRFs need at least one hit, a block and a sample rate");
  }
  const auto responses = static_cast<Index>(blocks.front().responses.size());
  for (const FrfBlock& block : blocks) {
    if (static_cast<Index>(block.responses.size()) != responses) {
      throw std::invalid_argument("every hit needs the same responses");
    }
  }
  FrfEstimate result;
  result.frequency_hz = line_frequencies(options.block_samples, options.sample_rate_hz);
  const Index lines = result.frequency_hz.size();
  result.H.resize(lines, responses);
  if (blocks.size() > 1) result.coherence.resize(lines, responses);
  result.std_from_noise_before_hit = blocks.size() == 1 && noise_is_known(blocks);
  if (blocks.size() > 1 || result.std_from_noise_before_hit) result.H_std.resize(lines, responses);

  FrfOptions chosen = options;
  chosen.leave_one_out = options.leave_one_out && blocks.size() > 2;
  Averager averager(blocks, chosen, result);
  const Index threads = std::clamp<Index>(options.threads, 1, std::max<Index>(1, responses));
  if (threads == 1) {
    averager.average(0, responses);
  } else {
    std::vector<std::jthread> workers;
    for (Index t = 0; t < threads; ++t) {
      workers.emplace_back(
          [&, t] { averager.average(responses * t / threads, responses * (t + 1) / threads); });
    }
  }
  averager.finish();
  return result;
}

}  // namespace rigfit::signal
