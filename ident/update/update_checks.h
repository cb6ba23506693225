// Checks of an update: states held out, Monte Carlo.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "ident/update/model_update.h"

namespace rigfit::ident {

struct HeldOut {
  int state = 0;
  UpdateStatus status = UpdateStatus::not_converged;
  double rms_fitted = 0;     ///< over the fitted states
  double rms_predicted = 0;  ///< held-out state
  double rms_before = 0;     ///< held-out state, at the start values
  double frf_fitted = 0, frf_predicted = 0, frf_before = 0;  ///< rms |ln FRF ratio| likewise
  std::vector<UpdatedPair> pairs;                            ///< held-out state
  std::optional<model::Scene> scene = std::nullopt;          ///< held-out state, as predicted
};

/// Leaves out each state in turn, fits the others, and predicts it with the shared parameters.
[[nodiscard]] std::vector<HeldOut> hold_out_each(const std::vector<UpdateState>& states,
                                                 const std::vector<FreeParameter>& free,
                                                 const UpdateOptions& options = {});

struct UpdateMonteCarlo {
  int samples = 0, failed = 0;
  Eigen::MatrixXd values;                ///< parameters x successful samples
  Eigen::VectorXd mean, std, low, high;  ///< central 95 % interval
  /// Frequencies of the solution's pairs, in their order: as the refitted model gives them, and as
  /// the scene gives them before any fit (inputs and priors drawn, the rest at its start).
  struct Frequencies {
    Eigen::VectorXd mean, std, low, high;  ///< Hz
  };
  Frequencies fitted, before;
};

/// Refits from the solution, with its pairs. Each sample draws from normal distributions: measured
/// frequencies, damping ratios and FRFs about the fitted model's (with their uncertainties, or the
/// fit's scatter where there are none), priors, and every input.
/// `progress` is called after each sample, from any thread.
[[nodiscard]] UpdateMonteCarlo update_monte_carlo(const UpdateResult& solution,
                                                  const std::vector<UpdateState>& states,
                                                  const std::vector<FreeParameter>& free,
                                                  const UpdateOptions& options, int samples,
                                                  const std::function<void()>& progress = {});

}  // namespace rigfit::ident
