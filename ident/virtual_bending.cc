#include "ident/virtual_bending.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace rigfit::ident {
namespace {

// Load per deflection of a clamped cable under tension (Jalali and Rideout 2021, eq. (17)):
// Q / d = 4 P / (l g), g = 1 - 2 tanh(x/2)/x with x = sqrt(P l^2 / (4 EI)); stable for every x > 0.
double elastic_stiffness(double tension, double span, double EI) {
  const double x = std::sqrt(tension * span * span / (4 * EI));
  // For small x the difference cancels: x^2/12 - x^4/120 + 17 x^6/20160, next term below 1e-6 at
  // 0.1.
  const double g = x < 0.1 ? x * x * (1. / 12 - x * x * (1. / 120 - x * x * 17. / 20160))
                           : 1 - 2 * std::tanh(x / 2) / x;
  return 4 * tension / (span * g);
}

}  // namespace

signal::Recording virtual_bending_record(const VirtualBendingTest& test, Random& random) {
  for (double value : {test.EI_Nm2, test.span_m, test.tension_N, test.peak_load_N,
                       test.friction_travel_m, test.cycle_s, test.sample_rate_hz}) {
    if (!(std::isfinite(value) && value > 0)) {
      throw std::invalid_argument("bending test: values must be positive and finite");
    }
  }
  if (test.cycles < 1 || test.frame_stiffness_N_m < 0 || test.friction_load_N < 0) {
    throw std::invalid_argument("bending test: negative value or no cycle");
  }
  const double dt = 1 / test.sample_rate_hz;
  const auto samples = static_cast<Eigen::Index>(std::floor(test.cycles * test.cycle_s / dt)) + 1;
  const double peak_deflection =
      test.peak_load_N / elastic_stiffness(test.tension_N, test.span_m, test.EI_Nm2);

  Eigen::MatrixX3d truth(samples, 3);  // tension, load, deflection
  double friction = 0;
  double before = 0;
  for (Eigen::Index i = 0; i < samples; ++i) {
    // The cylinder moves up and down at constant speed.
    const double phase = std::fmod(static_cast<double>(i) * dt / test.cycle_s, 1.0);
    const double d = peak_deflection * (1 - std::abs(2 * phase - 1));
    const double step = d - before;
    // Exact solution of Dahl's law over a step of constant direction.
    const double target = std::copysign(test.friction_load_N, step);
    friction = target + (friction - target) * std::exp(-std::abs(step) / test.friction_travel_m);
    const double tension = test.tension_N + test.frame_stiffness_N_m * 2 * d * d / test.span_m;
    truth.row(i) << tension, elastic_stiffness(tension, test.span_m, test.EI_Nm2) * d + friction, d;
    before = d;
  }
  signal::Recording recording;
  recording.format = "synthetic";
  recording.sample_rate_hz = test.sample_rate_hz;
  const auto add = [&](const char* name, const char* unit, signal::Quantity quantity, int column,
                       const SensorModel& sensor) {
    signal::Channel channel;
    channel.name = name;
    channel.unit = channel.source_unit = unit;
    channel.quantity = quantity;
    channel.samples = recorded(truth.col(column), Eigen::VectorXd(), dt, sensor, random);
    recording.channels.push_back(std::move(channel));
  };
  add("tension", "N", signal::Quantity::force, 0, test.tension_cell);
  add("load", "N", signal::Quantity::force, 1, test.load_cell);
  add("deflection", "m", signal::Quantity::displacement, 2, test.lvdt);
  return recording;
}

}  // namespace rigfit::ident
