#include "ident/update/pairing/mode_pairing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;

// Relative deviation in frequency and loss of MAC that cost 1, the price of pairing across planes,
// and that of leaving a modelled and a measured mode alone: 20 % in frequency.
constexpr double kFrequencyScale = 0.1, kMacScale = 0.5, kPlanePrice = 1.5, kUnpaired = 4;

std::string nearest_text(const PairingMode& mode, const std::vector<PairingMode>& others,
                         const char* kind) {
  const auto apart = [&](const PairingMode& other) {
    return std::abs(std::log(other.frequency_hz / mode.frequency_hz));
  };
  const auto nearest =
      std::min_element(others.begin(), others.end(),
                       [&](const auto& a, const auto& b) { return apart(a) < apart(b); });
  if (nearest == others.end()) return fmt::format("there is no {} mode", kind);
  return fmt::format("nearest {} mode at {:.4g} Hz ({:+.1f} %)", kind, nearest->frequency_hz,
                     100 * (nearest->frequency_hz / mode.frequency_hz - 1));
}

}  // namespace

bool planes_differ(const std::optional<model::ModePlane>& measured,
                   const std::optional<model::ModePlane>& modelled) {
  const auto transverse = [](model::ModePlane plane) {
    return plane == model::ModePlane::in || plane == model::ModePlane::out;
  };
  return measured && modelled && transverse(*measured) && transverse(*modelled) &&
         *measured != *modelled;
}

std::vector<std::vector<int>> tests_of(const std::vector<PairingMode>& measured) {
  std::vector<std::vector<int>> tests;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    auto test = std::find_if(tests.begin(), tests.end(), [&](const auto& one) {
      return measured[static_cast<std::size_t>(one.front())].plane == measured[i].plane;
    });
    if (test == tests.end()) test = tests.insert(tests.end(), std::vector<int>{});
    test->push_back(static_cast<int>(i));
  }
  return tests;
}

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
                       const std::vector<PairingMode>& modelled) {
  for (const auto* modes : {&measured, &modelled}) {
    for (const auto& mode : *modes) {
      if (!(std::isfinite(mode.frequency_hz) && mode.frequency_hz > 0)) {
        throw std::invalid_argument("mode pairing: every frequency must be positive and finite");
      }
    }
  }
  ModePairing result;
  std::vector<char> paired(measured.size(), 0), found(modelled.size(), 0);
  const auto columns = static_cast<Eigen::Index>(modelled.size());
  for (const auto& test : tests_of(measured)) {
    // What a pair saves against leaving both alone; the columns beyond the modelled: alone.
    const auto rows = static_cast<Eigen::Index>(test.size());
    Eigen::MatrixXd gain = Eigen::MatrixXd::Zero(rows, columns + rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const auto& row = measured[static_cast<std::size_t>(test[static_cast<std::size_t>(i)])];
      for (Eigen::Index j = 0; j < columns; ++j) {
        const auto& mode = modelled[static_cast<std::size_t>(j)];
        const double mac = shape_correlation(row.shape, mode.shape);
        double cost = std::pow(std::log(mode.frequency_hz / row.frequency_hz) / kFrequencyScale, 2);
        if (std::isfinite(mac)) cost += (1 - mac) / kMacScale;
        if (planes_differ(row.plane, mode.plane)) cost += kPlanePrice;
        gain(i, j) = std::min(0.0, cost - kUnpaired);
      }
    }
    const auto chosen = least_cost_assignment(gain);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const int j = chosen[i];
      if (!(gain(static_cast<Eigen::Index>(i), j) < 0)) continue;
      const auto &row = measured[static_cast<std::size_t>(test[i])],
                 &mode = modelled[static_cast<std::size_t>(j)];
      const bool leaks = planes_differ(row.plane, mode.plane);
      result.pairs.push_back({test[i], j, shape_correlation(row.shape, mode.shape), leaks});
      paired[static_cast<std::size_t>(test[i])] = 1;
      // Leakage into another test does not make up for the test that should have seen the mode.
      if (!leaks) found[static_cast<std::size_t>(j)] = 1;
    }
  }
  std::sort(result.pairs.begin(), result.pairs.end(),
            [](const ModePair& a, const ModePair& b) { return a.measured < b.measured; });
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (paired[i]) continue;
    result.unpaired.push_back(
        {static_cast<int>(i), nearest_text(measured[i], modelled, "modelled")});
  }
  for (std::size_t j = 0; j < modelled.size(); ++j) {
    if (found[j]) continue;
    const auto& mode = modelled[j];
    bool below = false, above = false;  // measured modes of a test that could have seen it
    for (const auto& row : measured) {
      if (planes_differ(row.plane, mode.plane)) continue;
      below = below || row.frequency_hz <= mode.frequency_hz;
      above = above || row.frequency_hz >= mode.frequency_hz;
    }
    if (!below || !above) continue;
    result.missed.push_back(
        {static_cast<int>(j), "missed by the test, " + nearest_text(mode, measured, "measured")});
  }
  return result;
}

}  // namespace rigfit::ident
