#include "ident/virtual_rig/virtual_bending.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ident/bending/bending_equation.h"

namespace rigfit::ident {
namespace {

// Exact solution of Dahl's law over a step of constant direction, in u = 1 - q/q_f sign(dd):
// du/ds = -u^i / d_f.
double after(double friction, double step, const VirtualBendingTest& test) {
  if (!(test.friction_load_N > 0) || step == 0) return friction;
  const double sign = step > 0 ? 1 : -1;
  const double z = std::abs(step) / test.friction_travel_m, i = test.friction_exponent;
  double u = 1 - sign * friction / test.friction_load_N;
  if (i == 1) {
    u *= std::exp(-z);
  } else if (u > 0) {
    const double power = std::pow(u, 1 - i) + (i - 1) * z;
    u = power > 0 ? std::pow(power, 1 / (1 - i)) : 0;
  }
  return sign * test.friction_load_N * (1 - u);
}

}  // namespace

signal::Recording virtual_bending_record(const VirtualBendingTest& test, Random& random) {
  for (double value : {test.EI_Nm2, test.span_m, test.tension_N, test.peak_load_N,
                       test.friction_travel_m, test.cycle_s, test.sample_rate_hz}) {
    if (!(std::isfinite(value) && value > 0)) {
      throw std::invalid_argument("bending test: values must be positive and finite");
    }
  }
  if (test.cycles < 1 || test.frame_stiffness_N_m < 0 || test.friction_load_N < 0 ||
      !(test.friction_exponent >= 0 && test.friction_exponent <= 3)) {
    throw std::invalid_argument("bending test: negative value or no cycle");
  }
  const double dt = 1 / test.sample_rate_hz;
  const auto samples = static_cast<Eigen::Index>(std::floor(test.cycles * test.cycle_s / dt)) + 1;
  const double peak_deflection =
      test.peak_load_N * midspan_compliance(test.EI_Nm2, test.tension_N, test.span_m);

  Eigen::MatrixX3d truth(samples, 3);  // tension, load, deflection
  double friction = 0;
  double before = 0;
  for (Eigen::Index i = 0; i < samples; ++i) {
    // The cylinder moves up and down at constant speed.
    const double phase = std::fmod(static_cast<double>(i) * dt / test.cycle_s, 1.0);
    const double d = peak_deflection * (1 - std::abs(2 * phase - 1));
    const double step = d - before;
    friction = after(friction, step, test);
    const double tension = test.tension_N + test.frame_stiffness_N_m * 2 * d * d / test.span_m;
    const double EI = test.EI_Nm2 + test.EI_by_tension_m2 * (tension - test.tension_N);
    truth.row(i) << tension, d / midspan_compliance(EI, tension, test.span_m) + friction, d;
    before = d;
  }
  signal::Recording recording;
  recording.format = "synthetic";
  recording.sample_rate_hz = test.sample_rate_hz;
  const auto add = [&](const char* name, const char* unit, signal::Quantity quantity, int column,
                       const SensorModel& sensor) {
    recording.channels.push_back(virtual_channel(
        name, unit, quantity, recorded(truth.col(column), Eigen::VectorXd(), dt, sensor, random)));
  };
  add("tension", "N", signal::Quantity::force, 0, test.tension_cell);
  add("load", "N", signal::Quantity::force, 1, test.load_cell);
  add("deflection", "m", signal::Quantity::displacement, 2, test.lvdt);
  recording.channels.back().source_unit = "mm";  // as its logger writes it
  recording.channels.back().si_per_source = 1e-3;
  return recording;
}

}  // namespace rigfit::ident
