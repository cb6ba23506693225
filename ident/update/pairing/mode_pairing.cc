#include "ident/update/pairing/mode_pairing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;

void require_frequencies(const std::vector<PairingMode>& modes) {
  for (const auto& mode : modes) {
    if (!(std::isfinite(mode.frequency_hz) && mode.frequency_hz > 0)) {
      throw std::invalid_argument("mode pairing: every frequency must be positive and finite");
    }
  }
}

// Planes differ when both are known to be one of the two and not the same; a mode that is mixed,
// axial or torsional may show in either test.
bool planes_differ(const PairingMode& measured, const PairingMode& modelled) {
  const auto transverse = [](model::ModePlane plane) {
    return plane == model::ModePlane::in || plane == model::ModePlane::out;
  };
  return measured.plane && modelled.plane && transverse(*measured.plane) &&
         transverse(*modelled.plane) && *measured.plane != *modelled.plane;
}

struct PairCost {
  double cost = 0, mac = kNaN;
  bool cross_plane = false;
};

PairCost cost_of(const PairingMode& measured, const PairingMode& modelled, double factor,
                 const PairingOptions& options) {
  PairCost result;
  const double deviation = std::log(factor * modelled.frequency_hz / measured.frequency_hz);
  result.cost = std::pow(deviation / options.frequency_scale, 2);
  result.mac = shape_correlation(measured.shape, modelled.shape);
  if (std::isfinite(result.mac)) result.cost += (1 - result.mac) / options.mac_scale;
  result.cross_plane = planes_differ(measured, modelled);
  if (result.cross_plane) result.cost += options.plane_price;
  return result;
}

struct Assignment {
  std::vector<ModePair> pairs;
  double cost = 0;
};

// One test: its measured modes against all modelled ones.
Assignment assign(const std::vector<PairingMode>& measured, const std::vector<int>& test,
                  const std::vector<PairingMode>& modelled, double factor,
                  const PairingOptions& options) {
  const auto rows = static_cast<Eigen::Index>(test.size());
  const auto columns = static_cast<Eigen::Index>(modelled.size());
  Assignment result;
  result.cost = options.unpaired_measured * static_cast<double>(rows);
  for (const auto& mode : modelled) result.cost += options.unpaired_model * mode.visibility;
  if (rows == 0 || columns == 0) return result;

  // What a pair saves against leaving both alone; a pair that saves nothing is none.
  Eigen::MatrixXd gain(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) {
      const auto& mode = modelled[static_cast<std::size_t>(j)];
      const auto& row = measured[static_cast<std::size_t>(test[static_cast<std::size_t>(i)])];
      gain(i, j) =
          std::min(0.0, cost_of(row, mode, factor, options).cost - options.unpaired_measured -
                            options.unpaired_model * mode.visibility);
    }
  }
  const bool wide = rows <= columns;
  const std::vector<int> chosen =
      wide ? least_cost_assignment(gain) : least_cost_assignment(gain.transpose());
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const auto i = wide ? k : static_cast<std::size_t>(chosen[k]);
    const auto j = wide ? static_cast<std::size_t>(chosen[k]) : k;
    const double saved = gain(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    if (saved >= 0) continue;
    result.cost += saved;
    const auto& row = measured[static_cast<std::size_t>(test[i])];
    const PairCost cost = cost_of(row, modelled[j], factor, options);
    result.pairs.push_back({.measured = test[i],
                            .model = static_cast<int>(j),
                            .relative_error = modelled[j].frequency_hz / row.frequency_hz - 1,
                            .mac = cost.mac,
                            .cost = cost.cost,
                            .cross_plane = cost.cross_plane});
  }
  return result;
}

std::string nearest_text(const PairingMode& mode, const std::vector<PairingMode>& others,
                         const char* kind) {
  const PairingMode* nearest = nullptr;
  for (const auto& other : others) {
    if (nearest == nullptr || std::abs(std::log(other.frequency_hz / mode.frequency_hz)) <
                                  std::abs(std::log(nearest->frequency_hz / mode.frequency_hz))) {
      nearest = &other;
    }
  }
  if (nearest == nullptr) return fmt::format("there is no {} mode", kind);
  return fmt::format("nearest {} mode at {:.4g} Hz ({:+.1f} %)", kind, nearest->frequency_hz,
                     100 * (nearest->frequency_hz / mode.frequency_hz - 1));
}

}  // namespace

double shape_correlation(const Eigen::Ref<const Eigen::VectorXcd>& a,
                         const Eigen::Ref<const Eigen::VectorXcd>& b) {
  if (a.size() < 2 || a.size() != b.size()) return kNaN;
  const double scale = a.squaredNorm() * b.squaredNorm();
  if (!(std::isfinite(scale) && scale > 0)) return kNaN;
  return std::min(1.0, std::norm(a.dot(b)) / scale);
}

