// Simulates the recordings of hammer hits and releases on a virtual rig.
//
// Every load of the scene is a test: an impact is struck `hits` times, each hit in a triggered
// record with the hammer's force; a release is recorded once. The simulated rig is finer than the
// fitted one (`finer` times the segments, the accelerometers' masses), hits vary in place,
// direction, strength and hardness, and some hits are double. The logger's anti-aliasing filter
// (linear phase, -80 dB) acts on all channels alike.
#pragma once

#include "ident/virtual_rig/sensor_model.h"
#include "model/scene/scene.h"
#include "signal/recording/recording.h"

namespace rigfit::ident {

struct VirtualRigOptions {
  int hits = 5;         ///< hits for every impact
  int double_hits = 1;  ///< number of double hits among them
  double record_s = 8;
  double pre_trigger_s = 0.05;
  double sample_rate_hz = 1024;
  int finer = 4;  ///< factor on the scene's segments (30 for "auto")
  /// Mass of each accelerometer (4.8 g: data sheet of the paper's B&K 4507), added where
  /// the scene has no mass yet.
  double accelerometer_mass_kg = 4.8e-3;
  VirtualInstruments instruments;
};

struct VirtualRigRecord {
  std::string load;             ///< name of the scene's load, or "load<k>" by its number from 1
  int hit = 0;                  ///< 1-based; 0: a release
  double peak_N = 0;            ///< peak of the first blow
  double second_peak_N = 0;     ///< peak of the bounce of a double hit
  double second_after_s = 0;    ///< of the bounce, zero: none
  signal::Recording recording;  ///< force (impacts only), then one channel per sensor
};

/// Response of a scene at its sensors: rows = duration * rate, columns = sensors. Loads act as in
/// the scene, sensors read SI.
using Simulate =
    std::function<MatrixXd(const model::Scene& scene, double duration_s, double rate_hz)>;

/// Throws std::invalid_argument for a scene without loads or sensors and for options out of range.
/// `advance` (may be empty) is called after each record.
[[nodiscard]] std::vector<VirtualRigRecord> virtual_rig_records(
    const model::Scene& scene, const VirtualRigOptions& options, const Simulate& simulate,
    std::uint64_t seed, const std::function<void()>& advance = {});

/// The scene with `finer` times the segments.
[[nodiscard]] model::Scene finer_scene(const model::Scene& scene, int finer);

/// The scene with its accelerometers' masses added.
[[nodiscard]] model::Scene scene_with_accelerometers(model::Scene scene,
                                                     double accelerometer_mass_kg);

}  // namespace rigfit::ident
