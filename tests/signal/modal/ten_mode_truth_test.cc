#include "tests/reference/ten_mode_truth.h"

#include <gtest/gtest.h>

#include <numbers>

#include "signal/spectra/fft.h"
#include "tests/expect_matrix.h"

namespace rigfit::testing::ten_mode_truth_test {
namespace {
using Eigen::Index;
using signal::good_fft_length;
using signal::line_frequencies;
using signal::real_spectra;

TEST(TenModeTruth, ReceptanceIsTheSumOverModes) {
  const TenModeTruth truth = ten_mode_truth();
  EXPECT_GT(truth.shapes.row(truth.driving_point).cwiseAbs().minCoeff(), 0.05);
  const double f = 100, w = 2 * std::numbers::pi * f;
  std::complex<double> sum = 0;
  for (Index r = 0; r < 10; ++r) {
    const double wr = 2 * std::numbers::pi * truth.frequency_hz[r];
    sum += truth.shapes(3, r) * truth.shapes(truth.driving_point, r) /
           std::complex<double>(wr * wr - w * w, 2 * truth.damping_ratio[r] * wr * w);
  }
  const auto H = truth.accelerance(Eigen::VectorXd::Constant(1, f))(0, 3);
  EXPECT_LT(std::abs(H + w * w * sum), 1e-12 * std::abs(H));
}

// One hit, everything decayed at the end: the ratio of the transforms is the FRF, but for what the
// low-pass lets alias (10th order at 2.5 kHz, images above 8192 - 1400 Hz: 5e-5 of images that are
// a few 1e-2 of the band's content) and for the 25 Hz mode cut at exp(-1.57 * 8) = 3.5e-6.
TEST(TenModeTruth, RecordingHoldsTheExactResponse) {
  const TenModeTruth truth = ten_mode_truth();
  ImpactRecordOptions options;
  options.noise = 0;
  const auto recording = impact_recording(truth, {{0.10003, 100, 0.6e-3}}, options, 8.2);
  const Index n = good_fft_length(recording.samples());
  Eigen::MatrixXd signals(recording.samples(), 21);
  for (Index c = 0; c < 21; ++c) {
    signals.col(c) = recording.channels[static_cast<std::size_t>(c)].samples;
  }
  const Eigen::MatrixXcd spectra = real_spectra(signals, n);
  const Eigen::VectorXd f = line_frequencies(n, options.sample_rate_hz);
  const Index lines = (f.array() < 1400).count();
  const Eigen::MatrixXcd exact = truth.accelerance(f.head(lines));
  double worst = 0;
  for (Index c = 0; c < 20; ++c) {
    const Eigen::ArrayXcd H =
        spectra.col(c + 1).head(lines).array() / spectra.col(0).head(lines).array();
    worst = std::max(worst, (H - exact.col(c).array()).matrix().norm() / exact.col(c).norm());
  }
  EXPECT_LT(worst, 5e-6);
  EXPECT_GT(worst, 1e-12);
}

TEST(TenModeTruth, SeedsGiveTheSameAndOtherNoise) {
  const TenModeTruth truth = ten_mode_truth(2);
  ImpactRecordOptions options;
  options.block_samples = 2048;
  options.hits = 2;
  const auto a = impact_recording(truth, options), b = impact_recording(truth, options);
  EXPECT_EQ(a.channels[1].samples, b.channels[1].samples);
  options.noise = 0;
  const auto clean = impact_recording(truth, options);
  const Eigen::VectorXd noise = a.channels[1].samples - clean.channels[1].samples;
  // 0.5 % of the rms, to the scatter of a standard deviation over thousands of samples.
  EXPECT_NEAR(noise.norm() / clean.channels[1].samples.norm(), 0.005, 0.0003);
}

}  // namespace
}  // namespace rigfit::testing::ten_mode_truth_test
