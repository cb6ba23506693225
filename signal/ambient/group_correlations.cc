#include "signal/ambient/group_correlations.h"

#include <algorithm>
#include <future>
#include <vector>

#include "signal/spectra/fft.h"

namespace rigfit::signal {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

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

void group_correlations(const AmbientSignals& signals, const MatrixXd& filters, Index lags,
                        const GroupOptions& options,
                        const std::function<void(int group, const MatrixXd& R)>& receive) {
  const Index n = signals.samples(), groups = options.groups;
  const auto summed = [&](Index g, const auto& block, const MatrixXd& combined) {
    return correlation(block, combined, n * g / groups, n * (g + 1) / groups, lags);
  };
  Eigen::ArrayXd products = Eigen::ArrayXd::Zero(2 * lags + 1);
  const auto mask = [&](Index first, Index count) { return signals.mask(first, count); };
  for (Index g = 0; g < groups; ++g) products += summed(g, mask, MatrixXd::Ones(1, 1)).array();
  products = products.round().max(1);
  const auto block = [&](Index first, Index count) { return signals.block(first, count); };
  const auto mean = [&](Index g) {
    return MatrixXd(summed(g, block, filters).array().colwise() / products);
  };
  for (Index first = 0; first < groups; first += options.threads) {
    std::vector<std::future<MatrixXd>> made;
    for (Index g = first; g < std::min<Index>(first + options.threads, groups); ++g) {
      made.push_back(
          std::async(options.threads > 1 ? std::launch::async : std::launch::deferred, mean, g));
    }
    for (Index k = 0; k < std::ssize(made); ++k) {
      receive(static_cast<int>(first + k), made[static_cast<std::size_t>(k)].get());
    }
  }
}

}  // namespace rigfit::signal
