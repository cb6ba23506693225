// FRFs, shapes and dampers as data of the model update.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "ident/update/model_update.h"
#include "ident/update/update_checks.h"
#include "model/response/response.h"
#include "signal/spectra/frf.h"
#include "tests/ident/update/fit_data.h"
#include "tests/reference/frf_differences.h"

namespace rigfit::ident::update_frfs_test {
namespace {

// Struck at 0.8; responses at 0.5 and 0.9.
model::Scene beam(double EI, double tip_mass) {
  auto scene = testing::beam(EI, tip_mass);
  scene.members[0].damping_ratio = 0.01;
  scene.loads.resize(1), scene.sensors.resize(2);
  scene.loads[0].name = "hammer";
  scene.loads[0].kind = model::Load::Kind::impact;
  scene.loads[0].place = {"", "beam", 0.8};
  scene.loads[0].peak = 1, scene.loads[0].duration = 0.002;
  scene.sensors[0].name = "low", scene.sensors[1].name = "high";
  scene.sensors[0].place = {"", "beam", 0.5}, scene.sensors[1].place = {"", "beam", 0.9};
  for (auto& sensor : scene.sensors) sensor.direction = {1, 0, 0};
  scene.loads[0].direction = {1, 0, 0};
  return scene;
}

model::Scene beam_with_dampers() {
  auto scene = beam(2.1, 0.02);
  scene.members[0].damping_ratio.reset();
  scene.members[0].damping.bending = 0.004, scene.members[0].damping.axial = 1;
  return scene;
}

// FRFs of a scene at lines up to 60 Hz, with relative noise.
std::vector<MeasuredFrf> frfs_of(const model::Scene& truth, double std, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(60, 1, 60);
  const auto exact = model::synthesize_frfs(truth, lines);
  std::vector<MeasuredFrf> frfs;
  for (std::size_t sensor = 0; sensor < truth.sensors.size(); ++sensor) {
    MeasuredFrf frf;
    frf.sensor = sensor;
    frf.frequency_hz = lines;
    frf.H.resize(lines.size()), frf.std.resize(lines.size());
    for (Eigen::Index k = 0; k < lines.size(); ++k) {
      const auto H = exact.H[static_cast<std::size_t>(k)](static_cast<Eigen::Index>(sensor), 0);
      frf.std[k] = std * std::abs(H);
      frf.H[k] = H + frf.std[k] * std::complex<double>(normal(random), normal(random));
    }
    frfs.push_back(std::move(frf));
  }
  return frfs;
}

std::vector<MeasuredMode> modes_of(const model::Scene& truth, int count, double damping_std) {
  model::ModesOptions options;
  options.count = 12;
  std::vector<MeasuredMode> modes;
  for (const auto& natural : model::analyse_modes(truth, options).modes) {
    if (natural.plane != model::ModePlane::in || static_cast<int>(modes.size()) == count) continue;
    MeasuredMode mode;
    mode.frequency_hz = {natural.frequency_hz, 1e-3 * natural.frequency_hz};
    mode.damping_ratio = {natural.damping_ratio, damping_std * natural.damping_ratio};
    mode.plane = natural.plane;
    mode.shape = natural.sensor_shape.cast<std::complex<double>>();
    modes.push_back(mode);
  }
  return modes;
}

TEST(UpdateFrfs, FindsStiffnessMassAndDampingFromStartsOffByThree) {
  const auto truth = beam(2.1, 0.02);
  for (const double factor : {1.0 / 3, 3.0}) {
    auto start = beam(2.1 * factor, 0.02 / factor);
    model::set_parameter(start, "beam.damping_ratio", 0.01 * factor);
    UpdateState state{"beam", start, modes_of(truth, 3, 0.1), frfs_of(truth, 0.02, 1), true};
    UpdateOptions options;
    options.segment_uncertainty = false;  // the data have the model's segments
    const auto result =
        update_model({state}, {{"beam.EI_z"}, {"tip.mass"}, {"beam.damping_ratio"}}, options);
    ASSERT_EQ(result.status, UpdateStatus::converged) << result.message;
    const double wanted[] = {2.1, 0.02, 0.01};
    for (std::size_t p = 0; p < 3; ++p) {
      EXPECT_TRUE(result.parameters[p].identifiable);
      EXPECT_NEAR(result.parameters[p].value, wanted[p], 4 * result.parameters[p].std) << p;
      EXPECT_LT(result.parameters[p].std, 0.05 * wanted[p]);
    }
    EXPECT_EQ(result.frf_lines, 120);
    // Noise of 2 % in real and imaginary part of the logarithm: sqrt(2) of it.
    EXPECT_NEAR(result.rms_log_frf_error, 0.02 * std::sqrt(2.0), 0.006);
    EXPECT_GT(result.rms_log_frf_error_before, 10 * result.rms_log_frf_error);
  }
}

// The hammer struck 3 mm and 2 degrees beside what the scene says, in its mean over the hits. With
// 60 lines of 0.5 % that is most of what the fit errs by, and it is known to it.
TEST(UpdateFrfs, WhereAndAlongWhatTheHammerStruckIsAnInput) {
  constexpr double kPlace = 0.003 / 0.75, kTurn = 2 * 3.14159265 / 180;
  constexpr int kSeeds = 20;
  int covered = 0, held_or_told = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    std::mt19937_64 random(900 + seed);
    std::normal_distribution<double> normal;
    auto truth = beam(2.1, 0.02);
    model::set_parameter(truth, "hammer.position", 0.8 + kPlace * normal(random));
    for (const char* side : {"hammer.direction_y", "hammer.direction_z"}) {
      model::set_parameter(truth, side, kTurn * normal(random));
    }
    EXPECT_NEAR(truth.loads[0].direction.norm(), 1, 1e-15);
    UpdateState state{"beam", beam(2.15, 0.022), {}, frfs_of(truth, 0.005, seed)};
    UpdateOptions options = testing::plain_options();
    for (const bool aim : {false, true}) {
      options.inputs.clear();
      if (aim) {
        options.inputs = {{"place", {{0, "hammer.position", kPlace}}},
                          {"up", {{0, "hammer.direction_y", kTurn}}},
                          {"out", {{0, "hammer.direction_z", kTurn}}}};
      }
      const auto result = update_model({state}, {{"beam.EI_z"}, {"tip.mass"}}, options);
      ASSERT_EQ(result.status, UpdateStatus::converged) << result.message;
      const double wanted[] = {2.1, 0.02};
      bool held = true;
      for (std::size_t p = 0; p < 2; ++p) {
        const auto& parameter = result.parameters[p];
        const bool in =
            std::abs(parameter.value - wanted[p]) <= result.coverage_factor * parameter.std;
        held = held && in;
        covered += aim && in;
        if (!aim) continue;
        // Data, place, up, out, and the noise on the force that the error bars allow.
        ASSERT_EQ(parameter.budget.size(), 5U);
        EXPECT_EQ(parameter.budget[1].source, "place");
      }
      held_or_told += !aim && (held || result.fit.ruled_out());
    }
  }
  EXPECT_GE(covered, 34);  // of 40: 95 %, three binomial deviations
  // Where it is not stated, the misfit rules the model out.
  EXPECT_EQ(held_or_told, kSeeds);
}

TEST(UpdateFrfs, WithoutAnyModeTheFitStartsFromWhereItIs) {
  const auto truth = beam(2.1, 0.02);
  UpdateState state{"beam", beam(2.0, 0.02), {}, frfs_of(truth, 0.02, 2)};
  UpdateOptions options;
  options.starts = 1;
  const auto result = update_model({state}, {{"beam.EI_z"}}, options);
  ASSERT_EQ(result.status, UpdateStatus::converged) << result.message;
  EXPECT_NEAR(result.parameters[0].value, 2.1, 4 * result.parameters[0].std);
  EXPECT_TRUE(std::isnan(result.rms_relative_error));
}

TEST(UpdateFrfs, IntervalsCover) {
  const auto truth = beam(2.1, 0.02);
  int covered = 0, total = 0;
  for (std::uint64_t seed = 0; seed < 25; ++seed) {
    UpdateState state{"beam", beam(2.15, 0.021), {}, frfs_of(truth, 0.05, 100 + seed)};
    UpdateOptions options = testing::plain_options();
    const auto result = update_model({state}, {{"beam.EI_z"}, {"tip.mass"}}, options);
    for (std::size_t p = 0; p < 2; ++p) {
      covered += std::abs(result.parameters[p].value - (p == 0 ? 2.1 : 0.02)) <=
                 result.coverage_factor * result.parameters[p].std;
      ++total;
    }
  }
  EXPECT_GE(covered, 0.86 * total);  // 95 %, three binomial deviations of 50
}

TEST(UpdateFrfs, AHeldOutStateIsPredicted) {
  std::vector<UpdateState> states;
  for (const double tip : {0.01, 0.03, 0.05}) {
    UpdateState state{"tip " + std::to_string(tip), beam(3.0, tip),
                      modes_of(beam(2.1, tip), 3, 0.1), frfs_of(beam(2.1, tip), 0.02, 7), true};
    states.push_back(state);
  }
  UpdateOptions options;
  options.starts = 1;
  for (const auto& held : hold_out_each(states, {{"beam.EI_z"}}, options)) {
    EXPECT_LT(held.frf_predicted, 0.04);
    EXPECT_GT(held.frf_before, 0.2);
    EXPECT_LT(held.rms_predicted, 1e-3);
  }
}

// Hits on the scene as a hammer test records them: 2 s at 4 kHz, an exponential window of 2.5 1/s
// on force and response (down to 0.7 % at the end), five hits averaged. The half sine of 8 ms has
// nothing beyond 1 kHz that folds back into the lines used.
std::vector<MeasuredFrf> windowed_frfs(const model::Scene& truth, double noise, double decay_rate,
                                       std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  model::ResponseOptions response;
  response.sampling.rate_hz = 4000;
  response.sampling.duration_s = 2;
  response.solver = model::ResponseSolver::modal;
  const auto simulated = model::simulate_response(truth, response);
  constexpr Eigen::Index kSamples = 8000;
  Eigen::VectorXd force = Eigen::VectorXd::Zero(kSamples);
  for (Eigen::Index i = 0; i <= 32; ++i) force[i] = std::sin(M_PI * static_cast<double>(i) / 32);
  std::vector<Eigen::VectorXd> recorded;
  for (int hit = 0; hit < 5; ++hit) {
    for (Eigen::Index sensor = 0; sensor < simulated.samples.cols(); ++sensor) {
      recorded.emplace_back(simulated.samples.col(sensor).head(kSamples));
      const double std = noise * std::sqrt(recorded.back().squaredNorm() / kSamples);
      for (double& value : recorded.back()) value += std * normal(random);
    }
  }
  const auto span_of = [](const Eigen::VectorXd& y) {
    return std::span<const double>(y.data(), static_cast<std::size_t>(y.size()));
  };
  std::vector<signal::FrfBlock> blocks(5);
  for (std::size_t hit = 0; hit < 5; ++hit) {
    blocks[hit].force = span_of(force);
    blocks[hit].responses = {span_of(recorded[2 * hit]), span_of(recorded[2 * hit + 1])};
  }
  signal::FrfOptions options;
  options.sample_rate_hz = 4000;
  options.block_samples = kSamples;
  options.exponential_decay_rate_1_s = decay_rate;
  const auto averaged = signal::average_frfs(blocks, options);
  std::vector<MeasuredFrf> frfs(2);
  for (std::size_t sensor = 0; sensor < 2; ++sensor) {
    frfs[sensor].sensor = sensor;
    frfs[sensor].frequency_hz = averaged.frequency_hz.segment(20, 101);  // 10 to 60 Hz
    frfs[sensor].H = averaged.H.col(static_cast<Eigen::Index>(sensor)).segment(20, 101);
    frfs[sensor].std = averaged.H_std.col(static_cast<Eigen::Index>(sensor)).segment(20, 101);
    frfs[sensor].decay_rate_1_s = decay_rate;
    frfs[sensor].lines_per_independent = lines_per_independent(decay_rate, 0.5);
  }
  return frfs;
}

// The window adds 2.5 / omega to every damping ratio: 0.026 and 0.009 at the two modes among the
// lines, which have 0.01. Fitted is what the beam has.
TEST(UpdateFrfs, AnExponentialWindowBiasesNothing) {
  auto truth = beam(2.1, 0.02);
  truth.loads[0].duration = 0.008;
  constexpr int kSeeds = 16;
  int covered = 0;
  double deviation = 0, squares = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    auto start = beam(2.13, 0.02);
    model::set_parameter(start, "beam.damping_ratio", 0.014);
    UpdateState state{"beam", start, {}, windowed_frfs(truth, 0.05, 2.5, 500 + seed)};
    UpdateOptions options = testing::plain_options();
    const std::vector<FreeParameter> free{{"beam.EI_z"}, {"beam.damping_ratio"}};
    const auto result = update_model({state}, free, options);
    ASSERT_EQ(result.status, UpdateStatus::converged) << result.message;
    const double wanted[] = {2.1, 0.01};
    for (std::size_t p = 0; p < 2; ++p) {
      const auto& parameter = result.parameters[p];
      covered +=
          std::abs(parameter.value - wanted[p]) <= result.coverage_factor * parameter.std ? 1 : 0;
    }
    const auto& damping = result.parameters[1];
    deviation += (damping.value - 0.01) / damping.std / kSeeds;
    squares += std::pow((damping.value - 0.01) / damping.std, 2) / kSeeds;
    EXPECT_LT(damping.std, 0.0005);
    if (seed > 0) continue;
    for (auto& frf : state.frfs) frf.decay_rate_1_s = 0;  // as if there had been none
    EXPECT_GT(update_model({state}, free, options).parameters[1].value, 0.015);
  }
  // The mean of 16 scatters by a quarter of a standard deviation, three of these; a standard
  // deviation of 16 is known to 18 %.
  EXPECT_LT(std::abs(deviation), 0.75);
  EXPECT_NEAR(std::sqrt(squares), 1, 0.54);
  EXPECT_GE(covered, 26);  // of 32: 95 %, three binomial deviations
}

