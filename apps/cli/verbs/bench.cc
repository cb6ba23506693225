// rigfit bench: speed against error of every solver of a motion, on the paper's released cable or
// on a scene. Each answer is compared with a reference that is better than all of them and whose
// own error is estimated.

#include <chrono>
#include <numeric>

#include "apps/cli/assets.h"
#include "apps/cli/verbs/all.h"
#include "apps/report/drawing/plot.h"
#include "model/response/response.h"
#include "model/scene/read_scene.h"
#include "signal/estimation/robust.h"

namespace rigfit::apps {
namespace {

using model::ResponseOptions;
using model::ResponseResult;
using model::ResponseSolver;

struct BenchRow {
  std::string method;
  int segments = 0;                 ///< in a member, the mean over members
  std::optional<double> step_s;     ///< largest time step
  std::optional<double> tolerance;  ///< asked of the method
  double wall_s = 0;                ///< median, one thread, from the parsed inputs to the answer
  double relative_error = 1;        ///< 1 where the method failed
  bool is_default = false;          ///< what the program does when nothing is said
  std::string note;                 ///< why it failed

  static constexpr auto fields() {
    using T = BenchRow;
    return std::tuple{
        field("task", [](const T&) { return std::string("nonlinear-response"); }),
        field("method", &T::method, "", "method", "with its setting"),
        field("segments", &T::segments, "", "segments", "of a member, on average"),
        field("step_s", &T::step_s, "s", "step", "the largest", 3),
        field("tolerance", &T::tolerance, "", "tolerance", "asked of the method", 2),
        field("wall_s", &T::wall_s, "s", "time", "median, one thread", 3),
        field("relative_error", &T::relative_error, "", "error", "1 where the method failed", 2),
        field("default", &T::is_default, "", "", "what the program does when nothing is said"),
        field("note", &T::note, "", "remark", "why it failed")};
  }
};

struct Bench {
  std::string scene;      ///< its title
  std::string error_of;   ///< whose relative error
  std::string reference;  ///< what it is compared with
  double reference_error = 0;
  std::vector<BenchRow> rows;

