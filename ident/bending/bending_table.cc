#include <algorithm>
#include <cmath>
#include <numeric>

#include "ident/bending/bending_analysis.h"

namespace rigfit::ident {

std::vector<BendingRecord> split_by_tension(const BendingRecord& table) {
  const Eigen::Index n = table.tension_N.size();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return table.tension_N[a] < table.tension_N[b];  // NaN never compares; such rows stay together
  });
  std::vector<std::vector<Eigen::Index>> clusters;
  for (Eigen::Index index : order) {
    const double P = table.tension_N[index];
    if (!std::isfinite(P)) continue;
    bool apart = clusters.empty();
    if (!apart) {
      const double low = table.tension_N[clusters.back().front()];
      const double high = table.tension_N[clusters.back().back()];
      apart = P - high > 0.05 * std::abs(P) && P - high > high - low;
    }
    if (apart) clusters.emplace_back();
    clusters.back().push_back(index);
  }
  std::vector<BendingRecord> records;
  for (auto& cluster : clusters) {
    std::sort(cluster.begin(), cluster.end());
    BendingRecord record;
    const auto size = static_cast<Eigen::Index>(cluster.size());
    record.tension_N.resize(size), record.load_N.resize(size), record.deflection_m.resize(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      const Eigen::Index row = cluster[static_cast<std::size_t>(i)];
      record.tension_N[i] = table.tension_N[row];
      record.load_N[i] = table.load_N[row];
      record.deflection_m[i] = table.deflection_m[row];
    }
    records.push_back(std::move(record));
  }
  return records;
}

}  // namespace rigfit::ident