TEST(UpdateFrfs, NoiseBandwidthOfTheWindow) {
  EXPECT_EQ(lines_per_independent(0, 0.5), 1);
  EXPECT_NEAR(lines_per_independent(1e-3, 0.5), 1, 1e-6);
  // N sum w^2 / (sum w)^2 of the window itself; sums differ from integrals by 1 / N^2.
  double squares = 0, sum = 0;
  for (int i = 0; i < 8000; ++i) {
    const double w = std::exp(-2.5 * (i + 0.5) / 4000);
    squares += w * w, sum += w;
  }
  EXPECT_NEAR(lines_per_independent(2.5, 0.5), 8000 * squares / (sum * sum), 1e-6);
}

TEST(UpdateFrfs, TheModelsRatesAreThoseOfDifferences) {
  const auto scene = beam(2.1, 0.02);
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(9, 3, 50);
  const std::vector<std::string> names{"beam.EI_z", "tip.mass", "beam.damping_ratio"};
  for (const double window : {0.0, 2.0}) {
    const auto rates = model::synthesize_frf_sensitivities(scene, lines, names, {}, window);
    const auto differences = frf_differences(scene, lines, names, window);
    for (std::size_t p = 0; p < names.size(); ++p) {
      for (std::size_t k = 0; k < 9; ++k) {
        const double size = differences.rate[p][k].norm();
        // Steps of 1e-4: second order in them over the distance to the next resonance, here 10 %.
        EXPECT_LT((rates.rate[p][k] - differences.rate[p][k]).norm(), 1e-4 * size) << names[p];
      }
    }
  }
}

