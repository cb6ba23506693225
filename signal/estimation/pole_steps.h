// Steps of the poles of a model that is linear in everything else (separable least squares).
//
//   min over p and c of |W (y - B(p) c)|^2
//
// At given poles a model eliminates its linear unknowns c exactly, by its own fast way, and states
// what is left: the cost, and for the real and imaginary part of every pole the gradient J'r and
// Gauss and Newton's J'J, J the derivatives outside the columns of B (Kaufman's form). Steps are
// damped after Levenberg and Marquardt, no pole moves further than the linearisation holds, and no
// step raises the cost. They end where the next one is small against the poles' standard
// uncertainties, r being noise of variance cost / freedom, or where only rounding is left. Sources:
// Golub and Pereyra, Inverse Problems 19 (2003) R1; Kaufman, BIT 15 (1975) 49; Ruhe and Wedin, SIAM
// Review 22 (1980) 318; Marquardt, J. SIAM 11 (1963) 431.
#pragma once

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

/// What a model states of its poles; it adds what else it finds there.
struct PoleStage {
  VectorXcd poles;
  double cost = 0;
  /// (real, imaginary) of each pole; parts whose information is 0 are held.
  VectorXd gradient;
  MatrixXd information;  ///< empty: the poles' columns cannot be told apart
  bool usable = false;   ///< false: no such model; `information` is not read

  /// Takes complex gradient and information: the model is analytic in its poles.
  void set_analytic(const VectorXcd& complex_gradient, const MatrixXcd& complex_information);
};

struct PoleStepOptions {
  int max_iterations = 50;    ///< steps, taken or refused
  double step_in_std = 1e-3;  ///< stop when a step is this small against the standard uncertainties
  double freedom = 1;         ///< degrees of freedom: cost / freedom is the noise's variance
  double rounding = 0;        ///< what the cost is known to
  /// Real part where a pole's damping is 0: half of its distance is how far it moves at once.
  double undamped = 0;
  double resolution = 0;  ///< and so much further
  /// Bounds of the imaginary and of the real parts.
  double low = -std::numeric_limits<double>::infinity(),
         high = std::numeric_limits<double>::infinity(),
         fastest = -std::numeric_limits<double>::infinity(),
         slowest = std::numeric_limits<double>::infinity();
};

enum class StepsEnd { converged, iteration_limit, rank_deficient };
[[nodiscard]] const char* name_of(StepsEnd end);

/// One step at a time; for take_pole_steps().
class PoleSteps {
 public:
  explicit PoleSteps(const PoleStepOptions& options) : options_(options) {}
  [[nodiscard]] StepsEnd end() const { return end_; }
  [[nodiscard]] int iterations() const { return iterations_; }
  /// The next poles to try from `stage` into `poles`; false: it is over.
  [[nodiscard]] bool next(const PoleStage& stage, VectorXcd& poles);
  void judge(bool better);

 private:
  const PoleStepOptions& options_;
  StepsEnd end_ = StepsEnd::iteration_limit;
  int iterations_ = 0;
  double damping_ = 1e-3, gain_ = 0;  // gain_: expected of the last step
};

/// Moves `stage` to the minimum. `evaluate(poles)` returns a Stage, derived from PoleStage; of the
/// one left in `stage` the poles may be older than those of the last call.
template <class Stage, class Evaluate>
StepsEnd take_pole_steps(const PoleStepOptions& options, Evaluate&& evaluate, Stage& stage,
                         int* iterations = nullptr) {
  PoleSteps steps(options);
  for (VectorXcd poles; steps.next(stage, poles);) {
    Stage trial = evaluate(poles);
    const bool better = trial.usable && trial.cost <= stage.cost;
    if (better) stage = std::move(trial);
    steps.judge(better);
  }
  if (iterations != nullptr) *iterations = steps.iterations();
  return steps.end();
}

}  // namespace rigfit::signal
