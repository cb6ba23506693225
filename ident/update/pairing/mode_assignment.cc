#include "ident/update/pairing/mode_assignment.h"

namespace rigfit::ident {
namespace {

constexpr double kOnePeak = 0.005;  // relative: half the bandwidth of a mode of 0.5 % damping
constexpr double kTwin = 0.999;     // probability; rounding is far below, data say more

// Both are known to be one of in and out, and not the same; a mode that is mixed, axial or
// torsional may show in either test.
bool planes_differ(const std::optional<model::ModePlane>& measured,
                   const std::optional<model::ModePlane>& modelled) {
  const auto transverse = [](model::ModePlane plane) {
    return plane == model::ModePlane::in || plane == model::ModePlane::out;
  };
  return measured && modelled && transverse(*measured) && transverse(*modelled) &&
         *measured != *modelled;
}

// A mode that this test was not made to see.
bool other_plane(const std::optional<model::ModePlane>& test, const PairingMode& mode) {
  if (mode.plane == model::ModePlane::axial || mode.plane == model::ModePlane::torsion) {
    return !test || *test != *mode.plane;
  }
  return planes_differ(test, mode.plane);
}

// How the test sees each modelled mode; `log_missed`: of the peak that it is part of, 0 outside of
// the band.
struct Sight {
  std::vector<double> probability, log_missed;
};

// A test that does not tell the planes apart sees modes that agree in both as one.
bool one_peak(const std::optional<model::ModePlane>& test, const PairingMode& a,
              const PairingMode& b) {
  return &a == &b ||
         (!test && std::abs(a.frequency_hz - b.frequency_hz) < kOnePeak * b.frequency_hz);
}

Sight sight_of(const std::optional<model::ModePlane>& plane, std::pair<double, double> band,
               const std::vector<PairingMode>& modelled, double relative_std,
               const AssignmentOptions& options) {
  const auto [low, high] = band;
  double strongest = 0;
  for (const auto& mode : modelled) {
    if (!other_plane(plane, mode) && mode.frequency_hz < 1.2 * high) {
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
    const double f = mode.frequency_hz;
    // The band's ends are as soft as frequencies are uncertain, or the likelihood would jump.
    double within = 0.5 * std::erfc(-std::log(high / f) / soft / std::sqrt(2.0));
    if (low > 0) within *= 0.5 * std::erfc(-std::log(f / low) / soft / std::sqrt(2.0));
    sight.probability.push_back(seen);
    sight.log_missed.push_back(within * std::log(1 - seen));
  }
  const std::vector<double> own = sight.log_missed;
  for (std::size_t j = 0; j < modelled.size(); ++j) {  // a peak as that mode which shows it best
    for (std::size_t k = 0; k < modelled.size(); ++k) {
      if (own[k] < sight.log_missed[j] && one_peak(plane, modelled[k], modelled[j]))
        sight.log_missed[j] = own[k];
    }
  }
  return sight;
}

double log_mac_density(double mac, double scale) {
  if (!std::isfinite(mac)) return 0;
  return -(1 - mac) / scale - std::log(scale * (1 - std::exp(-1 / scale)));
}

// The assignment of a test that looked at a band, its modes beyond `last_hz` false.
ModeAssignment assign_test(const std::vector<int>& test, const std::pair<double, double>& band,
                           double last_hz, const std::vector<PairingMode>& measured,
                           const std::vector<double>& relative_std,
                           const std::vector<PairingMode>& modelled,
                           const AssignmentOptions& options) {
  ModeAssignment result;
  const double log_false = std::log(options.false_mode), log_true = std::log1p(-options.false_mode);
  const auto& plane = measured[static_cast<std::size_t>(test.front())].plane;
  double mean_std = 0;
  for (const int i : test) mean_std += relative_std[static_cast<std::size_t>(i)];
  mean_std /= static_cast<double>(test.size());
  const Sight sight = sight_of(plane, band, modelled, mean_std, options);
  const auto rows = static_cast<Index>(test.size());
  const auto columns = static_cast<Index>(modelled.size());
  // What a pair gains over both unpaired; columns beyond the modelled: unpaired.
  MatrixXd cost = MatrixXd::Zero(rows, columns + rows);
  MatrixXd normal = MatrixXd::Zero(rows, columns), macs = normal;
  for (Index r = 0; r < rows; ++r) {
    const auto i = static_cast<std::size_t>(test[static_cast<std::size_t>(r)]);
    for (Index c = 0; c < columns; ++c) {
      const auto j = static_cast<std::size_t>(c);
      const double off =
          std::log(modelled[j].frequency_hz / measured[i].frequency_hz) / relative_std[i];
      if (measured[i].frequency_hz > last_hz) continue;
      if (measured[i].order > 0 && measured[i].order != modelled[j].order) continue;
      macs(r, c) = shape_correlation(measured[i].shape, modelled[j].shape);
      normal(r, c) = -0.5 * off * off - std::log(relative_std[i] * std::sqrt(2 * M_PI));
      const double gain = log_true + std::log(sight.probability[j]) - sight.log_missed[j] -
                          log_false + normal(r, c) + log_mac_density(macs(r, c), options.mac_scale);
      cost(r, c) = std::min(0.0, -gain);
    }
  }
  const auto chosen = least_cost_assignment(cost);
  for (Index r = 0; r < rows; ++r) {
    const int i = test[static_cast<std::size_t>(r)];
    const int c = chosen[static_cast<std::size_t>(r)];
    if (c >= columns || !(cost(r, c) < 0)) {
      result.unpaired_measured.push_back(i);
      result.log_false += log_false;
      continue;
    }
    const auto j = static_cast<std::size_t>(c);
    const double density = log_mac_density(macs(r, c), options.mac_scale);
    result.log_detected += log_true + std::log(sight.probability[j]) + density;
    result.log_likelihood += normal(r, c);
    result.pairs.push_back({i, c, macs(r, c), plane && other_plane(plane, modelled[j])});
  }
  std::vector<std::size_t> counted;  // in a pair, or as missed
  for (const auto& pair : result.pairs) counted.push_back(static_cast<std::size_t>(pair.model));
  for (std::size_t j = 0; j < modelled.size(); ++j) {
    const auto in_peak = [&](std::size_t k) { return one_peak(plane, modelled[k], modelled[j]); };
    if (std::ranges::any_of(counted, in_peak)) continue;
    counted.push_back(j);
    result.log_missed += sight.log_missed[j];
    const double seen = -std::expm1(sight.log_missed[j]);
    if (seen >= 0.5) result.missed.push_back({static_cast<int>(j), seen});
  }
  result.log_likelihood += result.without_densities();
  return result;
}

}  // namespace

double shape_correlation(const Ref<const VectorXcd>& a, const Ref<const VectorXcd>& b) {
  if (a.size() < 2 || a.size() != b.size()) return kNaN;
  const double scale = a.squaredNorm() * b.squaredNorm();
  if (!(std::isfinite(scale) && scale > 0)) return kNaN;
  return std::min(1.0, std::norm(a.dot(b)) / scale);
}

// Shortest augmenting paths with potentials; O(rows^2 columns). Rows and columns are counted from
// 1, 0 stands for none.
std::vector<int> least_cost_assignment(const Ref<const MatrixXd>& cost) {
  const auto n = static_cast<int>(cost.rows()), m = static_cast<int>(cost.cols());
  if (n > m) throw std::invalid_argument("assignment: more rows than columns");
  VectorXd of_row = VectorXd::Zero(n + 1), of_column = VectorXd::Zero(m + 1);
  Eigen::VectorXi row_of = Eigen::VectorXi::Zero(m + 1), previous = row_of;
  for (int row = 1; row <= n; ++row) {
    const double far = std::numeric_limits<double>::infinity();
    VectorXd slack = VectorXd::Constant(m + 1, far);
    Eigen::VectorXi visited = Eigen::VectorXi::Zero(m + 1);
    row_of[0] = row;
    int column = 0;
    do {
      visited[column] = 1;
      const int current = row_of[column];
      int next = 0;
      double smallest = far;
      for (int j = 1; j <= m; ++j) {
        if (visited[j]) continue;
        const double reduced = cost(current - 1, j - 1) - of_row[current] - of_column[j];
        if (reduced < slack[j]) slack[j] = reduced, previous[j] = column;
        if (slack[j] < smallest) smallest = slack[j], next = j;
      }
      for (int j = 0; j <= m; ++j) {
        if (!visited[j]) slack[j] -= smallest;
        if (visited[j]) of_row[row_of[j]] += smallest, of_column[j] -= smallest;
      }
      column = next;
    } while (row_of[column] != 0);
    for (; column != 0; column = previous[column]) row_of[column] = row_of[previous[column]];
  }
  std::vector<int> column_of(cost.rows(), 0);
  for (int j = 1; j <= m; ++j) {
    if (row_of[j] != 0) column_of[static_cast<std::size_t>(row_of[j]) - 1] = j - 1;
  }
  return column_of;
}

ModeAssignment assign_modes(const std::vector<PairingMode>& measured,
                            const std::vector<double>& relative_std,
                            const std::vector<PairingMode>& modelled,
                            const std::optional<std::pair<double, double>>& band_hz,
                            const AssignmentOptions& options) {
  ModeAssignment result;
  std::map<std::optional<model::ModePlane>, std::vector<int>> tests;  // one a plane that is named
  for (std::size_t i = 0; i < measured.size(); ++i) {
    tests[measured[i].plane].push_back(static_cast<int>(i));
  }
  for (const auto& [plane, test] : tests) {
    std::vector<double> ends;  // the band has
    for (const int i : test) ends.push_back(measured[static_cast<std::size_t>(i)].frequency_hz);
    if (!options.ends_at_pairs) ends = {std::ranges::max(ends)};
    std::optional<ModeAssignment> best;
    for (const double last_hz : ends) {
      const auto band =
          band_hz ? std::pair{band_hz->first, std::clamp(last_hz, band_hz->first, band_hz->second)}
                  : std::pair{0.0, last_hz};
      auto one = assign_test(test, band, last_hz, measured, relative_std, modelled, options);
      if (!best || one.log_likelihood > best->log_likelihood) best = std::move(one);
    }
    result.pairs.insert(result.pairs.end(), best->pairs.begin(), best->pairs.end());
    result.unpaired_measured.insert(result.unpaired_measured.end(), best->unpaired_measured.begin(),
                                    best->unpaired_measured.end());
    result.missed.insert(result.missed.end(), best->missed.begin(), best->missed.end());
    result.add(*best);
  }
  std::ranges::sort(result.pairs, {}, &ModePair::measured);
  std::ranges::sort(result.unpaired_measured);
  return result;
}

std::vector<ModePair> pair_modes(const std::vector<PairingMode>& measured,
                                 const std::vector<PairingMode>& modelled) {
  return assign_modes(measured, std::vector<double>(measured.size(), kListStd), modelled, {}, {})
      .pairs;
}

}  // namespace rigfit::ident
