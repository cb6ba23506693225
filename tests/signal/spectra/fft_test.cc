#include "signal/spectra/fft.h"

#include "tests/test.h"

#include <thread>

namespace rigfit::signal::fft_test {

VectorXd noise(Index n, unsigned seed) {
  Normal normal(seed);
  return VectorXd::NullaryExpr(n, [&] { return normal(); });
}

/// The definition, summed.
VectorXcd slow_transform(const VectorXd& x) {
  const Index n = x.size();
  VectorXcd X = VectorXcd::Zero(n / 2 + 1);
  for (Index k = 0; k < X.size(); ++k) {
    for (Index i = 0; i < n; ++i) {
      X[k] += x[i] *
              std::polar(1.0, -2 * kPi * static_cast<double>(k * i % n) / static_cast<double>(n));
    }
  }
  return X;
}

TEST(Fft, IsTheDefinitionAtEvenOddAndPrimeLengths) {
  for (const Index n : {1, 2, 7, 12, 97, 250}) {
    const VectorXd x = noise(n, static_cast<unsigned>(n));
    RealFft fft(n);
    fft.time() = x;
    fft.forward();
    // Round-off of a sum of n terms of size one.
    EXPECT_TRUE(MatricesNear(fft.spectrum(), slow_transform(x), 4e-15 * double(n + 3)));
    fft.inverse();
    EXPECT_TRUE(MatricesNear(fft.time(), x, 1e-13)) << n;
  }
}

TEST(Fft, ManyChannelsArePaddedOrCut) {
  const VectorXd x = noise(60, 3);
  MatrixXd signals(60, 2);
  signals << x, 2 * x;
  VectorXd padded = VectorXd::Zero(64);
  padded.head(60) = x;
  const MatrixXcd long_spectra = real_spectra(signals, 64);
  EXPECT_TRUE(MatricesNear(long_spectra.col(0), slow_transform(padded), 1e-12));
  EXPECT_TRUE(MatricesNear(long_spectra.col(1), 2 * long_spectra.col(0), 1e-12));
  EXPECT_TRUE(MatricesNear(real_spectra(signals, 50).col(0), slow_transform(x.head(50)), 1e-12));
}

TEST(Fft, ThreadsPlanAndTransformAtOnceAndGetTheSameBits) {
  const VectorXd x = noise(4096, 5);
  std::vector<VectorXcd> results(8);
  {
    std::vector<std::jthread> threads;
    for (auto& result : results) {
      threads.emplace_back([&result, &x] {
        for (const Index n : {4096, 4000, 3888, 4050}) {
          RealFft fft(n);
          fft.time() = x.head(n);
          fft.forward();
          if (n == 4096) result = fft.spectrum();
        }
      });
    }
  }
  for (const auto& result : results) EXPECT_EQ(result, results.front());
}

TEST(Fft, GoodLengthsHaveSmallFactorsAndAreClosest) {
  EXPECT_EQ(good_fft_length(1), 2);
  EXPECT_EQ(good_fft_length(32768), 32768);
  EXPECT_EQ(good_fft_length(32769), 33750);  // 2 * 3^3 * 5^4; 32805 = 3^8 * 5 is odd
  EXPECT_EQ(good_fft_length_below(32767), 32400);
  EXPECT_EQ(good_fft_length_below(2), 2);
}

}  // namespace rigfit::signal::fft_test
