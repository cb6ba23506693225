#include "signal/impact/impact_hits.h"

#include "signal/recording/recording.h"
#include "tests/reference/ten_mode_truth.h"
#include "tests/test.h"

namespace rigfit::signal::impact_hits_test {

using testing::HammerHit;
using testing::ImpactRecordOptions;

const std::vector<Index> kResponses{1, 2, 3};

struct Bench {
  testing::TenModeTruth truth = testing::ten_mode_truth(3);
  ImpactRecordOptions options;
  Bench() { options.block_samples = 8192; }  // 1 s

  [[nodiscard]] Recording record(const std::vector<HammerHit>& hits) const {
    return testing::impact_recording(truth, hits, options);
  }
  [[nodiscard]] HitSearch search(const std::vector<HammerHit>& hits,
                                 const HitOptions& how = {}) const {
    const Recording recording = record(hits);
    return find_hits(std::span(&recording, 1), 0, kResponses, how);
  }
};

TEST(ImpactHits, FiveCleanHitsAreFoundWhereTheyAreAndNeverFlagged) {
  Bench bench;
  for (const double sign : {1.0, -1.0}) {
    for (const double noise : {0.0, 0.002, 0.01}) {
      for (const double ringing : {0.0, 0.15}) {
        for (std::uint64_t seed = 1; seed <= 5; ++seed) {
          bench.options.seed = seed;
          bench.options.noise = noise;
          bench.options.noise_of_peak = true;
          bench.options.ringing = ringing;
          bench.options.force_sign = sign;
          bench.options.offset = 0.5;
          const auto truth = testing::hammer_hits(bench.options);
          const HitSearch search = bench.search(truth);
          ASSERT_EQ(search.hits.size(), 5u) << noise << " " << ringing << " " << seed;
          EXPECT_EQ(search.sign, static_cast<int>(sign));
          for (std::size_t i = 0; i < 5; ++i) {
            EXPECT_TRUE(search.hits[i].accepted)
                << noise << " " << ringing << " " << seed << ": " << search.hits[i].reason;
            // The low-pass delays by sum(-1 / Re poles) ~ 0.41 ms; the peak is half a pulse later.
            EXPECT_NEAR(search.hits[i].time_s, truth[i].time_s + 0.7e-3, 0.3e-3);
            EXPECT_GT(sign * search.hits[i].peak, 0);
          }
        }
      }
    }
  }
}

// 5 % at 20 ms and 30 % at 5 ms, before or after, with the ringing and the noise of the clean hits.
TEST(ImpactHits, DoubleHitsAreCaught) {
  Bench bench;
  bench.options.noise_of_peak = true;
  struct Case {
    double delay, ratio;
  };
  for (const Case second : {Case{20e-3, 0.05}, Case{5e-3, 0.3}, Case{60e-3, 0.1}, Case{-8e-3, 0.2},
                            Case{0.15, 0.8}, Case{0.4, 0.06}}) {
    for (const double noise : {0.0, 0.003}) {
      for (const double ringing : {0.0, 0.15}) {
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
          bench.options.seed = seed;
          bench.options.noise = noise;
          bench.options.ringing = ringing;
          auto hits = testing::hammer_hits(bench.options);
          const HammerHit& first = hits[2];
          hits.push_back({first.time_s + second.delay, second.ratio * first.peak,
                          first.duration_s * (seed % 2 == 0 ? 1 : 1.3)});
          const HitSearch search = bench.search(hits);
          ASSERT_EQ(search.hits.size(), 5u);
          for (std::size_t i = 0; i < 5; ++i) {
            const Hit& hit = search.hits[i];
            ASSERT_EQ(hit.accepted, i != 2) << second.delay << " " << noise << " " << ringing << " "
                                            << seed << ": " << hit.reason;
            if (i != 2) continue;
            EXPECT_THAT(hit.faults, ElementsAre(HitFault::double_hit));
            EXPECT_THAT(hit.reason, HasSubstr("double hit"));
            EXPECT_NEAR(hit.second_hit_delay_s, second.delay, 0.6e-3);
            EXPECT_NEAR(hit.second_hit, second.ratio, 0.3 * second.ratio + 0.01);
          }
        }
      }
    }
  }
}

// A converter of 12 bits over 1.5 times the largest value: equal peak neighbours are no clipping.
TEST(ImpactHits, ARecordThatBeginsWithinThePulseHoldsNoWholeHit) {
  Bench bench;
  bench.options.hits = 1;
  Recording recording = bench.record(testing::hammer_hits(bench.options));
  const Hit whole = find_hits(std::span(&recording, 1), 0, kResponses).hits.front();
  EXPECT_TRUE(whole.accepted) << whole.reason;
  for (const Index first : {whole.pulse_first, whole.pulse_first + 1}) {
    Recording cut = recording;
    for (Channel& channel : cut.channels) {
      channel.samples = channel.samples.tail(channel.samples.size() - first).eval();
    }
    const Hit hit = find_hits(std::span(&cut, 1), 0, kResponses).hits.front();
    EXPECT_TRUE(hit.has(HitFault::unresolved_pulse)) << first;
    EXPECT_FALSE(hit.accepted);
  }
}