  static constexpr auto fields() {
    using T = Bench;
    return std::tuple{
        field("scene", &T::scene, "", "scene", "title"),
        field("error_of", &T::error_of, "", "error of", ""),
        field("reference", &T::reference, "", "against", "which the answers are compared with"),
        field("reference_error", &T::reference_error, "", "itself good to", "estimated", 2),
        field("rows", &T::rows, "", "rows", "a method and its setting each")};
  }
};

/// Time against error, a series a method; without series where nothing has a time and an error.
Plot plot_of(const Bench& bench) {
  Plot plot{"nonlinear-response",
            "Response of " + bench.scene,
            fmt::format("Time of one core, and error of {}, against {}, itself good to {:.1e}. "
                        "Further left is faster, further down is better.",
                        bench.error_of, bench.reference, bench.reference_error),
            "time, s",
            "relative error",
            true,
            true};
  auto rows = bench.rows;
  // What failed has no error of its own.
  std::erase_if(rows, [](const BenchRow& row) {
    return !(row.wall_s > 0) || !(row.relative_error > 0) || row.relative_error >= 1;
  });
  for (const auto& row : rows) {
    plot.named(row.method).style = PlotSeries::Style::line_and_points;
  }
  std::ranges::stable_sort(rows, {}, &BenchRow::wall_s);
  for (const auto& row : rows) plot.named(row.method).add(row.wall_s, row.relative_error);
  return plot;
}

/// Largest over the sensors of rms difference over rms motion; 1 when there is no answer.
double difference(const ResponseResult& found, const Eigen::MatrixXd& truth) {
  if (!found.completed || found.samples.rows() != truth.rows()) return 1;
  double worst = 0;
  for (Eigen::Index s = 0; s < truth.cols(); ++s) {
    const double motion = (truth.col(s).array() - truth.col(s).mean()).matrix().norm();
    if (!(motion > 0)) continue;
    worst = std::max(worst, (found.samples.col(s) - truth.col(s)).norm() / motion);
  }
  return std::min(worst, 1.0);
}

/// Median time of runs of `work`, s: at most `repeats`, none after `most_s` in all.
template <class Work>
double median_time(std::size_t repeats, double most_s, const Work& work) {
  std::vector<double> times;
  for (double spent = 0; times.empty() || (times.size() < repeats && spent < most_s);) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    times.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    spent += times.back();
  }
  return signal::median(std::move(times));
}

/// Integrators on the same segments, against the explicit scheme at a fraction of its step (its own
/// error: against a step one and a half times as long). Sensors of acceleration and velocity are
/// read as displacements: the accelerations of a cut string hold frequencies up to where the
/// segments end. A scene whose loads are records is refused. `quick`: few repeats, a coarser
/// reference.
Bench compared(model::Scene scene, double duration_s, bool quick) {
  if (scene.loads.empty() || scene.sensors.empty()) {
    throw Refused(scene.file + ": there is no load or no sensor, and so no motion: add them",
                  "nothing_done");
  }
  if (std::ranges::count(scene.loads, model::Load::Kind::record, &model::Load::kind) > 0) {
    throw Refused(scene.file + ": a load is a recording, which is not simulated here: replace it",
                  "nothing_done");
  }
  for (auto& sensor : scene.sensors) {
    if (sensor.quantity == model::Sensor::Quantity::force) continue;
    sensor.quantity = model::Sensor::Quantity::displacement;
  }
  const auto simulate = [&](const ResponseOptions& options) {
    return model::simulate_response(scene, options);
  };
  ResponseOptions base;
  base.sampling = {.duration_s = duration_s, .rate_hz = 2000};
  const ResponseResult own = simulate(base);
  if (!own.completed) throw NotConverged("the response fails: " + own.reason);
  // The same segments for all, whatever the scene left open.
  for (std::size_t m = 0; m < scene.members.size(); ++m) {
    scene.members[m].segments = own.segments[m];
  }
  ResponseOptions fine = base;
  fine.solver = ResponseSolver::explicit_motion;
  fine.axial = true;
  const ResponseResult natural = simulate(fine);
  // As fine as a part of the time allows.
  int parts = 12;
  while (parts > 3 && (1 + 2.0 / 3) * parts * natural.wall_s > (quick ? 0.3 : 5)) parts /= 2;
  ResponseOptions coarser = fine;
  coarser.step_s = 1.5 * natural.step_s / parts;
  fine.step_s = natural.step_s / parts;
  const ResponseResult check = simulate(coarser), truth = simulate(fine);
  if (!truth.completed || !check.completed) {
    throw NotConverged("the reference fails: " + truth.reason + check.reason);
  }
  Bench bench{
      scene.title,
      fmt::format("{:g} s of the sensors' motion at {:g} Hz, rms", duration_s,
                  base.sampling.rate_hz),
      fmt::format("{} scheme, steps of {:.2g} ms", name_of(fine.solver), 1e3 * *fine.step_s),
      difference(check, truth.samples),
      {}};
  const auto add = [&](std::string method, const ResponseOptions& options) {
    const ResponseResult found = simulate(options);
    if (found.impossible) return;
    BenchRow& row = bench.rows.emplace_back();
    row.method = std::move(method);
    const double segments = std::accumulate(found.segments.begin(), found.segments.end(), 0.0);
    row.segments = static_cast<int>(
        std::lround(segments / std::max(1.0, static_cast<double>(found.segments.size()))));
    if (found.step_s > 0) row.step_s = found.step_s;
    if (options.solver == ResponseSolver::stiff_motion) row.tolerance = options.relative_tolerance;
    row.relative_error = difference(found, truth.samples);
    if (!found.completed) row.note = found.reason;
    row.wall_s = median_time(quick ? 7 : 15, quick ? 0.01 : 0.2, [&] { (void)simulate(options); });
  };
  add(std::string("default: ") + name_of(own.solver), base);
  bench.rows.front().is_default = true;
  ResponseOptions options = base;
  options.solver = ResponseSolver::modal;
  add("modal recurrence (linear)", options);
  for (const double part : {1.0, 1.5, 2.0, 3.0}) {
    fine.step_s = natural.step_s / part;
    add(name_of(fine.solver), fine);
  }
  options.solver = ResponseSolver::explicit_motion;
  options.axial = false;
  add("explicit, axial waves slowed", options);
  options = base;
  options.solver = ResponseSolver::stiff_motion;
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    options.relative_tolerance = tolerance;
    add("stiff (SUNDIALS IDA)", options);
    if (quick) break;
  }
  return bench;
}

/// The paper's cable at 200 N, 1 kg hung at its quarter span and cut at t = 0; 30 segments.
model::Scene released_cable() {
  model::Scene scene = model::parse_scene(assets::new_cable_toml, "cable.toml");
  scene.title += ", 1 kg released at the quarter span";
  scene.members[0].segments = 30;
  model::Load release;
  release.name = "string";
  release.kind = model::Load::Kind::release;
  release.place.member = scene.members[0].name;
  release.place.position = 0.25;
  release.mass = 1;
  scene.loads = {release};
  return scene;
}

struct BenchCommand {
  std::string scene;
  double duration_s = 2;
  bool quick = false;
};

Json run(BenchCommand& options, VerbContext& context) {
  const double duration_s = options.quick ? std::min(options.duration_s, 0.1) : options.duration_s;
  const Bench bench =
      compared(options.scene.empty() ? released_cable() : scene_of(options.scene, context),
               duration_s, options.quick);
  describe::print(context.out, describe::sheet_of(bench));
  if (context.plots) context.plots->add(plot_of(bench));
  return describe::json_of(bench);
}

describe::Options options_of(BenchCommand& c) {
  return {option("scene", c.scene, "Scene file (TOML); without: a released cable"),
          option("--duration", c.duration_s, "Seconds of motion").within(0.01, 1000.0),
          option("--quick", c.quick,
                 "Few repeats, a coarser reference, a short motion: seconds instead of ten")};
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
      run, true, false, describe::schema_of<Bench>);
}

}  // namespace rigfit::apps
