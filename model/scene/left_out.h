// What a model of a scene leaves out, and what that costs.
#pragma once

#include <string>

namespace rigfit::model {

/// One simplification of a model and its estimated error.
struct LeftOut {
  std::string what;           ///< such as "torsion"
  double relative_error = 0;  ///< estimated
  /// What the error is of: "frequency" (of the modes that take part), or "response" (root mean
  /// square of the sensors' samples).
  std::string of = "frequency";
};

}  // namespace rigfit::model
