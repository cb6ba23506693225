#include "signal/recording/recording_time.h"

#include "signal/readers/csv_fields.h"
#include "tests/test.h"

namespace rigfit::signal::time_axis_test {

VectorXd times(Index n, double rate, double resolution) {
  VectorXd t(n);
  for (Index k = 0; k < n; ++k) {
    t[k] = static_cast<double>(k) / rate;
    if (resolution > 0) t[k] = std::round(t[k] / resolution) * resolution;
  }
  return t;
}

TEST(TimeAxis, RoundedTimesGiveTheExactRate) {
  // 51.2 kHz printed to microseconds, to 10 us (half a step), 100 and 1000 Hz printed to seconds.
  for (const auto& [rate, resolution] :
       {std::pair{51200.0, 1e-6}, {51200.0, 1e-5}, {100.0, 1.0}, {1000.0, 1.0}}) {
    const TimeAxis axis = time_axis(times(20000, rate, resolution), resolution);
    EXPECT_EQ(axis.rate_hz, rate) << resolution;
    EXPECT_TRUE(axis.uniform) << resolution;
    // Rounding is spread evenly over one digit: resolution / sqrt(12).
    EXPECT_NEAR(axis.jitter_s, resolution / std::sqrt(12), 0.02 * resolution);
  }
}

// A step of 3 ms is what was printed, whatever rounder rate the digits would leave; of 4096 Hz to
// 0.1 ms 24 samples leave 4000 and 4100 Hz as well.
TEST(TimeAxis, FewTimesAreNotRounded) {
  EXPECT_NEAR(time_axis(times(24, 1 / 0.003, 0.001), 0.001).rate_hz, 1 / 0.003, 1e-6);
  const TimeAxis axis = time_axis(times(24, 4096, 1e-4), 1e-4);
  EXPECT_NEAR(axis.rate_hz, 4096, 3 * axis.rate_relative_std * 4096);
  EXPECT_GT(axis.rate_relative_std, 1e-3);
}

// Printed digits leave an interval: its ends are sqrt(3) standard deviations off.
TEST(TimeAxis, RatesThatAreNotUsualAreKnownToWhatWasPrinted) {
  for (const double rate : {400 / 3.0, 512 / 3.0, 2000 / 3.0, 100.3156, 104.37, 96.1234}) {
    const TimeAxis axis = time_axis(times(700, rate, 1e-3), 1e-3);
    EXPECT_LE(std::abs(axis.rate_hz / rate - 1), 1.74 * axis.rate_relative_std + 1e-9) << rate;
    EXPECT_LT(axis.rate_relative_std, 1e-3 / (700 / rate));
  }
}

TEST(TimeAxis, StatedRateIsCheckedAndTakenWhenTimesCannotTell) {
  EXPECT_TRUE(time_axis(times(100, 50, 0.01), 0.01, 50).agrees_with_stated);
  EXPECT_FALSE(time_axis(times(100, 50, 0.01), 0.01, 100).agrees_with_stated);
  EXPECT_EQ(time_axis(times(100, 48000, 1e-4), 1e-4, 48000).rate_hz, 48000);
}

TEST(TimeAxis, GapsRepeatsAndSteps) {
  VectorXd t = times(1000, 1000, 1e-3);
  t.tail(500).array() += 0.25;
  TimeAxis axis = time_axis(t, 1e-3);
  EXPECT_FALSE(axis.uniform);
  EXPECT_EQ(axis.gaps, 1);
  EXPECT_EQ(axis.longest_gap_at, 500);
  EXPECT_NEAR(axis.longest_gap_s, 0.251, 1e-9);
  EXPECT_NEAR(axis.rate_hz, 1000, 1e-6);
  t = times(1000, 1000, 1e-3);
  t[300] = t[299];
  t[700] = t[600];
  axis = time_axis(t, 1e-3);
  EXPECT_EQ(axis.repeated, 1);
  EXPECT_EQ(axis.backward, 1);
  EXPECT_EQ(axis.first_fault, 300);
}

TEST(TimeAxis, NoRateFromTimesThatDoNotRise) {
  EXPECT_EQ(time_axis(VectorXd::Constant(10, 3.0)).rate_hz, 0);
  EXPECT_EQ(time_axis(VectorXd::Constant(1, 3.0)).rate_hz, 0);
  EXPECT_EQ(time_axis(-times(10, 10, 0)).rate_hz, 0);
  VectorXd huge(3);
  huge << 0, 1e308, -1e308;
  const TimeAxis axis = time_axis(huge);
  EXPECT_TRUE(std::isfinite(axis.jitter_s) && std::isfinite(axis.rate_hz));
}

TEST(TimeAxis, RoundRates) {
  EXPECT_EQ(round_rate(65535.95, 1e-5), 65536);
  EXPECT_EQ(round_rate(1000.0000001, 1e-9), 1000);
  EXPECT_EQ(round_rate(0.1 + 1e-12, 1e-9), 0.1);
  EXPECT_EQ(round_rate(333.33333, 1e-12), 333.33333);
}

TEST(NumberText, AgreesWithTheLibraryToTheLastBit) {
  for (const char* text :
       {"0", "-0.0", "1", "12345678.87654321", "0.1234567890123456789", "-1.5e-7", "1E22", "1e23",
        "9007199254740993", "1.7976931348623157e308", "4.9e-324", "123456789012345678901234567890",
        "0.000001", "5.", ".5", "+3.25", "1.00000E-005", "8.5D+02", "00000000000000000000001.5"}) {
    double value = 0;
    ASSERT_TRUE(parse_whole_number(text, '.', value)) << text;
    std::string plain(text);
    for (char& c : plain) c = c == 'D' ? 'E' : c;
    EXPECT_EQ(value, std::strtod(plain.c_str(), nullptr)) << text;
  }
  double value = 0;
  EXPECT_TRUE(parse_whole_number("1,5e3", ',', value));
  EXPECT_EQ(value, 1500);
  for (const char* text :
       {"", "-", ".", "e5", "1,5", "1.5.2", "nan", "inf", "0x10", "1 2", "--1"}) {
    EXPECT_FALSE(parse_whole_number(text, '.', value)) << text;
  }
  EXPECT_TRUE(parse_whole_number("1e999", '.', value));
  EXPECT_TRUE(std::isinf(value));
  EXPECT_EQ(printed_decimals("0.250", '.'), 3);
  EXPECT_EQ(printed_decimals("1.50E-5", '.'), 7);
  EXPECT_EQ(printed_decimals("3", '.'), 0);
}

}  // namespace rigfit::signal::time_axis_test