// Shortest augmenting paths with potentials; O(rows^2 columns).
std::vector<int> least_cost_assignment(const Eigen::Ref<const Eigen::MatrixXd>& cost) {
  const auto n = static_cast<int>(cost.rows()), m = static_cast<int>(cost.cols());
  if (n > m) throw std::invalid_argument("assignment: more rows than columns");
  std::vector<double> row_potential(static_cast<std::size_t>(n) + 1, 0),
      column_potential(static_cast<std::size_t>(m) + 1, 0);
  // Index 0 stands for "none": rows and columns are counted from 1 here.
  std::vector<int> row_of(static_cast<std::size_t>(m) + 1, 0),
      previous(static_cast<std::size_t>(m) + 1, 0);
  const auto at = [](auto& vector, int index) -> auto& {
    return vector[static_cast<std::size_t>(index)];
  };
  std::vector<double> slack(static_cast<std::size_t>(m) + 1);
  std::vector<char> visited(static_cast<std::size_t>(m) + 1);
  for (int row = 1; row <= n; ++row) {
    std::fill(slack.begin(), slack.end(), std::numeric_limits<double>::infinity());
    std::fill(visited.begin(), visited.end(), 0);
    row_of[0] = row;
    int column = 0;
    do {
      at(visited, column) = 1;
      const int current = at(row_of, column);
      double smallest = std::numeric_limits<double>::infinity();
      int next = 0;
      for (int j = 1; j <= m; ++j) {
        if (at(visited, j)) continue;
        const double reduced =
            cost(current - 1, j - 1) - at(row_potential, current) - at(column_potential, j);
        if (reduced < at(slack, j)) {
          at(slack, j) = reduced;
          at(previous, j) = column;
        }
        if (at(slack, j) < smallest) {
          smallest = at(slack, j);
          next = j;
        }
      }
      for (int j = 0; j <= m; ++j) {
        if (at(visited, j)) {
          at(row_potential, at(row_of, j)) += smallest;
          at(column_potential, j) -= smallest;
        } else {
          at(slack, j) -= smallest;
        }
      }
      column = next;
    } while (at(row_of, column) != 0);
    while (column != 0) {
      const int before = at(previous, column);
      at(row_of, column) = at(row_of, before);
      column = before;
    }
  }
  std::vector<int> column_of(static_cast<std::size_t>(n), 0);
  for (int j = 1; j <= m; ++j) {
    if (at(row_of, j) != 0) at(column_of, at(row_of, j) - 1) = j - 1;
  }
  return column_of;
}

ModePairing pair_modes(const std::vector<PairingMode>& measured,
                       const std::vector<PairingMode>& modelled, const PairingOptions& options) {
  require_frequencies(measured);
  require_frequencies(modelled);
  // Tests: one for each plane that is named among the measured modes.
  std::vector<std::pair<int, std::vector<int>>> tests;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const int plane = measured[i].plane ? static_cast<int>(*measured[i].plane) : -1;
    auto test = std::find_if(tests.begin(), tests.end(),
                             [&](const auto& known) { return known.first == plane; });
    if (test == tests.end()) test = tests.insert(tests.end(), {plane, {}});
    test->second.push_back(static_cast<int>(i));
  }

  ModePairing result;
  result.cost = std::numeric_limits<double>::infinity();
  constexpr double kStep = 0.02;  // a fifth of the frequency scale: the cost is smooth on that
  const int steps = options.common_factor_range > 1
                        ? static_cast<int>(std::ceil(std::log(options.common_factor_range) / kStep))
                        : 0;
  for (int k = 0; k <= 2 * steps; ++k) {
    // 0, +1, -1, +2, ...: of equal costs the smallest factor wins.
    const double log_factor = kStep * (k % 2 == 1 ? (k + 1) / 2 : -k / 2);
    double cost = std::pow(log_factor / options.common_factor_scale, 2);
    std::vector<ModePair> pairs;
    for (const auto& [plane, test] : tests) {
      auto assigned = assign(measured, test, modelled, std::exp(log_factor), options);
      cost += assigned.cost;
      pairs.insert(pairs.end(), assigned.pairs.begin(), assigned.pairs.end());
    }
    if (cost < result.cost) {
      result.cost = cost;
      result.common_factor = std::exp(log_factor);
      result.pairs = std::move(pairs);
    }
  }
  std::sort(result.pairs.begin(), result.pairs.end(),
            [](const ModePair& a, const ModePair& b) { return a.measured < b.measured; });

  std::set<int> paired_measured, paired_model;
  for (const auto& pair : result.pairs) {
    paired_measured.insert(pair.measured);
    // Leakage into another test does not make up for the test that should have seen the mode.
    if (!pair.cross_plane) paired_model.insert(pair.model);
  }
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (paired_measured.contains(static_cast<int>(i))) continue;
    result.unpaired_measured.push_back(
        {static_cast<int>(i), false, nearest_text(measured[i], modelled, "modelled")});
  }
  for (std::size_t j = 0; j < modelled.size(); ++j) {
    if (paired_model.contains(static_cast<int>(j))) continue;
    const auto& mode = modelled[j];
    double low = std::numeric_limits<double>::infinity(), high = 0;
    for (const auto& row : measured) {
      if (planes_differ(row, mode)) continue;
      low = std::min(low, row.frequency_hz);
      high = std::max(high, row.frequency_hz);
    }
    const bool inside = mode.frequency_hz >= low && mode.frequency_hz <= high;
    std::string reason;
    if (high == 0) {
      reason = "no test in its plane";
    } else if (!inside) {
      reason = fmt::format("outside the measured modes, {:.4g} to {:.4g} Hz", low, high);
    } else if (mode.visibility < 0.1) {
      reason = "missed by the test: a node of this mode is near the sensors or the hammer";
    } else {
      reason = "missed by the test, " + nearest_text(mode, measured, "measured");
    }
    result.unpaired_model.push_back({static_cast<int>(j), inside, std::move(reason)});
  }
  return result;
}

double rms_relative_error(const ModePairing& pairing) {
  double squares = 0;
  int count = 0;
  for (const auto& pair : pairing.pairs) {
    if (pair.cross_plane) continue;
    squares += pair.relative_error * pair.relative_error;
    ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : kNaN;
}

}  // namespace rigfit::ident
