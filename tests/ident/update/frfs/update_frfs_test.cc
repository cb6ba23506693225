// FRFs and dampers as data of the model update.
#include "ident/update/model_update.h"
#include "tests/ident/update/hammered_beam.h"
#include "tests/test.h"

namespace rigfit::ident::update_frfs_test {

// Struck at 0.8; responses at 0.5 and 0.9.
model::Scene beam(double EI, double tip_mass) {
  auto scene = testing::hammered_beam(EI, tip_mass, 12);
  scene.sensors[0].place.position = 0.5, scene.sensors[1].place.position = 0.9;
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
  Normal normal(seed);
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(60, 1, 60);
  const auto exact = model::synthesize_frfs(truth, lines);
  std::vector<MeasuredFrf> frfs;
  for (std::size_t sensor = 0; sensor < truth.sensors.size(); ++sensor) {
    MeasuredFrf frf{.sensor = sensor, .frequency_hz = lines};
    frf.H.resize(lines.size()), frf.std.resize(lines.size());
    for (Index k = 0; k < lines.size(); ++k) {
      const auto H = exact.H[k](static_cast<Index>(sensor), 0);
      frf.std[k] = std * std::abs(H);
      frf.H[k] = H + frf.std[k] * Complex(normal(), normal());
    }
    frfs.push_back(std::move(frf));
  }
  return frfs;
}

std::vector<MeasuredMode> modes_of(const model::Scene& truth, int count, double damping_std) {
  std::vector<MeasuredMode> modes;
  for (const auto& natural : model::analyse_modes(truth, {.count = 12}).modes) {
    if (natural.plane != model::ModePlane::in || static_cast<int>(modes.size()) == count) continue;
    MeasuredMode mode{.frequency_hz = {natural.frequency_hz, 1e-3 * natural.frequency_hz},
                      .damping_ratio = {natural.damping_ratio, damping_std * natural.damping_ratio},
                      .plane = natural.plane,
                      .shape = natural.sensor_shape.cast<Complex>()};
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
    Normal normal(900 + seed);
    auto truth = beam(2.1, 0.02);
    model::set_parameter(truth, "hammer.position", 0.8 + kPlace * normal());
    for (const char* side : {"hammer.direction_y", "hammer.direction_z"}) {
      model::set_parameter(truth, side, kTurn * normal());
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

TEST(UpdateFrfs, AHeldOutStateIsPredicted) {
  std::vector<UpdateState> states;
  for (const double tip : {0.01, 0.03, 0.05}) {
    UpdateState state{"tip " + std::to_string(tip), beam(3.0, tip),
                      modes_of(beam(2.1, tip), 3, 0.1), frfs_of(beam(2.1, tip), 0.02, 7), true};
    states.push_back(state);
  }
  const auto all = update_model(states, {{"beam.EI_z"}}, {.starts = 1, .hold_out = true}).held;
  ASSERT_EQ(all.size(), 3U);
  for (const auto& held : all) {
    EXPECT_LT(held.frf_predicted, 0.04);
    EXPECT_GT(held.frf_before, 0.2);
    EXPECT_LT(held.rms_predicted, 1e-3);
  }
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
  EXPECT_THAT(result.open[0], HasSubstr("beam.damping_axial"));
}

}  // namespace rigfit::ident::update_frfs_test