// Joint dampers from the damping ratios of measured decays: what the source tuned by hand.
TEST(DamperFit, JointDampersComeFromMeasuredDecays) {
  const auto truth = beam_with_dampers();
  UpdateState state{"beam", truth, modes_of(truth, 3, 0.02)};
  for (auto& mode : state.measured) mode.damping_ratio.value *= 1.01;
  model::set_parameter(state.scene, "beam.damping_bending", 0.012);
  const auto result = update_model({state}, {{"beam.damping_bending"}});
  ASSERT_EQ(result.status, UpdateStatus::converged) << result.message;
  // Damping ratios go with the damper: 1 % more of them is 1 % more of it.
  EXPECT_NEAR(result.parameters[0].value, 0.00404, 1e-3 * 0.004);
  EXPECT_NEAR(result.parameters[0].std / 0.004, 0.02 / std::sqrt(3.0), 0.002);
  for (const auto& pair : result.pairs) {
    EXPECT_NEAR(pair.model_damping, pair.measured_damping, 1e-3 * pair.measured_damping);
  }
}

TEST(DamperFit, AndFromFrfsAndAnAxialDamperIsNotSeenInBending) {
  const auto truth = beam_with_dampers();
  auto start = truth;
  model::set_parameter(start, "beam.damping_bending", 0.01);
  UpdateState state{"beam", start, modes_of(truth, 3, 0.1), frfs_of(truth, 0.02, 5), true};
  const auto result = update_model({state}, {{"beam.damping_bending"}, {"beam.damping_axial"}});
  EXPECT_TRUE(result.parameters[0].identifiable);
  EXPECT_NEAR(result.parameters[0].value, 0.004, 4 * result.parameters[0].std);
  EXPECT_FALSE(result.parameters[1].identifiable);
  ASSERT_EQ(result.open.size(), 1U);
  EXPECT_NE(result.open[0].find("beam.damping_axial"), std::string::npos);
}

