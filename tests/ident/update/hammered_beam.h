// Averaged FRFs of a cantilever struck by a person, for tests and tables of coverage: every hit at
// a place of its own, noise of the force that a short window leaves (alike on neighbouring lines
// and common to all responses), noise of the responses, error bars from what the hits scatter by.
#pragma once

#include <cmath>
#include <complex>
#include <functional>
#include <string>
#include <vector>

#include "model/frfs/frf_synthesis.h"
#include "tests/ident/update/fit_data.h"
#include "tests/normal.h"

namespace rigfit::ident::testing {

inline constexpr double kBeamEI = 2.1, kTipMass = 0.02, kBeamDamping = 0.01;

/// 0.75 m, hammer at 0.6 m, responses at 0.45 and 0.65 m; `segments` 0: left to the program.
inline model::Scene hammered_beam(double EI, double tip_mass, int segments) {
  auto scene = beam(EI, tip_mass, segments);
  scene.members[0].damping_ratio = kBeamDamping;
  scene.loads = {model::testing::impact({"", "beam", 0.8}, {1, 0, 0}, 1, 0.002)};
  scene.sensors = {{"low", {"", "beam", 0.6}, {1, 0, 0}, {}},
                   {"high", {"", "beam", 0.866667}, {1, 0, 0}, {}}};
  return scene;
}

struct HammerTestNoise {
  int hits = 4;
  double place_m = 0.003;  ///< standard deviation of a hit's place
  /// Noise of a hit's force spectrum, relative, smooth over `force_width_hz`.
  double force = 0.014;
  double force_width_hz = 60;
  double response = 0.01;  ///< noise of a line of a hit, relative to the rms of H over the lines
  bool known_std = false;  ///< error bars from `response` itself, not from the hits' scatter
  /// Rate of an exponential window over blocks of one over the line spacing.
  double decay_rate_1_s = 0;
};

/// Noise of one line from a response's white noise under the test's window; unit variance.
inline Eigen::VectorXcd line_noise(const Eigen::VectorXd& lines, double decay_rate_1_s,
                                   const std::function<double()>& normal) {
  Eigen::VectorXcd noise(lines.size());
  if (decay_rate_1_s == 0) {
    for (auto& n : noise) n = {normal(), normal()};
    return noise;
  }
  constexpr int kSamples = 400;  // more than twice the lines
  const double T = 1 / (lines[1] - lines[0]), dt = T / kSamples;
  noise.setZero();
  double energy = 0;
  for (int i = 0; i < kSamples; ++i) {
    const double window = std::exp(-decay_rate_1_s * i * dt);
    const std::complex<double> sample{window * normal(), window * normal()};
    energy += window * window;
    for (Eigen::Index k = 0; k < lines.size(); ++k) {
      noise[k] += sample * std::polar(1.0, -2 * M_PI * lines[k] * i * dt);
    }
  }
  return noise / std::sqrt(energy);
}

/// FRFs at `lines` of the beam with 240 segments and the values above.
inline std::vector<MeasuredFrf> hammered_frfs(const Eigen::VectorXd& lines,
                                              const HammerTestNoise& noise, std::uint64_t seed,
                                              int segments = 240) {
  rigfit::testing::Normal normal(seed);
  const Eigen::Index count = lines.size();
  double known[2] = {0, 0};
  std::vector<std::vector<Eigen::VectorXcd>> hits;  // by hit, then response
  for (int hit = 0; hit < noise.hits; ++hit) {
    auto scene = hammered_beam(kBeamEI, kTipMass, segments);
    model::set_parameter(scene, "hammer.position", 0.8 + noise.place_m / 0.75 * normal());
    const auto exact = model::synthesize_frfs(scene, lines, {}, noise.decay_rate_1_s);
    // White noise under a window of duration T: a sum of decorrelated phases over T.
    constexpr int kSamples = 24;
    const double T = 1 / noise.force_width_hz;
    Eigen::VectorXcd force = Eigen::VectorXcd::Zero(count);
    for (int i = 0; i < kSamples; ++i) {
      const double sample = noise.force / std::sqrt(kSamples) * normal();
      for (Eigen::Index k = 0; k < count; ++k) {
        force[k] += sample * std::polar(1.0, -2 * M_PI * lines[k] * T * i / kSamples);
      }
    }
    std::vector<Eigen::VectorXcd> responses;
    for (Eigen::Index sensor = 0; sensor < 2; ++sensor) {
      Eigen::VectorXcd H(count);
      for (Eigen::Index k = 0; k < count; ++k) H[k] = exact.H[k](sensor, 0);
      const double std =
          noise.response * std::sqrt(H.squaredNorm() / static_cast<double>(count) / 2);
      known[sensor] = std / std::sqrt(noise.hits);
      const auto own = line_noise(lines, noise.decay_rate_1_s, [&] { return normal(); });
      for (Eigen::Index k = 0; k < count; ++k) H[k] = H[k] / (1.0 + force[k]) + std * own[k];
      responses.push_back(std::move(H));
    }
    hits.push_back(std::move(responses));
  }
  std::vector<MeasuredFrf> frfs(2);
  for (std::size_t sensor = 0; sensor < 2; ++sensor) {
    auto& frf = frfs[sensor];
    frf.sensor = sensor;
    frf.frequency_hz = lines;
    frf.H = Eigen::VectorXcd::Zero(count);
    for (const auto& hit : hits) frf.H += hit[sensor] / noise.hits;
    Eigen::VectorXd power = Eigen::VectorXd::Zero(count);
    for (const auto& hit : hits) power += (hit[sensor] - frf.H).cwiseAbs2();
    // As signal/spectra/frf.h: of the mean's real and imaginary part, over ten lines on either
    // side.
    power /= 2.0 * noise.hits * (noise.hits - 1);
    frf.decay_rate_1_s = noise.decay_rate_1_s;
    frf.lines_per_independent = lines_per_independent(noise.decay_rate_1_s, lines[1] - lines[0]);
    frf.std.resize(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::Index first = std::max<Eigen::Index>(0, k - 10);
      const Eigen::Index last = std::min(count - 1, k + 10);
      frf.std[k] = noise.known_std ? known[sensor]
                                   : std::sqrt(power.segment(first, last - first + 1).mean());
    }
  }
  return frfs;
}

/// Fit of EI, the tip's mass and damping to such a test, from values 2 to 10 % off.
inline UpdateResult fit_hammered_beam(std::vector<MeasuredFrf> frfs, int segments) {
  const UpdateState state{
      "beam", hammered_beam(1.02 * kBeamEI, 1.1 * kTipMass, segments), {}, std::move(frfs)};
  return update_model({state}, {{"beam.EI_z"}, {"tip.mass"}, {"beam.damping_ratio"}},
                      {.starts = 1});
}

}  // namespace rigfit::ident::testing
