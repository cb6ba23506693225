// A check of an update: states held out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ident/update/model_update.h"

namespace rigfit::ident {

struct HeldOut {
  int state = 0;
  std::string name;  ///< the state's
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

}  // namespace rigfit::ident
