#include "signal/quality/quality.h"

#include "tests/test.h"

namespace rigfit::signal::quality_test {

Recording recording_of(VectorXd samples, double rate) {
  return {.path = "x.csv",
          .sample_rate_hz = rate,
          .channels = {{.name = "a",
                        .unit = "m/s^2",
                        .quantity = Quantity::acceleration,
                        .samples = std::move(samples)}}};
}

VectorXd noise(Index n, double std, unsigned seed) {
  Normal normal(seed);
  return VectorXd::NullaryExpr(n, [&] { return std * normal(); });
}

VectorXd sine(Index n, double frequency, double rate, double amplitude) {
  return VectorXd::NullaryExpr(n, [=](Index k) {
    return amplitude * std::sin(2 * kPi * frequency * static_cast<double>(k) / rate);
  });
}

std::vector<std::string> codes(const ChannelQuality& q) {
  std::vector<std::string> out;
  for (const auto& f : q.findings) out.push_back(f.code);
  return out;
}

ChannelQuality check(const Recording& r) { return check_quality(r)[0]; }

TEST(Quality, CleanDecayAndNoiseHaveNoFindings) {
  // 40 seeds of a decaying mode near the mains frequency with noise: a finding would be false.
  for (unsigned seed = 0; seed < 40; ++seed) {
    VectorXd x = sine(4000, 50, 1000, 10);
    for (Index k = 0; k < x.size(); ++k) x[k] *= std::exp(-5.3e-3 * static_cast<double>(k));
    x += noise(4000, 0.01, seed);
    EXPECT_THAT(codes(check(recording_of(x, 1000))), ::testing::IsEmpty()) << seed;
  }
}

TEST(Quality, CountsClippedSamplesWithAndWithoutARange) {
  VectorXd x = sine(5000, 7, 1000, 1) + noise(5000, 1e-3, 1);
  long truth = 0;
  for (auto& v : x) {
    if (v > 0.8) v = 0.8, ++truth;
  }
  Recording r = recording_of(x, 1000);
  EXPECT_EQ(check(r).clipped_samples, truth);
  r.channels[0].nominal_range = 5;  // clipped well below it
  const auto q = check(r);
  EXPECT_EQ(q.clipped_samples, truth);
  EXPECT_THAT(q.findings[0].message, HasSubstr("below the range"));
  r.channels[0].nominal_range = 0.75;
  EXPECT_GT(check(r).clipped_samples, truth);
}

TEST(Quality, DropoutsStuckEndAndMissing) {
  VectorXd x = sine(6000, 11, 1000, 1) + noise(6000, 0.01, 4);
  x.segment(1000, 20).setZero();
  x.segment(2000, 15).setConstant(x[1999]);
  x.tail(200).setConstant(0.3);
  x[3000] = kNaN;
  const auto q = check(recording_of(x, 1000));
  EXPECT_THAT(codes(q), UnorderedElementsAre("missing", "dropouts", "stuck"));
  EXPECT_EQ(q.missing_samples, 1);
  for (const auto& f : q.findings) {
    // The sample before the held stretch has its value, too.
    if (f.code == "dropouts") {
      EXPECT_EQ(f.samples, 20 + 16);
    }
    if (f.code == "stuck") {
      EXPECT_EQ(f.samples, 200);
    }
  }
}

TEST(Quality, ASignalAtRestOnAFewStepsIsNoDropout) {
  VectorXd x = noise(20000, 0.3, 5);
  for (auto& v : x) v = std::round(v);  // mostly zero: runs of zeros are ordinary
  EXPECT_THAT(codes(check(recording_of(x, 1000))), Not(Contains("dropouts")));
  EXPECT_THAT(codes(check(recording_of(x, 1000))), Contains("coarse_quantisation"));
}

TEST(Quality, OneBit) {
  VectorXd x = noise(2000, 1, 6);
  for (auto& v : x) v = v > 0 ? 1 : 0;
  EXPECT_THAT(codes(check(recording_of(x, 1000))), Contains("one_bit"));
}

TEST(Quality, ConstantAndEmptyChannels) {
  EXPECT_THAT(codes(check(recording_of(VectorXd::Constant(50, 3.5), 100))), ElementsAre("stuck"));
  const double nan = kNaN;
  const auto q = check(recording_of(VectorXd::Constant(50, nan), 100));
  EXPECT_THAT(codes(q), ElementsAre("missing"));
  EXPECT_EQ(q.missing_samples, 50);
  EXPECT_THAT(codes(check(recording_of(VectorXd::Constant(1, 1.0), 100))), ::testing::IsEmpty());
}

}  // namespace rigfit::signal::quality_test
