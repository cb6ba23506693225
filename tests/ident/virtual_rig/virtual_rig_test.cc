#include "ident/virtual_rig/virtual_rig.h"

#include "ident/virtual_rig/virtual_bench.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::ident::virtual_rig_test {

// A stiff spring of one degree of freedom in place of a rig: sensor i reads (i + 1) times the
// force, the channels across its axis read nothing.
Eigen::MatrixXd quasi_static(const model::Scene& scene, double duration_s, double rate_hz) {
  const auto rows = static_cast<Index>(std::lround(duration_s * rate_hz));
  Eigen::MatrixXd response = Eigen::MatrixXd::Zero(rows, static_cast<Index>(scene.sensors.size()));
  for (Index i = 0; i < rows; ++i) {
    for (const auto& load : scene.loads) {
      const double t = static_cast<double>(i) / rate_hz - load.start;
      if (load.kind != model::Load::Kind::impact || t <= 0 || t >= load.duration) continue;
      const double force = load.peak * std::sin(kPi * t / load.duration);
      for (Index s = 0; s < response.cols(); s += 2) {
        response(i, s) += static_cast<double>(s / 2 + 1) * force;
      }
    }
  }
  return response;
}

model::Scene scene() {
  auto result = model::testing::released_cable();
  result.loads.insert(result.loads.begin(),
                      model::testing::impact({"", "cable", 0.25}, {0, -1, 0}, 50, 0.02, "quarter"));
  result.loads[1].name = "";
  result.sensors = {{"mid", {}, {0, 1, 0}, {}}, {"end", {}, {0, 1, 0}, {}}};
  return result;
}

TEST(VirtualRig, WritesEveryHitWithItsTruth) {
  const auto records = virtual_rig_records(scene(), {.record_s = 1}, quasi_static, 42);
  ASSERT_EQ(records.size(), 6u);
  int doubles = 0;
  for (int i = 0; i < 5; ++i) {
    const auto& record = records[i];
    EXPECT_EQ(record.load, "quarter");
    EXPECT_EQ(record.hit, i + 1);
    const auto& force = record.recording.channels[0].samples;
    EXPECT_EQ(force.size(), 1024);
    // A half sine of 20 ms has its lobe within 75 Hz, far below the filter; its peak falls within
    // half a sample of the record's largest: 1 - cos(pi/2 * 0.5/20.5) = 7e-4, and 0.02 N of noise.
    EXPECT_NEAR(force.maxCoeff() / record.peak_N, 1, 3e-3);
    // Offset and drift apart, sensors read what the rig does.
    const auto& mid = record.recording.channels[1].samples;
    const auto& end = record.recording.channels[2].samples;
    EXPECT_NEAR(((end.array() - end.mean()) - 2 * (mid.array() - mid.mean())).abs().maxCoeff(), 0,
                0.05);
    doubles += record.second_after_s > 0;
  }
  EXPECT_EQ(doubles, 1);
  EXPECT_EQ(records[5].load, "load2");
  EXPECT_EQ(records[5].recording.channels.size(), 2u);  // no hammer
}

TEST(VirtualRig, SameSeedSameRecordsOtherSeedOthers) {
  VirtualRigOptions options{.record_s = 0.5};
  const auto first = virtual_rig_records(scene(), options, quasi_static, 1);
  const auto again = virtual_rig_records(scene(), options, quasi_static, 1);
  const auto other = virtual_rig_records(scene(), options, quasi_static, 2);
  for (std::size_t i = 0; i < first.size(); ++i) {
    for (std::size_t c = 0; c < first[i].recording.channels.size(); ++c) {
      EXPECT_EQ(first[i].recording.channels[c].samples, again[i].recording.channels[c].samples);
      EXPECT_NE(first[i].recording.channels[c].samples, other[i].recording.channels[c].samples);
    }
  }
}

// One undamped mode of 1 kg at 3996 Hz, struck for 2 ms: after the pulse it rings at 50 N a / w0 2
// |cos(w0 T / 2)| = 5 m/s^2 and more, far above the logger's 512 Hz. Sampled at four times the
// logger's rate that would stand in the record as 100 Hz.
TEST(VirtualRig, WhatIsAboveTheLoggersBandDoesNotFoldIntoIt) {
  const double w0 = 2 * kPi * 3996;
  const auto ringing = [&](const model::Scene& struck, double duration_s, double rate_hz) {
    const auto& load = struck.loads[0];
    const double a = kPi / load.duration, scale = load.peak / (w0 * w0 - a * a);
    const auto forced = [&](double t) {
      return t > 0 ? scale * (a * w0 * std::sin(w0 * t) - a * a * std::sin(a * t)) : 0.0;
    };
    const auto rows = static_cast<Index>(std::lround(duration_s * rate_hz));
    Eigen::MatrixXd response = Eigen::MatrixXd::Zero(rows, 2);
    for (Index i = 0; i < rows; ++i) {
      // A half sine is a sine that begins at once and another half a period later.
      const double t = static_cast<double>(i) / rate_hz - load.start;
      response(i, 0) = forced(t) + forced(t - load.duration);
    }
    return response;
  };
  model::Scene one = scene();
  one.loads.resize(1), one.sensors.resize(1);
  one.loads[0].duration = 0.002;
  const auto records =
      virtual_rig_records(one, {.hits = 1, .double_hits = 0, .record_s = 1}, ringing, 3);
  const Eigen::VectorXd& y = records.at(0).recording.channels[1].samples;
  // Beyond the pulse and the filter's length: offset, drift and noise of 0.003 m/s^2 a sample.
  const Eigen::VectorXd after = y.segment(200, 700);
  EXPECT_LT((after.array() - after.mean()).abs().maxCoeff(), 0.03);
}

