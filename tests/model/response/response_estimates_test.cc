// Every estimate of what was left out against the full run: within a factor of three.
#include "model/response/response.h"
#include "model/response/response_modes.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::response_estimates_test {

using Quantity = Sensor::Quantity;

ResponseResult respond(const Scene& scene, ResponseOptions options, double duration, double rate) {
  options.sampling = {.duration_s = duration, .rate_hz = rate};
  ResponseResult result = simulate_response(scene, options);
  EXPECT_TRUE(result.completed) << result.reason;
  return result;
}

/// The cost of the thing left out whose name begins so; -1: it was not.
double cost(const ResponseResult& result, const std::string& begin) {
  for (const LeftOut& what : result.left_out) {
    if (what.what.rfind(begin, 0) == 0) return what.relative_error;
  }
  return -1;
}

void expect_honest(double estimate, double measured) {
  EXPECT_GT(measured, 0);
  EXPECT_GT(estimate, measured / 3);
  EXPECT_LT(estimate, measured * 3);
}

/// Relative difference of frequency between two responses, column 0 a displacement and column 1
/// its velocity in the second: the d of y(t (1 + d)) = y + d t y' with the least squares.
double frequency_difference(const ResponseResult& a, const ResponseResult& b) {
  double above = 0, below = 0;
  for (Index i = 0; i < b.samples.rows(); ++i) {
    const double moved = static_cast<double>(i) / b.rate_hz * b.samples(i, 1);
    above += (a.samples(i, 0) - b.samples(i, 0)) * moved;
    below += moved * moved;
  }
  return std::abs(above / below);
}

Scene released(int segments, double mass, double position, Eigen::Vector3d direction = {0, -1, 0}) {
  Scene scene = testing::released_cable(segments, mass);
  scene.loads[0].place.position = position;
  scene.loads[0].direction = direction.normalized();
  scene.sensors = {testing::sensor("cable", 0.5, Quantity::displacement),
                   testing::sensor("cable", 0.5, Quantity::velocity)};
  return scene;
}

TEST(ResponseEstimates, SlowedAxialWaves) {
  Scene scene = released(30, 1, 0.25);
  scene.sensors.pop_back();  // weigh what a displacement sees
  ResponseOptions options{.solver = ResponseSolver::explicit_motion, .axial = false};
  const ResponseResult slowed = respond(scene, options, 5, 2000);
  EXPECT_EQ(slowed.step_s, 0.0005);
  const double estimate = cost(slowed, "axial waves");
  scene = released(30, 1, 0.25);
  options.axial = true;
  const ResponseResult full = respond(scene, options, 5, 2000);
  EXPECT_LT(full.step_s, 0.0001);
  EXPECT_EQ(cost(full, "axial waves"), -1);
  expect_honest(estimate, frequency_difference(slowed, full));
  // By need: as far as a third of the accuracy allows.
  scene.sensors.pop_back();
  options.axial.reset();
  const ResponseResult chosen = respond(scene, options, 0.5, 2000);
  EXPECT_GT(chosen.step_s, 0.0001);
  EXPECT_LT(cost(chosen, "axial waves"), scene.accuracy / 3);
}

TEST(ResponseEstimates, ChangeOfStiffnessWithMotion) {
  for (const double mass : {0.25, 0.5}) {
    const Scene scene = released(16, mass, 0.5);
    ResponseOptions options{.solver = ResponseSolver::modal};
    const ResponseResult linear = respond(scene, options, 4, 1000);
    options.solver = ResponseSolver::explicit_motion;
    const ResponseResult exact = respond(scene, options, 4, 1000);
    EXPECT_TRUE(linear.nonlinear);
    // Mean frequencies between the first and the last rise through zero.
    const auto frequency = [](const ResponseResult& r) {
      double first = -1, last = 0;
      int count = -1;
      const double mean = r.samples.col(0).mean();
      for (Index i = 1; i < r.samples.rows(); ++i) {
        const double a = r.samples(i - 1, 0) - mean, b = r.samples(i, 0) - mean;
        if (!(a < 0 && b >= 0)) continue;
        last = (static_cast<double>(i - 1) - a / (b - a)) / r.rate_hz;
        if (first < 0) first = last;
        ++count;
      }
      return count / (last - first);
    };
    expect_honest(cost(linear, "change of stiffness"), frequency(exact) / frequency(linear) - 1);
  }
}

TEST(ResponseEstimates, ModesAboveThoseFound) {
  Scene scene = released(30, 0.002, 0.25);
  scene.sensors.pop_back();
  const std::vector<LoadForce> forces{{scene.loads[0]}};
  const auto found = [&](int modes) {
    ChainModes out = response_modes(scene, {});
    MotionModes& plane = out.motions[0];
    plane.take(lowest_eigenpairs(plane.stiffness, plane.mass, modes));
    return out;
  };
  const auto samples = [&](const LinearAnswer& answer) {
    return modal_response(answer.sensors, {Quantity::displacement}, forces, 1e-3, 1001);
  };
  const LinearAnswer all = linear_answer(response_modes(scene, {}), scene, forces, 1);
  EXPECT_EQ(truncated_part(all, scene), 0);
  for (const int modes : {5, 9}) {
    const LinearAnswer some = linear_answer(found(modes), scene, forces, 1);
    expect_honest(truncated_part(some, scene),
                  (samples(some) - samples(all)).norm() / samples(all).norm());
  }
}

TEST(ResponseEstimates, SegmentsChosenReachTheAccuracy) {
  Scene scene = released(0, 0.002, 0.5);
  scene.members[0].damping_ratio = 0.02;
  scene.accuracy = 1e-3;
  ResponseOptions options;
  const ResponseResult chosen = respond(scene, options, 0.5, 1000);
  EXPECT_LE(chosen.resolution_error, scene.accuracy);
  EXPECT_EQ(cost(chosen, "bending within segments"), chosen.resolution_error);
  const auto truth = [&](int segments) {
    // Against a chain of 240: its own error is below a hundredth of these. All transverse modes
    // there are, which so few segments have below the axial ones.
    const ChainModes limit = response_modes(scene, {240});
    const LinearAnswer answer =
        linear_answer(response_modes(scene, {segments}), scene, {{scene.loads[0]}}, 0.5);
    double error = 0;
    for (Index i = 0; i < std::min(segments - 1, 60); ++i) {
      error +=
          answer.energy(i) * std::abs(answer.omega(i) / std::sqrt(limit.motions[0].omega2(i)) - 1);
    }
    return error;
  };
  ASSERT_EQ(chosen.segments.size(), 1u);
  const int n = chosen.segments[0];
  EXPECT_LE(truth(n), scene.accuracy);
  expect_honest(chosen.resolution_error, truth(n));
}

}  // namespace rigfit::model::response_estimates_test
