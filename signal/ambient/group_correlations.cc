#include "signal/ambient/group_correlations.h"

#include <algorithm>
#include <complex>
#include <future>

#include "signal/spectra/fft.h"

namespace rigfit::signal {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Range = std::pair<Index, Index>;
using Reader = std::function<MatrixXd(Index first, Index count)>;

/// R of one range. `lower`: signals are the channels; pairs with channel < signal stay 0.
MatrixXd correlation(const Reader& block, const MatrixXd& filters, Range range, Index lags,
                     bool lower) {
  const Index channels = filters.rows(), signals = filters.cols(), span = 2 * lags + 1;
  // Four times the lags waste a quarter of a transform; 2^16 samples stay in a processor's cache.
  const Index usual = std::max<Index>(1 << 16, 8 * lags);
  const Index length = good_fft_length(std::min(range.second - range.first + 2 * lags, usual));
  const Index piece = length - 2 * lags;
  RealFft fft(length);
  std::vector<std::pair<Index, Index>> pairs;  // signal, channel
  for (Index j = 0; j < signals; ++j) {
    for (Index i = lower ? j : 0; i < channels; ++i) pairs.emplace_back(j, i);
  }
  MatrixXcd sums = MatrixXcd::Zero(fft.lines(), std::ssize(pairs));
  for (Index a = range.first; a < range.second; a += piece) {
    const Index count = std::min(piece, range.second - a);
    const MatrixXd wide = block(a - lags, count + 2 * lags);
    const MatrixXcd Y = real_spectra(wide, length);
    const MatrixXcd X = lower ? real_spectra(wide.middleRows(lags, count), length)
                              : real_spectra(wide.middleRows(lags, count) * filters, length);
    for (Index p = 0; p < std::ssize(pairs); ++p) {
      const auto [j, i] = pairs[static_cast<std::size_t>(p)];
      sums.col(p).array() += X.col(j).array().conjugate() * Y.col(i).array();
    }
  }
  MatrixXd R = MatrixXd::Zero(span, channels * signals);
  for (Index p = 0; p < std::ssize(pairs); ++p) {
    const auto [j, i] = pairs[static_cast<std::size_t>(p)];
    fft.spectrum() = sums.col(p);
    fft.inverse();
    R.col(j * channels + i) = fft.time().head(span);
  }
  return R;
}

/// receive(g, make(g)) for g = 0 .. count - 1, in this order; so many are made at a time.
void in_order(int count, int threads, const std::function<MatrixXd(int)>& make,
              const std::function<void(int, const MatrixXd&)>& receive) {
  for (int first = 0; first < count; first += threads) {
    const int together = std::min(threads, count - first);
    std::vector<std::future<MatrixXd>> made;
    for (int t = 1; t < together; ++t) {
      made.push_back(std::async(std::launch::async, make, first + t));
    }
    receive(first, make(first));
    for (int t = 1; t < together; ++t) {
      receive(first + t, made[static_cast<std::size_t>(t - 1)].get());
    }
  }
}

}  // namespace

GroupCorrelations::GroupCorrelations(const AmbientSignals& signals, Index lags, int groups,
                                     double share, int threads)
    : signals_(signals), lags_(lags), threads_(std::max(threads, 1)) {
  const Index n = signals.samples();
  for (Index g = 0; g < groups; ++g) {
    const Index a = n * g / groups, b = n * (g + 1) / groups;
    const double used = share * static_cast<double>(b - a);
    ranges_.emplace_back(a, a + std::clamp<Index>(static_cast<Index>(std::lround(used)), 1, b - a));
  }
  counts_.resize(2 * lags + 1, groups);
  for (Index g = 0; g < groups; ++g) {
    const auto [a, b] = ranges_[static_cast<std::size_t>(g)];
    if (signals.complete()) {
      for (Index k = -lags; k <= lags; ++k) {
        const Index pairs = std::min(b, n - k) - std::max(a, -k);
        counts_(k + lags, g) = static_cast<double>(std::max<Index>(0, pairs));
      }
    } else {
      const Reader mask = [&](Index first, Index count) { return signals.mask(first, count); };
      counts_.col(g) = correlation(mask, MatrixXd::Ones(1, 1), {a, b}, lags, false);
    }
  }
  counts_ = counts_.array().round();
}

void GroupCorrelations::each(
    const MatrixXd& filters,
    const std::function<void(int group, const MatrixXd& R)>& receive) const {
  const Reader block = [&](Index first, Index count) { return signals_.block(first, count); };
  in_order(
      groups(), threads_,
      [&](int g) {
        return correlation(block, filters, ranges_[static_cast<std::size_t>(g)], lags_, false);
      },
      receive);
}

MatrixXd GroupCorrelations::all_pairs() const {
  const Index channels = signals_.channels();
  const Reader block = [&](Index first, Index count) { return signals_.block(first, count); };
  MatrixXd sum = MatrixXd::Zero(2 * lags_ + 1, channels * channels);
  const MatrixXd all = MatrixXd::Identity(channels, channels);
  in_order(
      groups(), threads_,
      [&](int g) {
        return correlation(block, all, ranges_[static_cast<std::size_t>(g)], lags_, true);
      },
      [&](int, const MatrixXd& R) { sum += R; });
  sum.array().colwise() /= counts_.rowwise().sum().array().max(1);
  // R_ij(k) = R_ji(-k) of the whole.
  for (Index j = 0; j < channels; ++j) {
    for (Index i = j + 1; i < channels; ++i) {
      sum.col(i * channels + j) = sum.col(j * channels + i).reverse();
    }
  }
  return sum;
}

}  // namespace rigfit::signal
