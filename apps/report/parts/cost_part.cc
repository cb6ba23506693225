#include "apps/report/parts/parts.h"

#include <fmt/format.h>

#include <cmath>

#include "apps/bench/bench_study.h"

namespace rigfit::apps {

ReportPart cost_part(const std::vector<ReportPart>& parts) {
  ReportPart part;
  part.id = "solvers";
  part.title = "What the model did, and what it cost";
  ReportTable table;
  table.id = "solver-costs";
  table.caption =
      "Computations of this report. Estimated error: of frequencies for modes; of a linear answer, "
      "what the size of the motion would change; of a large motion, the drift of its energy.";
  table.columns = {{"computation", {}, false},
                   {"how", {}, false},
                   {"choice", {}, false},
                   {"time", {}, true},
                   {"estimated error", {}, true}};
  std::size_t rows = 0;
  for (const auto& one : parts) {
    for (const auto& cost : one.costs) {
      ++rows;
      table.rows.push_back({cost.what, cost.method, cost.choices, time_words(cost.wall_s),
                            std::isfinite(cost.relative_error)
                                ? fmt::format("{:.1e}", cost.relative_error)
                                : std::string("–")});
    }
  }
  if (rows == 0) return part;
  part.blocks.push_back(
      Paragraph{"Every computation chooses what to model and how, by the error that it estimates, "
                "and says what "
                "it left out. Times are of this run on this machine."});
  if (rows > 10) table.fold = fmt::format("All {} computations", rows);
  part.blocks.push_back(std::move(table));
  return part;
}

}  // namespace rigfit::apps
