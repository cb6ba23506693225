#include "apps/campaign_file/stiffness_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "apps/cli/exit_code.h"
#include "model/scene/scene_error.h"

namespace rigfit::apps {

ResultTable read_stiffness_table(const std::filesystem::path& path) {
  if (path.extension() != ".json") return read_result_table(path);
  std::ifstream file(path, std::ios::binary);
  const auto document = nlohmann::json::parse(file, nullptr, false);
  ResultTable table;
  table.file = path.string();
  table.columns = {"tension_N", "EI_Nm2", "std"};
  const auto number = [](const nlohmann::json& from, const char* key) {
    return from.is_object() && from.contains(key) && from[key].is_number()
               ? from[key].get<double>()
               : std::numeric_limits<double>::quiet_NaN();
  };
  if (document.is_object() && document.contains("tests") && document["tests"].is_array()) {
    for (const auto& test : document["tests"]) {
      if (!test.is_object() || !test.contains("EI_Nm2")) continue;
      const auto& EI = test["EI_Nm2"];
      table.rows.push_back({number(test, "tension_N"), number(EI, "value"), number(EI, "std")});
      table.lines.push_back(0);
    }
  }
  if (table.rows.empty()) {
    throw model::SceneError({table.file, 0, 0, "tests"}, "is no result of a bending test",
                            "give what rigfit bending ... --json FILE wrote, or a table");
  }
  return table;
}

std::vector<StiffnessPoint> stiffness_points(const ResultTable& table) {
  const auto T = table.column("tension_N"), EI = table.column("EI_Nm2");
  const auto std = std::find(table.columns.begin(), table.columns.end(), "std");
  std::vector<StiffnessPoint> points;
  for (std::size_t k = 0; k < table.rows.size(); ++k) {
    const auto& row = table.rows[k];
    if (!std::isfinite(row[T]) || !std::isfinite(row[EI])) continue;
    if (row[T] < 0 || row[EI] <= 0) {
      throw model::SceneError({table.file, table.lines[k], 0, row[T] < 0 ? "tension_N" : "EI_Nm2"},
                              "is not positive", "mend or remove the row");
    }
    points.push_back({row[T], row[EI],
                      std == table.columns.end()
                          ? std::numeric_limits<double>::quiet_NaN()
                          : row[static_cast<std::size_t>(std - table.columns.begin())]});
  }
  std::sort(points.begin(), points.end(),
            [](const auto& a, const auto& b) { return a.tension_N < b.tension_N; });
  return points;
}

StiffnessShare stiffness_share(const std::vector<StiffnessPoint>& points, double tension) {
  if (tension <= points.front().tension_N) return {};
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (tension > points[i].tension_N) continue;
    const double width = points[i].tension_N - points[i - 1].tension_N;
    return {i - 1, i, (tension - points[i - 1].tension_N) / width,
            (points[i].EI_Nm2 - points[i - 1].EI_Nm2) / width};
  }
  return {points.size() - 1, points.size() - 1, 0, 0};
}

double stiffness_at(const ResultTable& table, double tension, VerbContext& context) {
  const auto points = stiffness_points(table);
  if (points.empty()) throw Refused(table.file + " holds no EI over tension");
  if (tension < points.front().tension_N || tension > points.back().tension_N) {
    context.warn("extrapolated",
                 fmt::format("EI at {:.4g} N is taken from the nearest test", tension), table.file);
  }
  const StiffnessShare at = stiffness_share(points, tension);
  return (1 - at.share) * points[at.first].EI_Nm2 + at.share * points[at.second].EI_Nm2;
}

}  // namespace rigfit::apps