// Shapes say where stiffness or mass sits, which few frequencies do not.
TEST(UpdateShapes, ShapesAreDataWhenAskedFor) {
  const auto truth = beam(2.1, 0.05);
  UpdateState state{"beam", beam(2.1, 0.01), modes_of(truth, 3, 0.1)};
  for (auto& mode : state.measured) {
    mode.frequency_hz.std = 0.2 * mode.frequency_hz.value;  // hardly known
    mode.shape *= std::polar(3.0, 0.7);                     // any scale and phase
  }
  UpdateOptions options;
  options.starts = 1;
  const auto without = update_model({state}, {{"tip.mass"}}, options);
  options.shape_std = 0.005;
  const auto with = update_model({state}, {{"tip.mass"}}, options);
  ASSERT_EQ(with.status, UpdateStatus::converged) << with.message;
  EXPECT_NEAR(with.parameters[0].value, 0.05, 0.002);
  EXPECT_LT(with.parameters[0].std, 0.5 * without.parameters[0].std);
  EXPECT_EQ(with.degrees_of_freedom, 3 + 3 * 2 - 1);
}

// The mean of four hits, each 3 mm off: the FRFs' error bars hold what hits scatter by, and one
// place for all lines is no error of the model in every line. With the mass at the tip left out the
// same FRFs rule the model out.
TEST(UpdateFrfs, TheMeanPlaceOfTheHitsIsNoErrorOfTheModel) {
  constexpr int kHits = 40, kAveraged = 4;  // many, so that error bars are known as smoothed ones
  const double place_std = 0.003 / 0.75, noise = 0.01;
  int ruled_out = 0, covered = 0, wrong_ruled_out = 0;
  constexpr int kSeeds = 6;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    std::mt19937_64 random(300 + seed);
    std::normal_distribution<double> normal;
    std::vector<std::vector<MeasuredFrf>> hits;
    for (int hit = 0; hit < kHits; ++hit) {
      auto truth = beam(2.1, 0.02);
      model::set_parameter(truth, "hammer.position", 0.8 + place_std * normal(random));
      hits.push_back(frfs_of(truth, noise, 100 * seed + static_cast<std::uint64_t>(hit)));
    }
    std::vector<MeasuredFrf> mean = hits[0];
    for (std::size_t f = 0; f < mean.size(); ++f) {
      Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(mean[f].H.size());
      Eigen::VectorXcd all = Eigen::VectorXcd::Zero(mean[f].H.size());
      for (const auto& hit : hits) all += hit[f].H / kHits;
      for (const auto& hit : hits) squares += (hit[f].H - all).array().abs2();
      // Variance of the real and of the imaginary part of a mean of four.
      mean[f].std = (squares / (2.0 * (kHits - 1) * kAveraged)).sqrt();
      for (std::size_t hit = 1; hit < kAveraged; ++hit) mean[f].H += hits[hit][f].H;
      mean[f].H /= kAveraged;
    }
    UpdateOptions options = testing::plain_options();
    const UpdateState state{"beam", beam(2.15, 0.022), {}, mean};
    const auto result = update_model({state}, {{"beam.EI_z"}, {"tip.mass"}}, options);
    ruled_out += result.fit.ruled_out();
    covered += result.parameters[0].low <= 2.1 && result.parameters[0].high >= 2.1;
    UpdateState wrong{"beam", beam(2.0, 0), {}, mean};
    const auto other = update_model({wrong}, {{"beam.EI_z"}}, options);
    wrong_ruled_out += other.fit.ruled_out();
  }
  // 1 % of right models are ruled out by chance and 5 % of intervals miss: one of six allows for
  // both (probability 0.97).
  EXPECT_LE(ruled_out, 1);
  EXPECT_GE(covered, kSeeds - 1);
  EXPECT_EQ(wrong_ruled_out, kSeeds);
}

}  // namespace
}  // namespace rigfit::ident::update_frfs_test
