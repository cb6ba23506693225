#include "signal/impact/roving_hammer.h"

#include "signal/recording/recording.h"
#include "tests/reference/ten_mode_truth.h"
#include "tests/test.h"

namespace rigfit::signal::roving_hammer_test {

/// Three accelerometers, the hammer at the first, the third and a place without one.
struct Roving : ::testing::Test {
  std::vector<Recording> of(Index struck, double noise, std::uint64_t seed,
                            Index block = 8192) const {
    testing::TenModeTruth truth = testing::ten_mode_truth(6);
    truth.driving_point = struck;
    std::vector<Recording> recordings;  // a hit each, so that none rings into the next
    for (std::uint64_t hit = 0; hit < 3; ++hit) {
      testing::ImpactRecordOptions record{
          .block_samples = block, .noise = noise, .seed = 10 * seed + hit};
      record.hits = 1;
      recordings.push_back(testing::impact_recording(truth, record));
      recordings.back().channels.resize(4);
    }
    return recordings;
  }
  RovingHammer analyse(double noise, double sign = 1) {
    first = of(0, noise, 1);
    third = of(2, noise, 2);
    fifth = of(4, noise, 3, 8192 - 700);  // its hits leave shorter blocks
    for (Recording& recording : third) recording.channels[0].samples *= sign;
    const std::vector<StruckPoint> points{{"a1", first}, {"a3", third}, {"beam 5", fifth}};
    ImpactTestOptions options{.exponential_decay_rate_1_s = 6};
    options.hits.band_hz = {10.0, 1300.0};
    return analyse_roving_hammer(points, "force", std::vector<std::string>{"a1", "a2", "a3"},
                                 options);
  }
  std::vector<Recording> first, third, fifth;
};

TEST_F(Roving, GivesTheExactFrfsOfEveryPointInOneSet) {
  const RovingHammer roving = analyse(0);
  const FrfSet& frfs = roving.frfs;
  ASSERT_EQ(frfs.inputs.size(), 3u);
  ASSERT_EQ(frfs.responses.size(), 3u);
  ASSERT_EQ(frfs.H.cols(), 9);
  EXPECT_EQ(frfs.inputs[1].name, "a3");
  EXPECT_EQ(frfs.inputs[1].node, frfs.responses[2].node);
  EXPECT_EQ(frfs.inputs[2].node, 4);  // after the three responses
  const Index lines = (frfs.frequency_hz.array() < 1300).count();
  const Index struck[] = {0, 2, 4};
  for (Index i = 0; i < 3; ++i) {
    testing::TenModeTruth truth = testing::ten_mode_truth(6);
    truth.driving_point = struck[i];
    const MatrixXcd exact = truth.accelerance(frfs.frequency_hz.head(lines), 6);
    for (Index r = 0; r < 3; ++r) {
      // What a ring-down leaves beyond its block: exp(-(1.57 + 6) 0.9) = 1e-3 of the 25 Hz mode,
      // less of the others.
      EXPECT_LT((frfs.H.col(frfs.column(r, i)).head(lines) - exact.col(r)).norm(),
                2e-3 * exact.col(r).norm())
          << r << " " << i;
    }
  }
  ASSERT_EQ(roving.driving_points.size(), 2u);
  for (const DrivingPoint& driving : roving.driving_points) {
    EXPECT_EQ(driving.check.verdict, DrivingPointVerdict::consistent);
  }
  ASSERT_EQ(roving.reciprocity.size(), 1u);
  EXPECT_EQ(roving.reciprocity[0].points[0], "a1");
  EXPECT_EQ(roving.reciprocity[0].points[1], "a3");
  EXPECT_LT(roving.reciprocity[0].difference, 4e-3);  // each within 2e-3
}

TEST_F(Roving, NamesAPointStruckTheOtherWay) {
  const RovingHammer roving = analyse(0.002, -1);
  ASSERT_EQ(roving.driving_points.size(), 2u);
  EXPECT_EQ(roving.driving_points[1].check.verdict, DrivingPointVerdict::inverted);
  // H and -H: their mean is nothing but noise.
  EXPECT_GT(roving.reciprocity[0].difference, 10);
  EXPECT_TRUE(says(roving.notes, "driving_point"));
  EXPECT_TRUE(says(roving.notes, "not_reciprocal"));
}

TEST_F(Roving, LeavesOutAPointWithoutAUsableHitAndRefusesMixedRates) {
  first = of(0, 0.002, 1);
  third = of(2, 0.002, 2);
  for (Recording& recording : third) recording.channels[0].samples.setZero();
  std::vector<StruckPoint> points{{"a1", first}, {"a3", third}};
  const std::vector<std::string> responses{"a1", "a3"};
  const RovingHammer roving = analyse_roving_hammer(points, "force", responses);
  ASSERT_EQ(roving.frfs.inputs.size(), 1u);
  EXPECT_EQ(roving.frfs.inputs[0].name, "a1");
  EXPECT_TRUE(says(roving.notes, "point_left_out"));

  points[1].recordings.front().sample_rate_hz *= 2;
  EXPECT_THROW((void)analyse_roving_hammer(points, "force", responses), RecordingError);
}

}  // namespace rigfit::signal::roving_hammer_test
