// Time response of a scene to its loads with the parameters of a fit, and its 95 % interval.
//
// The parameters are drawn from their covariance, positive ones lognormal; the scene, its
// equilibrium and its response are computed for every draw. The interval is that of the draws at
// each instant: it holds the value at that instant with a probability of 95 %, not the whole
// history. With a standard uncertainty s of a frequency the phase error grows as 2 pi s t, so that
// the interval widens with time until it spans the amplitude. Source: JCGM 101:2008 (sampling).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "ident/predict/scene_prediction.h"
#include "model/response/response.h"

namespace rigfit::ident {

struct ResponsePredictionOptions {
  model::ResponseOptions response;
  int samples = 200;  ///< draws, >= 40
  std::uint64_t seed = 1;
};

struct ResponsePrediction {
  model::ResponseResult response;           ///< at the fitted values; check its status first
  Eigen::MatrixXd low, high;                ///< as `response.samples`: 95 %
  int samples = 0;                          ///< draws that have a response
  std::vector<std::string> used, not_used;  ///< names of parameters
};

/// No interval (empty matrices) where fewer than 40 draws have a response. Throws
/// std::invalid_argument when no parameter of the fit is one of the scene's, model::SceneError as
/// simulate_response.
[[nodiscard]] ResponsePrediction predict_response(const model::Scene& scene,
                                                  const FittedParameters& fitted,
                                                  const ResponsePredictionOptions& options);

}  // namespace rigfit::ident
