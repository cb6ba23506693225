#include "apps/stiffness_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/exit_code.h"

namespace rigfit::apps {

double stiffness_at(const ResultTable& table, double tension, VerbContext& context) {
  const auto T = table.column("tension_N"), EI = table.column("EI_Nm2");
  std::vector<std::pair<double, double>> points;
  for (const auto& row : table.rows) {
    if (std::isfinite(row[T]) && std::isfinite(row[EI])) points.emplace_back(row[T], row[EI]);
  }
  if (points.empty()) throw Refused(table.file + " holds no EI over tension");
  std::sort(points.begin(), points.end());
  if (tension < points.front().first || tension > points.back().first) {
    context.warn("extrapolated",
                 fmt::format("EI at {:.4g} N is taken from the nearest test", tension), table.file);
  }
  if (tension <= points.front().first) return points.front().second;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (tension > points[i].first) continue;
    const double share = (tension - points[i - 1].first) / (points[i].first - points[i - 1].first);
    return points[i - 1].second + share * (points[i].second - points[i - 1].second);
  }
  return points.back().second;
}

}  // namespace rigfit::apps
