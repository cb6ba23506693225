#include "ident/plan/plan_candidates.h"

#include <fmt/format.h>
#include <gsl/gsl_sf_trig.h>

#include <Eigen/LU>

#include "ident/statistics/in_parallel.h"

namespace rigfit::ident {
namespace {

constexpr double kSeenEnergy = 100;  // 20 dB (plan_candidates.h)
// Loggers' anti-aliasing filters pass 0.8 of the Nyquist frequency (virtual_rig.h).
constexpr double kUsableShare = 0.4;

void place_candidates(const model::Scene& scene, PlanCandidates& candidates) {
  const bool as_drawn = candidates.options.as_drawn;
  for (const auto& load : scene.loads) {
    if (load.kind != model::Load::Kind::impact || !(load.peak > 0)) continue;
    candidates.loads.push_back(load);
    if (as_drawn || std::abs(load.direction.z()) > std::sqrt(0.5)) continue;
    candidates.loads.push_back(load);
    candidates.loads.back().name += " along z";
    candidates.loads.back().direction = Vector3d::UnitZ();
  }
  candidates.sensors = scene.sensors;
  for (const auto& member : scene.members) {
    for (int k = 0; k < 27 && !as_drawn; ++k) {
      const int tenth = 1 + k / 3;
      const double position = 0.1 * tenth;
      candidates.sensors.push_back(
          {fmt::format("{} {:.1f} {}", member.name, position, "xyz"[k % 3]),
           {"", member.name, position},
           Vector3d::Unit(k % 3)});
    }
  }
  if (candidates.loads.empty() || candidates.sensors.empty()) {
    throw std::invalid_argument("the scene has no load of kind \"impact\" or no sensor: add them");
  }
}

// Amplitudes over the noise, loads x sensors, after a hit of each load.
MatrixXd decay_amplitudes(const model::NaturalMode& mode, const PlanCandidates& candidates) {
  using Quantity = model::Sensor::Quantity;
  const VirtualInstruments instruments;
  const double omega = 2 * M_PI * mode.frequency_hz;
  MatrixXd amplitude = mode.load_shape * mode.sensor_shape.transpose();
  for (Index l = 0; l < amplitude.rows(); ++l) {
    const auto& load = candidates.loads[static_cast<std::size_t>(l)];
    amplitude.row(l) *= half_sine_impulse(load.peak, load.duration, omega);
  }
  for (Index s = 0; s < amplitude.cols(); ++s) {
    const auto quantity = candidates.sensors[static_cast<std::size_t>(s)].quantity;
    double by_quantity = omega, noise = instruments.accelerometer.noise_std;
    if (quantity == Quantity::velocity) {  // as good as an accelerometer at that frequency
      by_quantity = 1, noise /= omega;
    } else if (quantity != Quantity::acceleration) {
      by_quantity = 1 / omega;
      noise = (quantity == Quantity::force ? instruments.tension_cell : instruments.lvdt).noise_std;
    }
    amplitude.col(s) *= by_quantity / candidates.options.noise_std.value_or(noise);
  }
  return amplitude.cwiseAbs();
}

PlanStateModes state_modes(int state, const PlanCandidates& candidates) {
  const auto& options = candidates.options;
  PlanStateModes result;
  const auto modelled = candidates.problem.modes(state, candidates.q, true);
  result.failure = modelled.failure;
  if (!result.failure.empty()) return result;
  // The same modes once more, at the candidates' places.
  model::Scene scene = candidates.problem.scene_at(state, candidates.q);
  for (auto& member : scene.members) {
    if (member.segments == 0) member.segments = UpdateOptions().auto_segments;
  }
  scene.loads = candidates.loads;
  scene.sensors = candidates.sensors;
  model::ModesOptions modes;
  modes.count = std::min(100, 3 * options.modes + 8);  // as an update with so many modes asks for
  modes.shapes = modes.error_estimate = false;
  std::size_t next = 0;
  for (const auto& natural : model::analyse_modes(scene, modes).modes) {
    if (!known(natural.frequency_hz) || next == modelled.modes.size()) continue;
    const auto& mode = modelled.modes[next++];
    if (mode.order > options.modes || mode.frequency_hz > kUsableShare * options.sample_rate_hz) {
      continue;
    }
    result.modes.push_back({static_cast<std::size_t>(state),
                            candidates.problem.states()[static_cast<std::size_t>(state)].name,
                            mode.dlog_frequency, mode.dlog_damping, natural.plane, mode.order,
                            mode.frequency_hz, natural.damping_ratio});
    result.amplitude.push_back(decay_amplitudes(natural, candidates));
  }
  return result;
}

}  // namespace

DecayInformation decay_information(double signal_to_noise, double decay_rate_1_s, double duration_s,
                                   double rate_hz) {
  const double x = 2 * decay_rate_1_s * duration_s;
  const double mean = x > 0 ? -std::expm1(-x) / x : 1;  // I0 / T
  // 1 / 12 - x^2 / 240 for small x: at 1e-3 it is that of none to 5e-8, and cancels to 1e-9.
  const double y = std::max(x, 1e-3), spread = 1 / (y * y) - 1 / std::pow(2 * std::sinh(y / 2), 2);
  DecayInformation information;
  information.energy = rate_hz * signal_to_noise * signal_to_noise * mean * duration_s / 2;
  information.pole = information.energy * duration_s * duration_s * spread;
  return information;
}

double half_sine_impulse(double peak, double duration_s, double omega) {
  const double u = omega * duration_s / M_PI;  // cos(pi u / 2) = sin(pi (1 - u) / 2)
  return peak * duration_s * std::abs(gsl_sf_sinc((1 - u) / 2)) / (1 + u);
}

PlanCandidates plan_candidates(const std::vector<UpdateState>& states,
                               const std::vector<FreeParameter>& free, const PlanOptions& options) {
  // The problem computes as many modes as measured ones ask for, and damping where one has it.
  auto asked = states;
  const MeasuredMode any{{1, 1}, {1, 1}};
  for (auto& state : asked) state.measured.assign(static_cast<std::size_t>(options.modes), any);
  UpdateOptions update;
  update.inputs = options.inputs;
  PlanCandidates candidates{UpdateProblem(asked, free, update), options};
  candidates.q = candidates.problem.start();
  place_candidates(states.front().scene, candidates);
  candidates.states.resize(states.size());
  in_parallel(states.size(), options.threads, [&](std::size_t s) {
    candidates.states[s] = state_modes(static_cast<int>(s), candidates);
  });
  return candidates;
}

std::vector<PlannedMode> planned_modes(const PlanCandidates& candidates,
                                       const std::vector<PlanTest>& tests) {
  const auto& options = candidates.options;
  const double model_std =
      options.model_relative_std.value_or(candidates.problem.states().front().scene.accuracy);
  std::vector<PlannedMode> planned;
  for (const auto& state : candidates.states) {
    for (std::size_t i = 0; i < state.modes.size(); ++i) {
      PlannedMode mode = state.modes[i];
      const double omega = 2 * M_PI * mode.frequency_hz, rate = mode.damping_ratio * omega;
      double pole = 0;
      for (const auto& test : tests) {
        if (test.state != mode.state) continue;
        for (const auto sensor : test.sensors) {
          const auto information = decay_information(
              state.amplitude[i](static_cast<Index>(test.load), static_cast<Index>(sensor)), rate,
              options.durations_s[test.duration], options.sample_rate_hz);
          if (information.energy > kSeenEnergy) {
            pole += options.hits[test.hits] * information.pole;
          }
        }
      }
      if (!(pole > 0)) continue;
      const double own = options.frequency_relative_std > 0 ? options.frequency_relative_std
                                                            : 1 / (std::sqrt(pole) * omega);
      mode.frequency_std = std::hypot(own, model_std);
      // Frequency and decay rate are known equally well.
      mode.damping_std = rate > 0 ? std::hypot(own * omega / rate, options.damping_model_std) : 0;
      planned.push_back(mode);
    }
  }
  return planned;
}

MatrixXd plan_rows(const PlanCandidates& candidates, const std::vector<PlannedMode>& modes) {
  const auto count = static_cast<Index>(modes.size());
  MatrixXd rows = MatrixXd::Zero(2 * count, candidates.problem.size());
  for (Index i = 0; i < count; ++i) {
    const auto& mode = modes[static_cast<std::size_t>(i)];
    rows.row(2 * i) = mode.dlog_frequency / mode.frequency_std;
    if (mode.damping_std > 0) rows.row(2 * i + 1) = mode.dlog_damping / mode.damping_std;
  }
  return rows;
}

MatrixXd plan_covariance(const PlanCandidates& candidates, const std::vector<PlannedMode>& modes) {
  const MatrixXd rows = plan_rows(candidates, modes);
  const Index n = candidates.problem.parameter_count();
  MatrixXd information = rows.transpose() * rows;
  for (Index j = 0; j < rows.cols(); ++j) {
    const double prior = candidates.problem.coordinates()[static_cast<std::size_t>(j)].prior_std;
    if (prior > 0) information(j, j) += 1 / (prior * prior);
  }
  // A vague prior, of 1000 and above the rounding of the largest information, keeps it regular.
  information.diagonal().array() +=
      std::max(1e-6, std::numeric_limits<double>::epsilon() * information.trace());
  return information.inverse().topLeftCorner(n, n);
}

}  // namespace rigfit::ident
