#include "ident/virtual_rig/sensor_model.h"

namespace rigfit::ident {

VectorXd recorded(const Ref<const VectorXd>& signal, const Ref<const VectorXd>& transverse,
                  double dt_s, const SensorModel& sensor, Random& random) {
  if (transverse.size() != 0 && transverse.size() != signal.size()) {
    throw std::invalid_argument("sensor model: transverse signal of another length");
  }
  if (sensor.bits != 0 && !(sensor.full_scale > 0)) {
    throw std::invalid_argument("sensor model: a converter needs a full scale");
  }
  std::normal_distribution<double> normal;
  const double offset = sensor.offset_std * normal(random);
  const double slope = sensor.drift_per_s * normal(random);
  const double walk_step = sensor.random_walk_per_root_s * std::sqrt(dt_s);
  const double lsb = sensor.bits > 0 ? 2 * sensor.full_scale / std::exp2(sensor.bits) : 0;

  VectorXd out(signal.size());
  double walk = 0;
  for (Index i = 0; i < signal.size(); ++i) {
    double y = signal[i] + offset + slope * static_cast<double>(i) * dt_s + walk;
    if (transverse.size() != 0) y += sensor.transverse_sensitivity * transverse[i];
    y += sensor.noise_std * normal(random);
    walk += walk_step * normal(random);
    if (lsb > 0) y = lsb * std::round(y / lsb);
    if (sensor.full_scale > 0) y = std::clamp(y, -sensor.full_scale, sensor.full_scale);
    out[i] = y;
  }
  return out;
}

signal::Recording virtual_recording(double sample_rate_hz) {
  signal::Recording recording;
  recording.format = "synthetic";
  recording.sample_rate_hz = sample_rate_hz;
  return recording;
}

void add_channel(signal::Recording& recording, std::string name, signal::Quantity quantity,
                 const Ref<const VectorXd>& signal, const SensorModel* sensor, Random& random,
                 const Vector3d& direction, const Ref<const VectorXd>& transverse) {
  auto& channel = recording.channels.emplace_back();
  channel.name = std::move(name);
  channel.unit = channel.source_unit = signal::si_of(quantity);
  channel.quantity = quantity;
  channel.direction = {direction.x(), direction.y(), direction.z()};
  channel.samples = signal;
  if (!sensor) return;
  channel.samples = recorded(signal, transverse, 1 / recording.sample_rate_hz, *sensor, random);
}

Random random_stream(std::uint64_t seed, std::uint64_t stream) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                         static_cast<std::uint32_t>(stream),
                         static_cast<std::uint32_t>(stream >> 32)};
  return Random(sequence);
}

}  // namespace rigfit::ident
