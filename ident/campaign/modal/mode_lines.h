// Natural frequencies of a scene followed along a rising tension, each by its shape, and where they
// cross: where lines cross, the order of the modes changes.
//
// From one tension to the next a mode is the one of the same plane whose shape is most like (MAC of
// the displacements at 32 places of every member, whatever its segments). Steps are even in the
// logarithm of the tension: what changes, changes most at low ones.
#pragma once

#include <functional>
#include <vector>

#include "model/linear/modal_analysis.h"
#include "model/scene/scene.h"

namespace rigfit::ident {

struct ModeLine {
  model::ModePlane plane = model::ModePlane::in;
  int number = 0;  ///< 1-based, among the lines of its plane by frequency at its highest tension
  int first = 0;   ///< step at which it begins
  std::vector<double> frequency_hz;  ///< from that step on
};

struct ModeCrossing {
  double tension_N = 0, frequency_hz = 0;
  std::size_t one = 0, other = 0;  ///< lines
};

struct ModeLines {
  std::vector<double> tension_N;
  std::vector<ModeLine> lines;          ///< modes in plane and out of plane only
  std::vector<ModeCrossing> crossings;  ///< by rising tension
};

/// `scene_at`: the scene at a tension; `high_hz`: modes above are left out.
[[nodiscard]] ModeLines follow_modes(const std::function<model::Scene(double tension_N)>& scene_at,
                                     double low_N, double high_N, int steps, double high_hz);

/// Where lines change their order: interpolated between steps. Lines that lie as near as
/// `resolution` (relative) to each other on one side of it all along are one, and do not cross.
[[nodiscard]] std::vector<ModeCrossing> crossings_of(const std::vector<double>& tension_N,
                                                     const std::vector<ModeLine>& lines,
                                                     double resolution = 5e-3);

}  // namespace rigfit::ident
