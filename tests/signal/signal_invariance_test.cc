// What must not depend on how a test is written down: the order of channels, the units of force,
// motion and time. FRFs follow to rounding; modes follow far within their standard uncertainty,
// which is where an iteration that ends at 1e-6 of its scale and a numerical rank leave them.
#include "signal/impact/impact_frfs.h"
#include "signal/modal/modal_identification.h"
#include "tests/reference/ten_mode_truth.h"
#include "tests/test.h"

namespace rigfit::signal::signal_invariance_test {

constexpr int kResponses = 5;

class SignalInvariance : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    testing::ImpactRecordOptions record{.hits = 3};
    record.block_samples = 16384;
    recording_ = std::make_unique<Recording>(
        testing::impact_recording(testing::ten_mode_truth(kResponses), record));
    frfs_ = std::make_unique<FrfSet>(frfs_of(*recording_, names()));
    modes_ = std::make_unique<ModalResult>(modes_of(*frfs_, 1));
    ASSERT_EQ(modes_->model.modes.size(), 10u);
  }
  static void TearDownTestSuite() {
    recording_.reset();
    frfs_.reset();
    modes_.reset();
  }

  static std::vector<std::string> names() {
    std::vector<std::string> list;
    for (int k = 1; k <= kResponses; ++k) list.push_back("a" + std::to_string(k));
    return list;
  }

  /// `time`: what the records' unit of time is of a second.
  static FrfSet frfs_of(const Recording& recording, const std::vector<std::string>& responses,
                        double time = 1) {
    ImpactTestOptions options{.hits = {.block_s = 2 / time},
                              .exponential_decay_rate_1_s = 1 * time};
    return analyse_impact_test({&recording, 1}, "force", responses, options).frfs;
  }
  static ModalResult modes_of(const FrfSet& frfs, double time) {
    return identify_modes(frfs, {.high_hz = 1400 * time});
  }

  static void expect_same_modes(const ModalResult& found, double time = 1) {
    ASSERT_EQ(found.model.modes.size(), modes_->model.modes.size());
    for (std::size_t r = 0; r < found.model.modes.size(); ++r) {
      const auto& mode = found.model.modes[r];
      const auto& expected = modes_->model.modes[r];
      EXPECT_NEAR(mode.frequency_hz.value / time, expected.frequency_hz.value,
                  0.01 * expected.frequency_hz.std);
      EXPECT_NEAR(mode.damping_ratio.value, expected.damping_ratio.value,
                  0.01 * expected.damping_ratio.std);
      EXPECT_NEAR(mode.frequency_hz.std / time / expected.frequency_hz.std, 1, 0.01);
    }
  }

  static inline std::unique_ptr<Recording> recording_;
  static inline std::unique_ptr<FrfSet> frfs_;
  static inline std::unique_ptr<ModalResult> modes_;
};

TEST_F(SignalInvariance, OfTheOrderOfChannels) {
  auto reversed = names();
  std::reverse(reversed.begin(), reversed.end());
  const FrfSet frfs = frfs_of(*recording_, reversed);
  for (Index k = 0; k < kResponses; ++k) {
    EXPECT_EQ(frfs.responses[k].name, frfs_->responses[kResponses - 1 - k].name);
  }
  const double largest = frfs_->H.cwiseAbs().maxCoeff();
  EXPECT_LT((frfs.H.rowwise().reverse() - frfs_->H).cwiseAbs().maxCoeff(), 1e-12 * largest);
  expect_same_modes(modes_of(frfs, 1));
}

TEST_F(SignalInvariance, OfTheUnitsOfForceAndMotion) {
  Recording recording = *recording_;
  for (auto& channel : recording.channels) {
    channel.samples *= channel.name == "force" ? 1e-3 : 1e3;
  }
  const FrfSet frfs = frfs_of(recording, names());
  // To 1400 Hz: the windowed force has hardly anything but rounding where its pulse has none.
  const MatrixXcd expected = frfs_->H.topRows(2801);
  EXPECT_LT((frfs.H.topRows(2801) * 1e-6 - expected).cwiseAbs().maxCoeff(),
            1e-13 * expected.cwiseAbs().maxCoeff());
  expect_same_modes(modes_of(frfs, 1));
}

TEST_F(SignalInvariance, OfTheUnitOfTime) {
  constexpr double kFaster = 8;  // all happens in an eighth of the time
  Recording recording = *recording_;
  recording.sample_rate_hz *= kFaster;
  recording.start_time_s /= kFaster;
  const FrfSet frfs = frfs_of(recording, names(), kFaster);
  ASSERT_EQ(frfs.H.rows(), frfs_->H.rows());
  EXPECT_LT((frfs.frequency_hz / kFaster - frfs_->frequency_hz).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((frfs.H - frfs_->H).cwiseAbs().maxCoeff(), 1e-9 * frfs_->H.cwiseAbs().maxCoeff());
  expect_same_modes(modes_of(frfs, kFaster), kFaster);
}

}  // namespace rigfit::signal::signal_invariance_test
