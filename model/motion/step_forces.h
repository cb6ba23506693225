// The forces of all loads as an explicit scheme takes them: one value a step, such that impulse and
// its moment are exact: the average over neighbouring steps with a hat, less h^2/12 of the second
// difference that the average adds.
#pragma once

#include "model/algebra/numbers.h"
#include "model/motion/motion_problem.h"

namespace rigfit::model {

class StepForces {
 public:
  StepForces(const MotionProblem& problem, double step, long steps);

  /// Whether any force acts at step n.
  [[nodiscard]] bool active(long n) const { return n >= active_from_ && n <= active_to_; }
  /// N along the load's direction, of load l at step n.
  [[nodiscard]] double at(std::size_t l, long n) const {
    const LoadSteps& load = loads_[l];
    const long i = n - load.first;
    return i >= 0 && i < static_cast<long>(load.value.size())
               ? load.value[static_cast<std::size_t>(i)]
               : 0;
  }
  /// The largest size of load l's force at any step, N.
  [[nodiscard]] double largest(std::size_t l) const {
    double size = 0;
    for (const double f : loads_[l].value) size = std::max(size, std::abs(f));
    return size;
  }

 private:
  struct LoadSteps {
    long first = 0;
    std::vector<double> value;
  };
  std::vector<LoadSteps> loads_;
  long active_from_ = std::numeric_limits<long>::max(), active_to_ = -1;
};

}  // namespace rigfit::model
