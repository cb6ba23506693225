// Impact tests from recordings to modes where hits, sensors and logger are not as one wishes:
// pulses of one sample, double hits, hum, gaps, saturation, a single hit, modes closer than their
// bandwidth, modes a thousand times weaker than others. The rig is small and known exactly
// (tests/reference/ten_mode_truth.h); hits, noise and their times are drawn anew for each test.
#include "signal/impact/impact_frfs.h"
#include "signal/modal/modal_identification.h"
#include "tests/coverage.h"
#include "tests/reference/ten_mode_truth.h"
#include "tests/test.h"

namespace rigfit::signal::hit_coverage_test {

constexpr double kRate = 2048;
constexpr Index kBlock = 8192;
constexpr Index kResponses = 4;

/// Modes with orthogonal-looking shapes on a driving point and three more.
testing::TenModeTruth rig(const std::vector<double>& frequency_hz, double damping_ratio = 0.01) {
  testing::TenModeTruth truth;
  const auto modes = static_cast<Index>(frequency_hz.size());
  truth.frequency_hz = Map<const VectorXd>(frequency_hz.data(), modes);
  truth.damping_ratio = VectorXd::Constant(modes, damping_ratio);
  truth.shapes.resize(kResponses, modes);
  for (Index j = 0; j < kResponses; ++j) {
    for (Index r = 0; r < modes; ++r) {
      const double x = (static_cast<double>(j) + 0.6) / (static_cast<double>(kResponses) + 0.7);
      truth.shapes(j, r) = 0.5 * std::sin(static_cast<double>(r + 1) * kPi * x);
    }
  }
  return truth;
}

struct ImpactCase {
  testing::TenModeTruth truth = rig({40, 95, 170});
  testing::ImpactRecordOptions record;
  ImpactTestOptions impact;
  ModalOptions modal;
  std::vector<testing::HammerHit> hits;
  std::uint64_t seed;
  /// Hits that must be rejected, and why.
  std::vector<std::size_t> rejected = {};
  HitFault why = HitFault::double_hit;
  /// What becomes of the recording.
  std::function<void(Recording&)> alter = {};

  explicit ImpactCase(std::uint64_t seed_, int count = 5) : seed(seed_) {
    record.sample_rate_hz = kRate;
    record.block_samples = kBlock;
    record.hits = count;
    record.filter_hz = 800;
    record.filter_order = 8;
    record.noise = 0.002;
    record.seed = seed;
    impact.hits.block_s = kBlock / kRate;
    modal.low_hz = 10, modal.high_hz = 250;
    modal.lscf.max_order = 30;
    draw(2.5e-3);
  }
  void draw(double pulse_s) {
    hits = testing::hammer_hits(record);
    for (auto& hit : hits) hit.duration_s *= pulse_s / 0.6e-3;
  }
  [[nodiscard]] Index sample_at(double time_s) const { return static_cast<Index>(time_s * kRate); }
  [[nodiscard]] ImpactTest analysed() const {
    Recording recording = testing::impact_recording(truth, hits, record);
    if (alter) alter(recording);
    const std::vector<std::string> responses{"a1", "a2", "a3", "a4"};
    return analyse_impact_test({&recording, 1}, "force", responses, impact);
  }
};

/// Coverage of frequency, damping and residues over tests; what else must be so.
class Tally {
 public:
  void add(const ImpactCase& test) {
    const ImpactTest measured = test.analysed();
    expect_hits(test, measured);
    const FrfSet& frfs = measured.frfs;
    EXPECT_TRUE(frfs.H.allFinite() && frfs.H_std.allFinite() && frfs.coherence.allFinite());
    const ModalResult result = identify_modes(frfs, test.modal);
    std::vector<const IdentifiedMode*> sure;
    for (const auto& mode : result.model.modes) {
      EXPECT_TRUE(std::isfinite(mode.frequency_hz.value + mode.frequency_hz.std +
                                mode.damping_ratio.value + mode.damping_ratio.std) &&
                  mode.shape.allFinite() && mode.shape_std.allFinite());
      if (!mode.doubtful) sure.push_back(&mode);
    }
    const Index modes = test.truth.frequency_hz.size();
    if (static_cast<Index>(sure.size()) != modes) {
      // One mode for two is honest only where it explains the FRFs within their error bars.
      const bool said =
          sure.size() < result.model.modes.size() || says(result.model.notes, "systematic_misfit");
      EXPECT_TRUE(said || (static_cast<Index>(sure.size()) < modes &&
                           result.misfit_over_error_bars.value_or(2) < 1.1))
          << sure.size() << " modes instead of " << modes << " and no doubt";
      return;
    }
    const MatrixXcd residues = test.truth.residues();
    for (Index r = 0; r < modes; ++r) {
      const auto& mode = *sure[r];
      const auto [f, f_std] = mode.frequency_hz;
      const auto [zeta, zeta_std] = mode.damping_ratio;
      frequency_.add(f, f_std, test.truth.frequency_hz[r]);
      damping_.add(zeta, zeta_std, test.truth.damping_ratio[r]);
      if (!measured.amplitudes) continue;
      for (Index o = 0; o < residues.rows(); ++o) {
        residue_.add(mode.shape[o].real(), mode.shape_std(o, 0), residues(o, r).real());
        residue_.add(mode.shape[o].imag(), mode.shape_std(o, 1), residues(o, r).imag());
      }
    }
  }

