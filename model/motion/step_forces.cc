#include "model/motion/step_forces.h"

namespace rigfit::model {
namespace {

// (1/h) int f(t + s) (1 - |s|/h) ds by Gauss-Legendre (5 points) between corners. Before t = 0
// there is no force.
double hat_average(const LoadForce& force, const std::vector<double>& corners, double t, double h) {
  std::vector<double> cuts{std::max(0.0, t - h), std::max(0.0, t), std::max(0.0, t + h)};
  for (auto c = std::lower_bound(corners.begin(), corners.end(), t - h);
       c != corners.end() && *c < t + h; ++c) {
    if (*c > 0) cuts.push_back(*c);
  }
  std::sort(cuts.begin(), cuts.end());
  static constexpr double kNode[5] = {-0.9061798459386640, -0.5384693101056831, 0,
                                      0.5384693101056831, 0.9061798459386640};
  static constexpr double kWeight[5] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                        0.4786286704993665, 0.2369268850561891};
  double sum = 0;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double middle = (cuts[i] + cuts[i + 1]) / 2, half = (cuts[i + 1] - cuts[i]) / 2;
    if (!(half > 0)) continue;
    for (int k = 0; k < 5; ++k) {
      const double at = middle + half * kNode[k];
      sum += kWeight[k] * half * force.at(at) * (1 - std::abs(at - t) / h);
    }
  }
  return sum / h;
}

}  // namespace

StepForces::StepForces(const MotionProblem& problem, double step, long steps) {
  for (std::size_t l = 0; l < problem.loads.size(); ++l) {
    const LoadForce force(problem.loads[l], problem.records[l]);
    LoadSteps load;
    const double end = force.end_s();
    const std::vector<double> corners = force.corners();
    if (end > 0 && !corners.empty()) {
      load.first = std::max(0L, static_cast<long>(std::floor(corners.front() / step)) - 2);
      const long last = std::min(steps, static_cast<long>(std::ceil(end / step)) + 2);
      std::vector<double> hat;
      for (long n = load.first - 1; n <= last + 1; ++n) {
        // Mirrored at t = 0, where the first kick lasts half a step only.
        hat.push_back((n == 0 ? 2 : 1) *
                      hat_average(force, corners, static_cast<double>(std::abs(n)) * step, step));
      }
      for (std::size_t i = 1; i + 1 < hat.size(); ++i) {
        load.value.push_back(hat[i] - (hat[i + 1] - 2 * hat[i] + hat[i - 1]) / 12);
      }
      active_from_ = std::min(active_from_, load.first);
      active_to_ = std::max(active_to_, last);
    }
    loads_.push_back(std::move(load));
  }
}

}  // namespace rigfit::model
