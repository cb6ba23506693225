// Cables at the ends of what can hang between two points: nearly slack, taut to 10 kN, steep,
// inextensible, limp or stiff as a rod, cut into three segments or three thousand.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "model/linear/modal_analysis.h"
#include "tests/bench/hard_cases/bar_chain.h"
#include "tests/bench/hard_cases/hard_case.h"
#include "tests/reference/closed_forms.h"
#include "tests/scenes.h"

namespace rigfit::hard_cases {
namespace cable_area {
namespace {

using namespace model;

constexpr double kMass = 0.16667, kEA = 221780, kSpan = 2.4;
constexpr double kWeight = kMass * kStandardGravity;

/// What the estimate of the error by the number of segments may be short of it: a tenth
/// (segment_choice.h), and what rounding makes of a frequency.
constexpr double kHonest = 1.1, kRounding = 1e-9;

Scene cable(double EI, double degrees = 0) {
  Scene scene = testing::paper_cable(200, EI, 0);  // segments by accuracy
  const double angle = degrees * M_PI / 180;
  scene.nodes[1].position << kSpan * std::cos(angle), kSpan * std::sin(angle), 0;
  return scene;
}

/// Frequencies of both planes against a reference good to `own` (relative); within the analysis'
/// own estimate, which itself meets the scene's accuracy.
void compare(Worst& worst, const Scene& scene, const std::vector<double>& in,
             const std::vector<double>& out, double own, int count) {
  const ModalAnalysis found = analyse_modes(scene, {.count = count});
  worst.require(found.equilibrium.status == EquilibriumStatus::converged, found.equilibrium.reason);
  worst.require(found.complete, "modes are missing");
  worst.require(
      found.relative_error_estimate <= scene.accuracy || scene.members[0].segments > 0,
      fmt::format("estimate {:.1e} above the accuracy asked for", found.relative_error_estimate));
  std::size_t next[2] = {0, 0};
  for (const NaturalMode& mode : found.modes) {
    const bool out_of_plane = mode.plane == ModePlane::out;
    const auto& truth = out_of_plane ? out : in;
    const std::size_t i = next[out_of_plane]++;
    if (i >= truth.size()) continue;
    worst.add(std::abs(mode.frequency_hz / truth[i] - 1),
              kHonest * found.relative_error_estimate + own + kRounding);
  }
}

/// Longer than its chord by `slack` (relative): tension, sag and the first modes of both planes.
Outcome near_slack(bool quick) {
  Worst worst;
  for (const double slack : {-1e-3, -1e-5, 0.0, 1e-5, 1e-3, 0.03, 0.3}) {
    if (quick && slack != 1e-5 && slack != 0.3) continue;
    Scene scene = cable(0);
    scene.members[0].tension.reset();
    scene.members[0].unstretched_length = kSpan * (1 + slack);
    const ElasticCatenary truth{kSpan, 0, kWeight, kEA};
    const CatenaryState state = catenary_of_length(truth, kSpan * (1 + slack));
    const BarFrequencies bars = bar_frequencies(truth, state, kMass, 3);
    compare(worst, scene, bars.in_hz, bars.out_hz, bars.error, 6);
    // Statics: second order in the segments' length, the rest of Richardson's value of fourth.
    ModesOptions options{.count = 1, .error_estimate = false};
    double tension[2], sag[2];
    for (int k = 0; k < 2; ++k) {
      options.segments = k == 0 ? 60 : 120;
      const ModalAnalysis found = analyse_modes(scene, options);
      worst.require(found.equilibrium.status == EquilibriumStatus::converged,
                    found.equilibrium.reason);
      if (found.equilibrium.members.empty()) return worst.outcome();
      tension[k] = found.equilibrium.members[0].tension_N;
      sag[k] = found.equilibrium.members[0].sag_m;
    }
    const auto limit = [](const double* x) { return (4 * x[1] - x[0]) / 3; };
    const auto change = [](const double* x) { return std::abs(x[1] - x[0]); };
    // Rounding of positions turns into EA times a few parts in 1e16.
    worst.add(std::abs(limit(tension) / state.tension_N - 1),
              0.1 * change(tension) / state.tension_N + 1e-13 * kEA / state.tension_N + 1e-9);
    worst.add(std::abs(limit(sag) / state.sag_m - 1), 0.1 * change(sag) / state.sag_m + 1e-9);
  }
  return worst.outcome();
}

/// By its length, 0.01 % to 1 % longer or 1 % shorter than its chord, so that no tension has to be
/// defined: both planes against bars on the catenary.
Outcome inclined(bool quick) {
  Worst worst;
  for (const double degrees : {30.0, 60.0, 80.0}) {
    if (quick && degrees != 80) continue;
    for (const double slack : {-1e-2, 1e-4, 1e-2}) {
      Scene scene = cable(0, degrees);
      scene.members[0].tension.reset();
      scene.members[0].unstretched_length = kSpan * (1 + slack);
      const Eigen::Vector3d end = scene.nodes[1].position;
      const ElasticCatenary truth{end.x(), end.y(), kWeight, kEA};
      const CatenaryState state = catenary_of_length(truth, kSpan * (1 + slack));
      const BarFrequencies bars = bar_frequencies(truth, state, kMass, 3);
      compare(worst, scene, bars.in_hz, bars.out_hz, bars.error, 6);
    }
  }
  return worst.outcome();
}

/// Weightless, so that it is a prestressed beam; mass and stiffness are per unstretched length.
UniformBeam prestressed(double tension, double EI) {
  const double e = tension / kEA;
  return {kSpan, kMass / (1 + e), EI * (1 + e), tension};
}

/// A weightless cable against its closed form, `count` modes of a plane; `own`: what the closed
/// form is good to.
void compare_weightless(Worst& worst, double tension, double EI, bool clamped, int count,
                        int segments = 0, double own = 0) {
  Scene scene = cable(EI);
  scene.gravity.setZero();
  scene.members[0].tension = tension;
  scene.members[0].segments = segments;
  for (auto& node : scene.nodes) {
    if (clamped) node.support.kind = Support::Kind::clamped;
  }
  const UniformBeam beam = prestressed(tension, EI);
  const auto truth =
      clamped ? clamped_beam_frequencies(beam, count) : pinned_beam_frequencies(beam, count);
  compare(worst, scene, truth, truth, own, 2 * count);
}

Outcome ten_kilonewton(bool) {
  Worst worst;
  for (const double EI : {0.0306, 15.5632}) {
    for (const bool clamped : {false, true}) compare_weightless(worst, 1e4, EI, clamped, 3);
  }
  return worst.outcome();
}

Outcome limits_of_stiffness(bool) {
  Worst worst;
  for (const double tension : {25.0, 300.0}) {
    for (const double EI : {0.0, 1e-9, 0.0306, 15.5632}) {
      for (const bool clamped : {false, true}) {
        // Boundary layers of sqrt(EI / T) = 6 micrometres are out of a segment's reach.
        if (!clamped || EI >= 0.01) compare_weightless(worst, tension, EI, clamped, 3);
      }
    }
  }
  return worst.outcome();
}

/// Irvine's limit: small weight over tension, a parameter of 5000 by EA alone. His theory leaves
/// out (m g L / H)^2 = 1e-6 and the strain; rounding of positions is worth EA / T times 1e-16 a
/// segment.
Outcome inextensible(bool) {
  Worst worst;
  Scene scene = cable(0);
  scene.members[0].EA = 1e12;
  scene.gravity << 0, -1e-3 * 200 / (kMass * kSpan), 0;
  const SaggingCable taut{kSpan, kMass, 1e12, 200, 1e-3 * 200 / (kMass * kSpan)};
  std::vector<double> in = irvine_symmetric_frequencies(taut, 3);
  for (const double f : irvine_antisymmetric_frequencies(taut, 3)) in.push_back(f);
  std::sort(in.begin(), in.end());
  compare(worst, scene, in, irvine_out_of_plane_frequencies(taut, 3), 2e-6, 6);
  return worst.outcome();
}

Outcome three_segments(bool) {
  Worst worst;
  for (const bool clamped : {false, true}) compare_weightless(worst, 200, 0.5972, clamped, 1, 3);
  return worst.outcome();
}

Outcome three_thousand_segments(bool) {
  Worst worst;
  // Rounding alone: 1e-16 times the highest over the lowest eigenvalue, 16 EI / l^4 over
  // T (pi / L)^2.
  const double l = kSpan / 3000;
  const double conditioning = 16 * 0.5972 / std::pow(l, 4) / (200 * std::pow(M_PI / kSpan, 2));
  compare_weightless(worst, 200, 0.5972, false, 3, 3000, 1.1e-16 * conditioning);
  return worst.outcome();
}

}  // namespace
}  // namespace cable_area

std::vector<HardCase> cable_cases() {
  using namespace cable_area;
  const std::string area = "cable";
  return {
      {area, "0.1 % shorter to 30 % longer than its span", "catenary; modes: bars, own estimate",
       near_slack},
      {area, "inclined 30, 60, 80 degrees, limp", "bars on the catenary, own estimate", inclined},
      {area, "10 kN, EImin and EImax", "closed form within own estimate", ten_kilonewton},
      {area, "EI = 0, 1e-9, EImin, EImax, 25 and 300 N", "closed form within own estimate",
       limits_of_stiffness},
      {area, "inextensible, lambda^2 = 5000", "Irvine, own estimate + 2e-6", inextensible},
      {area, "3 segments", "closed form within own estimate", three_segments},
      {area, "3000 segments", "closed form, estimate + rounding", three_thousand_segments},
  };
}

}  // namespace rigfit::hard_cases
