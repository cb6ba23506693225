#include "ident/campaign/modal/mode_lines.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace rigfit::ident {
namespace {

constexpr int kPlaces = 32;  // places on a member at which shapes are compared

/// The scene with sensors of displacement at places that do not depend on its segments.
model::Scene sampled(model::Scene scene) {
  scene.sensors.clear();
  for (const auto& member : scene.members) {
    for (int k = 0; k < kPlaces; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        model::Sensor sensor;
        sensor.place.member = member.name;
        sensor.place.position = (k + 0.5) / kPlaces;
        sensor.direction = Eigen::Vector3d::Unit(axis);
        sensor.quantity = model::Sensor::Quantity::displacement;
        scene.sensors.push_back(std::move(sensor));
      }
    }
  }
  return scene;
}

/// Displacements of all members in one vector of unit length.
Eigen::VectorXd shape_vector(const model::NaturalMode& mode) {
  const double length = mode.sensor_shape.norm();
  return length > 0 ? Eigen::VectorXd(mode.sensor_shape / length) : mode.sensor_shape;
}

/// Less alike than this, from one step to the next, is another mode.
constexpr double kLeastMac = 0.3;

}  // namespace

ModeLines follow_modes(const std::function<model::Scene(double)>& scene_at, double low_N,
                       double high_N, int steps, double high_hz) {
  ModeLines result;
  std::vector<Eigen::VectorXd> last;  // shape of every line at its last step
  for (int step = 0; step <= steps; ++step) {
    const double tension = low_N * std::pow(high_N / low_N, static_cast<double>(step) / steps);
    result.tension_N.push_back(tension);
    model::ModesOptions options;
    options.band_hz = {{0.0, high_hz}};
    options.damped = options.shapes = false;
    options.error_estimate = false;
    const auto analysis = model::analyse_modes(sampled(scene_at(tension)), options);
    std::vector<std::size_t> modes;
    std::vector<Eigen::VectorXd> shapes;
    for (std::size_t i = 0; i < analysis.modes.size(); ++i) {
      const auto plane = analysis.modes[i].plane;
      if (plane != model::ModePlane::in && plane != model::ModePlane::out) continue;
      modes.push_back(i);
      shapes.push_back(shape_vector(analysis.modes[i]));
    }
    std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
    for (std::size_t l = 0; l < result.lines.size(); ++l) {
      const auto& line = result.lines[l];
      if (line.first + static_cast<int>(line.frequency_hz.size()) != step) continue;  // it ended
      for (std::size_t m = 0; m < modes.size(); ++m) {
        if (analysis.modes[modes[m]].plane != line.plane) continue;
        const double product = shapes[m].dot(last[l]);
        if (product * product > kLeastMac) pairs.emplace_back(-product * product, l, m);
      }
    }
    std::sort(pairs.begin(), pairs.end());
    std::vector<bool> taken(modes.size(), false);
    for (const auto& [negative_mac, l, m] : pairs) {
      auto& line = result.lines[l];
      if (taken[m] || line.first + static_cast<int>(line.frequency_hz.size()) != step) continue;
      taken[m] = true;
      line.frequency_hz.push_back(analysis.modes[modes[m]].frequency_hz);
      last[l] = shapes[m];
    }
    for (std::size_t m = 0; m < modes.size(); ++m) {
      if (taken[m]) continue;
      const auto& mode = analysis.modes[modes[m]];
      result.lines.push_back({mode.plane, 0, step, {mode.frequency_hz}});
      last.push_back(shapes[m]);
    }
  }
  // Numbers as at the highest tension that each line reaches, the longest-lived first.
  std::vector<std::size_t> order(result.lines.size());
  for (std::size_t l = 0; l < order.size(); ++l) order[l] = l;
  const auto key = [&](std::size_t l) {
    const auto& line = result.lines[l];
    return std::tuple(-(line.first + static_cast<int>(line.frequency_hz.size())),
                      line.frequency_hz.back());
  };
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  int in = 0, out = 0;
  for (const std::size_t l : order) {
    auto& line = result.lines[l];
    line.number = line.plane == model::ModePlane::in ? ++in : ++out;
  }
  result.crossings = crossings_of(result.tension_N, result.lines);
  return result;
}

std::vector<ModeCrossing> crossings_of(const std::vector<double>& tension_N,
                                       const std::vector<ModeLine>& lines, double resolution) {
  std::vector<ModeCrossing> crossings;
  for (std::size_t a = 0; a < lines.size(); ++a) {
    for (std::size_t b = a + 1; b < lines.size(); ++b) {
      const auto end = [](const ModeLine& line) {
        return line.first + static_cast<int>(line.frequency_hz.size());
      };
      const int from = std::max(lines[a].first, lines[b].first);
      const int to = std::min(end(lines[a]), end(lines[b]));
      const auto f = [](const ModeLine& line, int step) {
        return line.frequency_hz[static_cast<std::size_t>(step - line.first)];
      };
      const auto apart = [&](int step) {
        return (f(lines[a], step) - f(lines[b], step)) / f(lines[a], step);
      };
      // Largest distance on either side of a change of sign, up to the next one.
      double before = 0;
      for (int step = from; step + 1 < to; ++step) {
        before = std::max(before, std::abs(apart(step)));
        const double here = apart(step), next = apart(step + 1);
        if (here * next > 0 || here == 0) continue;
        double after = 0;
        for (int k = step + 1; k < to && apart(k) * next >= 0; ++k) {
          after = std::max(after, std::abs(apart(k)));
        }
        if (before > resolution && after > resolution) {
          const double one = f(lines[a], step) - f(lines[b], step);
          const double other = f(lines[a], step + 1) - f(lines[b], step + 1);
          const double t = one / (one - other);
          const auto k = static_cast<std::size_t>(step);
          crossings.push_back({tension_N[k] + t * (tension_N[k + 1] - tension_N[k]),
                               f(lines[a], step) + t * (f(lines[a], step + 1) - f(lines[a], step)),
                               a, b});
        }
        before = 0;
      }
    }
  }
  std::sort(crossings.begin(), crossings.end(),
            [](const auto& one, const auto& other) { return one.tension_N < other.tension_N; });
  return crossings;
}

}  // namespace rigfit::ident