TEST(ImpactHits, CoarseQuantisationIsNotOverload) {
  Bench bench;
  bench.options.noise = 0;
  Recording recording = bench.record(testing::hammer_hits(bench.options));
  for (Channel& channel : recording.channels) {
    const double step = channel.samples.cwiseAbs().maxCoeff() * 1.5 / 2048;
    channel.samples = (channel.samples / step).array().round() * step;
  }
  const HitSearch search = find_hits(std::span(&recording, 1), 0, kResponses);
  ASSERT_EQ(search.hits.size(), 5u);
  for (const Hit& hit : search.hits) EXPECT_TRUE(hit.accepted) << hit.reason;
}

TEST(ImpactHits, RingDownCutOffByTheNextHitOrTheEnd) {
  Bench bench;
  bench.options.noise = 1e-4;
  // Hits 1 s apart, but the third comes 0.4 s after the second, and the record ends 0.3 s after the
  // last. A ring-down (slowest 1.6 1/s) is at some per cent after 0.4 s.
  const std::vector<HammerHit> hits{
      {0.2, 100, 6e-4}, {1.3, 100, 6e-4}, {1.7, 100, 6e-4}, {2.8, 100, 6e-4}, {3.9, 100, 6e-4}};
  const Recording recording = testing::impact_recording(bench.truth, hits, bench.options, 4.2);
  const HitSearch search = find_hits(std::span(&recording, 1), 0, kResponses);
  ASSERT_EQ(search.hits.size(), 5u);
  EXPECT_NEAR(static_cast<double>(search.block_samples) / 8192, 1.08, 0.05);
  EXPECT_TRUE(search.hits[0].accepted) << search.hits[0].reason;
  EXPECT_THAT(search.hits[1].reason, HasSubstr("cut off by the next hit"));
  EXPECT_TRUE(search.hits[2].accepted) << search.hits[2].reason;
  EXPECT_TRUE(search.hits[3].accepted) << search.hits[3].reason;
  EXPECT_THAT(search.hits[4].reason, HasSubstr("cut off by the end of the record"));
  EXPECT_THAT(search.hits[4].faults, ElementsAre(HitFault::cut_off));
}

TEST(ImpactHits, ForceSpectrumIsAskedForInTheBand) {
  Bench bench;
  bench.options.noise = 0;
  bench.options.hits = 2;
  auto hits = testing::hammer_hits(bench.options);
  hits[0].duration_s = hits[1].duration_s = 1e-3;
  // |cos(pi f T) / (1 - (2 f T)^2)|: 20 dB below 0 Hz at f T = 1.303, below the filter.
  const HitSearch search = bench.search(hits);
  ASSERT_EQ(search.hits.size(), 2u);
  // Lines are 2 Hz apart.
  EXPECT_NEAR(search.hits[0].usable_hz, 1303, 4);
  EXPECT_TRUE(search.hits[0].accepted);
  HitOptions options{.band_hz = std::pair(10.0, 1200.0)};
  EXPECT_TRUE(bench.search(hits, options).hits[0].accepted);
  options.band_hz = {10.0, 1400.0};
  const Hit hit = bench.search(hits, options).hits[0];
  EXPECT_THAT(hit.faults, ElementsAre(HitFault::force_spectrum));
  EXPECT_THAT(hit.reason, HasSubstr("usable to"));
}

TEST(ImpactHits, RecordsWithoutHitsAreSaid) {
  Bench bench;
  Recording recording = bench.record(testing::hammer_hits(bench.options));
  for (const double level : {0.0, kNaN}) {
    recording.channels[0].samples.setConstant(level);
    const HitSearch none = find_hits(std::span(&recording, 1), 0, kResponses);
    EXPECT_TRUE(none.hits.empty());
    ASSERT_EQ(none.notes.size(), 1u);
    EXPECT_EQ(none.notes[0].code, "no_hit");
  }
  recording.channels[0].samples = recording.channels[1].samples.reverse();
  recording.sample_rate_hz = 0;
  EXPECT_THROW((void)find_hits(std::span(&recording, 1), 0, kResponses), RecordingError);
}

// An accelerometer named as the force rings between its "hits"; the hammer is named as what it is.
TEST(ImpactHits, AResponseNamedAsForceIsRefusedAndTheHammerNamed) {
  Bench bench;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    bench.options.seed = seed;
    const Recording recording = bench.record(testing::hammer_hits(bench.options));
    const std::vector<Index> responses{0, 2};
    const HitSearch search = find_hits(std::span(&recording, 1), 1, responses);
    ASSERT_FALSE(search.hits.empty());
    for (const Hit& hit : search.hits) {
      EXPECT_FALSE(hit.accepted);
      EXPECT_THAT(hit.faults, ElementsAre(HitFault::rings));
      EXPECT_THAT(hit.reason, HasSubstr("\"force\" has a short pulse"));
    }
  }
}

}  // namespace rigfit::signal::impact_hits_test
