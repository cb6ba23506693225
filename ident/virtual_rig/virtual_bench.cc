#include "ident/virtual_rig/virtual_bench.h"

#include <initializer_list>

#include "ident/axial/axial_fit.h"
#include "ident/bending/bending_equation.h"
#include "ident/statistics/root.h"
#include "model/scene/scene.h"

namespace rigfit::ident {
namespace {

constexpr double kBefore_s = 0.5, kAfter_s = 3;  // of an axial record, about the tap

/// Throws for a value that is not positive and finite, or else where `good` is false.
void check(const std::string& test, std::initializer_list<double> positive, bool good,
           const char* what) {
  if (!std::ranges::all_of(positive, [](double x) { return x > 0 && std::isfinite(x); })) {
    throw std::invalid_argument(test + ": values must be positive and finite");
  }
  if (!good) throw std::invalid_argument(test + ": " + what);
}

// Undamped circular frequency; the root lies below those without the cable's mass and without the
// mass that hangs on it.
double natural_omega(const VirtualAxialTest& test) {
  check(
      "axial test",
      {test.EA_N, test.mass_per_length_kg_m, test.length_m, test.hung_mass_kg, test.sample_rate_hz},
      test.adapter_stiffness_N_m >= 0 && test.damping_ratio >= 0 && test.damping_ratio < 1,
      "a negative value, or a damping ratio outside [0, 1)");
  const double k = test.EA_N / test.length_m, inertia = test.mass_per_length_kg_m * test.length_m,
               adapter = test.adapter_stiffness_N_m > 0 ? 1 / test.adapter_stiffness_N_m : 0;
  const double high = std::min(1 / std::sqrt((1 / k + adapter) * test.hung_mass_kg),
                               std::numbers::pi / 2 * std::sqrt(k / inertia));
  return root_between(1e-6 * high, (1 + 1e-9) * high, 1e-15, [&](double omega) {
    const double W = omega * omega;
    return W * test.hung_mass_kg - 1 / (rod_compliance(k, W * inertia, 0.0) + adapter);
  });
}

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

double axial_frequency_hz(const VirtualAxialTest& test) {
  return natural_omega(test) * std::sqrt(1 - test.damping_ratio * test.damping_ratio) / kTwoPi;
}

signal::Recording virtual_axial_record(const VirtualAxialTest& test, Random& random) {
  const double omega = natural_omega(test);
  const double decay = test.damping_ratio * omega;
  const double omega_d = omega * std::sqrt(1 - test.damping_ratio * test.damping_ratio);
  std::normal_distribution<double> normal;
  const double impulse = 0.5 * std::max(0.1, 1 + 0.2 * normal(random));  // N s, scatter 20 %
  const double velocity = impulse / test.hung_mass_kg;
  const double weight = test.hung_mass_kg * model::kStandardGravity;
  const double swing_omega = std::sqrt(model::kStandardGravity / test.length_m);
  const double swing_phase = kTwoPi * std::uniform_real_distribution<>()(random);

  // The tap falls between two samples, as it does in a laboratory.
  const double dt = 1 / test.sample_rate_hz;
  const double tap_time = kBefore_s + dt * std::uniform_real_distribution<>()(random);
  const auto samples = static_cast<Index>(std::floor((kBefore_s + kAfter_s) * test.sample_rate_hz));
  VectorXd tension(samples);
  for (Index i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) * dt;
    // T = M g (cos a + a'^2 L / g), to second order in the swing's amplitude.
    tension[i] = weight * (1 + test.swing_rad * test.swing_rad *
                                   (0.25 - 0.75 * std::cos(2 * (swing_omega * t + swing_phase))));
    const double s = t - tap_time;
    if (s > 0) {
      // Force through the cell is M (g - x''); x = v/wd exp(-d s) sin(wd s).
      const double e = std::exp(-decay * s) * velocity / omega_d;
      const double acceleration = e * ((decay * decay - omega_d * omega_d) * std::sin(omega_d * s) -
                                       2 * decay * omega_d * std::cos(omega_d * s));
      tension[i] -= test.hung_mass_kg * acceleration;
    }
  }
  auto recording = virtual_recording(test.sample_rate_hz);
  add_channel(recording, "tension", signal::Quantity::force, tension, &test.load_cell, random);
  return recording;
}

signal::Recording virtual_bending_record(const VirtualBendingTest& test, Random& random) {
  check("bending test",
        {test.EI_Nm2, test.span_m, test.tension_N, test.peak_load_N, test.friction_travel_m,
         test.cycle_s, test.sample_rate_hz},
        test.cycles >= 1 && test.frame_stiffness_N_m >= 0 && test.friction_load_N >= 0 &&
            test.friction_exponent >= 0 && test.friction_exponent <= 3,
        "negative value or no cycle");
  const double dt = 1 / test.sample_rate_hz;
  const auto samples = static_cast<Index>(std::floor(test.cycles * test.cycle_s / dt)) + 1;
  const double peak_deflection =
      test.peak_load_N * midspan_compliance(test.EI_Nm2, test.tension_N, test.span_m);

  Eigen::MatrixX3d truth(samples, 3);  // tension, load, deflection
  double friction = 0;
  double before = 0;
  for (Index i = 0; i < samples; ++i) {
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
  auto recording = virtual_recording(test.sample_rate_hz);
  using signal::Quantity;
  add_channel(recording, "tension", Quantity::force, truth.col(0), &test.tension_cell, random);
  add_channel(recording, "load", Quantity::force, truth.col(1), &test.load_cell, random);
  add_channel(recording, "deflection", Quantity::displacement, truth.col(2), &test.lvdt, random);
  recording.channels.back().source_unit = "mm";  // as its logger writes it
  recording.channels.back().si_per_source = 1e-3;
  return recording;
}

}  // namespace rigfit::ident
