// rigfit bench: speed against error of every solver, on a standard set or on a scene.
#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "apps/bench/bench_plot.h"
#include "apps/bench/bench_study.h"
#include "apps/bench/response_studies.h"
#include "apps/cli/plots/plot_option.h"
#include "apps/cli/verbs/all.h"
#include "apps/describe/sheet.h"
#include "model/scene/read_scene.h"

namespace rigfit::apps {
namespace {

struct BenchCommand {
  std::string scene;
  std::vector<std::string> tasks;
  double duration_s = 2;
  bool quick = false;
};

std::string name_of(const BenchStudy& study) {
  return study.study.empty() ? study.task : study.task + ", " + study.study;
}

void print(std::ostream& out, const BenchStudy& study) {
  out << fmt::format("{} | {}\n", name_of(study), study.scene);
  if (!study.skipped.empty()) {
    out << fmt::format("  not done: {}\n\n", study.skipped);
    return;
  }
  out << fmt::format("  error of {}; against {}", study.error_of, study.reference);
  out << (study.reference_error > 0
              ? fmt::format(", itself good to {:.1e}\n", study.reference_error)
              : std::string("\n"));
  describe::print(out, describe::table_of(study.rows));
  for (const BenchRow& row : study.rows) {
    if (!row.note.empty()) {
      out << fmt::format("  {}{}: {}\n", row.is_default ? "default not on the front: " : "",
                         row.method, row.note);
    }
  }
  out << '\n';
}

Json row_json(const BenchStudy& study, const BenchRow& row) {
  Json out{{"task", study.task}, {"study", study.study}, {"scene", study.scene}};
  out.update(describe::json_of(row));
  out["reference_error"] = study.reference_error;
  return out;
}

Json run(BenchCommand& options, VerbContext& context) {
  std::optional<model::Scene> scene;
  if (!options.scene.empty()) {
    context.input(options.scene);
    scene = model::read_scene(options.scene);
  }
  BenchBudget budget;
  budget.quick = options.quick;
  if (options.quick) budget.repeats = 7, budget.row_s = 0.01;
  const double duration_s = options.quick ? std::min(options.duration_s, 0.1) : options.duration_s;
  Json result;
  result["rows"] = Json::array();
  result["studies"] = Json::array();
  const std::vector<BenchStudy> studies =
      response_studies(scene ? *scene : bench_released_cable(), duration_s, budget);
  bool any = false;
  for (const BenchStudy& study : studies) {
    print(context.out, study);
    std::size_t front = 0;
    for (const BenchRow& row : study.rows) {
      result["rows"].push_back(row_json(study, row));
      front += row.on_front;
    }
    Json about{{"task", study.task}, {"study", study.study}, {"scene", study.scene}};
    if (study.skipped.empty()) {
      any = true;
      about["error_of"] = study.error_of;
      about["reference"] = study.reference;
      about["reference_error"] = study.reference_error;
      about["rows"] = study.rows.size();
      about["on_front"] = front;
    } else {
      about["skipped"] = study.skipped;
      context.warn("not_done", study.task + ": " + study.skipped, options.scene);
    }
    result["studies"].push_back(std::move(about));
    if (context.plots) {
      Plot plot = bench_plot(study);
      if (!plot.series.empty()) context.plots->add(Block(std::move(plot)));
    }
  }
  if (!any) context.refuse("nothing_done", "no study can be done", options.scene);
  return result;
}

describe::Options options_of(BenchCommand& c) {
  using describe::option;
  return {option("scene", c.scene, "Scene file (TOML); without: a released cable").type("SCENE"),
          option("--task", c.tasks, "Only these").type("TASK").one_of({"nonlinear-response"}),
          option("--duration", c.duration_s, "Seconds of motion").type("S").within(0.01, 1000.0),
          option("--quick", c.quick,
                 "Few repeats, coarser references, short motions: seconds instead of a minute")};
}
}  // namespace

Verb bench_verb() {
  return verb_of<BenchCommand>(
      "bench",
      "Run time against error of the solvers of a motion, against a reference whose own error is "
      "shown; one thread",
      "\"front\": no other row is as fast and as accurate.\n"
      "Examples:\n"
      "  rigfit bench --quick\n"
      "  rigfit bench testdata/scenes/cable-release.toml --plot time-error.svg",
      run, true);
}

}  // namespace rigfit::apps
