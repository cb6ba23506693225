// Time against error of every response solver on the 1 kg release of the 200 N cable (10 s at
// 2 kHz, 30 segments), as a table. Truth is the explicit scheme at a twelfth of its step.
//
//   response_table [DURATION_S [SEGMENTS]]
//
// Errors are root-mean-square differences over the root-mean-square of the truth (about its mean),
// for the displacement and the acceleration at mid-span. The last column compares, for every own
// run, with the CVODE-Adams time at the same displacement error, interpolated in its table on
// logarithmic scales (its nearest end where the error lies outside).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "model/response.h"
#include "tests/model/motion_scenes.h"

using namespace rigfit::model;

namespace {

struct Row {
  ResponseSolver solver;
  double control;
  double wall_s, displacement, acceleration, drift;
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
      return std::exp(std::log(adams[i].wall_s) * (1 - x) + std::log(adams[i + 1].wall_s) * x);
    }
  }
  for (std::size_t i = 0; i < adams.size(); ++i) {
    if (std::abs(std::log(adams[i].displacement / wanted)) <
        std::abs(std::log(adams[best].displacement / wanted))) {
      best = i;
    }
  }
  return adams[best].wall_s;
}

}  // namespace

int main(int argc, char** argv) {
  const double duration = argc > 1 ? std::atof(argv[1]) : 10;
  const Scene scene = testing::released_cable(argc > 2 ? std::atoi(argv[2]) : 30);
  ResponseOptions options;
  options.sampling = {.duration_s = duration, .rate_hz = 2000, .energy_samples = 100};
  options.solver = ResponseSolver::explicit_motion;
  options.step_s = 0.0005 / 72;
  const ResponseResult truth = simulate_response(scene, options);
  if (!truth.completed) {
    std::printf("the truth failed: %s\n", truth.reason.c_str());
    return 1;
  }
  const auto run = [&](ResponseSolver solver, double control, int repeats) {
    options.solver = solver;
    options.step_s.reset();
    const bool cvode =
        solver == ResponseSolver::cvode_adams || solver == ResponseSolver::cvode_banded;
    if (cvode) {
      options.relative_tolerance = control;
    } else {
      options.step_s = control;
    }
    std::vector<double> times;
    ResponseResult result;
    for (int i = 0; i < repeats; ++i) {
      result = simulate_response(scene, options);
      times.push_back(result.wall_s);
    }
    std::sort(times.begin(), times.end());
    if (!result.completed) {
      return Row{solver, control, times[times.size() / 2], 1, 1, 1, result.steps};
    }
    return Row{solver,
               control,
               times[times.size() / 2],
               error(result.samples, truth.samples, 0),
               error(result.samples, truth.samples, 1),
               result.energy_drift,
               result.steps};
  };
  std::vector<Row> adams, rows;
  for (double tolerance : {1e-4, 1e-5, 1e-6}) {
    adams.push_back(run(ResponseSolver::cvode_adams, tolerance, 1));
  }
  for (double step : {0.0005 / 6, 0.0005 / 8, 0.0005 / 12, 0.0005 / 24}) {
    rows.push_back(run(ResponseSolver::explicit_motion, step, 5));
  }
  for (double step : {0.0005, 0.00025}) {
    rows.push_back(run(ResponseSolver::implicit_motion, step, 1));
  }
  for (double tolerance : {1e-4, 1e-5}) {
    rows.push_back(run(ResponseSolver::cvode_banded, tolerance, 1));
  }
  rows.push_back(run(ResponseSolver::modal, 0.0005, 5));

  std::printf(
      "| solver | step or tolerance | steps | time, s | error, displacement | "
      "error, acceleration | energy drift | CVODE-Adams time / this |\n"
      "|---|---|---|---|---|---|---|---|\n");
  const auto print = [&](const Row& row) {
    std::printf("| %s | %.3g | %ld | %.4f | %.2e | %.2e | %.1e | %.1f |\n", name_of(row.solver),
                row.control, row.steps, row.wall_s, row.displacement, row.acceleration, row.drift,
                adams_time(adams, row.displacement) / row.wall_s);
  };
  for (const Row& row : adams) print(row);
  for (const Row& row : rows) print(row);
  return 0;
}
