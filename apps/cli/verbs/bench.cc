// rigfit bench: speed against error of every solver, on a standard set or on a scene. A study
// solves one task by several methods and settings and compares each answer with a reference that is
// better than all of them and whose own error is estimated.

#include <chrono>
#include <numeric>

#include "apps/cli/assets.h"
#include "apps/cli/verbs/all.h"
#include "apps/report/drawing/plot.h"
#include "document/describe.h"
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
  /// Segments in a member, the mean over members; 0: none in this task.
  int segments = 0;
  std::optional<double> step_s;     ///< largest time step
  std::optional<double> tolerance;  ///< asked of the method
  double wall_s = 0;                ///< median, one thread, from the parsed inputs to the answer
  double relative_error = 1;        ///< 1 where the method failed
  bool is_default = false;          ///< what the program does when nothing is said
  std::string note;                 ///< why it failed

  static constexpr auto fields() {
    using T = BenchRow;
    return std::tuple{
        field("method", &T::method, "", "method", "with its setting"),
        field("segments", describe::positive(&T::segments), "", "segments",
              "of a member, on average"),
        field("step_s", &T::step_s, "s", "step", "the largest", 3),
        field("tolerance", &T::tolerance, "", "tolerance", "asked of the method", 2),
        field("wall_s", &T::wall_s, "s", "time", "median, one thread", 3),
        field("relative_error", &T::relative_error, "", "error", "1 where the method failed", 2),
        field("default", &T::is_default, "", "", "what the program does when nothing is said"),
        field("note", &T::note, "", "remark", "why it failed")};
  }
};

struct BenchStudy {
  std::string task = "nonlinear-response";
  std::string study;      ///< what varies: "steps", "segments"
  std::string scene;      ///< title of the scene
  std::string error_of;   ///< whose relative error
  std::string reference;  ///< what it is compared with
  double reference_error = 0;
  std::vector<BenchRow> rows;

  static constexpr auto fields() {
    using T = BenchStudy;
    return std::tuple{
        field("task", &T::task),           field("study", &T::study),
        field("scene", &T::scene),         field("error_of", &T::error_of),
        field("reference", &T::reference), field("reference_error", &T::reference_error)};
  }
};

