// rigfit bench: speed against error of every solver, on a standard set or on a scene.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <memory>

#include "apps/bench/bench_plot.h"
#include "apps/bench/bench_scenes.h"
#include "apps/bench/bench_study.h"
#include "apps/bench/ident_studies.h"
#include "apps/bench/model_studies.h"
#include "apps/bench/response_studies.h"
#include "apps/bench/signal_studies.h"
#include "apps/bench/size_study.h"
#include "apps/cli/output_file.h"
#include "apps/cli/plots/plot_option.h"
#include "apps/cli/progress.h"
#include "apps/cli/verbs/all.h"
#include "model/scene/read_scene.h"

namespace rigfit::apps {
namespace {

struct BenchCommand {
  std::string scene, out;
  std::vector<std::string> tasks;
  double duration_s = 2;
  bool quick = false, size = false;
};

/// In the order of the table; those of the model run on a scene that is given.
const std::vector<std::string> kTasks{
    "statics", "modes",   "linear-response", "nonlinear-response", "frf-synthesis", "decay", "frf",
    "poles",   "bending", "update"};
constexpr std::size_t kModelTasks = 5;

std::vector<BenchStudy> studies_of(const std::string& task, const model::Scene* scene,
                                   const BenchCommand& options, std::uint64_t seed) {
  BenchBudget budget;
  budget.quick = options.quick;
  if (options.quick) budget.repeats = 7, budget.row_s = 0.01;
  ResponseStudyOptions response;
  response.duration_s = options.quick ? std::min(options.duration_s, 0.1) : options.duration_s;
  const auto on_scenes = [&](BenchStudy (*study)(const model::Scene&, const BenchBudget&)) {
    std::vector<BenchStudy> out;
    if (scene) {
      out.push_back(study(*scene, budget));
    } else {
      out.push_back(study(bench_cable(), budget));
      if (!options.quick) out.push_back(study(bench_rig(), budget));
    }
    return out;
  };
  if (task == "statics") return on_scenes(statics_study);
  if (task == "modes") return on_scenes(modes_study);
  if (task == "frf-synthesis") return on_scenes(frf_synthesis_study);
  if (task == "linear-response") {
    return linear_response_studies(scene ? *scene : bench_cable(), response, budget);
  }
  if (task == "nonlinear-response") {
    return nonlinear_response_studies(scene ? *scene : bench_released_cable(), response, budget);
  }
  if (task == "decay") return {decay_study(seed, budget)};
  if (task == "frf") return {frf_study(seed, budget)};
  if (task == "poles") return {poles_study(seed, budget)};
  if (task == "bending") return {bending_study(budget)};
  return {update_study(budget)};
}

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
  bool steps = false, tolerances = false, orders = false, segments = false, bounds = false;
  std::size_t width = 6;
  for (const BenchRow& row : study.rows) {
    steps = steps || row.step_s;
    tolerances = tolerances || row.tolerance;
    orders = orders || row.order;
    segments = segments || row.segments > 0;
    bounds = bounds || row.bound;
    width = std::max(width, row.method.size());
  }
  const auto cell = [&](bool shown, const std::string& text) {
    if (shown) out << fmt::format(" {:>9}", text);
  };
  out << fmt::format("  {:<5} {:<{}}", "", "method", width);
  cell(orders, "number");
  cell(segments, "segments");
  cell(steps, "step, ms");
  cell(tolerances, "tolerance");
  out << fmt::format(" {:>9} {:>9}", "time", "error");
  cell(bounds, "bound");
  out << '\n';
  for (const BenchRow& row : study.rows) {
    out << fmt::format("  {:<5} {:<{}}", std::string(row.on_front ? "front" : ""), row.method,
                       width);
    cell(orders, row.order ? std::to_string(*row.order) : "");
    cell(segments, row.segments > 0 ? std::to_string(row.segments) : "");
    cell(steps, row.step_s ? fmt::format("{:.3g}", 1e3 * *row.step_s) : "");
    cell(tolerances, row.tolerance ? fmt::format("{:.0e}", *row.tolerance) : "");
    // µ is two bytes of one column.
    const std::string time = time_words(row.wall_s);
    out << fmt::format(" {:>{}}", time, time.find("µ") == std::string::npos ? 9 : 10);
    out << fmt::format(" {:>8.1e}{}", row.relative_error,
                       row.relative_error < study.reference_error ? '~' : ' ');
    cell(bounds, row.bound ? fmt::format("{:.1e}", *row.bound) : "");
    out << (row.is_default ? "  default\n" : "\n");
  }
  for (const BenchRow& row : study.rows) {
    if (!row.note.empty()) {
      out << fmt::format("  {}{}: {}\n", row.is_default ? "default not on the front: " : "",
                         row.method, row.note);
    }
  }
  if (!study.beside.empty()) out << fmt::format("  {}\n", study.beside);
  out << '\n';
}

Json row_json(const BenchStudy& study, const BenchRow& row) {
  Json out{{"task", study.task}};
  if (!study.study.empty()) out["study"] = study.study;
  out["scene"] = study.scene;
  out["method"] = row.method;
  out["segments"] = row.segments;
  if (row.step_s) out["step_s"] = *row.step_s;
  if (row.tolerance) out["tolerance"] = *row.tolerance;
  if (row.order) out["order"] = *row.order;
  out["wall_s"] = row.wall_s;
  out["relative_error"] = row.relative_error;
  out["reference_error"] = study.reference_error;
  if (row.bound) out["bound"] = *row.bound;
  out["default"] = row.is_default;
  out["on_front"] = row.on_front;
  if (!row.note.empty()) out["note"] = row.note;
  return out;
}

std::string rows_csv(const std::vector<BenchStudy>& studies) {
  const auto quoted = [](const std::string& text) {
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
  };
  const auto maybe = [](const auto& value) {
    return value ? fmt::format("{:.6g}", double(*value)) : std::string();
  };
  std::string text =
      "task,study,scene,method,segments,step_s,tolerance,order,wall_s,relative_error,"
      "reference_error,default,on_front\n";
  for (const auto& study : studies) {
    for (const auto& row : study.rows) {
      text += fmt::format("{},{},{},{},{},{},{},{},{:.6g},{:.6g},{:.6g},{:d},{:d}\n", study.task,
                          study.study, quoted(study.scene), quoted(row.method), row.segments,
                          maybe(row.step_s), maybe(row.tolerance), maybe(row.order), row.wall_s,
                          row.relative_error, study.reference_error, row.is_default, row.on_front);
    }
  }
  return text;
}

std::string bytes_words(double bytes) {
  return bytes < 9.995e5   ? fmt::format("{:.3g} kB", 1e-3 * bytes)
         : bytes < 9.995e8 ? fmt::format("{:.3g} MB", 1e-6 * bytes)
                           : fmt::format("{:.3g} GB", 1e-9 * bytes);
}

void print(std::ostream& out, const SizeSeries& series) {
  out << fmt::format("{}\n  {:>14} {:>10} {:>10}\n", series.method, series.size_of, "time",
                     "memory");
  for (const SizeRow& row : series.rows) {
    const std::string time = time_words(row.wall_s);
    out << fmt::format("  {:>14g} {:>{}} {:>10}\n", row.size, time,
                       time.find("µ") == std::string::npos ? 10 : 11,
                       row.peak_bytes ? bytes_words(*row.peak_bytes) : "");
  }
  const auto slope = [](const std::optional<double>& value) {
    return value ? fmt::format("{:.2f}", *value) : std::string("-");
  };
  out << fmt::format("  slope of the last three: time {}, memory {}\n", slope(series.time_slope),
                     slope(series.memory_slope));
  if (!series.stopped.empty()) out << fmt::format("  stopped {}\n", series.stopped);
  out << '\n';
}

/// Rows as those of the other studies, and the slopes.
Json run_sizes(VerbContext& context, const BenchCommand& options) {
  if (!options.scene.empty()) throw UsageError("--size has its own data: leave SCENE out");
  for (const std::string& task : options.tasks) {
    const auto& known = size_tasks();
    if (std::find(known.begin(), known.end(), task) == known.end()) {
      throw UsageError("--size --task takes " + fmt::format("{}", fmt::join(known, ", ")));
    }
  }
  SizeLimits limits;
  if (options.quick) limits = {.seconds = 0.1, .memory_share = 0.05, .largest_share = 0.03};
  Json result;
  result["rows"] = Json::array();
  result["studies"] = Json::array();
  std::string csv = "task,method,size_of,size,wall_s,peak_bytes\n";
  run_size_study(limits, options.tasks, [&](const SizeSeries& series) {
    print(context.out, series);
    context.out.flush();
    for (const SizeRow& row : series.rows) {
      Json one{{"task", series.task},
               {"method", series.method},
               {"segments", series.size_of == "segments" ? row.size : 0.0},
               {"size_of", series.size_of},
               {"size", row.size},
               {"wall_s", row.wall_s}};
      if (row.peak_bytes) one["peak_bytes"] = *row.peak_bytes;
      result["rows"].push_back(std::move(one));
      csv += fmt::format("{},\"{}\",{},{:g},{:.6g},{}\n", series.task, series.method,
                         series.size_of, row.size, row.wall_s,
                         row.peak_bytes ? fmt::format("{:.0f}", *row.peak_bytes) : "");
    }
    Json about{{"task", series.task}, {"method", series.method}, {"size_of", series.size_of}};
    if (series.time_slope) about["time_slope"] = *series.time_slope;
    if (series.memory_slope) about["memory_slope"] = *series.memory_slope;
    if (!series.stopped.empty()) about["stopped"] = series.stopped;
    result["studies"].push_back(std::move(about));
  });
  if (!options.out.empty()) {
    write_whole_file(options.out, csv);
    result["out"] = options.out;
  }
  return result;
}

Json run_bench(VerbContext& context, const BenchCommand& options) {
  if (options.size) return run_sizes(context, options);
  for (const std::string& task : options.tasks) {
    if (std::find(kTasks.begin(), kTasks.end(), task) == kTasks.end()) {
      throw UsageError("--task " + task + " belongs to --size");
    }
  }
  std::optional<model::Scene> scene;
  std::vector<std::string> tasks = options.tasks;
  if (!options.scene.empty()) {
    context.input(options.scene);
    scene = model::read_scene(options.scene);
    for (const std::string& task : tasks) {
      const auto place = std::find(kTasks.begin(), kTasks.end(), task) - kTasks.begin();
      if (place >= static_cast<long>(kModelTasks)) {
        throw UsageError("--task " + task + " has its own data: leave SCENE out");
      }
    }
  }
  if (tasks.empty()) {
    tasks.assign(kTasks.begin(), scene ? kTasks.begin() + kModelTasks : kTasks.end());
  }
  Json result;
  result["rows"] = Json::array();
  result["studies"] = Json::array();
  std::vector<BenchStudy> studies;
  Progress progress("bench", static_cast<long>(tasks.size()), context.quiet);
  for (const std::string& task : tasks) {
    for (BenchStudy& study : studies_of(task, scene ? &*scene : nullptr, options, context.seed)) {
      print(context.out, study);
      context.out.flush();
      std::size_t front = 0;
      for (const BenchRow& row : study.rows) {
        result["rows"].push_back(row_json(study, row));
        front += row.on_front;
      }
      Json about{{"task", study.task}};
      if (!study.study.empty()) about["study"] = study.study;
      about["scene"] = study.scene;
      if (study.skipped.empty()) {
        about["error_of"] = study.error_of;
        about["reference"] = study.reference;
        about["reference_error"] = study.reference_error;
        if (!study.reference_values.empty()) about["reference_values"] = study.reference_values;
        about["rows"] = study.rows.size();
        about["on_front"] = front;
        if (!study.beside.empty()) about["beside"] = study.beside;
      } else {
        about["skipped"] = study.skipped;
        context.warn("not_done", study.task + ": " + study.skipped, options.scene);
      }
      result["studies"].push_back(std::move(about));
      if (context.plots) {
        Plot plot = bench_plot(study);
        if (!plot.series.empty()) context.plots->add(Block(std::move(plot)));
      }
      studies.push_back(std::move(study));
    }
    progress.advance();
  }
  if (!options.out.empty()) {
    write_whole_file(options.out, rows_csv(studies));
    result["out"] = options.out;
  }
  const bool any = std::any_of(studies.begin(), studies.end(),
                               [](const BenchStudy& study) { return study.skipped.empty(); });
  if (!any) context.refuse("nothing_done", "none of the tasks can be done", options.scene);
  return result;
}

describe::Options options_of(BenchCommand& c) {
  using describe::option;
  std::vector<std::string> all_tasks = kTasks;
  all_tasks.insert(all_tasks.end(), size_tasks().begin(), size_tasks().end());
  return {option("scene", c.scene, "Scene file (TOML); without: a standard set").type("SCENE"),
          option("--task", c.tasks, "Only these").type("TASK").one_of(all_tasks),
          option("--duration", c.duration_s, "Seconds of motion in the response tasks")
              .type("S")
              .within(0.01, 1000.0),
          option("--quick", c.quick,
                 "Few repeats, coarser references, short motions: seconds instead of a minute"),
          option("--size", c.size,
                 "Cost against size instead: segments, poles, channels, samples, files (minutes)"),
          option("--out", c.out, "The rows as CSV").type("F.csv")};
}
}  // namespace

Verb bench_verb() {
  Verb verb = verb_of<BenchCommand>(
      "bench",
      "Speed against error: every solver and estimator, its settings and its rivals, against "
      "references whose own error is shown; one thread",
      "\"front\": no other row is as fast and as accurate; \"~\": below the reference's own "
      "error.\n"
      "Examples:\n"
      "  rigfit bench --quick --task modes bending\n"
      "  rigfit bench testdata/jalali2021/scenes/rig.toml --task modes --json bench.json\n"
      "  rigfit bench --task nonlinear-response --plot time-error.svg\n"
      "  rigfit bench --size --task poles",
      [](const BenchCommand& c, VerbContext& context) { return run_bench(context, c); });
  verb.draws = true;
  return verb;
}

}  // namespace rigfit::apps