  void expect_coverage() const {
    if (frequency_.trials() == 0) return;
    EXPECT_TRUE(frequency_.holds(0.3)) << "frequency";
    EXPECT_TRUE(damping_.holds(0.3)) << "damping";
    EXPECT_TRUE(residue_.trials() == 0 || residue_.holds(0.3)) << "residues";
  }

 private:
  static void expect_hits(const ImpactCase& test, const ImpactTest& measured) {
    if (test.rejected.empty()) return;
    const auto& hits = measured.search.hits;
    EXPECT_EQ(hits.size(), 5U);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const bool bad = std::ranges::count(test.rejected, i) > 0;
      EXPECT_EQ(hits[i].accepted, !bad) << i << hits[i].reason;
      EXPECT_TRUE(!bad || hits[i].has(test.why)) << hits[i].reason;
    }
  }

  testing::Coverage frequency_, damping_, residue_;
};

/// `change` makes the case of tests that are otherwise good.
void expect_coverage(const std::function<void(ImpactCase&)>& change, std::uint64_t tests = 25,
                     int hits = 5) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= tests; ++seed) {
    SCOPED_TRACE(seed);
    ImpactCase test(seed, hits);
    change(test);
    tally.add(test);
  }
  tally.expect_coverage();
}

TEST(HitCoverage, AcceptedPulsesOfOneOrTwoSamplesGiveNoAmplitudes) {
  expect_coverage([](ImpactCase& test) {
    test.record.filter_hz = 1e5;
    test.impact.hits.accept_unresolved = true;
    test.draw(0.7e-3);
    const auto measured = test.analysed();
    EXPECT_FALSE(measured.amplitudes);
    EXPECT_EQ(measured.frfs.form, FrfForm::unknown);
  });
}

TEST(HitCoverage, HitsWithMissingSamplesAreLeftOut) {
  expect_coverage([](ImpactCase& test) {
    test.alter = [&test](Recording& recording) {
      recording.channels[2]
          .samples.segment(test.sample_at(test.hits[1].time_s + 0.5), 20)
          .setConstant(kNaN);
      recording.channels[0].samples[test.sample_at(test.hits[3].time_s + 0.1)] = kNaN;
    };
    test.rejected = {1, 3}, test.why = HitFault::missing_samples;
  });
}

TEST(HitCoverage, SaturatedHitsAreLeftOut) {
  expect_coverage([](ImpactCase& test) {
    test.hits[2].peak = 300;  // a response
    test.hits[4].peak = 340;  // and the force
    test.alter = [&test](Recording& recording) {
      auto& force = recording.channels[0].samples;
      force = force.cwiseMin(0.94 * force.maxCoeff()).eval();
      auto& y = recording.channels[1].samples;
      const Index third = test.sample_at(test.hits[2].time_s);
      y = y.cwiseMin(0.6 * y.segment(third, kBlock / 2).maxCoeff()).eval();
    };
    test.rejected = {2, 4}, test.why = HitFault::overload;
  });
}

// At 50 and 150 Hz on every channel, 5 % of its rms, also beside a mode at 49.5 Hz.
TEST(HitCoverage, HumIsNoMode) {
  for (const double lowest_hz : {40.0, 49.5}) {
    expect_coverage([lowest_hz](ImpactCase& test) {
      test.truth = rig({lowest_hz, 95, 170});
      test.alter = [&test](Recording& recording) {
        for (std::size_t c = 0; c < recording.channels.size(); ++c) {
          auto& y = recording.channels[c].samples;
          const double rms = std::sqrt(y.squaredNorm() / static_cast<double>(y.size()));
          for (Index j = 0; j < y.size(); ++j) {
            const double turn =
                2 * kPi * 50 * static_cast<double>(j) / kRate + static_cast<double>(test.seed + c);
            y[j] += 0.05 * rms * (std::sqrt(2.0) * std::cos(turn) + 0.4 * std::cos(3 * turn));
          }
        }
      };
    });
  }
}

// By the noise before it.
TEST(HitCoverage, OfASingleHit) {
  expect_coverage(
      [](ImpactCase& test) {
        const auto measured = test.analysed();
        EXPECT_EQ(measured.frfs.averages, 1);
        EXPECT_EQ(measured.frfs.coherence.size(), 0);
      },
      25, 1);
}

// Most of the closest pairs are unclear; the intervals of a test's 16 residues share its noise.
TEST(HitCoverage, OfModesWithinTheirBandwidth) {
  for (const double bandwidths : {0.1, 0.2, 0.5, 1.0, 2.0}) {
    SCOPED_TRACE(bandwidths);
    expect_coverage(
        [&](ImpactCase& test) {
          test.truth = rig({100, 100 * (1 + 0.02 * bandwidths)});
        },
        bandwidths < 0.5 ? 100 : 25);
  }
}

// Residues of the mode in the middle are a thousand times smaller than its neighbours'.
TEST(HitCoverage, OfAWeakModeAmongStrongOnes) {
  expect_coverage([](ImpactCase& test) {
    test.truth.shapes.col(1) *= std::sqrt(1e-3);
    test.record.noise = 1e-4;
    // What aliases past the usual filter is 4e-6 of the strong modes: more than their error bars.
    test.record.filter_hz = 600, test.record.filter_order = 14;
  });
}

}  // namespace rigfit::signal::hit_coverage_test
