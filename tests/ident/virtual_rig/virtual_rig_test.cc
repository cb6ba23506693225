#include "ident/virtual_rig/virtual_rig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace rigfit::ident::virtual_rig_test {
namespace {

// A stiff spring of one degree of freedom in place of a rig: sensor i reads (i + 1) times the
// force, the channels across its axis read nothing.
Eigen::MatrixXd quasi_static(const model::Scene& scene, double duration_s, double rate_hz) {
  const auto rows = static_cast<Eigen::Index>(std::lround(duration_s * rate_hz));
  Eigen::MatrixXd response =
      Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(scene.sensors.size()));
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (const auto& load : scene.loads) {
      const double t = static_cast<double>(i) / rate_hz - load.start;
      if (load.kind != model::Load::Kind::impact || t <= 0 || t >= load.duration) continue;
      const double force = load.peak * std::sin(std::numbers::pi * t / load.duration);
      for (Eigen::Index s = 0; s < response.cols(); s += 2) {
        response(i, s) += static_cast<double>(s / 2 + 1) * force;
      }
    }
  }
  return response;
}

model::Scene scene() {
  model::Scene result;
  result.nodes.resize(2);
  result.nodes[0].name = "a";
  result.nodes[1].name = "b";
  result.nodes[1].position = {2.4, 0, 0};
  result.members.resize(1);
  result.members[0].name = "cable";
  result.members[0].nodes = {"a", "b"};
  result.members[0].segments = 30;
  result.loads.resize(2);
  result.loads[0].name = "quarter";
  result.loads[0].place = {"", "cable", 0.25};
  result.loads[0].peak = 50;
  result.loads[0].duration = 0.02;
  result.loads[1].kind = model::Load::Kind::release;
  result.loads[1].place = {"", "cable", 0.25};
  result.loads[1].mass = 1;
  result.sensors.resize(2);
  result.sensors[0].name = "mid";
  result.sensors[1].name = "end";
  return result;
}

TEST(VirtualRig, WritesEveryHitWithItsTruth) {
  VirtualRigOptions options;
  options.record_s = 1;
  const auto records = virtual_rig_records(scene(), options, quasi_static, 42);
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
    doubles += record.double_hit;
    EXPECT_EQ(record.double_hit, record.second_peak_N > 0);
  }
  EXPECT_EQ(doubles, 1);
  EXPECT_EQ(records[5].load, "load2");
  EXPECT_EQ(records[5].recording.channels.size(), 2u);  // no hammer
}

TEST(VirtualRig, SameSeedSameRecordsOtherSeedOthers) {
  VirtualRigOptions options;
  options.record_s = 0.5;
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
  const double w0 = 2 * std::numbers::pi * 3996;
  const auto ringing = [&](const model::Scene& struck, double duration_s, double rate_hz) {
    const auto& load = struck.loads[0];
    const double a = std::numbers::pi / load.duration, scale = load.peak / (w0 * w0 - a * a);
    const auto forced = [&](double t) {
      return t > 0 ? scale * (a * w0 * std::sin(w0 * t) - a * a * std::sin(a * t)) : 0.0;
    };
    const auto rows = static_cast<Eigen::Index>(std::lround(duration_s * rate_hz));
    Eigen::MatrixXd response = Eigen::MatrixXd::Zero(rows, 2);
    for (Eigen::Index i = 0; i < rows; ++i) {
      // A half sine is a sine that begins at once and another half a period later.
      const double t = static_cast<double>(i) / rate_hz - load.start;
      response(i, 0) = forced(t) + forced(t - load.duration);
    }
    return response;
  };
  model::Scene one = scene();
  one.loads.resize(1), one.sensors.resize(1);
  one.loads[0].duration = 0.002;
  VirtualRigOptions options;
  options.hits = 1, options.double_hits = 0, options.record_s = 1;
  const auto records = virtual_rig_records(one, options, ringing, 3);
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

// Pass band to 0.8, stop band from 1 of the new Nyquist frequency: ripple of an 80 dB design is
// 1e-4.
TEST(Decimated, KeepsWhatIsBelowAndRemovesWhatIsAboveTheNewNyquist) {
  const int factor = 4;
  Eigen::VectorXd low(4000), high(4000);
  for (Eigen::Index i = 0; i < low.size(); ++i) {
    low[i] = std::sin(0.79 * std::numbers::pi / factor * static_cast<double>(i));
    high[i] = std::sin(1.02 * std::numbers::pi / factor * static_cast<double>(i));
  }
  const Eigen::VectorXd kept = decimated(low, factor), removed = decimated(high, factor);
  for (Eigen::Index j = 100; j < 900; ++j) {
    EXPECT_NEAR(kept[j], low[4 * j], 2e-4);
    EXPECT_NEAR(removed[j], 0, 2e-4);
  }
}

}  // namespace
}  // namespace rigfit::ident::virtual_rig_test
