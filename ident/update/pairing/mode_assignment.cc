#include "ident/update/pairing/mode_assignment.h"

#include <algorithm>
#include <cmath>

namespace rigfit::ident {
namespace {

constexpr double kFarthest = 6;  // standard deviations: beyond, a pair is none
constexpr double kTwin = 0.999;  // probability; rounding is far below, data say more

// A mode that this test was not made to see.
bool other_plane(const std::optional<model::ModePlane>& test, const PairingMode& mode) {
  if (mode.plane == model::ModePlane::axial || mode.plane == model::ModePlane::torsion) {
    return !test || *test != *mode.plane;
  }
  return planes_differ(test, mode.plane);
}

// How the test sees each modelled mode.
struct Sight {
  std::vector<double> probability, log_missed;  // log_missed: 0 outside of the band
  std::vector<char> inside;
};

Sight sight_of(const std::vector<int>& test, const std::vector<PairingMode>& measured,
               const std::vector<PairingMode>& modelled, double relative_std, double factor,
               const std::optional<std::pair<double, double>>& band,
               const AssignmentOptions& options) {
  const auto& plane = measured[static_cast<std::size_t>(test.front())].plane;
  double high = 0;
  for (const int i : test) {
    high = std::max(high, measured[static_cast<std::size_t>(i)].frequency_hz);
  }
  double low = 0;
  if (band) low = band->first, high = std::min(std::max(high, band->first), band->second);
  double strongest = 0;
  for (const auto& mode : modelled) {
    if (!other_plane(plane, mode) && factor * mode.frequency_hz < 1.2 * high) {
      strongest = std::max(strongest, mode.visibility);
    }
  }
  const double soft = std::max(relative_std, 1e-3);
  Sight sight;
  for (const auto& mode : modelled) {
    double visible = other_plane(plane, mode) ? 0 : 1;
    if (visible > 0 && strongest > 0) {
      const double ratio = mode.visibility / strongest / options.visible_ratio;
      visible = ratio * ratio / (1 + ratio * ratio);
    }
    double seen = (1 - options.missed) * (options.leaked + (1 - options.leaked) * visible);
    // Where the planes agree, a mode with its node at the sensor and its twin of the other plane
    // would be seen alike, and rounding would choose.
    if (other_plane(plane, mode)) seen *= kTwin;
    const double f = factor * mode.frequency_hz;
    // The band's ends are as soft as frequencies are uncertain, or the likelihood would jump.
    double within = 0.5 * std::erfc(-std::log(high / f) / soft / std::sqrt(2.0));
    if (low > 0) within *= 0.5 * std::erfc(-std::log(f / low) / soft / std::sqrt(2.0));
    sight.probability.push_back(seen);
    sight.log_missed.push_back(within * std::log(1 - seen));
    sight.inside.push_back(within > 0.5);
  }
  return sight;
}

double log_mac_density(double mac, double scale) {
  if (!std::isfinite(mac)) return 0;
  return -(1 - mac) / scale - std::log(scale * (1 - std::exp(-1 / scale)));
}

}  // namespace

ModeAssignment assign_modes(const std::vector<PairingMode>& measured,
                            const std::vector<double>& relative_std,
                            const std::vector<PairingMode>& modelled,
                            const std::optional<std::pair<double, double>>& band_hz,
                            const AssignmentOptions& options, double factor) {
  ModeAssignment result;
  const double log_false = std::log(options.false_mode), log_true = std::log1p(-options.false_mode);
  for (const auto& test : tests_of(measured)) {
    const auto& plane = measured[static_cast<std::size_t>(test.front())].plane;
    double mean_std = 0;
    for (const int i : test) mean_std += relative_std[static_cast<std::size_t>(i)];
    mean_std /= static_cast<double>(test.size());
    const Sight sight = sight_of(test, measured, modelled, mean_std, factor, band_hz, options);
    const auto rows = static_cast<Eigen::Index>(test.size());
    const auto columns = static_cast<Eigen::Index>(modelled.size());
    // What a pair gains over both unpaired; columns beyond the modelled: unpaired.
    Eigen::MatrixXd cost = Eigen::MatrixXd::Zero(rows, columns + rows);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(rows, columns), macs = normal;
    for (Eigen::Index r = 0; r < rows; ++r) {
      const auto i = static_cast<std::size_t>(test[static_cast<std::size_t>(r)]);
      for (Eigen::Index c = 0; c < columns; ++c) {
        const auto j = static_cast<std::size_t>(c);
        const double off = std::log(factor * modelled[j].frequency_hz / measured[i].frequency_hz) /
                           relative_std[i];
        if (std::abs(off) > kFarthest) continue;
        macs(r, c) = shape_correlation(measured[i].shape, modelled[j].shape);
        normal(r, c) = -0.5 * off * off - std::log(relative_std[i] * std::sqrt(2 * M_PI));
        const double gain = log_true + std::log(sight.probability[j]) - sight.log_missed[j] -
                            log_false + normal(r, c) +
                            log_mac_density(macs(r, c), options.mac_scale);
        cost(r, c) = std::min(0.0, -gain);
      }
    }
    std::vector<char> taken(modelled.size(), 0);
    const auto chosen = least_cost_assignment(cost);
    for (Eigen::Index r = 0; r < rows; ++r) {
      const int i = test[static_cast<std::size_t>(r)];
      const int c = chosen[static_cast<std::size_t>(r)];
      if (c >= columns || !(cost(r, c) < 0)) {
        result.unpaired_measured.push_back(i);
        result.log_false += log_false;
        continue;
      }
      const auto j = static_cast<std::size_t>(c);
      taken[j] = 1;
      const double density = log_mac_density(macs(r, c), options.mac_scale);
      result.log_detected += log_true + std::log(sight.probability[j]) + density;
      result.log_likelihood += normal(r, c);
      result.pairs.push_back({i, c, macs(r, c), plane && other_plane(plane, modelled[j])});
    }
    for (std::size_t j = 0; j < modelled.size(); ++j) {
      if (taken[j]) continue;
      result.log_missed += sight.log_missed[j];
      if (sight.inside[j] && sight.probability[j] >= 0.5) {
        result.missed.push_back({static_cast<int>(j), sight.probability[j]});
      }
    }
  }
  std::sort(result.pairs.begin(), result.pairs.end(),
            [](const ModePair& a, const ModePair& b) { return a.measured < b.measured; });
  std::sort(result.unpaired_measured.begin(), result.unpaired_measured.end());
  result.log_likelihood += result.log_detected + result.log_false + result.log_missed;
  return result;
}

}  // namespace rigfit::ident
