#include "signal/impact_test.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "signal/recording_error.h"
#include "tests/signal/ten_mode_truth.h"

namespace rigfit::signal {
namespace {
using Eigen::Index;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using testing::ImpactRecordOptions;

std::vector<std::string> names(Index count) {
  std::vector<std::string> result;
  for (Index j = 0; j < count; ++j) result.push_back("#" + std::to_string(j + 2));
  return result;
}

ImpactTest analyse(const Recording& recording, Index responses, const ImpactTestOptions& options) {
  const auto all = names(responses);
  return analyse_impact_test(std::span(&recording, 1), "force", all, options);
}

/// Largest over the responses of |H - exact| / |exact| in root mean squares over lines below 1300 Hz.
double error_of(const FrfSet& frfs, const Eigen::MatrixXcd& exact) {
  double worst = 0;
  for (Index c = 0; c < exact.cols(); ++c) {
    worst = std::max(worst, (frfs.H.col(c).head(exact.rows()) - exact.col(c)).norm() /
                                exact.col(c).norm());
  }
  return worst;
}

Eigen::VectorXd lines_below(const FrfSet& frfs, double f) {
  return frfs.frequency_hz.head((frfs.frequency_hz.array() < f).count());
}

// Without noise what is left of the error is what aliases (5e-6, see ten_mode_truth_test) and what each
// ring-down leaves beyond its block: exp(-(1.57 + a) 4 s) of the 25 Hz mode.
TEST(ImpactTest, GivesTheExactFrfAlsoUnderAnExponentialWindow) {
  const auto truth = testing::ten_mode_truth(6);
  ImpactRecordOptions record;
  record.noise = 0;
  const Recording recording = testing::impact_recording(truth, record);
  for (const double rate : {0.0, 2.0}) {
    for (const double force_window : {0.0, 0.02}) {
      ImpactTestOptions options;
      options.exponential_decay_rate_1_s = rate;
      options.force_window_s = force_window;
      options.driving_response = truth.driving_point;
      const ImpactTest test = analyse(recording, 6, options);
      EXPECT_EQ(test.frfs.averages, 5);
      EXPECT_EQ(test.frfs.exponential_decay_rate_1_s, rate);
      EXPECT_EQ(test.frfs.form, FrfForm::accelerance);
      EXPECT_TRUE(test.amplitudes);
      const double error =
          error_of(test.frfs, truth.accelerance(lines_below(test.frfs, 1300), rate));
      EXPECT_LT(error, rate > 0 ? 2e-5 : 2.5e-3) << rate << " " << force_window;
      ASSERT_TRUE(test.driving_point);
      EXPECT_EQ(test.driving_point->verdict, DrivingPointVerdict::consistent);
      EXPECT_LT(test.driving_point->wrong_sign_share, 1e-3);
      EXPECT_EQ(test.driving_point->resonances, 10);
      EXPECT_EQ(test.driving_point->missing_antiresonances, 0);
    }
  }
}

}  // namespace
}  // namespace rigfit::signal
