#include "ident/virtual_rig/virtual_rig.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "model/scene/actual_state.h"
#include "model/scene/force_history.h"
#include "signal/numerics/low_pass.h"

namespace rigfit::ident {
namespace {

// The rig is simulated at this many times the logger's rate or more, and so often that a pulse has
// `kSamplesInPulse`: what lies above half of that rate folds back into the record before the
// anti-aliasing filter sees it. Accelerance of a beam struck for 3 ms errs by 0.04 to 0.12 (m/s2)/N
// below 150 Hz at 25 samples a pulse, by 0.001 to 0.003 at 98. Of pulses of 50 to 100 ms a beam's
// record without the least factor is off by more than its noise; of 0.5 ms one at 32 times the rate
// differs from one at 512 times by 1e-5.
constexpr int kLeastOversampling = 4, kMostOversampling = 64;
constexpr double kSamplesInPulse = 96;

int oversampling(const model::Scene& scene, double sample_rate_hz) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const auto& load : scene.loads) {
    // A string that is cut is an edge: 16 times the logger's rate.
    shortest = std::min(shortest, load.duration > 0 ? load.duration : 6 / sample_rate_hz);
  }
  const double factor = std::ceil(kSamplesInPulse / (shortest * sample_rate_hz));
  return static_cast<int>(std::clamp<double>(factor, kLeastOversampling, kMostOversampling));
}

// A unit vector normal to v.
Vector3d normal_to(const Vector3d& v) {
  Index smallest = 0;
  v.cwiseAbs().minCoeff(&smallest);
  return v.cross(Vector3d::Unit(smallest)).normalized();
}

// A blow as a person strikes it, a little off: 20 % in strength, 5 % in duration, 0.03 rad in
// direction, 3 mm in place (standard deviations).
model::Load struck(const model::Scene& scene, const model::Load& meant,
                   const VirtualRigOptions& options, Random& random) {
  std::normal_distribution<double> normal;
  model::Load load = meant;
  load.peak *= std::max(0.3, 1 + 0.2 * normal(random));
  load.duration *= std::max(0.5, 1 + 0.05 * normal(random));
  load.start = options.pre_trigger_s;
  const double angle = 0.03 * normal(random);
  const double around = kTwoPi * std::uniform_real_distribution<>()(random);
  const Vector3d off = Eigen::AngleAxisd(around, meant.direction) * normal_to(meant.direction);
  load.direction = (std::cos(angle) * meant.direction + std::sin(angle) * off).normalized();
  double length = 0;
  for (const auto& member : scene.members) {
    if (member.name == load.place.member) length = model::chord_of(scene, member).norm();
  }
  const double shift = 0.003 * normal(random);
  if (load.place.node.empty() && length > 0) {
    load.place.position = std::clamp(load.place.position + shift / length, 0.001, 0.999);
  }
  return load;
}

// Every `factor`-th sample of a zero-phase low-pass of x (stop band -80 dB from the new Nyquist
// frequency on, pass band up to 0.8 of it); the ends repeat their last value.
VectorXd decimated(const Ref<const VectorXd>& x, int factor) {
  const signal::LowPass filter(0.4 / factor, 0.5 / factor, 80);
  const int half = static_cast<int>(filter.half_length());
  VectorXd taps(2 * half + 1), longer(x.size() + 2 * half);
  for (int k = -half; k <= half; ++k) taps[half + k] = filter.at(std::abs(k));
  taps /= taps.sum();
  longer << VectorXd::Constant(half, x[0]), x, VectorXd::Constant(half, x[x.size() - 1]);
  VectorXd out((x.size() + factor - 1) / factor);
  for (Index j = 0; j < out.size(); ++j) {
    out[j] = taps.dot(longer.segment(j * factor, taps.size()));
  }
  return out;
}

class Laboratory {
 public:
  Laboratory(const model::Scene& scene, const VirtualRigOptions& options, const Simulate& simulate,
             std::uint64_t seed)
      : scene_(finer_scene(scene_with_accelerometers(scene, options.accelerometer_mass_kg),
                           options.finer)),
        options_(options),
        simulate_(simulate),
        seed_(seed),
        sensors_(scene.sensors) {
    scene_.loads.clear();
    scene_.sensors.clear();
    Random random = random_stream(seed, 0);
    for (const auto& sensor : sensors_) {
      // Each accelerometer is most sensitive, beside its axis, to one direction across it.
      model::Sensor across = sensor;
      const double around = kTwoPi * std::uniform_real_distribution<>()(random);
      across.direction = Eigen::AngleAxisd(around, sensor.direction) * normal_to(sensor.direction);
      across.name += " across";
      scene_.sensors.push_back(sensor);
      scene_.sensors.push_back(across);
    }
  }

