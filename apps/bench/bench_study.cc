#include "apps/bench/bench_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "apps/cli/assets.h"
#include "model/response/response.h"
#include "model/scene/read_scene.h"
#include "signal/estimation/robust.h"

namespace rigfit::apps {

Plot bench_plot(const BenchStudy& study) {
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

namespace {

using model::ResponseOptions;
using model::ResponseResult;
using model::ResponseSolver;

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
      return {skipped("the scene has no load or no sensor")};
    }
    for (const auto& load : scene_.loads) {
      if (load.kind == model::Load::Kind::record) return {skipped("a load is a recording")};
    }
    own_ = model::simulate_response(scene_, base_);
    if (!own_.completed) return {skipped("the response fails: " + own_.reason)};
    return {steps_study(), segments_study()};
  }

 private:
  BenchStudy skipped(std::string why) const {
    BenchStudy study;
    study.scene = scene_.title;
    study.skipped = std::move(why);
    return study;
  }

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
    if (!natural.completed) {
      study.skipped = "the reference fails: " + natural.reason;
      return study;
    }
    // As fine as a part of the time allows.
    int parts = 12;
    while (parts > 3 && (1 + 2.0 / 3) * parts * natural.wall_s > (quick_ ? 0.3 : 5)) parts /= 2;
    fine.step_s = 1.5 * natural.step_s / parts;
    const ResponseResult coarser = simulate(fine);
    fine.step_s = natural.step_s / parts;
    const ResponseResult finest = simulate(fine);
    if (!finest.completed || !coarser.completed) {
      study.skipped = "the reference fails: " + finest.reason + coarser.reason;
      return study;
    }
    const auto& truth = finest.samples;
    study.reference =
        fmt::format("{} scheme, steps of {:.2g} ms", name_of(fine.solver), 1e3 * finest.step_s);
    study.reference_error = difference(coarser, truth);
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
    // Finer than what is compared, "auto" too.
    model::Scene given = scene_;
    for (auto& member : scene_.members) member.segments = 0;
    const int automatic = mean_segments(simulate(base_).segments);
    std::swap(scene_, given);
    const int fine = quick_ ? 120 : std::clamp(2 * automatic, 240, 600);
    ResponseOptions options = base_;
    options.solver = own_.solver;
    options.segments = 2 * fine / 3;
    const ResponseResult coarser = simulate(options);
    options.segments = fine;
    const ResponseResult finest = simulate(options);
    if (!finest.completed || !coarser.completed) {
      study.skipped = "the reference fails: " + finest.reason + coarser.reason;
      return study;
    }
    study.reference = fmt::format("{} segments a member, {}", fine, name_of(own_.solver));
    study.reference_error = difference(coarser, finest.samples);
    options = base_;
    options.solver = own_.solver;
    for (const int n : {8, 15, 30, 60, 120}) {
      if (n >= fine) continue;
      options.segments = n;
      add(study, finest.samples, name_of(own_.solver), options);
    }
    std::swap(scene_, given);
    add(study, finest.samples, "segments = \"auto\"", base_, true);
    std::swap(scene_, given);
    return study;
  }

  model::Scene scene_;
  bool quick_;
  ResponseOptions base_;
  ResponseResult own_;
};

}  // namespace

model::Scene bench_released_cable() {
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

std::vector<BenchStudy> response_studies(const model::Scene& scene, double duration_s, bool quick) {
  return Studies(scene, duration_s, quick).run();
}

}  // namespace rigfit::apps