TEST(VirtualRig, RefusesASceneWithNothingToTest) {
  model::Scene empty = scene();
  empty.sensors.clear();
  EXPECT_THROW((void)virtual_rig_records(empty, {}, quasi_static, 1), std::invalid_argument);
}

VirtualAxialTest light_test() {
  return {.EA_N = 221780,
          .mass_per_length_kg_m = 0.16667,
          .length_m = 1.0,
          .hung_mass_kg = 2.2,
          .damping_ratio = 0.017};
}

// Without any disturbance the record is the weight, then a decaying sinusoid about it: its
// successive extremes obey the logarithmic decrement.
TEST(VirtualAxial, RecordDecaysWithTheStatedDampingRatio) {
  auto test = light_test();
  test.swing_rad = 0;
  test.sample_rate_hz = 50000;
  Random random = random_stream(1, 0);
  const auto recording = virtual_axial_record(test, random);
  const auto& x = recording.channels[0].samples;
  const double weight = 2.2 * 9.80665;
  EXPECT_NEAR(x[0], weight, 1e-9);
  std::vector<double> peaks;
  for (Index i = 25100; i + 1 < x.size() && peaks.size() < 11; ++i) {
    if (x[i] > x[i - 1] && x[i] >= x[i + 1]) peaks.push_back(x[i] - weight);
  }
  ASSERT_EQ(peaks.size(), 11u);
  const double decrement = std::log(peaks.front() / peaks.back()) / 10;
  // Peaks are met within half a sample of 1000 a cycle: relative error (pi/1000)^2 / 2 = 5e-6 each.
  EXPECT_NEAR(decrement, 2 * kPi * 0.017 / std::sqrt(1 - 0.017 * 0.017), 2e-6);
}

VirtualBendingTest quiet_test() {
  VirtualBendingTest test{.EI_Nm2 = 0.5972, .span_m = 1.0, .tension_N = 200, .friction_load_N = 0};
  test.frame_stiffness_N_m = 0;
  return test;
}

TEST(VirtualBending, TensionOnlyGrowsAndFrictionOpensALoop) {
  auto test = quiet_test();
  test.frame_stiffness_N_m = 2e4;
  test.friction_load_N = 0.05;
  Random random = random_stream(1, 0);
  const auto recording = virtual_bending_record(test, random);
  const auto& tension = recording.channels[0].samples;
  const auto& load = recording.channels[1].samples;
  EXPECT_GE(tension.minCoeff(), test.tension_N);
  EXPECT_GT(tension.maxCoeff(), test.tension_N);
  // At the same deflection, half-way up and half-way down, the loads differ by twice the friction.
  const Index cycle = (recording.samples() - 1) / 2;
  EXPECT_NEAR(load[cycle / 4] - load[3 * cycle / 4], 2 * test.friction_load_N, 1e-9);
}

TEST(SensorModel, QuantisesClipsAndAddsTheTransverseSignal) {
  Random random = random_stream(1, 0);
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(101, -2, 2);
  const Eigen::VectorXd t = Eigen::VectorXd::Ones(101);
  const Eigen::VectorXd y =
      recorded(x, Eigen::VectorXd(), 0.01, {.full_scale = 1, .bits = 3}, random);
  EXPECT_EQ(y.minCoeff(), -1);
  EXPECT_EQ(y.maxCoeff(), 1);
  EXPECT_EQ((y * 4).array().round().matrix(), y * 4);  // 2^3 steps over +-1
  SensorModel tilted{.transverse_sensitivity = 0.05};
  EXPECT_NEAR((recorded(x, t, 0.01, tilted, random) - x).maxCoeff(), 0.05, 1e-12);
  EXPECT_THROW((void)recorded(x, t.head(3), 0.01, tilted, random), std::invalid_argument);
}

}  // namespace rigfit::ident::virtual_rig_test
