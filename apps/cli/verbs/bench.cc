// rigfit bench: speed against error of every solver, on a standard set or on a scene.

#include "apps/bench/bench_study.h"
#include "apps/cli/verbs/all.h"
#include "apps/describe/json_of.h"

namespace rigfit::apps {
namespace {

struct BenchCommand {
  std::string scene;
  double duration_s = 2;
  bool quick = false;
};

void print(std::ostream& out, const BenchStudy& study) {
  out << fmt::format("{}, {} | {}\n", study.task, study.study, study.scene);
  if (!study.skipped.empty()) {
    out << fmt::format("  not done: {}\n\n", study.skipped);
    return;
  }
  out << fmt::format("  error of {}; against {}, itself good to {:.1e}\n", study.error_of,
                     study.reference, study.reference_error);
  describe::print(out, describe::table_of(study.rows));
  out << '\n';
}

Json run(BenchCommand& options, VerbContext& context) {
  const model::Scene scene =
      options.scene.empty() ? bench_released_cable() : scene_of(options.scene, context);
  const double duration_s = options.quick ? std::min(options.duration_s, 0.1) : options.duration_s;
  Json rows = Json::array();
  bool any = false;
  for (const BenchStudy& study : response_studies(scene, duration_s, options.quick)) {
    print(context.out, study);
    for (const BenchRow& row : study.rows) {
      rows.push_back(describe::json_of(study));
      rows.back().update(describe::json_of(row));
    }
    any = any || study.skipped.empty();
    if (!study.skipped.empty()) {
      context.warn("not_done", study.task + ": " + study.skipped, options.scene);
    }
    if (context.plots) context.plots->add(bench_plot(study));
  }
  if (!any) context.refuse("nothing_done", "no study can be done", options.scene);
  return {{"rows", std::move(rows)}};
}

describe::Options options_of(BenchCommand& c) {
  return {option("scene", c.scene, "Scene file (TOML); without: a released cable"),
          option("--duration", c.duration_s, "Seconds of motion").within(0.01, 1000.0),
          option("--quick", c.quick,
                 "Few repeats, coarser references, short motions: seconds instead of a minute")};
}
}  // namespace

Verb bench_verb() {
  return verb_of<BenchCommand>(
      "bench",
      "Run time against error of the solvers of a motion, against a reference whose own error is "
      "shown; one thread",
      "Examples:\n"
      "  rigfit bench --quick\n"
      "  rigfit bench testdata/scenes/cable-release.toml --plot time-error.svg",
      run, true, false, []() -> Json {
        return describe::schema_of_keys({{"rows", describe::schema_of<std::vector<BenchRow>>()}});
      });
}

}  // namespace rigfit::apps
