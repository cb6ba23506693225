// Time against error of every response solver on the 1 kg release of the 200 N cable (10 s at
// 2 kHz, 30 segments), as a table. Truth is the explicit scheme at a twelfth of its step; its own
// error is that against a sixth, over 15 (fourth order).
//
//   response_table [DURATION_S [SEGMENTS]]
//   response_table perturbed: CVODE-Adams at 1e-8 where the released mass is off by rounding
//   response_table cost: nanoseconds a segment and step of the explicit scheme against segments
//
// Times are the processor's, one core (the median of repeated runs). Errors are root-mean-square
// differences over the root-mean-square of the truth (about its mean), for the displacement and the
// acceleration at mid-span. The last column compares, for every own run, with the CVODE-Adams time
// at the same displacement error, interpolated in its table on logarithmic scales (its nearest end
// where the error lies outside).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "model/response/response.h"
#include "tests/model/motion_scenes.h"

using namespace rigfit::model;

namespace {

struct Row {
  const char* name;
  double control;
  double time_s, displacement, acceleration, drift;
  long steps;
};

double error(const Eigen::MatrixXd& a, const Eigen::MatrixXd& truth, int column) {
  const double mean = truth.col(column).mean();
  return (a.col(column) - truth.col(column)).norm() /
         (truth.col(column).array() - mean).matrix().norm();
}

double adams_time(const std::vector<Row>& adams, double wanted) {
  std::size_t best = 0;
  for (std::size_t i = 0; i + 1 < adams.size(); ++i) {
    const double a = std::log(adams[i].displacement), b = std::log(adams[i + 1].displacement);
    const double x = (std::log(wanted) - a) / (b - a);
    if (x >= 0 && x <= 1) {
      return std::exp(std::log(adams[i].time_s) * (1 - x) + std::log(adams[i + 1].time_s) * x);
    }
  }
  for (std::size_t i = 0; i < adams.size(); ++i) {
    if (std::abs(std::log(adams[i].displacement / wanted)) <
        std::abs(std::log(adams[best].displacement / wanted))) {
      best = i;
    }
  }
  return adams[best].time_s;
}

// The least of seven runs of 24,000 steps, less what a run without steps takes.
void cost_of_a_step() {
  std::printf("| segments | in the plane, ns a segment and step | in space |\n|---|---|---|\n");
  for (const int segments : {6, 14, 30, 60, 120, 240}) {
    const Scene scene = testing::released_cable(segments);
    std::printf("| %d |", segments);
    for (const bool plane : {true, false}) {
      ResponseOptions options;
      options.solver = ResponseSolver::explicit_motion;
      options.plane = plane;
      options.axial = true;
      options.step_s = 0.0005 / 6 * 30 / segments;
      const double rate = 1 / (6 * *options.step_s);
      double least[2] = {1e9, 1e9};
      for (int part = 0; part < 2; ++part) {
        const int rows = part == 0 ? 1 : 4001;
        options.sampling = {.duration_s = rows / rate, .rate_hz = rate, .energy_samples = 0};
        for (int i = 0; i < 7; ++i) {
          const std::clock_t begin = std::clock();
          const ResponseResult result = simulate_response(scene, options);
          if (!result.completed) std::printf(" failed: %s", result.reason.c_str());
          least[part] =
              std::min(least[part], static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
        }
      }
      std::printf(" %.1f |", (least[1] - least[0]) / 24000 / segments * 1e9);
    }
    std::printf("\n");
  }
}

// Runs that differ by (1 + k 1e-14) in the released mass differ by that in their truth; what they
// differ by in their errors is what rounding makes of the integrator.
void perturbed() {
  ResponseOptions options;
  options.sampling = {.duration_s = 10, .rate_hz = 2000, .energy_samples = 100};
  std::printf("| k | steps | error, displacement | energy drift |\n|---|---|---|---|\n");
  options.solver = ResponseSolver::explicit_motion;
  options.step_s = 0.0005 / 72;
  const ResponseResult truth = simulate_response(testing::released_cable(30), options);
  options.step_s.reset();
  options.solver = ResponseSolver::cvode_adams;
  options.relative_tolerance = 1e-8;
  for (int k = 0; k < 6; ++k) {
    Scene scene = testing::released_cable(30);
    scene.loads[0].mass *= 1 + k * 1e-14;
    const ResponseResult found = simulate_response(scene, options);
    if (!found.completed) continue;
    std::printf("| %d | %ld | %.2e | %.1e |\n", k, found.steps,
                error(found.samples, truth.samples, 0), found.energy_drift);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "perturbed") {
    perturbed();
    return 0;
  }
  if (argc > 1 && std::string(argv[1]) == "cost") {
    cost_of_a_step();
    return 0;
  }
  const double duration = argc > 1 ? std::atof(argv[1]) : 10;
  const Scene scene = testing::released_cable(argc > 2 ? std::atoi(argv[2]) : 30);
  ResponseOptions options;
  options.sampling = {.duration_s = duration, .rate_hz = 2000, .energy_samples = 100};
  options.solver = ResponseSolver::explicit_motion;
  options.step_s = 0.0005 / 36;
  const ResponseResult coarser = simulate_response(scene, options);
  options.step_s = 0.0005 / 72;
  const ResponseResult truth = simulate_response(scene, options);
  if (!truth.completed || !coarser.completed) {
    std::printf("the truth failed: %s\n", truth.reason.c_str());
    return 1;
  }
  std::printf("error of the truth: %.1e in displacement, %.1e in acceleration\n\n",
              error(coarser.samples, truth.samples, 0) / 15,
              error(coarser.samples, truth.samples, 1) / 15);
  const auto run = [&](const char* name, int repeats) {
    std::vector<double> times;
    ResponseResult result;
    for (int i = 0; i < repeats; ++i) {
      const std::clock_t begin = std::clock();
      result = simulate_response(scene, options);
      times.push_back(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
    }
    std::sort(times.begin(), times.end());
    const bool cvode = options.solver == ResponseSolver::cvode_adams ||
                       options.solver == ResponseSolver::cvode_banded;
    Row row{name,
            cvode ? options.relative_tolerance : result.step_s,
            times[times.size() / 2],
            1,
            1,
            1,
            result.steps};
    if (result.completed) {
      row.displacement = error(result.samples, truth.samples, 0);
      row.acceleration = error(result.samples, truth.samples, 1);
      row.drift = result.energy_drift;
    }
    return row;
  };
  std::vector<Row> adams, rows;
  options.step_s.reset();
  options.solver = ResponseSolver::cvode_adams;
  for (double tolerance : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8}) {
    options.relative_tolerance = tolerance;
    adams.push_back(run("CVODE-Adams, fixed point", 1));
  }
  options.solver = ResponseSolver::cvode_banded;
  for (double tolerance : {1e-4, 1e-5, 1e-6}) {
    options.relative_tolerance = tolerance;
    rows.push_back(run("CVODE-BDF, banded Newton", 1));
  }
  options.solver = ResponseSolver::implicit_motion;
  for (double step : {0.0005, 0.00025}) {
    options.step_s = step;
    rows.push_back(run("implicit, banded Newton", 1));
  }
  options.step_s.reset();
  options.solver = ResponseSolver::explicit_motion;
  options.axial = false;
  rows.push_back(run("explicit, axial waves slowed", 5));
  options.axial = true;
  for (double step : {0.0005 / 6, 0.0005 / 8, 0.0005 / 12, 0.0005 / 24}) {
    options.step_s = step;
    rows.push_back(run("explicit", 5));
  }
  options.step_s.reset();
  options.solver = ResponseSolver::modal;
  rows.push_back(run("modal (linear)", 5));

  std::printf(
      "| solver | step or tolerance | steps | time, s | error, displacement | "
      "error, acceleration | energy drift | CVODE-Adams time / this |\n"
      "|---|---|---|---|---|---|---|---|\n");
  const auto print = [&](const Row& row) {
    std::printf("| %s | %.3g | %ld | %.4f | %.2e | %.2e | %.1e | %.1f |\n", row.name, row.control,
                row.steps, row.time_s, row.displacement, row.acceleration, row.drift,
                adams_time(adams, row.displacement) / row.time_s);
  };
  for (const Row& row : adams) print(row);
  for (const Row& row : rows) print(row);
  return 0;
}