  /// `hit`: from 1 on; 0: a release.
  VirtualRigRecord record(const model::Load& load, int number, int hit, bool twice) {
    Random random = random_stream(
        seed_, 1000ull * static_cast<std::uint64_t>(number) + static_cast<std::uint64_t>(hit) + 1);
    VirtualRigRecord record;
    record.load = load.name.empty() ? fmt::format("load{}", number) : load.name;
    record.hit = hit;
    scene_.loads = {load};
    if (hit > 0) {
      scene_.loads = {struck(scene_, load, options_, random)};
      record.peak_N = scene_.loads[0].peak;
    }
    if (twice) {
      model::Load bounce = scene_.loads[0];
      record.second_after_s = std::uniform_real_distribution<>(0.008, 0.03)(random);
      bounce.peak *= std::uniform_real_distribution<>(0.1, 0.4)(random);
      bounce.start += record.second_after_s;
      record.second_peak_N = bounce.peak;
      scene_.loads.push_back(std::move(bounce));
    }
    const int oversampled = oversampling(scene_, options_.sample_rate_hz);
    const double rate = options_.sample_rate_hz * oversampled;
    const MatrixXd response = simulate_(scene_, options_.record_s, rate);
    record.recording = virtual_recording(options_.sample_rate_hz);
    if (hit > 0) {
      // The load cell sits along the hammer, whatever the blow's direction.
      VectorXd blows = VectorXd::Zero(response.rows());
      for (const auto& blow : scene_.loads) {
        const model::LoadForce pulse{blow};
        for (Index i = 0; i < blows.size(); ++i) {
          blows[i] += pulse.at(static_cast<double>(i) / rate);
        }
      }
      add_channel(record.recording, "force", signal::Quantity::force, decimated(blows, oversampled),
                  &options_.instruments.hammer, random, load.direction);
    }
    // By model::Sensor::Quantity; velocities are read as they are.
    using enum signal::Quantity;
    constexpr signal::Quantity quantities[] = {acceleration, velocity, displacement, force};
    const auto& own = options_.instruments;
    const SensorModel* instruments[] = {&own.accelerometer, nullptr, &own.lvdt, &own.tension_cell};
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
      const auto column = static_cast<Index>(2 * i);
      const auto kind = static_cast<std::size_t>(sensors_[i].quantity);
      add_channel(record.recording, sensors_[i].name, quantities[kind],
                  decimated(response.col(column), oversampled), instruments[kind], random,
                  sensors_[i].direction, decimated(response.col(column + 1), oversampled));
    }
    return record;
  }

 private:
  model::Scene scene_;
  const VirtualRigOptions& options_;
  const Simulate& simulate_;
  std::uint64_t seed_;
  std::vector<model::Sensor> sensors_;
};

}  // namespace

model::Scene finer_scene(const model::Scene& scene, int finer) {
  model::Scene fine = scene;
  for (auto& member : fine.members) {
    member.segments = finer * (member.segments > 0 ? member.segments : 30);
  }
  return fine;
}

model::Scene scene_with_accelerometers(model::Scene scene, double accelerometer_mass_kg) {
  if (!(accelerometer_mass_kg > 0)) return scene;
  for (const auto& sensor : scene.sensors) {
    if (sensor.quantity != model::Sensor::Quantity::acceleration) continue;
    for (auto& node : scene.nodes) {
      if (node.name == sensor.place.node && node.mass == 0) node.mass = accelerometer_mass_kg;
    }
    for (auto& member : scene.members) {
      if (!sensor.place.node.empty() || member.name != sensor.place.member) continue;
      const bool there = std::any_of(
          member.masses.begin(), member.masses.end(),
          [&](const auto& mass) { return std::abs(mass.position - sensor.place.position) < 1e-6; });
      if (!there) member.masses.push_back({sensor.place.position, accelerometer_mass_kg});
    }
  }
  return scene;
}

std::vector<VirtualRigRecord> virtual_rig_records(const model::Scene& scene,
                                                  const VirtualRigOptions& options,
                                                  const Simulate& simulate, std::uint64_t seed,
                                                  const std::function<void()>& advance) {
  if (scene.loads.empty() || scene.sensors.empty()) {
    throw std::invalid_argument("the scene needs a load and a sensor to be tested");
  }
  if (options.hits < 1 || options.double_hits < 0 || options.double_hits > options.hits ||
      options.finer < 1 || !(options.accelerometer_mass_kg >= 0) || !(options.sample_rate_hz > 0) ||
      !(options.record_s > 0) ||
      !(options.pre_trigger_s >= 0 && options.pre_trigger_s < options.record_s)) {
    throw std::invalid_argument("virtual rig: option out of range");
  }
  Laboratory laboratory(scene, options, simulate, seed);
  std::vector<VirtualRigRecord> records;
  for (std::size_t i = 0; i < scene.loads.size(); ++i) {
    const auto& load = scene.loads[i];
    const bool impact = load.kind == model::Load::Kind::impact;
    if (!impact && load.kind != model::Load::Kind::release) continue;
    // Which of the hits bounce is the seed's choice.
    std::vector<bool> twice(impact ? static_cast<std::size_t>(options.hits) : 1, false);
    if (impact) {
      Random random = random_stream(seed, 500'000ull + i);
      std::fill_n(twice.begin(), options.double_hits, true);
      std::shuffle(twice.begin(), twice.end(), random);
    }
    for (std::size_t k = 0; k < twice.size(); ++k) {
      records.push_back(laboratory.record(load, static_cast<int>(i) + 1,
                                          impact ? static_cast<int>(k) + 1 : 0, twice[k]));
      if (advance) advance();
    }
  }
  return records;
}

}  // namespace rigfit::ident