/// Time against error, a series a method; without series where nothing of the study has a time and
/// an error.
Plot plot_of(const BenchStudy& study) {
  Plot plot;
  plot.id = study.task + "-" + study.study;
  plot.title = study.task + ", by " + study.study;
  plot.caption = fmt::format(
      "{}: time of one core, and error of {}, against {}, itself good to {:.1e}. Further left is "
      "faster, further down is better.",
      study.scene, study.error_of, study.reference, study.reference_error);
  plot.x_label = "time, s";
  plot.y_label = "relative error";
  plot.log_x = plot.log_y = true;
  auto rows = study.rows;
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

int mean_segments(const std::vector<int>& by_member) {
  const double sum = std::accumulate(by_member.begin(), by_member.end(), 0.0);
  return static_cast<int>(std::lround(sum / std::max(1.0, double(by_member.size()))));
}

/// Large motions: "steps" compares integrators on the same segments with the explicit scheme at a
/// fraction of its step (its own error: against a step one and a half times as long);
/// "segments" compares numbers of segments with many (own error: against two thirds as many).
/// Sensors of acceleration and velocity are read as displacements: the accelerations of a cut
/// string hold frequencies up to where the segments end. A scene whose loads are records is
/// refused. `quick`: few repeats, coarser references.
class Studies {
 public:
  Studies(model::Scene scene, double duration_s, bool quick)
      : scene_(std::move(scene)), quick_(quick) {
    base_.sampling = {.duration_s = duration_s, .rate_hz = 2000};
    for (auto& sensor : scene_.sensors) {
      if (sensor.quantity != model::Sensor::Quantity::force) {
        sensor.quantity = model::Sensor::Quantity::displacement;
      }
    }
  }

  std::vector<BenchStudy> run() {
    if (scene_.loads.empty() || scene_.sensors.empty()) {
      throw Refused(scene_.file + ": there is no load or no sensor, and so no motion: add them",
                    "nothing_done");
    }
    if (std::ranges::count(scene_.loads, model::Load::Kind::record, &model::Load::kind) > 0) {
      throw Refused(
          scene_.file + ": a load is a recording, which is not simulated here: replace it",
          "nothing_done");
    }
    own_ = simulate(base_);
    if (!own_.completed) throw NotConverged("the response fails: " + own_.reason);
    return {steps_study(), segments_study()};
  }

 private:
  BenchStudy started(const char* varied) const {
    BenchStudy study;
    study.study = varied;
    study.scene = scene_.title;
    study.error_of = fmt::format("{:g} s of the sensors' motion at {:g} Hz, rms",
                                 base_.sampling.duration_s, base_.sampling.rate_hz);
    return study;
  }

  ResponseResult simulate(const ResponseOptions& options) const {
    return model::simulate_response(scene_, options);
  }

  /// The answer that a study compares with.
  Eigen::MatrixXd reference(BenchStudy& study, const ResponseOptions& coarser,
                            const ResponseOptions& finest, std::string name) const {
    const ResponseResult check = simulate(coarser), truth = simulate(finest);
    if (!truth.completed || !check.completed) {
      throw NotConverged("the reference fails: " + truth.reason + check.reason);
    }
    study.reference = std::move(name);
    study.reference_error = difference(check, truth.samples);
    return truth.samples;
  }

  void add(BenchStudy& study, const Eigen::MatrixXd& truth, std::string method,
           const ResponseOptions& options, bool is_default = false) const {
    const ResponseResult found = simulate(options);
    if (found.impossible) return;
    BenchRow row;
    row.method = std::move(method);
    row.segments = mean_segments(found.segments);
    if (study.study == "steps" && found.step_s > 0) row.step_s = found.step_s;
    if (options.solver == ResponseSolver::stiff_motion) row.tolerance = options.relative_tolerance;
    row.is_default = is_default;
    row.relative_error = difference(found, truth);
    if (!found.completed) row.note = found.reason;
    row.wall_s =
        median_time(quick_ ? 7 : 15, quick_ ? 0.01 : 0.2, [&] { (void)simulate(options); });
    study.rows.push_back(std::move(row));
  }

  BenchStudy steps_study() {
    BenchStudy study = started("steps");
    // The same segments for all, whatever the scene left open.
    for (std::size_t m = 0; m < scene_.members.size(); ++m) {
      scene_.members[m].segments = own_.segments[m];
    }
    ResponseOptions fine = base_;
    fine.solver = ResponseSolver::explicit_motion;
    fine.axial = true;
    const ResponseResult natural = simulate(fine);
    // As fine as a part of the time allows.
    int parts = 12;
    while (parts > 3 && (1 + 2.0 / 3) * parts * natural.wall_s > (quick_ ? 0.3 : 5)) parts /= 2;
    ResponseOptions coarser = fine;
    coarser.step_s = 1.5 * natural.step_s / parts;
    fine.step_s = natural.step_s / parts;
    const auto truth = reference(
        study, coarser, fine,
        fmt::format("{} scheme, steps of {:.2g} ms", name_of(fine.solver), 1e3 * *fine.step_s));
    add(study, truth, std::string("default: ") + name_of(own_.solver), base_, true);
    ResponseOptions options = base_;
    options.solver = ResponseSolver::modal;
    add(study, truth, "modal recurrence (linear)", options);
    for (const double part : {1.0, 1.5, 2.0, 3.0}) {
      fine.step_s = natural.step_s / part;
      add(study, truth, name_of(fine.solver), fine);
    }
    options.solver = ResponseSolver::explicit_motion;
    options.axial = false;
    add(study, truth, "explicit, axial waves slowed", options);
    options = base_;
    options.solver = ResponseSolver::stiff_motion;
    for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
      options.relative_tolerance = tolerance;
      add(study, truth, "stiff (SUNDIALS IDA)", options);
      if (quick_) break;
    }
    return study;
  }

  BenchStudy segments_study() {
    BenchStudy study = started("segments");
    for (auto& member : scene_.members) member.segments = 0;  // "auto"
    // Finer than what is compared, "auto" too.
    const int fine =
        quick_ ? 120 : std::clamp(2 * mean_segments(simulate(base_).segments), 240, 600);
    ResponseOptions options = base_, finest = base_;
    options.solver = finest.solver = own_.solver;
    options.segments = 2 * fine / 3;
    finest.segments = fine;
    const auto truth =
        reference(study, options, finest,
                  fmt::format("{} segments a member, {}", fine, name_of(own_.solver)));
    for (const int n : {8, 15, 30, 60, 120}) {
      if (n >= fine) continue;
      options.segments = n;
      add(study, truth, name_of(own_.solver), options);
    }
    add(study, truth, "segments = \"auto\"", base_, true);
    return study;
  }

  model::Scene scene_;
  bool quick_;
  ResponseOptions base_;
  ResponseResult own_;
};

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

void print(std::ostream& out, const BenchStudy& study) {
  out << fmt::format("{}, {} | {}\n", study.task, study.study, study.scene);
  out << fmt::format("  error of {}; against {}, itself good to {:.1e}\n", study.error_of,
                     study.reference, study.reference_error);
  describe::print(out, describe::table_of(study.rows));
  out << '\n';
}

Json run(BenchCommand& options, VerbContext& context) {
  const model::Scene scene =
      options.scene.empty() ? released_cable() : scene_of(options.scene, context);
  const double duration_s = options.quick ? std::min(options.duration_s, 0.1) : options.duration_s;
  Json rows = Json::array();
  for (const BenchStudy& study : Studies(scene, duration_s, options.quick).run()) {
    print(context.out, study);
    for (const BenchRow& row : study.rows) {
      rows.push_back(describe::json_of(study));
      rows.back().update(describe::json_of(row));
    }
    if (context.plots) context.plots->add(plot_of(study));
  }
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
